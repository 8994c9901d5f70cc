// What tells a person what to do: a hint until the first gesture, and the list of gestures and keys.

import { element, icon, iconButton } from "../tools/elements.js";

const [GLASS, SOLID] = ["Light falls through a block of coloured glass.", "A solid stands in the light."];
const ITS_GLASS = "So that one sees into it the glass is drawn clearer than it is, and shining; what the wall shows, and what the lamp's eye sees, is exact.";
const ITS_LIGHT = "Each pixel shows all the light that falls on it; nearer, one sees how that varies inside.";
const AT_STOPS = "At each stop of the turntable its shadow is another picture.";
const ON_SCREENS = "Its shadows are pictures.";
const GESTURES = [
  ["right drag · Shift drag · two fingers", "move the eye"],
  ["wheel · pinch", "go nearer to what is pointed at, or farther"],
  ["double click", "put the eye back"],
  ["point at a screen", "choose the scan-line"],
];
const TURNING_KEYS = [
  ["← →", "turn by 1°, with Shift by 0.1°"],
  ["Page Up, Page Down · , .", "previous, next picture"],
  ["Space", "play, pause"],
  ["N", "snap to the nearest picture"],
  ["Home", "first picture"],
];
const KEYS = [
  ["arrows on “shown”", "choose the scan-line's row and pixel"],
  ["+ −", "nearer, farther"],
  ["L", "look from where the lamp is"],
  ["D", "details: scores, lamps, scan-line"],
  ["G", "tour, step by step: arrows, Escape"],
  ["A", "larger type, for a projector"],
  ["W", "whole shadow"],
  ["B", "thin beams, as in the paper"],
  ["F", "full screen"],
  ["T", "light or dark"],
  ["?", "this list"],
];

/**
 * A hand that shows what a drag does, until `done` is called.
 *
 * @param {Object} scene
 * @returns {{element: HTMLElement, done: function(): void}}
 */
export function createHint(scene) {
  const hand = element("span", { class: "hand", "aria-hidden": "true" }, icon("hand"));
  const hint = element("div", { class: "hint" }, hand, element("span", { text: `Drag to ${whatDragDoes(scene)}` }));
  return {
    element: hint,
    done() {
      hint.classList.add("gone");
    },
  };
}

/**
 * The list of gestures and keys, in a dialog.
 *
 * @param {Object} scene
 * @returns {{element: HTMLElement, toggle: function(): void}}
 */
export function createHelp(scene) {
  const close = iconButton("close", "Close", "Escape", () => dialog.close());
  const gestures = scene.turns ? [["drag", whatDragDoes(scene)], ...GESTURES] : [["drag", "move the eye"], ...GESTURES.slice(1)];
  const all = [...(scene.turns ? TURNING_KEYS : []), ...KEYS];
  const keys = all.filter(([key]) => (key !== "W" || scene.whole_shadow !== null) && (key !== "G" || !scene.solid));
  const dialog = element("dialog", { class: "help", "aria-labelledby": "lightcube-help" },
    element("header", {}, element("h2", { id: "lightcube-help", text: "Turning a light cube" }), close),
    element("p", { text: `${scene.solid ? SOLID : GLASS} ${scene.turns ? AT_STOPS : ON_SCREENS} ${ITS_LIGHT} ${ITS_GLASS}` }),
    element("div", { class: "lists" }, listOf("gestures", "Mouse and fingers", gestures), listOf("keys", "Keys", keys)));
  dialog.addEventListener("click", (event) => event.target === dialog && dialog.close());
  return {
    element: dialog,
    toggle() {
      if (dialog.open) dialog.close();
      else dialog.showModal();
    },
  };
}

/** What turns under the hand: the cube, or what goes round it. */
function whatDragDoes({ turns, carried }) {
  if (!turns) return "look around";
  return carried ? "turn the cube" : "turn the table";
}

function listOf(kind, title, pairs) {
  return element("section", { class: kind }, element("h3", { text: title }),
    element("dl", {}, ...pairs.map(([what, does]) =>
      element("div", {}, element("dt", { text: what }), element("dd", { text: does })))));
}
