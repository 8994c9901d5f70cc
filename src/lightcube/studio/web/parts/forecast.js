// The forecast: each picture as its wall will look, how good it will be, what it takes, and the sliders.

import { element } from "/viewer/tools/elements.js";
import { sentenceOf } from "../tools/asking.js";

/** Milliseconds between two changes that a slider sends. */
const EVERY = 90;
const MARKS = ["good", "fair", "poor"];
const per = (value) => `${Math.round(100 * value)} %`;

const SLIDERS = [
  { name: "width", label: "How wide", low: 0.2, high: 1, step: 0.05, ends: ["small pictures", "wide pictures"], text: (value) => `${per(value)} of the cube` },
  { name: "lamp", label: "Lamp", low: 0, high: 6, step: 0.5, ends: ["a gentle lamp", "a strong lamp"], to: (value) => Math.log2(value), from: (value) => 2 ** value,
    text: (value) => (value === 1 ? "as white as the wall" : `${Number(value.toPrecision(2))} times as strong`) },
  { name: "hold_deg", label: "Hold", low: 0, high: 3, step: 0.25, ends: ["a blink", "long"], text: (value) => (value ? `stands for ± ${value}°` : "only at its stop") },
  { name: "richness", label: "Glass", low: 0.02, high: 0.5, step: 0.02, ends: ["clear", "rich"], to: (value) => value || 0.5, from: (value) => (value >= 0.5 ? 0 : value),
    text: (value) => (value ? `lets ${per(Math.exp(-10 * value))} through 1 cm of the darkest` : "as rich as can be") },
  { name: "voxels", label: "How fine", low: 32, high: 128, step: 16, ends: ["quick", "fine"], text: (value) => `${value} voxels a side` },
];

/** Fill the section of the forecast. */
export function mount(section, studio) {
  const walls = element("ol", { class: "walls", "aria-label": "How each wall will look" });
  const verdict = element("p", { class: "verdict", "aria-live": "polite" });
  const bar = element("div", { class: "bar" }, element("i"));
  const costly = element("p", { class: "quiet costly" });
  const capacity = element("div", { class: "capacity", role: "img" }, element("span", { text: "Room in the glass" }), bar, costly);
  const empty = element("p", { class: "quiet", text: "As soon as there are two pictures, you see here how they will look on the wall, before anything is made." });
  const made = SLIDERS.map((slider) => sliderOf(slider, studio));
  const count = countOf(studio);
  const choices = element("div", { class: "row choices-of-making" },
    choiceOf(studio, "mat", "Around the pictures", [["dark", "dark"], ["grey", "grey"], ["light", "light"], ["none", "anything"]]),
    choiceOf(studio, "fit", "Other shapes", [["crop", "cut to fit"], ["pad", "keep all"]]),
    choiceOf(studio, "order", "Order", [["given", "as given"], ["best", "the best one"]]),
    choiceOf(studio, "quality", "Care", [["draft", "quick"], ["normal", "normal"], ["best", "best"]]));
  const sliders = element("div", { class: "sliders" }, count.element, ...made.map((each) => each.element));
  section.append(empty, element("div", { class: "looks" }, verdict, walls, capacity), sliders, choices);
  const known = new Map();

  function show(facts) {
    if (facts === undefined || !("status" in facts)) return;
    const { status, pictures } = facts;
    section.dataset.status = status;
    section.toggleAttribute("data-none", pictures.length === 0);
    empty.hidden = status !== "none";
    verdict.replaceChildren(...said(facts));
    if (known.get("pictures") !== pictures) walls.replaceChildren(...pictures.map(wallOf));
    known.set("pictures", pictures);
    const full = facts.full ?? 0;
    bar.firstChild.style.width = `${100 * full}%`;
    bar.dataset.full = full < 0.55 ? "little" : full < 0.8 ? "much" : "all";
    capacity.setAttribute("aria-label", `${per(full)} of the room in the glass is taken`);
    costly.textContent = costsOf(facts);
  }

  studio.on("forecast", show);
  return {
    update(state) {
      for (const each of [...made, count]) each.update(state);
      for (const each of choices.querySelectorAll("select")) each.value = state.settings.making[each.name];
      sliders.hidden = choices.hidden = state.settings.pictures.length < 2;
      show(state.forecast);
    },
  };
}

/** What is said of all pictures. */
function said({ status, pictures, sentence, psnr }) {
  if (status === "failed") return [sentenceOf(sentence)];
  if (status === "compiling") return ["Compiling, once: about half a minute, then never again."];
  if (status === "none") return [];
  if (!pictures.length) return ["Looking …"];
  const counts = MARKS.map((word) => [word, pictures.filter((each) => each.mark === word).length]).filter(([, count]) => count);
  const all = counts.length === 1;
  const words = counts.map(([word, count]) => element("b", { class: word, text: all ? `All ${count} pictures will be ${word}` : `${count} ${word}` }));
  const mixed = words.flatMap((word, number) => (number ? [number + 1 === words.length ? " and " : ", ", word] : [word]));
  const first = status === "looking" || status === "first" ? element("span", { class: "quiet", text: " · looking closer …" }) : "";
  return all ? [...mixed, ".", first] : [...mixed, " are to be expected.", first];
}

function wallOf({ name, image, mark, reason, psnr }) {
  return element("li", { title: `${psnr} dB` },
    element("img", { src: `data:image/png;base64,${image}`, alt: `${name} on its wall: ${mark}` }),
    element("span", { class: "name", text: name }),
    element("span", { class: `word ${mark}`, text: mark }),
    reason ? element("span", { class: "reason", text: reason }) : null);
}

function costsOf({ costs, pictures, full }) {
  if (!pictures.length) return "";
  if (!costs || costs.length !== pictures.length) return full > 0.8 ? "Nearly all is taken: fewer or smaller pictures become better." : "";
  if (full < 0.3) return "There is plenty of room: more or wider pictures would fit.";
  const most = costs.indexOf(Math.max(...costs));
  if (costs[most] < 0.7) return "All pictures take about as much.";
  return `“${pictures[most].name}” takes most: without it the others would come out clearer.`;
}

/** A slider that sends what it says while it moves, not more often than can be answered. */
function sliderOf({ name, label, low, high, step, ends, text, to = (value) => value, from = (value) => value }, studio) {
  const value = element("span", { class: "now", "aria-hidden": "true" });
  const input = element("input", { type: "range", min: low, max: high, step, "aria-label": label });
  let [waiting, sent, asked] = [0, 0, 0];
  const send = async () => {
    clearTimeout(waiting);
    const soon = sent + EVERY - performance.now();
    waiting = soon > 0 ? setTimeout(send, soon) : 0;
    if (waiting) return;
    sent = performance.now();
    asked += 1;
    const state = await studio.ask("/api/settings", { method: "PATCH", json: { making: { [name]: from(Number(input.value)) } } });
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
    input.value = to(settings.making[name]);
    show(settings.making[name]);
  }
}

/** How many of the pictures are used; all of them, also when there are more. */
function countOf(studio) {
  let all = 2;
  const slider = sliderOf({ name: "count", label: "How many", low: 2, high: 2, step: 1, ends: ["two", "all of them"],
    text: (value) => (value && value < all ? `the first ${value}` : `all ${all}`),
    to: (value) => Math.min(value || all, all), from: (value) => (value < all ? value : 0) }, studio);
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

function choiceOf(studio, name, label, options) {
  const select = element("select", { name, change: () => studio.ask("/api/settings", { method: "PATCH", json: { making: { [name]: select.value } } }) },
    ...options.map(([value, text]) => element("option", { value, text })));
  return element("label", { class: "choice" }, element("span", { class: "quiet", text: label }), select);
}
