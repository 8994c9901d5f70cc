// The title, the quiet line that says what the page holds, and the buttons of the page itself.

import { element, iconButton, oneDecimal } from "../tools/elements.js";

/**
 * Title and buttons.
 *
 * @param {Object} scene
 * @param {Object} does `theme()`, `fullScreen()`, `help()`
 * @returns {HTMLElement}
 */
export function createHeader(scene, does) {
  return element("header", { class: "top" },
    element("h1", { text: scene.title }),
    element("div", { class: "tools" },
      iconButton("theme", "Light or dark", "T", does.theme),
      document.fullscreenEnabled ? iconButton("screen", "Full screen", "F", does.fullScreen) : null,
      iconButton("help", "Help", "?", does.help)));
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
  return element("p", { class: "quiet", text: [keptText(scene), note].filter(Boolean).join(" ") });
}

function keptText({ voxels, kept }) {
  const [full, held] = [countText(kept.full), countText(voxels.shape)];
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
