// Makes the page's elements and icons in few words, measures on them, and formats numbers.

/** Pixels of a canvas to a pixel of the page, at most. */
const DENSEST = 2;
/** Least decibels of a picture that is good, and of one that is fair. */
const [GOOD, FAIR] = [33, 26];
/** Lines of the icons, in a square of 24. */
const ICONS = {
  play: "M8 5l11 7-11 7z",
  pause: "M8 5v14M16 5v14",
  previous: "M18 6l-8 6 8 6M7 6v12",
  next: "M6 6l8 6-8 6M17 6v12",
  magnet: "M6 4v8a6 6 0 0 0 12 0V4M6 9h4M14 9h4M10 4v8a2 2 0 0 0 4 0V4M6 4h4M14 4h4",
  thin: "M3 12h18M8 7h8v10H8z",
  whole: "M4 8V4h4M16 4h4v4M20 16v4h-4M8 20H4v-4M9 9h6v6H9z",
  screen: "M9 4H4v5M15 4h5v5M20 15v5h-5M9 20H4v-5",
  theme: "M12 4a8 8 0 1 0 0 16zM12 4a8 8 0 0 1 0 16",
  tour: "M4 19V6a2 2 0 0 1 2-2h13v12H6a2 2 0 0 0-2 2 2 2 0 0 0 2 2h13M9 8h6M9 11.500h4",
  far: "M12 4a8 8 0 1 0 0 16 8 8 0 0 0 0-16zM12 9a3 3 0 1 0 0 6 3 3 0 0 0 0-6",
  details: "M4 6h16M4 12h16M4 18h10",
  eye: "M2.5 12s3.5-6 9.5-6 9.5 6 9.5 6-3.5 6-9.5 6-9.5-6-9.5-6zM12 9.5a2.5 2.5 0 1 0 0 5 2.5 2.5 0 0 0 0-5",
  help: "M9 9a3 3 0 1 1 4.2 2.8c-.8.4-1.2 1-1.2 2.2M12 17.5v.5",
  hand:
    "M9 12V5.5a1.5 1.5 0 0 1 3 0V11m0-1a1.5 1.5 0 0 1 3 0v1m0-.5a1.5 1.5 0 0 1 3 0V15a6 6 0 0 1-6 6h-1" +
    "a6 6 0 0 1-4.6-2.2L4 15.5a1.6 1.6 0 0 1 2.4-2L9 15.5V12",
  close: "M6 6l12 12M18 6L6 18",
  undo: "M9 6L4 11l5 5M4 11h10a6 6 0 0 1 6 6v1",
  redo: "M15 6l5 5-5 5M20 11H10a6 6 0 0 0-6 6v1",
};

/**
 * A new element.
 *
 * @param {string} tag
 * @param {Object} given attributes; functions listen to the event of that name, `text` is its text, `true` is bare,
 *   and `false` and `null` are left out
 * @param {...Node} children those that are null are left out
 * @returns {HTMLElement}
 */
export function element(tag, given = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(given)) {
    if (typeof value === "function") made.addEventListener(name, value);
    else if (name === "text") made.textContent = value;
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null) made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null));
  return made;
}

/**
 * A new element of a drawing.
 *
 * @param {string} tag
 * @param {Object} given attributes
 * @param {...Node} children
 * @returns {SVGElement}
 */
export function svg(tag, given, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(given)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** An icon of 24 × 24 of these lines, in the colour of its text, hidden from screen readers. */
export function iconOf(lines) {
  return svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, svg("path", { d: lines }));
}

/** The icon of a name, one of `ICONS`. */
export function icon(name) {
  return iconOf(ICONS[name]);
}

/**
 * A button with an icon, its name and its key said on pointing at it.
 *
 * @param {string} name of the icon
 * @param {string} label for people
 * @param {string} key that does the same
 * @param {function(): void} pressed
 * @param {Object} given further attributes
 * @returns {HTMLButtonElement}
 */
export function iconButton(name, label, key, pressed, given = {}) {
  const said = { type: "button", class: "icon", "aria-label": label, title: `${label} (${key})`, click: pressed };
  return element("button", { ...said, ...given }, icon(name));
}

/** A button with an icon and a word, that can be on; what it does is said on pointing at it. */
export function wordButton(name, text, title, pressed) {
  return element("button", { type: "button", class: "switch", "aria-pressed": "false", title, click: pressed },
    icon(name), element("span", { text }));
}

/** Say of such a button whether it is on. */
export function setPressed(button, on) {
  button.setAttribute("aria-pressed", String(on));
}

/** Let an element fill the screen, or not any more; a person's browser may refuse it. */
export function toggleFullScreen(root) {
  if (document.fullscreenElement) document.exitFullscreen();
  else root.requestFullscreen?.().catch(() => {});
}

/** Give a canvas as many pixels as it covers on the screen. */
export function fitCanvas(canvas) {
  const density = Math.min(window.devicePixelRatio, DENSEST);
  const sides = [canvas.clientWidth, canvas.clientHeight];
  const [width, height] = sides.map((side) => Math.max(1, Math.round(side * density)));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
}

/** Where a pointer is, 0..1 from an element's upper left. */
export function placeIn(area, event) {
  const box = area.getBoundingClientRect();
  return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
}

/** A number with one decimal, 0 never negative: -0.04 is "0.0". */
export function oneDecimal(value) {
  return (Math.round(value * 10) / 10 + 0).toFixed(1);
}

/** An angle for people: 23.46 is "23.5°", and 359.97 is "0.0°". */
export function degreesText(angle) {
  return `${oneDecimal((Math.round(angle * 10) / 10) % 360)}°`;
}

/** A positive number with three figures at most: 0.00013 is "0.0001", 3.456 is "3.46". */
export function figuresText(value) {
  return String(value >= 0.01 ? Number(value.toPrecision(3)) : Number(value.toPrecision(1)));
}

/** A score for people: 41.27 is "41.3 dB"; empty where there is none. */
export function scoreText(psnr) {
  return psnr === null ? "" : `${oneDecimal(psnr)} dB`;
}

/** How far the shadow of a shape is the silhouette: 0.9953 is "overlap 99.5 %"; empty where that is not known. */
export function overlapText(overlap) {
  return typeof overlap === "number" ? `overlap ${oneDecimal(100 * overlap)} %` : "";
}

/** In a word how well a picture came out, by the light that the wall shows; empty where nothing was wanted. */
export function qualityOf(psnr) {
  if (psnr === null) return "";
  return psnr >= GOOD ? "good" : psnr >= FAIR ? "fair" : "poor";
}

/** The nearest number in low..high. */
export function clampTo(value, low, high) {
  return Math.min(high, Math.max(low, value));
}
