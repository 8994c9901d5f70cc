// The card that shows the nearest stop's picture as it was wanted and as it is shown, and the lamps that make it.

import { middleOfShadow } from "../model/stage.js";
import { lampPowers, wantedImage } from "../tools/cards.js";
import { clampTo, degreesText, element, figuresText, overlapText, placeIn, scoreText } from "../tools/elements.js";
import { dot, sub } from "../tools/vectors.js";

const COLOURS = ["red", "green", "blue"];

/**
 * The card; where there are several screens, with a tab for each.
 *
 * @param {Object} scene
 * @param {Object} does `screen(place)`: another screen is chosen; `point(row, column)`: a pixel of the shown picture is
 *   pointed at, `column` null where only the row counts
 * @returns {{element: HTMLElement, update: function(Object, RoomView): void}} `update` takes what is known at a
 *   moment, and the room
 */
export function createCompare(scene, does) {
  const title = element("h2");
  const facts = element("p", { class: "facts" });
  const tabs = element("div", { class: "tabs", role: "group", "aria-label": "Screens" });
  const wanted = element("div", { class: "picture" });
  const shown = scene.solid ? createStill() : createShown(does);
  const caption = element("figcaption");
  const lamps = scene.solid ? null : createLamps(scene); // a shape's are all alike
  let drawn = "";
  const card = element("section", { class: "card compare", "aria-label": "Wanted and shown" },
    element("header", {}, title, facts), tabs,
    element("div", { class: "pair" },
      element("figure", {}, wanted, element("figcaption", { text: "wanted" })),
      element("figure", {}, shown.element, caption)),
    lamps?.element ?? null);

  return {
    element: card,
    update(now, view) {
      const exposure = now.exposures[now.spot.place];
      const picture = scene.pictures[exposure.picture];
      title.textContent = picture.name + (picture.mirrored ? " (mirrored)" : "");
      facts.textContent = exposure.lit ? placeText(now, picture) : "no light on this screen here";
      const key = `${exposure.picture} ${exposure.lit}`;
      if (key !== drawn) wanted.replaceChildren(wantedImage(scene, picture));
      drawn = key;
      updateTabs(tabs, scene, now, does);
      caption.textContent = now.thin ? "shown, thin beams" : "shown";
      shown.update(now, view, now.whole ? windowInWhole(scene, exposure) : null);
      lamps?.update(exposure);
    },
  };
}

/** "stop 33.8° · here · 54.1 dB"; the score is of all light, not of thin beams. */
function placeText({ away, thin }, picture) {
  const stop = `stop ${degreesText(picture.angle_deg)}`;
  if (Math.abs(away) >= 0.005) return `${stop} · ${degreesText(Math.abs(away))} away`;
  return [stop, "here", thin ? "" : scoreText(picture.psnr), overlapText(picture.overlap)].filter(Boolean).join(" · ");
}

/** The shown picture of a shape, of which all rows are alike. */
function createStill() {
  const canvas = element("canvas", { class: "image" });
  return {
    element: element("div", { class: "picture" }, canvas),
    update: (now, view) => view.copyShadow(now.spot.place, canvas),
  };
}

/** The shown picture, on which pointing, dragging or the arrow keys choose a row. */
function createShown(does) {
  const canvas = element("canvas", { class: "image" });
  const line = element("span", { class: "line" });
  const dotted = element("span", { class: "dot" });
  const frame = element("span", { class: "frame" });
  const area = element("div", {
    class: "picture choose", tabindex: 0, role: "slider", "aria-orientation": "vertical",
    "aria-label": "Row of the shown picture", "aria-valuemin": 1,
  }, canvas, line, dotted, frame);
  let [row, column, rows, columns] = [0, null, 1, 1];

  const pointAt = (event) => {
    const [x, y] = placeIn(canvas, event);
    row = within(Math.floor(y * rows), rows); // at once: the mouse may leave before the next drawing
    does.point(row, within(Math.floor(x * columns), columns));
  };
  area.addEventListener("pointerdown", pointAt);
  area.addEventListener("pointermove", pointAt);
  area.addEventListener("pointerleave", (event) => {
    if (event.pointerType === "mouse") does.point(row, null); // what a finger has shown stays
  });
  area.addEventListener("keydown", (event) => {
    const way = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key];
    if (way === undefined) return;
    event.preventDefault();
    const across = way[1] === 0 ? column : within((column ?? Math.floor(columns / 2)) + way[1], columns);
    does.point(within(row + way[0], rows), across);
  });

  return {
    element: area,
    update(now, view, inner) {
      ({ row, column } = now.spot);
      [rows, columns] = now.exposures[now.spot.place].window;
      view.copyShadow(now.spot.place, canvas);
      placeBox(line, [row, 0, 1, columns], rows, columns);
      dotted.hidden = column === null;
      if (column !== null) placeBox(dotted, [row, column, 1, 1], rows, columns);
      frame.hidden = inner === null;
      if (inner !== null) placeBox(frame, inner, rows, columns);
      area.setAttribute("aria-valuemax", rows);
      area.setAttribute("aria-valuenow", row + 1);
      const across = column === null ? "" : `, column ${column + 1}`;
      area.setAttribute("aria-valuetext", `row ${row + 1} of ${rows}${across}`);
    },
  };
}

/** Lay an element over pixels [row, column, rows, columns] of a picture. */
function placeBox(box, [row, column, tall, wide], rows, columns) {
  const percent = (part, all) => `${(100 * part) / all}%`;
  Object.assign(box.style, {
    top: percent(row, rows), height: percent(tall, rows), left: percent(column, columns), width: percent(wide, columns),
  });
}

function within(number, count) {
  return clampTo(number, 0, count - 1);
}

/** The picture's window [row, column, rows, columns] in the raster of the whole shadow. */
function windowInWhole(scene, { picture, raster }) {
  const views = scene.views.filter((view) => view.picture === picture);
  const { lamp, origin, right, down } = views[0];
  const [rows, columns] = scene.pictures[picture].window;
  const off = sub(origin, middleOfShadow(views, lamp));
  const [below, across] = [down, right].map((step) => dot(off, step) / dot(step, step));
  return [(raster[0] - rows) / 2 + below, (raster[1] - columns) / 2 + across, rows, columns];
}

function updateTabs(tabs, scene, now, does) {
  tabs.hidden = now.exposures.length < 2;
  if (tabs.hidden) return;
  if (tabs.children.length === 0) {
    tabs.append(...now.exposures.map(({ screen }, place) =>
      element("button", { type: "button", text: scene.screens[screen], click: () => does.screen(place) })));
  }
  now.exposures.forEach((exposure, place) => {
    tabs.children[place].setAttribute("aria-pressed", String(place === now.spot.place));
    tabs.children[place].disabled = !exposure.lit;
  });
}

/** Power of every lamp that shines on the screen, by colour, as bars and numbers. */
function createLamps(scene) {
  const most = Math.max(...scene.pairs.flatMap((pair) => pair.power));
  const body = element("tbody");
  const rows = new Map();
  const heading = scene.lamps.length > 1 ? "Lamps" : "Lamp power";
  const table = element("table", { class: "lamps" },
    element("caption", { text: heading, title: "Light in parts of the white that the screen shows at 1" }), body);

  return {
    element: table,
    update(exposure) {
      const powers = lampPowers(exposure);
      for (const [lamp, power] of powers) {
        if (!rows.has(lamp)) rows.set(lamp, lampEntry(scene, lamp));
        rows.get(lamp).update(power, most);
      }
      const order = [...powers.keys()].map((lamp) => rows.get(lamp).element);
      const same = order.length === body.children.length && order.every((row, i) => body.children[i] === row);
      if (!same) body.replaceChildren(...order);
    },
  };
}

function lampEntry(scene, lamp) {
  const cells = (scene.voxels.channels === 1 ? ["white"] : COLOURS).map((colour) => {
    const bar = element("i", { class: "bar" });
    const number = element("span");
    const cell = element("td", { class: colour }, number, element("span", { class: "track" }, bar));
    return { colour, bar, number, cell };
  });
  const name = scene.lamps.length > 1 ? element("th", { scope: "row", text: scene.lamps[lamp] }) : null;
  return {
    element: element("tr", {}, name, ...cells.map(({ cell }) => cell)),
    update(power, most) {
      cells.forEach(({ colour, bar, number, cell }, i) => {
        bar.style.width = `${100 * Math.min(1, power[i] / most)}%`;
        number.textContent = figuresText(power[i]);
        cell.title = `${colour}: ${figuresText(power[i])} times white`;
      });
    },
  };
}
