// The lesson of the small cube: 27 voxels, pictures of 5 x 3 pixels, and an equation for each of those.

import { element, svg } from "/viewer/tools/elements.js";

const NAMES = [..."abcdefghi"];
const COLOURS = ["Red", "Green", "Blue"];
const SLICES = ["Bottom slice", "Middle slice", "Top slice"];
/** Beams are drawn so far out, in voxels. */
const REACH = 2.6;
const STEPS = [
  { views: 1, truth: true, title: "A cube of 27 voxels", text: "Three slices of nine voxels, each a glass of its own tint. Light goes through from one side; behind it five times three pixels catch what is left. Each row of the picture belongs to one slice." },
  { views: 1, truth: true, beam: true, title: "One beam, one equation", text: "A beam loses light in each voxel, the more the longer its way there. The logarithm makes a sum of it: lengths times absorption, which is an equation. Choose a pixel, another slice, a colour." },
  { views: 1, found: true, title: "One picture: three equations", text: "Now only the picture is known. Nine unknowns in a slice, and three beams that meet it: nobody can tell the voxels of one beam apart." },
  { views: 2, found: true, title: "Two pictures: eight equations", text: "The table turns, and other beams cross the first ones. Some voxels are known already, where a beam passes through one of them alone." },
  { views: 3, found: true, title: "Three pictures: all nine", text: "Thirteen equations, of which nine say something new: each voxel is found exactly. Repeat it for three slices and three colours." },
  { views: 8, found: true, title: "Eight pictures: more than are needed", text: "Pictures of a real cube agree, so more of them change nothing. Photographs that have nothing to do with each other do not agree: then the cube is found that comes nearest to them all, and that is what “Make a cube” does." },
];

/** @returns {{title: string, steps: Object[], element: HTMLElement, show: function(number): void}} */
export function createCubeLesson(studio, said) {
  const now = { step: STEPS[0], data: null, slice: 1, colour: 0, view: 0, beam: 2 };
  const plan = element("div", { class: "plan" });
  const picture = element("div", { class: "pixels", role: "group", "aria-label": "The picture on the wall" });
  const list = element("ol", { class: "equations", tabindex: "0", "aria-label": "Equations" });
  const equation = element("p", { class: "equation", "aria-live": "polite" });
  const select = (label, texts, key) => element("select", { "aria-label": label, change: (event) => {
    now[key] = Number(event.target.value);
    draw();
  } }, ...texts.map((text, i) => element("option", { value: i, text, selected: i === now[key] })));
  const views = select("Picture", ["Picture 1"], "view");
  const chosen = element("div", { class: "row" }, select("Slice", SLICES, "slice"), select("Colour", COLOURS, "colour"), views);

  function draw() {
    const { data, step } = now;
    if (data === null) return;
    now.view = Math.min(now.view, step.views - 1);
    views.replaceChildren(...Array.from({ length: step.views }, (_, i) =>
      element("option", { value: i, selected: i === now.view, text: `Picture ${i + 1}, at ${data.angles_deg[i]}°` })));
    plan.replaceChildren(planOf(now, pick));
    picture.replaceChildren(...pixelsOf(now, pick));
    equation.replaceChildren(...(step.beam ? equationOf(now, now.view, now.beam) : []));
    equation.hidden = !step.beam;
    list.hidden = !step.found;
    list.replaceChildren(...(step.found ? allOf(now) : []));
    const found = data.found[step.views - 1];
    const right = found.right.filter(Boolean).length;
    said(step.found ? `${found.equations} equations in each slice, ${found.rank} of them independent: ${right === 9 ? "all nine voxels are" : right === 0 ? "no voxel is" : right === 1 ? "one voxel is" : `${right} of nine voxels are`} found.` : "");
  }

  function pick(beam, slice = now.slice) {
    Object.assign(now, { beam, slice });
    chosen.querySelector("select").value = String(slice);
    draw();
  }

  return {
    title: "A cube of 27 voxels",
    steps: STEPS,
    element: element("div", { class: "lesson-cube" }, chosen,
      element("div", { class: "sides" }, element("figure", {}, plan, element("figcaption", { text: "The slice from above, and the beams that meet it" })),
        element("figure", {}, picture, element("figcaption", { text: "What they show on the wall" }))), equation, list),
    async show(number) {
      now.step = STEPS[number];
      now.view = now.step.views - 1 < 3 ? now.step.views - 1 : 0;
      if (now.data === null) now.data = await studio.ask("/api/lessons/cube");
      draw();
    },
    repaint: draw,
  };
}

function rgb(levels) {
  return `rgb(${levels.join(" ")})`;
}

/** The slice from above, x to the right and y up, with its voxels' names and beams of a picture. */
function planOf(now, pick) {
  const { data, step, slice, view } = now;
  const found = data.found[step.views - 1];
  const drawing = svg("svg", { viewBox: "-2.7 -2.7 5.4 5.4", class: "slice-plan", role: "img", "aria-label": `The ${SLICES[slice].toLowerCase()} from above, with the beams of picture ${view + 1}` });
  const names = []; // above the beams
  for (let voxel = 0; voxel < 9; voxel++) {
    const [y, x] = [Math.floor(voxel / 3), voxel % 3];
    const known = step.truth || found.right[voxel];
    const tint = known ? data.tints[slice][y][x] : [128, 128, 128];
    const dark = 0.3 * tint[0] + 0.59 * tint[1] + 0.11 * tint[2] < 128;
    drawing.append(svg("rect", { x: x - 1.5, y: 0.5 - y, width: 1, height: 1, fill: rgb(tint), class: known ? "voxel" : "voxel unknown" }));
    const name = svg("text", { x: x - 1, y: 1.14 - y, class: "name", fill: known ? (dark ? "#fff" : "#111") : "currentColor" });
    name.textContent = known ? NAMES[voxel] : `${NAMES[voxel]} ?`;
    names.push(name);
  }
  const turn = (data.angles_deg[view] * Math.PI) / 180;
  const [along, aside] = [[Math.cos(turn), -Math.sin(turn)], [-Math.sin(turn), -Math.cos(turn)]];
  data.lengths[view].forEach((lengths, beam) => {
    const middle = aside.map((each) => each * (beam - 2));
    const [from, to] = [-REACH, REACH].map((far) => middle.map((each, axis) => each + far * along[axis]));
    const meets = lengths.some((each) => each > 0);
    const line = { x1: from[0], y1: -from[1], x2: to[0], y2: -to[1] };
    const isChosen = step.beam && beam === now.beam;
    const hit = svg("line", { ...line, class: "hit" });
    hit.addEventListener("click", () => pick(beam));
    drawing.append(svg("line", { ...line, class: `beam${meets ? "" : " free"}${isChosen ? " chosen" : ""}` }), hit);
  });
  drawing.append(...names);
  return drawing;
}

/** Pixels of a picture, as buttons, the top row first. */
function pixelsOf(now, pick) {
  const { data, view, slice, beam, step } = now;
  return data.pictures[view].flatMap((row, i) => row.map((levels, column) => {
    const at = 2 - i;
    const button = element("button", { type: "button", class: "pixel", "aria-label": `${SLICES[at]}, pixel ${column + 1}`,
      "aria-pressed": String(Boolean(step.beam) && at === slice && column === beam), click: () => pick(column, at) });
    button.style.background = rgb(levels);
    return button;
  }));
}

/** A beam's equation, in parts that can be coloured. */
function equationOf({ data, slice, colour }, view, beam) {
  const lengths = data.lengths[view][beam];
  const light = data.light[view][2 - slice][beam][colour];
  const terms = lengths.map((length, voxel) => [length, NAMES[voxel]]).filter(([length]) => length > 1e-9);
  if (terms.length === 0) return [element("span", { text: "This beam meets no voxel: the pixel stays white, and says nothing." })];
  const parts = terms.flatMap(([length, name], i) => [i ? " + " : "", `${length.toFixed(2)} `, element("i", { text: name })]);
  return [element("span", { class: "terms" }, ...parts), element("span", { text: `= −ln ${light.toFixed(3)} = ${(-Math.log(light)).toFixed(3)}` })];
}

/** All equations of the pictures so far that meet the slice. */
function allOf(now) {
  const { data, step } = now;
  return data.lengths.slice(0, step.views).flatMap((beams, view) => beams.flatMap((lengths, beam) =>
    lengths.some((each) => each > 1e-9) ? [element("li", view === now.view ? { class: "own" } : {}, ...equationOf(now, view, beam))] : []));
}
