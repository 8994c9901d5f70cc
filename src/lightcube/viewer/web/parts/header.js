// The title, the quiet line that says what the page holds, and the buttons of the page itself.

import { element, iconButton, oneDecimal, setPressed, wordButton } from "../tools/elements.js";

const [GLASS, SOLID] = ["Light falls through a block of coloured glass", "A solid stands in the light"];

/**
 * Title, who made it and for whom, what it is, and buttons.
 *
 * @param {Object} scene
 * @param {Object} does `tour()`, `details()`, `theme()`, `fullScreen()`, `help()`
 * @param {boolean} compact the title and the buttons of a notebook
 * @returns {{element: HTMLElement, update: function(Object): void}}
 */
export function createHeader(scene, does, compact) {
  const tour = wordButton("tour", "Tour", "What light does here, step by step, for a class (G)", does.tour);
  const details = wordButton("details", "Details", "Scores, lamps and the way of the light (D)", does.details);
  const lit = scene.solid ? SOLID : GLASS;
  const what = scene.turns ? `${lit}; at each stop its shadow is another picture.` : `${lit}; its shadows are pictures.`;
  const said = [scene.by && `by ${scene.by}`, scene.note].filter(Boolean);
  return {
    element: element("header", { class: "top" },
      element("div", { class: "titles" },
        element("h1", { text: scene.title, dir: "auto" }),
        said.length > 0 ? element("p", { class: "by", text: said.join(" · "), dir: "auto" }) : null,
        compact ? null : element("p", { class: "what", text: what })),
      element("div", { class: "tools" },
        ...(compact ? [] : scene.solid ? [details] : [tour, details]),
        named("theme", "Light or dark", "T", does.theme, "Theme"),
        document.fullscreenEnabled ? named("screen", "Full screen", "F", does.fullScreen, "Full") : null,
        named("help", "Help", "?", does.help, "Help"))),
    update(now) {
      setPressed(tour, now.lesson !== null);
      setPressed(details, now.details);
    },
  };
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
