// What tells a person what to do: a hint until the first gesture, and the list of gestures and keys.

import { element, icon, iconButton } from "../tools/elements.js";

/**
 * A hand that shows what a drag does, until `done` is called.
 *
 * @param {string} does what one drags to do
 * @returns {{element: HTMLElement, done: function(): void}}
 */
export function createHint(does) {
  const hand = element("span", { class: "hand", "aria-hidden": "true" }, icon("hand"));
  const hint = element("div", { class: "hint" }, hand, element("span", { text: `Drag to ${does}` }));
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
 * @param {string} title
 * @param {string} what is to be seen, in some sentences
 * @param {string[][]} gestures each with what it does
 * @param {string[][]} keys likewise
 * @returns {{element: HTMLElement, toggle: function(): void}}
 */
export function createHelp(title, what, gestures, keys) {
  const close = iconButton("close", "Close", "Escape", () => dialog.close());
  const dialog = element("dialog", { class: "help", "aria-labelledby": "lightcube-help" },
    element("header", {}, element("h2", { id: "lightcube-help", text: title }), close),
    element("p", { text: what }),
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

function listOf(kind, title, pairs) {
  return element("section", { class: kind }, element("h3", { text: title }),
    element("dl", {}, ...pairs.map(([what, does]) =>
      element("div", {}, element("dt", { text: what }), element("dd", { text: does })))));
}
