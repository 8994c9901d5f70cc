// Take away: what can be made of the cube, what it is worth, and the way to save it.

import { element } from "/viewer/tools/elements.js";
import { sentenceOf } from "../tools/asking.js";
import { wear } from "../tools/wearing.js";

const GROUPS = [["show", "To show"], ["know", "To keep"], ["make", "To be made by printers, lasers and other programs"]];

/** Fill the section of what is taken away. */
export function mount(section, studio) {
  wear("/web/taking/taking.css");
  const field = (label, most, given = {}) => element("input", { type: "text", maxlength: most, "aria-label": label, placeholder: label, ...given });
  const [by, note] = [field("By whom it is", 200), field("A word on it, or for whom it is", 600)];
  const captions = element("input", { type: "checkbox", id: "taking-captions" });
  const named = element("label", { for: "taking-captions" }, captions, element("span", { text: "Names below the pictures of movies" }));
  const said = element("div", { class: "row labelled" }, by, note,
    named);
  const empty = element("p", { class: "quiet", text: "Here it is taken away once it is made: as a page, a movie, or something to be printed." });
  const cards = new Map();
  const groups = element("div", { class: "groups" });
  section.append(empty, said, groups);
  let [known, shown] = [null, ""];

  function make(name) {
    studio.ask(`/api/taking/${name}`, { json: { by: by.value, note: note.value, captions: captions.checked } });
  }

  function cardOf(thing) {
    const heading = element("h4", { text: thing.title });
    const what = element("p", { class: "quiet", text: thing.said });
    const worth = element("ul", { class: "worth" });
    const bar = element("progress", { max: 1, "aria-label": `${thing.title} is being made`, hidden: true });
    const step = element("p", { class: "quiet", role: "status" });
    const press = element("button", { type: "button", class: "switch", click: () => make(thing.name) });
    const save = element("a", { class: "save", download: "", href: `/api/taking/${thing.name}/file`, hidden: true });
    const stop = element("button", { type: "button", class: "switch", text: "Stop", hidden: true, click: () => studio.ask("/api/taking/stop", { method: "POST" }) });
    const card = element("article", { class: "thing" }, heading, what, worth, bar, step, element("div", { class: "row" }, save, press, stop));
    return { card, worth, bar, step, press, save, stop };
  }

  function show(state) {
    known = { ...known, ...state };
    const { things, doing, has_cube } = known;
    empty.hidden = has_cube;
    [said.hidden, groups.hidden] = [!has_cube, !has_cube];
    if (known.kind !== shown) {
      shown = known.kind;
      cards.clear();
      named.hidden = things.every(({ name }) => name !== "square");
      groups.replaceChildren();
      const first = (group) => things.findIndex((thing) => thing.group === group);
      for (const [group, title] of GROUPS.toSorted(([one], [other]) => first(one) - first(other))) {
        const made = things.filter((thing) => thing.group === group).map((thing) => {
          cards.set(thing.name, cardOf(thing));
          return cards.get(thing.name).card;
        });
        if (made.length) groups.append(element("section", {}, element("h3", { text: title }), element("div", { class: "things" }, ...made)));
      }
    }
    for (const { name, title, made, failed, suffix } of things) {
      const { worth, bar, step, press, save, stop } = cards.get(name);
      const busy = doing?.name === name;
      const lines = failed ? [failed] : made?.is_old ? ["this is of an earlier cube: make it again", ...made.said] : made?.said ?? [];
      worth.replaceChildren(...lines.map((line) => element("li", { text: sentenceOf(line) })));
      worth.toggleAttribute("data-bad", Boolean(failed));
      bar.hidden = stop.hidden = step.hidden = !busy;
      step.textContent = busy ? stepOf(doing) : "";
      if (busy && doing.of > 0) bar.value = doing.done / doing.of;
      else bar.removeAttribute("value");
      [press.hidden, press.disabled] = [busy, doing !== null];
      press.textContent = made ? "Make again" : "Make";
      press.setAttribute("aria-label", `${press.textContent}: ${title}`);
      save.hidden = !made || busy;
      if (!made) continue;
      save.textContent = `Save .${suffix}, ${sizeText(made.bytes)}`;
      save.setAttribute("aria-label", `Save ${title.toLowerCase()}, ${sizeText(made.bytes)}`);
    }
  }

  studio.on("taking", (state) => known !== null && show(state));
  studio.on("solving", ({ status }) => {
    if (["done", "kept"].includes(status)) studio.ask("/api/taking").then((state) => state && show(state));
  });
  return { update: (state) => state.taking && show(state.taking) };
}

/** What is being done, or how far it is. */
function stepOf({ sentence, done, of }) {
  if (sentence) return `${sentenceOf(sentence).replace(/\.$/, "")} …`;
  return of > 0 ? `${done} of ${of}` : "Begun …";
}

function sizeText(bytes) {
  return bytes < 1e6 ? `${Math.max(1, Math.round(bytes / 1e3))} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}
