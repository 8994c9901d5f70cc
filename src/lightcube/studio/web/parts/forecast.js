// The forecast: each picture as its wall will look, how good it will be, what it takes, and the sliders.

import { element } from "/viewer/tools/elements.js";
import { sentenceOf } from "../tools/asking.js";
import { createChoice, createCount, createSlider } from "../tools/controls.js";
import { MAKINGS } from "../tools/makings.js";

const MARKS = ["good", "fair", "poor"];
const per = (value) => `${Math.round(100 * value)} %`;

/** Fill the section of the forecast. */
export function mount(section, studio) {
  const walls = element("ol", { class: "walls", "aria-label": "How each wall will look" });
  const verdict = element("p", { class: "verdict", "aria-live": "polite" });
  const bar = element("div", { class: "bar" }, element("i"));
  const costly = element("p", { class: "quiet costly" });
  const capacity = element("div", { class: "capacity", role: "img" }, element("span", { text: "Room in the glass" }), bar, costly);
  const empty = element("p", { class: "quiet", text: "As soon as there are pictures enough, you see here how they will look, before anything is made." });
  const notes = element("ul", { class: "notes" });
  const sliders = element("div", { class: "sliders" });
  const choices = element("div", { class: "row choices-of-making" });
  section.append(empty, element("div", { class: "looks" }, verdict, walls, capacity, notes), sliders, choices);
  let controls = [];
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
    capacity.hidden = facts.full === undefined;
    costly.textContent = costsOf(facts);
    notes.replaceChildren(...(facts.notes ?? []).map((note) => element("li", { text: sentenceOf(note) })));
  }

  /** Show what can be said of a kind of thing. */
  function fill(kind) {
    if (known.get("kind") === kind) return;
    known.set("kind", kind);
    walls.classList.toggle("on-paper", kind === "shape");
    const { counted = false, sliders: each, choices: few } = MAKINGS[kind];
    const field = studio.kind().settings;
    const makes = [[sliders, createSlider, each], [choices, createChoice, few]];
    controls = counted ? [createCount(studio)] : [];
    sliders.replaceChildren(...controls.map((control) => control.element));
    choices.replaceChildren();
    for (const [place, create, rows] of makes) {
      for (const row of rows) {
        const { element: control, update } = create(row, field, studio);
        place.append(control);
        controls.push({ update(state) {
          if (row.where) control.hidden = !row.where(state.settings[field]);
          update(state);
        } });
      }
    }
  }

  studio.on("forecast", show);
  return {
    update(state) {
      fill(state.settings.kind);
      for (const each of controls) each.update(state);
      sliders.hidden = choices.hidden = state.settings.pictures.length === 0;
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
  const words = counts.map(([word, count]) => element("b", { class: word, text: all ? `${count === 1 ? "The picture" : `All ${count} pictures`} will be ${word}` : `${count} ${word}` }));
  const mixed = words.flatMap((word, number) => (number ? [number + 1 === words.length ? " and " : ", ", word] : [word]));
  const first = status === "looking" || status === "first" ? element("span", { class: "quiet", text: " · looking closer …" }) : "";
  return all ? [...mixed, ".", first] : [...mixed, " are to be expected.", first];
}

function wallOf({ name, image, mark, reason, worth }) {
  return element("li", { title: worth },
    element("img", { src: `data:image/png;base64,${image}`, alt: `${name} on its wall: ${mark}` }),
    element("span", { class: "name", text: name }),
    element("span", { class: `word ${mark}`, text: mark }),
    reason ? element("span", { class: "reason", text: reason }) : null);
}

function costsOf({ costs, pictures, full }) {
  if (!pictures.length || full === undefined) return "";
  if (!costs || costs.length !== pictures.length) return full > 0.8 ? "Nearly all is taken: fewer or smaller pictures become better." : "";
  if (full < 0.3) return "There is plenty of room: more or wider pictures would fit.";
  const most = costs.indexOf(Math.max(...costs));
  if (costs[most] < 0.7) return "All pictures take about as much.";
  return `“${pictures[most].name}” takes most: without it the others would come out clearer.`;
}
