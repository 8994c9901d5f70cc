// The lesson's words below the room, large enough for a projector, and the buttons between its steps.

import { element, iconButton } from "../tools/elements.js";

/**
 * The panel of the tour, shown while there is a step.
 *
 * @param {Object} does `walk(way)`, `tour()`
 * @returns {{element: HTMLElement, update: function(Object): void}}
 */
export function createTour(does) {
  const [title, text] = [element("h2"), element("p")];
  const place = element("span", { class: "place" });
  const previous = iconButton("previous", "Previous step", "←", () => does.walk(-1));
  const next = iconButton("next", "Next step", "→", () => does.walk(1));
  const panel = element("section", { class: "tour", "aria-label": "Tour", hidden: true },
    element("div", { class: "words", "aria-live": "polite" }, title, text),
    element("div", { class: "steps" }, previous, place, next, iconButton("close", "End of the tour", "Escape", does.tour)));
  return {
    element: panel,
    update({ lesson }) {
      panel.hidden = lesson === null;
      if (lesson === null || title.textContent === lesson.title) return;
      title.textContent = lesson.title;
      text.textContent = lesson.text;
      place.textContent = `${lesson.number + 1} of ${lesson.count}`;
      previous.disabled = lesson.number === 0;
      next.disabled = lesson.number === lesson.count - 1;
    },
  };
}
