// What the project is to become: a card for each kind of thing, small once there are pictures.

import { element } from "/viewer/tools/elements.js";
import { glyph } from "../tools/glyphs.js";
import { wear } from "../tools/wearing.js";

/** Fill the section in which one chooses. */
export function mount(section, studio) {
  wear("/web/choosing/choosing.css");
  const cards = new Map(studio.kinds.map((kind) => [kind.name, cardOf(kind, choose)]));
  let before = null;
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

  /** Say what becomes of the thing that was being made. */
  function sayRests(name) {
    const { called, are } = studio.kinds.find((kind) => kind.name === name);
    const they = are === "are" ? ["rest", "they go", "them"] : ["rests", "it goes", "it"];
    studio.say(`${called[0].toUpperCase()}${called.slice(1)} ${they[0]} meanwhile: ${they[1]} on when you choose ${they[2]} again.`, "good");
  }

  return {
    update({ settings, resting }) {
      if (before !== null && settings.kind !== before && resting.includes(before)) sayRests(before);
      before = settings.kind;
      section.toggleAttribute("data-small", settings.pictures.length > 0);
      for (const [name, card] of cards) {
        card.setAttribute("aria-checked", String(name === settings.kind));
        card.tabIndex = name === settings.kind ? 0 : -1;
        card.toggleAttribute("data-resting", resting.includes(name) && name !== settings.kind);
      }
      const chosen = cards.get(settings.kind);
      row.scrollLeft = chosen.offsetLeft - row.offsetLeft - (row.clientWidth - chosen.offsetWidth) / 2;
    },
  };
}

function cardOf({ name, title, said }, choose) {
  return element("button", { type: "button", class: "kind", role: "radio", title: said, click: () => choose(name) },
    glyph(name), element("b", {}, title, element("i", { class: "rests", text: " · half made" })), element("span", { class: "quiet", text: said }));
}
