// Sliders and choices that say how a thing is made, and send it.

import { element } from "/viewer/tools/elements.js";

/** Milliseconds between two changes that a slider sends. */
const EVERY = 90;

/**
 * A slider that sends what it says while it moves, not more often than can be answered.
 *
 * @param {Object} slider `name` of the setting, `label`, `low`, `high`, `step`, what its two `ends` are, the `text` of a
 *   value, and `to` and `from`, which make a place on the slider of a value and back
 * @param {string} field which of the settings it belongs to
 */
export function createSlider({ name, label, low, high, step, ends, text, to = (value) => value, from = (value) => value }, field, studio) {
  const value = element("span", { class: "now", "aria-hidden": "true" });
  const input = element("input", { type: "range", name, min: low, max: high, step, "aria-label": label });
  let [waiting, sent, asked] = [0, 0, 0];
  const send = async () => {
    clearTimeout(waiting);
    const soon = sent + EVERY - performance.now();
    waiting = soon > 0 ? setTimeout(send, soon) : 0;
    if (waiting) return;
    sent = performance.now();
    asked += 1;
    const state = await studio.ask("/api/settings", { method: "PATCH", json: { [field]: { [name]: from(Number(input.value)) } } });
    asked -= 1;
    update(state ?? studio.state); // what was refused goes back
  };
  const show = (now) => {
    value.textContent = text(now);
    input.setAttribute("aria-valuetext", text(now));
    input.style.setProperty("--part", (to(now) - input.min) / (input.max - input.min || 1));
  };
  input.addEventListener("input", () => {
    show(from(Number(input.value)));
    send();
  });
  return {
    element: element("label", { class: "setting" }, element("span", { class: "label" }, element("b", { text: label }), value), input,
      element("span", { class: "ends quiet" }, ...ends.map((end) => element("span", { text: end })))),
    update,
  };

  /** While it is moved nothing that was true before comes in between. */
  function isMoving() {
    return waiting !== 0 || asked > 0 || input.matches(":active");
  }

  function update({ settings }) {
    if (isMoving()) return;
    input.value = to(settings[field][name]);
    show(settings[field][name]);
  }
}

/** How many of the pictures are used; all of them, also when there are more. */
export function createCount(studio) {
  let all = 2;
  const slider = createSlider({ name: "count", label: "How many", low: 2, high: 2, step: 1, ends: ["two", "all of them"],
    text: (value) => (value && value < all ? `the first ${value}` : `all ${all}`),
    to: (value) => Math.min(value || all, all), from: (value) => (value < all ? value : 0) }, "making", studio);
  return {
    element: slider.element,
    update(state) {
      all = state.settings.pictures.length;
      slider.element.hidden = all < 3;
      slider.element.querySelector("input").max = all;
      slider.update(state);
    },
  };
}

/** A choice of a few words. */
export function createChoice({ name, label, options }, field, studio) {
  const send = async () => update(await studio.ask("/api/settings", { method: "PATCH", json: { [field]: { [name]: valueOf(select.value) } } }) ?? studio.state);
  const select = element("select", { name, change: send }, ...options.map(([value, text]) => element("option", { value, text })));
  const update = ({ settings }) => (select.value = String(settings[field][name])); // what was refused goes back
  return { element: element("label", { class: "choice" }, element("span", { class: "quiet", text: label }), select), update };
}

/** What an option of a select stands for. */
function valueOf(text) {
  return { true: true, false: false }[text] ?? text;
}
