// What stands around a stack's room: its title, the lamps to choose, how far films lie off, the paper, and the help.

import { wantedImage } from "../tools/cards.js";
import { element, icon, iconButton, oneDecimal, qualityOf, setPressed, wordButton } from "../tools/elements.js";
import { createHeader } from "./header.js";
import { createHelp } from "./help.js";

const WHAT = "Light falls through printed films that lie above each other; under each lamp they show another picture.";
const MOVED = "Light falls through printed films that lie above each other; as films are moved they show another picture.";
const OFF = "How far each film lies from where it should, as when one lays them by hand: every film its own way";
/** Films lie off by this at most, mm, in steps of so much. */
const [FARTHEST, STEP] = [0.5, 0.01];
/** A score above this is as good as any, dB. */
const PERFECT = 60;
const GESTURES = [
  ["drag", "look around the films"],
  ["wheel · pinch", "go nearer, or farther"],
  ["double click", "put the eye back"],
];
const KEYS = [
  ["← → · Page Up, Page Down · , .", "previous, next picture"],
  ["Space", "play, pause"],
  ["Home", "first picture"],
  ["+ −", "nearer, farther"],
  ["D", "details: wanted and shown"],
  ["A", "larger type, for a projector"],
  ["F", "full screen"],
  ["T", "light or dark"],
  ["?", "this list"],
];

/** Title, what it is, and buttons. */
export function headerOfFilms(scene, does) {
  const details = wordButton("details", "Details", "What was wanted and what is shown (D)", does.details);
  const lamps = scene.pictures.every(({ told }) => told.startsWith("under"));
  return {
    element: createHeader(scene, lamps ? WHAT : MOVED, [details], does),
    update: (now) => setPressed(details, now.details),
  };
}

/** Playing, which lamp is lit, and the slider of films that lie off. */
export function controlsOfFilms(scene, does) {
  const play = iconButton("play", "Play", "Space", does.play);
  const lamp = element("output", { class: "told", "aria-live": "off" });
  const said = element("output", { class: "told", "aria-live": "off" });
  const slider = element("input", {
    type: "range", min: 0, max: FARTHEST, step: STEP, value: 0, "aria-label": "Films off by, mm", title: OFF,
    input: () => does.off(Number(slider.value)),
  });
  return {
    element: element("div", { class: "controls", role: "group", "aria-label": "Pictures" },
      element("div", { class: "transport" },
        iconButton("previous", "Previous picture", "Page Up", () => does.neighbour(-1)), play,
        iconButton("next", "Next picture", "Page Down", () => does.neighbour(1))),
      lamp, said, element("div", { class: "slider" }, slider)),
    update(now) {
      if (play.dataset.playing !== String(now.playing)) {
        play.dataset.playing = now.playing;
        play.replaceChildren(icon(now.playing ? "pause" : "play"));
        play.setAttribute("aria-label", now.playing ? "Pause" : "Play");
      }
      lamp.textContent = now.told;
      said.textContent = `films off by ${now.off.toFixed(2)} mm`;
      if (Number(slider.value) !== now.off) slider.value = now.off;
      slider.style.setProperty("--part", now.off / FARTHEST);
      slider.setAttribute("aria-valuetext", `${now.off.toFixed(2)} mm`);
    },
  };
}

/**
 * What the paper shows, large, and beside what was wanted.
 *
 * @param {Object} scene
 * @returns {{element: HTMLElement, pair: HTMLElement, update: function(Object): void}}
 */
export function createPaper(scene) {
  const [canvas, beside] = [0, 1].map(() => element("canvas", { role: "img", "aria-label": "What the paper shows" }));
  const [name, quality, title, facts] = ["span", "span", "h2", "p"].map((tag) => element(tag));
  [name.className, quality.className, facts.className, beside.className] = ["name", "quality", "facts", "image"];
  const wanted = element("div", { class: "picture" });
  let drawn = null;
  return {
    element: element("figure", { class: "wall" }, canvas, element("figcaption", {}, name, quality)),
    pair: element("section", { class: "card compare", "aria-label": "Wanted and shown" },
      element("header", {}, title, facts),
      element("div", { class: "pair" },
        element("figure", {}, wanted, element("figcaption", { text: "wanted" })),
        element("figure", {}, element("div", { class: "picture" }, beside), element("figcaption", { text: "shown" })))),
    update(now) {
      for (const each of [canvas, beside]) put(each, scene, now.levels);
      const picture = scene.pictures[now.picture];
      const score = scoreOf(now.psnr);
      name.textContent = title.textContent = picture.name;
      quality.textContent = [qualityOf(now.psnr), score].filter(Boolean).join(", ");
      facts.textContent = [picture.told, `films off by ${now.off.toFixed(2)} mm`, score].filter(Boolean).join(" · ");
      if (drawn !== now.picture) wanted.replaceChildren(wantedImage(scene, picture));
      drawn = now.picture;
    },
  };
}

/** What the page holds, in a line. */
export function quietOfFilms({ shape: [count, rows, columns] }) {
  return element("p", { class: "quiet", text: `${count} films of ${columns} × ${rows} cells. What the paper shows is the exact mean ` +
    "over each pixel, as “play” casts it; so that one sees them the films are drawn brighter than they are." });
}

/** The list of gestures and keys. */
export function helpOfFilms() {
  const off = "The slider lays every film off by some part of a millimetre, as hands do, and the picture is cast anew.";
  return createHelp("Looking at films and what they show", `${WHAT} ${off}`, GESTURES, KEYS);
}

function put(canvas, { raster: [rows, columns] }, levels) {
  if (canvas.width !== columns || canvas.height !== rows) Object.assign(canvas, { width: columns, height: rows });
  canvas.getContext("2d").putImageData(new ImageData(levels, columns, rows), 0, 0);
}

function scoreOf(psnr) {
  if (psnr === null) return "";
  return psnr > PERFECT ? `above ${PERFECT} dB` : `${oneDecimal(psnr)} dB`;
}
