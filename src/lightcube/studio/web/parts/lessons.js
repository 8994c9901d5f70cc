// Class mode: two lessons, step by step, with the arrow keys.

import { element, iconButton } from "/viewer/tools/elements.js";
import { createCubeLesson } from "../lessons/cube.js";
import { createSolidLesson } from "../lessons/solid.js";
import { sentenceOf } from "../tools/asking.js";
import { wear } from "../tools/wearing.js";

/** Elements that need the arrow keys themselves. */
const OWN_KEYS = "select, input, textarea, canvas, [role=slider], dialog";

/** Fill the section of lessons. */
export function mount(section, studio) {
  wear("/web/lessons/lessons.css");
  const found = element("p", { class: "found", "aria-live": "polite" });
  const say = (sentence, bad = false) => {
    found.textContent = sentence && (bad ? sentenceOf(sentence) : sentence);
    found.toggleAttribute("data-bad", bad);
  };
  // an answer that comes when another lesson is open says nothing
  const lessons = [createSolidLesson, createCubeLesson].map((create, i) => create(studio, (...told) => now.lesson === lessons[i] && say(...told)));
  const now = { lesson: null, step: 0 };
  const tabs = lessons.map((lesson) => element("button", { type: "button", class: "switch", "aria-pressed": "false", text: lesson.title, click: () => begin(lesson) }));
  const title = element("h3");
  const text = element("p");
  const count = element("span");
  const [back, on] = [["previous", "Step before", "←", -1], ["next", "Next step", "→", 1]].map(([icon, label, key, way]) =>
    iconButton(icon, label, key, () => go(way)));
  const words = element("div", { class: "words", "aria-live": "polite" }, title, text, found);
  const area = element("div", { class: "area" });
  section.append(element("div", { class: "tabs" }, ...tabs),
    element("div", { class: "lesson-head" }, words, element("div", { class: "steps" }, back, count, on)), area);

  function begin(lesson) {
    Object.assign(now, { lesson, step: 0 });
    tabs.forEach((tab, i) => tab.setAttribute("aria-pressed", String(lessons[i] === lesson)));
    area.replaceChildren(lesson.element);
    show();
  }

  function go(way) {
    const step = Math.min(now.lesson.steps.length - 1, Math.max(0, now.step + way));
    if (step === now.step) return;
    now.step = step;
    show();
  }

  function show() {
    const { lesson, step } = now;
    say("");
    title.textContent = lesson.steps[step].title;
    text.textContent = lesson.steps[step].text;
    count.textContent = `${step + 1} of ${lesson.steps.length}`;
    [back.disabled, on.disabled] = [step === 0, step === lesson.steps.length - 1];
    lesson.show(step);
  }

  document.addEventListener("keydown", (event) => {
    if (section.hidden || now.lesson === null || event.defaultPrevented || event.altKey || event.ctrlKey || event.metaKey) return;
    const way = { ArrowLeft: -1, PageUp: -1, ArrowRight: 1, PageDown: 1 }[event.key];
    if (way === undefined || event.target.closest?.(OWN_KEYS)) return;
    event.preventDefault();
    go(way);
  });
  new MutationObserver(() => now.lesson?.repaint()).observe(studio.root, { attributeFilter: ["data-theme"] });
  return { opened: () => now.lesson ?? begin(lessons[0]) };
}
