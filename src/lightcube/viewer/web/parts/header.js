// The title, the quiet line that says what the page holds, and the buttons of the page itself.

import { wordsOf } from "../model/words.js";
import { element, iconButton, oneDecimal } from "../tools/elements.js";

/**
 * Title, who made it and for whom, what it is, and buttons.
 *
 * @param {Object} scene
 * @param {string|null} what it is, in a sentence; null in notebooks
 * @param {HTMLElement[]} tools buttons of this page, before those that all have
 * @param {Object} does `theme()`, `fullScreen()`, `help()`
 * @returns {HTMLElement}
 */
export function createHeader(scene, what, tools, does) {
  const said = [scene.by && `by ${scene.by}`, scene.note].filter(Boolean);
  return element("header", { class: "top" },
    element("div", { class: "titles" },
      element("h1", { text: scene.title, dir: "auto" }),
      said.length > 0 ? element("p", { class: "by", text: said.join(" · "), dir: "auto" }) : null,
      what === null ? null : element("p", { class: "what", text: what })),
    element("div", { class: "tools" },
      ...tools,
      named("theme", "Light or dark", "T", does.theme, "Theme"),
      document.fullscreenEnabled ? named("screen", "Full screen", "F", does.fullScreen, "Full") : null,
      named("help", "Help", "?", does.help, "Help")));
}

/** An icon's button that says its name where nothing is pointed at, on phones. */
function named(name, label, key, pressed, word) {
  const button = iconButton(name, label, key, pressed);
  button.append(element("span", { "aria-hidden": "true", text: word }));
  return button;
}

/**
 * What the page holds of the cube, in one line.
 *
 * @param {Object} scene
 * @param {string|null} note a sentence more
 * @param {boolean} brief only where all of the cube is not held, or there is a note
 * @returns {HTMLElement|null}
 */
export function createQuietLine(scene, note, brief) {
  const whole = countText(scene.kept.full) === countText(scene.voxels.shape);
  if (brief && whole && note === null) return null;
  return element("p", { class: "quiet", text: [keptText(scene), scene.glass && wordsOf(scene).drawn, note].filter(Boolean).join(" ") });
}

function keptText({ voxels, kept, solid }) {
  const [full, held] = [countText(kept.full), countText(voxels.shape)];
  if (solid) return `A shape in a block of ${held} voxels; the shadows are those of its voxels, whose edges a printed mesh smooths.`;
  if (full === held) {
    return `A cube of ${full} voxels, rounded for this page: its shadows differ from the original's by at most ` +
      `${oneDecimal(kept.worst_levels)} of 255 levels.`;
  }
  return `A cube of ${held} voxels, solved for the pictures of one of ${full}, which is too large for this page: at the ` +
    `stops, their shadows differ by ${oneDecimal(kept.rms_levels)} of 255 levels on average.`;
}

/** "64³", or "60 × 64 × 64" (x, y, z). */
function countText([nz, ny, nx]) {
  return nx === ny && ny === nz ? `${nx}³` : `${nx} × ${ny} × ${nz}`;
}
