// What stands around a relief's plate: its title, what moves the lamp, from how far one looks, and the help.

import { degreesText, element, oneDecimal, setPressed, wordButton } from "../tools/elements.js";
import { createControls } from "./controls.js";
import { createHeader } from "./header.js";
import { createHelp, createHint } from "./help.js";

const WHAT = "A white plate lies under a low lamp; as the lamp goes round, its shadows become another picture.";
const IN_COLOUR = "A white plate lies under three low lamps, red, green and blue; its shadows are one picture in colour.";
/** From how far one looks, by the name of the blur. */
const DISTANCES = { near: "From near by", far: "From afar", columns: "Each column" };
const GESTURES = [
  ["drag", "take the lamp round the plate"],
  ["Shift drag · two fingers, up and down", "lift the lamp, or lower it"],
  ["double click", "put the lamp as high as the plate is made for"],
];
const KEYS = [
  ["← →", "the lamp goes round by 1°, with Shift by 0.1°"],
  ["↑ ↓ on the plate", "the lamp stands 1° higher, lower"],
  ["Page Up, Page Down · , .", "previous, next picture"],
  ["Space", "play, pause"],
  ["N", "on to the nearest picture"],
  ["Home", "first picture"],
  ["D", "details: wanted and shown"],
  ["A", "larger type, for a projector"],
  ["F", "full screen"],
  ["T", "light or dark"],
  ["?", "this list"],
];

/** Title, what it is, and buttons. */
export function headerOfPlate(scene, does, compact) {
  const details = wordButton("details", "Details", "What was wanted and what is shown (D)", does.details);
  return {
    element: createHeader(scene, compact ? null : whatOf(scene), compact ? [] : [details], does),
    update: (now) => setPressed(details, now.details),
  };
}

function whatOf({ colours }) {
  return colours === null ? WHAT : IN_COLOUR;
}

/** The hint of what a drag does. */
export function hintOfPlate() {
  return createHint("take the lamp round");
}

/** The list of gestures and keys. */
export function helpOfPlate(scene) {
  const said = `${whatOf(scene)} Under no other light than the lamp's one sees from above what is shown large: the light of each ` +
    "column, exactly, as an eye blurs it near by or from afar. On the table the plate is drawn for the eye.";
  return createHelp("Looking at a relief", said, GESTURES, KEYS);
}

/**
 * Slider, playing, the lamp's height, and from how far one looks.
 *
 * @param {Object} scene
 * @param {number[]} stops
 * @param {Object} does what `createControls` takes, `blur(name)`, `lift(degrees)`, `right()`
 * @returns {{element: HTMLElement, update: function(Object): void}} `update` takes what the app knows at a moment
 */
export function controlsOfPlate(scene, stops, does) {
  const options = Object.entries(DISTANCES).map(([name, text]) => element("option", { value: name, text }));
  const far = element("select", {
    "aria-label": "From how far one looks", title: "How far the eye is from the picture: it blurs one column, two, or none",
    change: () => does.blur(far.value),
  }, ...options);
  const height = element("span", { class: "lift" });
  const lift = element("div", { class: "lifts", role: "group", "aria-label": "Height of the lamp", title: "How high the lamp stands: the plate is made for one height, and bears a little more or less" },
    element("button", { type: "button", text: "−", "aria-label": "Lower", click: () => does.lift(-1) }), height,
    element("button", { type: "button", text: "+", "aria-label": "Higher", click: () => does.lift(1) }));
  const controls = createControls(stops, does, "Where the lamp stands", [lift, far]);
  return {
    element: controls.element,
    update(now) {
      far.value = now.blur;
      height.textContent = `${oneDecimal(now.elevation).replace(".0", "")}° high`;
      height.classList.toggle("off", !now.right);
      controls.update(now);
    },
  };
}

/** What the page holds, in one line. */
export function quietOfPlate({ columns: [rows, across], pitch_mm, size_mm, elevation_deg }) {
  const size = size_mm.map((side) => oneDecimal(side).replace(".0", "")).join(" × ");
  const text = `A plate of ${across} × ${rows} columns of ${pitch_mm} mm, ${size} mm large, made for lamps that stand ` +
    `${degreesText(elevation_deg).replace(".0", "")} high. Light is computed here, at 55 points of each column.`;
  return element("p", { class: "quiet", text });
}
