// What stands around the room of a cube or a shape: its title, its controls, and the help.

import { wordsOf } from "../model/words.js";
import { setPressed, wordButton } from "../tools/elements.js";
import { createControls } from "./controls.js";
import { createHeader } from "./header.js";
import { createHelp, createHint } from "./help.js";

const LIGHT = "Each pixel shows all the light that falls on it; nearer, one sees how that varies inside.";
const THIN = "Show a single ray through the middle of each pixel, as the paper does, instead of all the light that falls on it (B)";
const GESTURES = [
  ["right drag · Shift drag · two fingers", "move the eye"],
  ["wheel · pinch", "go nearer to what is pointed at, or farther"],
  ["double click", "put the eye back"],
];
const POINTING = [["point at a screen", "choose the scan-line"]];
const POINTING_BENT = [["point at a screen", "see the way of the light that falls there"]];
const TURNING_KEYS = [
  ["← →", "turn by 1°, with Shift by 0.1°"],
  ["Page Up, Page Down · , .", "previous, next picture"],
  ["Space", "play, pause"],
  ["N", "snap to the nearest picture"],
  ["Home", "first picture"],
];
const STRAIGHT_KEYS = [
  ["arrows on “shown”", "choose the scan-line's row and pixel"],
  ["G", "tour, step by step: arrows, Escape"],
];
const GLASS_KEYS = [["B", "thin beams, as in the paper"]];
const KEYS = [
  ["A", "larger type, for a projector"],
  ["F", "full screen"],
  ["T", "light or dark"],
  ["?", "this list"],
];

/**
 * Title, what it is, and buttons.
 *
 * @param {Object} scene
 * @param {Object} does `tour()`, `details()`, `theme()`, `fullScreen()`, `help()`
 * @param {boolean} compact the title and the buttons of a notebook
 * @returns {{element: HTMLElement, update: function(Object): void}}
 */
export function headerAround(scene, does, compact) {
  const tour = wordButton("tour", "Tour", "What light does here, step by step, for a class (G)", does.tour);
  const inside = scene.solid || scene.glass ? "What was wanted and what is shown (D)" : "Scores, lamps and the way of the light (D)";
  const details = wordButton("details", "Details", inside, does.details);
  const { lit } = wordsOf(scene);
  const what = scene.turns ? `${lit}; at each stop its shadow is another picture.` : `${lit}; its shadows are pictures.`;
  const tools = compact ? [] : scene.solid || scene.glass ? [details] : [tour, details];
  return {
    element: createHeader(scene, compact ? null : what, tools, does),
    update(now) {
      setPressed(tour, now.lesson !== null);
      setPressed(details, now.details);
    },
  };
}

/**
 * Slider, playing, and what can be chosen of a turning cube.
 *
 * @param {Object} scene
 * @param {number[]} stops
 * @param {Object} does what `createControls` takes, `whole()`, `thin()`, `lampsEye()`
 * @returns {{element: HTMLElement, update: function(Object): void}} `update` takes what the app knows at a moment
 */
export function controlsAround(scene, stops, does) {
  const whole = wordButton("whole", "Whole shadow", "Show the whole shadow (W)", does.whole);
  whole.hidden = scene.whole_shadow === null;
  const thin = wordButton("thin", "Thin beams", THIN, does.thin);
  thin.hidden = scene.solid;
  const eye = wordButton("eye", "Lamp's eye", "Look from where the lamp is (L)", does.lampsEye);
  const controls = createControls(stops, does, "Angle of the turntable", [eye, whole, thin]);
  return {
    element: controls.element,
    update(now) {
      setPressed(eye, now.lampsEye);
      setPressed(whole, now.whole);
      setPressed(thin, now.thin);
      controls.update(now);
    },
  };
}

/** The hint of what a drag does. */
export function hintAround(scene) {
  return createHint(whatDragDoes(scene));
}

/** The list of gestures and keys. */
export function helpAround(scene) {
  const { title, lit, drawn } = wordsOf(scene);
  const pictures = scene.turns ? "At each stop of the turntable its shadow is another picture." : "Its shadows are pictures.";
  const first = scene.turns ? [["drag", whatDragDoes(scene)], ...GESTURES] : [["drag", "move the eye"], ...GESTURES.slice(1)];
  const gestures = scene.solid ? first : [...first, ...(scene.glass ? POINTING_BENT : POINTING)];
  const all = [
    ...(scene.turns ? TURNING_KEYS : []),
    ["+ −", "nearer, farther"],
    ["L", "look from where the lamp is"],
    ["D", scene.solid || scene.glass ? "details: wanted and shown" : "details: scores, lamps, scan-line"],
    ...(scene.whole_shadow === null ? [] : [["W", "whole shadow"]]),
    ...(scene.solid || scene.glass ? [] : STRAIGHT_KEYS),
    ...(scene.solid ? [] : GLASS_KEYS),
    ...KEYS,
  ];
  return createHelp(title, `${lit}. ${pictures} ${LIGHT} ${drawn}`, gestures, all);
}

/** What turns under the hand: the cube, or what goes round it. */
function whatDragDoes(scene) {
  if (!scene.turns) return "look around";
  return `turn the ${scene.carried ? wordsOf(scene).name : "table"}`;
}
