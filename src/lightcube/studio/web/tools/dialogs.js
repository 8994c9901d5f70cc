// A dialog that is asked something: it answers when it closes.

import { element } from "/viewer/tools/elements.js";

/**
 * Open a dialog.
 * @param {HTMLElement} root
 * @param {string} title
 * @param {Node[]} content
 * @param {string} yes what agreeing is called
 * @param {function(): any} answer what it answers then
 * @returns {Promise<any>} null where it is left without an answer
 */
export function openDialog(root, title, content, yes, answer) {
  return new Promise((resolve) => {
    let answered = null;
    const dialog = element("dialog", { class: "asked", "aria-label": title, close: () => {
      dialog.remove();
      resolve(answered);
    } });
    const agree = element("button", { type: "button", class: "main", text: yes, click: () => {
      answered = answer();
      dialog.close();
    } });
    const leave = element("button", { type: "button", class: "switch", text: "Cancel", click: () => dialog.close() });
    dialog.append(element("h3", { text: title }), ...content, element("div", { class: "row answers" }, leave, agree));
    root.append(dialog);
    dialog.showModal();
  });
}
