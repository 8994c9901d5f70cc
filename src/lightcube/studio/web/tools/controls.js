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
  let [waiting, sent] = [0, 0];
  const send = () => {
    clearTimeout(waiting);
    const soon = sent + EVERY - performance.now();
    if (soon > 0) {
      waiting = setTimeout(send, soon);
      return;
    }
    sent = performance.now();
    studio.ask("/api/settings", { method: "PATCH", json: { [field]: { [name]: from(Number(input.value)) } } });
  };
  const show = (now) => {
    value.textContent = text(now);
    input.setAttribute("aria-valuetext", text(now));
    input.style.setProperty("--part", (to(now) - low) / (high - low));
  };
  input.addEventListener("input", () => {
    show(from(Number(input.value)));
    send();
  });
  return {
    element: element("label", { class: "setting" }, element("span", { class: "label" }, element("b", { text: label }), value), input,
      element("span", { class: "ends quiet" }, ...ends.map((end) => element("span", { text: end })))),
    update({ settings }) {
      const now = settings[field][name];
      if (document.activeElement !== input || !input.matches(":active")) input.value = to(now);
      show(now);
    },
  };
}

/** How many of the pictures are used. */
export function createCount(studio) {
  const slider = createSlider({ name: "count", label: "How many", low: 2, high: 2, step: 1, ends: ["two", "all of them"], text: (value) => (value ? `the first ${value}` : "all of them") }, "making", studio);
  const input = slider.element.querySelector("input");
  const value = slider.element.querySelector(".now");
  let all = 2;
  return {
    element: slider.element,
    update({ settings }) {
      all = settings.pictures.length;
      const count = Math.min(settings.making.count || all, all);
      slider.element.hidden = all < 3;
      input.max = all;
      if (!input.matches(":active")) input.value = count;
      value.textContent = count >= all ? `all ${all}` : `the first ${count}`;
      input.setAttribute("aria-valuetext", value.textContent);
      input.style.setProperty("--part", (count - 2) / Math.max(all - 2, 1));
    },
  };
}

/** A choice of a few words. */
export function createChoice({ name, label, options }, field, studio) {
  const select = element("select", { name, change: () => studio.ask("/api/settings", { method: "PATCH", json: { [field]: { [name]: valueOf(select.value) } } }) },
    ...options.map(([value, text]) => element("option", { value, text })));
  return {
    element: element("label", { class: "choice" }, element("span", { class: "quiet", text: label }), select),
    update({ settings }) {
      select.value = String(settings[field][name]);
    },
  };
}

/** What an option of a select stands for. */
function valueOf(text) {
  return { true: true, false: false }[text] ?? text;
}
