// What tells a person what to do: a hint until the first gesture, and the list of gestures and keys.

import { element, icon, iconButton } from "./elements.js";

const WHAT_IT_IS =
  "Light falls through a block of coloured glass. At each stop of the turntable its shadow is another picture.";
const GESTURES = [
  ["drag", "turn the cube"],
  ["right drag · Shift drag · two fingers", "move the eye"],
  ["wheel · pinch", "go nearer or farther"],
  ["double click", "put the eye back"],
  ["point at a screen", "choose the scan-line"],
];
const KEYS = [
  ["← →", "turn by 1°, with Shift by 0.1°"],
  ["Page Up, Page Down · , .", "previous, next picture"],
  ["Space", "play, pause"],
  ["N", "snap to the nearest picture"],
  ["Home", "first picture"],
  ["+ −", "nearer, farther"],
  ["W", "whole shadow"],
  ["F", "full screen"],
  ["T", "light or dark"],
  ["?", "this list"],
];

/**
 * A hand that shows how to turn the cube, until `done` is called.
 *
 * @param {boolean} turns whether anything turns; else one walks around it
 * @returns {{element: HTMLElement, done: function(): void}}
 */
export function createHint(turns) {
  const hand = element("span", { class: "hand", "aria-hidden": "true" }, icon("hand"));
  const hint = element("div", { class: "hint" }, hand, element("span", { text: turns ? "Drag to turn the cube" : "Drag to look around" }));
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
 * @param {boolean} whole whether there is a whole shadow to show
 * @returns {{element: HTMLElement, toggle: function(): void}}
 */
export function createHelp(whole) {
  const close = iconButton("close", "Close", "Escape", () => dialog.close());
  const keys = KEYS.filter(([, does]) => whole || does !== "whole shadow");
  const dialog = element("dialog", { class: "help", "aria-labelledby": "lightcube-help" },
    element("header", {}, element("h2", { id: "lightcube-help", text: "Turning a light cube" }), close),
    element("p", { text: WHAT_IT_IS }),
    element("div", { class: "lists" }, listOf("Mouse and fingers", GESTURES), listOf("Keys", keys)));
  dialog.addEventListener("click", (event) => event.target === dialog && dialog.close());
  return {
    element: dialog,
    toggle() {
      if (dialog.open) dialog.close();
      else dialog.showModal();
    },
  };
}

function listOf(title, pairs) {
  return element("section", {}, element("h3", { text: title }),
    element("dl", {}, ...pairs.map(([what, does]) =>
      element("div", {}, element("dt", { text: what }), element("dd", { text: does })))));
}
