// The wall as one sees it who stands before it: the picture that the light makes, large, tied to its place in the room.

import { element, qualityOf } from "../tools/elements.js";

const SPACE = "http://www.w3.org/2000/svg";

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
  const threads = document.createElementNS(SPACE, "svg");
  const lines = document.createElementNS(SPACE, "path");
  threads.setAttribute("class", "threads");
  threads.setAttribute("aria-hidden", "true");
  threads.append(lines);

  return {
    element: figure,
    threads,
    update(now, view) {
      const exposure = now.exposures[now.spot.place];
      const picture = scene.pictures[exposure.picture];
      view.copyShadow(now.spot.place, canvas);
      const here = exposure.lit && Math.abs(now.away) < 0.005;
      name.textContent = here ? picture.name : "between two pictures";
      quality.textContent = here ? qualityOf(picture.psnr) : "";
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
    },
  };
}

/** Where a picture of some shape stands in a box that it is fitted into. */
function fittedInto({ left, top, width, height }, aspect) {
  const [wide, high] = [Math.min(width, height * aspect), Math.min(height, width / aspect)];
  return { left: left + (width - wide) / 2, top: top + (height - high) / 2, width: wide, height: high };
}
