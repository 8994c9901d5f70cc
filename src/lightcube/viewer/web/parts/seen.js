// What a relief shows from above: large, and beside what was wanted.

import { wantedImage } from "../tools/cards.js";
import { degreesText, element, qualityOf, scoreText } from "../tools/elements.js";

/** Put levels of red, green, blue, opaque on a canvas of a scene's pixels. */
function put(canvas, { window: [rows, columns] }, levels) {
  if (canvas.width !== columns || canvas.height !== rows) Object.assign(canvas, { width: columns, height: rows });
  canvas.getContext("2d").putImageData(new ImageData(levels, columns, rows), 0, 0);
}

/** Whether the lamp stands where the plate is made for. */
function isRight(now) {
  return now.here && now.right;
}

/** The score of a picture from where one looks; of single columns there is none. */
function scoreOf(picture, blur) {
  return { near: picture.psnr, far: picture.far_psnr }[blur] ?? null;
}

/**
 * The picture that the lamp shows, large, with its name.
 *
 * @param {Object} scene
 * @returns {{element: HTMLElement, update: function(Object, Uint8ClampedArray): void}} `update` takes what is known at a
 *   moment, and levels of what is seen
 */
export function createSeen(scene) {
  const canvas = element("canvas", { role: "img", "aria-label": "What the plate shows" });
  const name = element("span", { class: "name" });
  const quality = element("span", { class: "quality" });
  return {
    element: element("figure", { class: "wall" }, canvas, element("figcaption", {}, name, quality)),
    update(now, levels) {
      put(canvas, scene, levels);
      canvas.classList.toggle("columns", now.blur === "columns");
      name.textContent = now.here ? now.name : "between two pictures";
      quality.textContent = isRight(now) ? qualityOf(scoreOf(scene.pictures[now.picture], now.blur)) : "";
      canvas.setAttribute("aria-label", now.here ? `The plate shows ${now.name}` : "The plate between two pictures");
    },
  };
}

/**
 * The nearest picture as it was wanted and as it is shown.
 *
 * @param {Object} scene
 * @returns {{element: HTMLElement, update: function(Object, Uint8ClampedArray): void}}
 */
export function createPair(scene) {
  const [title, facts] = [element("h2"), element("p", { class: "facts" })];
  const [wanted, shown] = [element("div", { class: "picture" }), element("canvas", { class: "image" })];
  let drawn = null;
  return {
    element: element("section", { class: "card compare", "aria-label": "Wanted and shown" },
      element("header", {}, title, facts),
      element("div", { class: "pair" },
        element("figure", {}, wanted, element("figcaption", { text: "wanted" })),
        element("figure", {}, element("div", { class: "picture" }, shown), element("figcaption", { text: "shown" })))),
    update(now, levels) {
      const picture = scene.pictures[now.picture];
      title.textContent = picture.name;
      facts.textContent = placeText(now, picture);
      if (drawn !== now.picture) wanted.replaceChildren(wantedImage(scene, picture));
      drawn = now.picture;
      put(shown, scene, levels);
    },
  };
}

/** "lamp at 90.0° · here · 25.9 dB near by". */
function placeText(now, picture) {
  const stop = `lamp at ${degreesText(picture.angle_deg)}`;
  if (!now.here) return `${stop} · ${degreesText(Math.abs(now.away))} away`;
  if (!now.right) return `${stop} · ${degreesText(now.elevation)} high`;
  return [stop, "here", scoreText(scoreOf(picture, now.blur))].filter(Boolean).join(" · ");
}
