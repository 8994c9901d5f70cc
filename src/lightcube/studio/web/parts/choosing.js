// What the project is to become: a card for each kind of thing, small once there are pictures.

import { element } from "/viewer/tools/elements.js";
import { glyph } from "../tools/glyphs.js";
import { wear } from "../tools/wearing.js";

/** Fill the section in which one chooses. */
export function mount(section, studio) {
  wear("/web/choosing/choosing.css");
  const cards = new Map(studio.kinds.map((kind) => [kind.name, cardOf(kind, choose)]));
  const row = element("div", { class: "kinds", role: "radiogroup", "aria-label": "What will it be?" }, ...cards.values());
  section.append(row);
  section.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 }[event.key];
    const all = [...cards.values()];
    const at = all.indexOf(event.target.closest(".kind"));
    if (way === undefined || at < 0) return;
    event.preventDefault();
    all[(at + way + all.length) % all.length].focus();
  });

  /** Become something else; a room has to be there first. */
  function choose(name) {
    if (name === "room" && !studio.state.settings.parts.rooms) {
      studio.open("room");
      studio.say("Set up your room, and make the cube for it then.", "good");
      return;
    }
    studio.ask("/api/settings", { method: "PATCH", json: { kind: name } });
  }

  return {
    update({ settings }) {
      section.toggleAttribute("data-small", settings.pictures.length > 0);
      for (const [name, card] of cards) {
        card.setAttribute("aria-checked", String(name === settings.kind));
        card.tabIndex = name === settings.kind ? 0 : -1;
      }
      const chosen = cards.get(settings.kind);
      row.scrollLeft = chosen.offsetLeft - row.offsetLeft - (row.clientWidth - chosen.offsetWidth) / 2;
    },
  };
}

function cardOf({ name, title, said }, choose) {
  return element("button", { type: "button", class: "kind", role: "radio", title: said, click: () => choose(name) },
    glyph(name), element("b", { text: title }), element("span", { class: "quiet", text: said }));
}
