// The wall as one sees it who stands before it: the picture that the light makes, large, tied to its place in the room.

import { element, overlapText, qualityOf, svg } from "../tools/elements.js";

/**
 * The picture on the wall, and threads that lead to it from the wall in the room.
 *
 * @param {Object} scene
 * @returns {{element: HTMLElement, threads: SVGElement, update: function(Object, RoomView): void,
 *   tie: function(Object, RoomView): void}} `update` copies the shadow of a moment, `tie` draws the threads anew
 */
export function createWall(scene) {
  const canvas = element("canvas", { role: "img", "aria-label": "What the wall shows" });
  const name = element("span", { class: "name" });
  const quality = element("span", { class: "quality" });
  const figure = element("figure", { class: "wall" }, canvas, element("figcaption", {}, name, quality));
  const [lines, meant] = [svg("path", {}), svg("path", { class: "meant" })];
  const threads = svg("svg", { class: "threads", "aria-hidden": "true" }, lines, meant);

  return {
    element: figure,
    threads,
    update(now, view) {
      const exposure = now.exposures[now.spot.place];
      const picture = scene.pictures[exposure.picture];
      view.copyShadow(now.spot.place, canvas);
      if (now.lesson?.nameless) {
        name.textContent = quality.textContent = "";
        canvas.setAttribute("aria-label", `What the wall shows: ${now.lesson.title}`);
        return;
      }
      const here = exposure.lit && Math.abs(now.away) < 0.005;
      name.textContent = here ? picture.name : "between two pictures";
      quality.textContent = here ? qualityOf(picture.psnr) || overlapText(picture.overlap) : "";
      canvas.setAttribute("aria-label", here ? `The wall shows ${picture.name}` : "The wall between two pictures");
    },
    tie(now, view) {
      const [around, room, box] = [threads.parentElement, view.canvas, canvas].map((each) => each.getBoundingClientRect());
      const there = fittedInto(box, canvas.width / canvas.height);
      const seen = view.cornersSeen(now.spot.place).map(([x, y]) => [
        room.left + x * room.width - around.left, room.top + y * room.height - around.top,
      ]);
      const [left, top] = [there.left - around.left, there.top - around.top];
      const shown = [[left, top], [left + there.width, top], [left + there.width, top + there.height], [left, top + there.height]];
      // the two corners on the side from which the threads come: the others would cross the picture
      const below = box.top >= room.bottom - 1;
      const ends = below ? [0, 1] : [0, 3];
      lines.setAttribute("d", ends.map((i) => `M${seen[i]}L${shown[i]}`).join(""));
      meant.setAttribute("d", outlineOf(now.lesson?.mark ?? null, { ...there, left, top }, canvas));
    },
  };
}

/** The outline of the pixel or the row that the tour speaks of, around its picture's place. */
function outlineOf(mark, { left, top, width, height }, { width: columns, height: rows }) {
  if (mark === null || mark.row === null) return "";
  const [wide, high] = [width / columns, height / rows];
  const [x, across] = mark.column === null ? [left, width] : [left + mark.column * wide, wide];
  return `M${x - 2} ${top + mark.row * high - 2}h${across + 4}v${high + 4}h${-across - 4}z`;
}

/** Where a picture of some shape stands in a box that it is fitted into. */
function fittedInto({ left, top, width, height }, aspect) {
  const [wide, high] = [Math.min(width, height * aspect), Math.min(height, width / aspect)];
  return { left: left + (width - wide) / 2, top: top + (height - high) / 2, width: wide, height: high };
}
