// The lesson of three silhouettes: what solid they make, where they contradict each other, and the repair.

import { fromBase64, readScene, readVoxels } from "/viewer/model/data.js";
import { element } from "/viewer/tools/elements.js";
import { createBox, letterOf, rowsOf } from "./boxes.js";
import { sentenceOf } from "../tools/asking.js";

const WALLS = [["front", "as the lamp before it sees it"], ["side", "from its right"], ["top", "from above"]];
/** Milliseconds after a stroke until the solid is asked for. */
const CALM = 150;
/** Milliseconds after which it is said that there is something to wait for. */
const SLOW = 500;
const square = rowsOf((x, y) => Math.max(Math.abs(x), Math.abs(y)) < 0.7);
const disc = rowsOf((x, y) => Math.hypot(x, y) < 0.75);
const heart = rowsOf((x, y) => ((x / 0.72) ** 2 + ((y - 0.05) / 0.68) ** 2 - 1) ** 3 < (x / 0.72) ** 2 * ((y - 0.05) / 0.68) ** 3);
const arrow = rowsOf((x, y) => (Math.abs(x) < 0.25 && y > -0.75 && y <= 0.1) || (y > 0 && Math.abs(x) < 0.75 - y && y < 0.75));
const [G, E, B] = [
  ["........", ".######.", ".######.", ".##.....", ".##.###.", ".##..##.", ".######.", ".######."],
  ["........", ".######.", ".##.....", ".#####..", ".##.....", ".##.....", ".######.", ".######."],
  ["........", ".#####..", ".##.###.", ".#####..", ".##.###.", ".##..##.", ".######.", ".#####.."],
].map(letterOf);
const SAMPLES = [
  ["Heart, square, disc", [heart, square, disc]],
  ["Three letters", [G, E, B]],
  ["Disc from all sides", [disc, disc, disc]],
  ["Arrow and bars", [arrow, rowsOf((x, y) => Math.abs(x) < 0.7 && y < 0.2 && y > -0.75), disc]],
];
const WAYS = [["warp", "Bend"], ["trim", "Leave out"], ["grow", "Add"]];
const STEPS = [
  { count: 1, title: "One silhouette", text: "Draw in the box of the front what your solid shall look like from there. One drawing alone cuts a straight bar out of the block, like a biscuit cutter." },
  { count: 2, title: "A second one, from the side", text: "The drawing of the side cuts too. What is left lies inside both: each drawing takes away, none of them ever adds." },
  { count: 3, title: "The hull of all three", text: "And from above. What is left is the largest solid whose shadows stay inside all three drawings: their hull. Turn it." },
  { count: 3, lost: true, title: "Where they contradict each other", text: "Orange: what no object at all casts there while it keeps to the other drawings." },
  { count: 3, way: "warp", title: "The repair", text: "The drawings are changed as little as can be, until one object casts them all. Orange is given up, blue comes in." },
];

/**
 * @param {Object} studio
 * @param {function(string, boolean): void} said says a sentence below the step's words; true = it is bad
 * @returns {{title: string, steps: Object[], element: HTMLElement, show: function(number): void}}
 */
export function createSolidLesson(studio, said) {
  const boxes = WALLS.map(([name, where]) => createBox(name, where, ask));
  const room = element("div", { class: "solid" });
  const ways = WAYS.map(([way, text]) => element("button", {
    type: "button", class: "switch", "aria-pressed": "false", text, click: () => {
      now.way = way;
      ask();
    },
  }));
  const repairs = element("div", { class: "row", hidden: true, role: "group", "aria-label": "How they are made to agree" },
    element("p", { text: "How they are made to agree" }), ...ways);
  const blank = ["Empty boxes", WALLS.map(() => rowsOf(() => false))];
  const samples = [...SAMPLES, blank].map(([text, drawn]) =>
    element("button", { type: "button", class: "switch", text, click: () => take(drawn) }));
  const saves = element("div", { class: "row", role: "group", "aria-label": "Take the solid away" }, element("p", { text: "For a 3-D printer" }),
    ...["stl", "3mf"].map((suffix) => element("button", { type: "button", class: "switch", text: `Make .${suffix}`, click: () => print(suffix) })));
  const file = element("a", { class: "save", hidden: true });
  const choices = element("div", { class: "choices-of" }, repairs, element("p", { text: "Or begin with" }), ...samples, saves, file);
  const now = { step: STEPS[0], way: "warp", asked: 0, waiting: 0, shown: null, scene: "" };
  boxes.forEach((box, i) => box.fill(SAMPLES[0][1][i]));

  function take(drawn) {
    boxes.forEach((box, i) => box.fill(drawn[i]));
    ask();
  }

  /** What is asked for: the drawings, how many of them count, and how they are to agree. */
  function wanted() {
    const { count, way } = now.step;
    return Object.assign({ count, way: way ? now.way : "none" }, ...WALLS.map(([name], i) => ({ [name]: boxes[i].rows })));
  }

  /** Make a file for a printer, say what it casts, and let it be saved. */
  async function print(suffix) {
    const made = await studio.ask(`/api/lessons/mesh/${suffix}`, { json: wanted() });
    if (made === null) return;
    said(made.said.map(sentenceOf).join("\n"));
    if (file.href) URL.revokeObjectURL(file.href);
    const bytes = fromBase64(made.data);
    Object.assign(file, { href: URL.createObjectURL(new Blob([bytes])), download: made.name, hidden: false });
    file.textContent = `Save ${made.name}, ${Math.ceil(bytes.length / 1000)} kB`;
  }

  function ask() {
    file.hidden = true;
    clearTimeout(now.waiting);
    now.waiting = setTimeout(answer, CALM);
  }

  async function answer() {
    const { way, lost } = now.step;
    const number = ++now.asked;
    ways.forEach((button, i) => button.setAttribute("aria-pressed", String(WAYS[i][0] === now.way)));
    const slow = setTimeout(() => said("Working on it …"), SLOW);
    const found = await studio.ask("/api/lessons/hull", { json: wanted(), refused: (sentence) => number === now.asked && said(sentence, true) });
    clearTimeout(slow);
    if (number !== now.asked) return;
    if (found === null) {
      boxes.forEach((box) => box.show(null, null, ""));
      room.toggleAttribute("data-empty", true);
      return;
    }
    room.toggleAttribute("data-empty", false);
    boxes.forEach((box, i) => box.show(lost ? found.lost[i] : null, way ? found.cast[i] : null, sharesOf(found, i, now.step)));
    said(way ? found.repaired : lost ? found.said.join("\n") : "");
    await turn(found);
  }

  /** Show a solid in its room, seen from where the one before was. */
  async function turn({ scene, voxels }) {
    if (now.scene === scene + voxels) return;
    now.scene = scene + voxels;
    const [{ mount }, described] = await Promise.all([import("/viewer/app.js"), readScene(fromBase64(scene))]);
    const cube = await readVoxels(fromBase64(voxels), described);
    if (now.scene !== scene + voxels) return;
    now.shown?.dispose();
    const root = element("div");
    room.replaceChildren(root);
    now.shown = mount(root, described, cube, { compact: true });
  }

  return {
    title: "Three silhouettes",
    steps: STEPS,
    element: element("div", { class: "lesson-solid" }, element("div", { class: "boxes" }, ...boxes.map((box) => box.element), choices), room),
    show(number) {
      now.step = STEPS[number];
      repairs.hidden = !now.step.way;
      boxes.forEach((box, i) => box.element.toggleAttribute("data-later", i >= now.step.count));
      ask();
    },
    repaint: () => boxes.forEach((box) => box.paint()),
  };
}

function sharesOf(found, i, { count, lost, way }) {
  if (i >= count) return "";
  if (lost && found.shares[i] > 0) return `${Math.max(1, Math.round(100 * found.shares[i]))} % lost`;
  return way ? `${Math.round(100 * found.overlaps[i])} % as drawn` : "";
}
