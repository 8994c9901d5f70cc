// The card that shows one scan-line from above: a slice of the cube, the beams through it, and the pixels they make.

import { pointsOf } from "../model/area.js";
import { pixelFacts, sheetOf } from "../model/sheet.js";
import { lampPowers } from "../tools/cards.js";
import { element } from "../tools/elements.js";
import { SliceDrawing } from "./slice.js";

/**
 * The card.
 *
 * @param {Object} scene
 * @param {Object} cube
 * @param {function(number, number|null): void} point called with the row and the column that are pointed at
 * @returns {{element: HTMLElement, update: function(Object, Object): void}} `update` takes what is known at a moment,
 *   and how many beams make a pixel, as `pointsOf` does
 */
export function createScanline(scene, cube, point) {
  const canvas = element("canvas", { class: "slice", role: "img" });
  const facts = element("p", { class: "facts", "aria-live": "polite" });
  const heading = element("h2", { text: `Scan-line ${seenFrom(2)}` });
  const subtitle = element("p", { class: "facts" });
  const lamps = element("select", { "aria-label": "Lamp whose beams are drawn", change: () => showAgain() });
  const drawing = new SliceDrawing(canvas, cube);
  let [now, many] = [null, null];

  canvas.addEventListener("pointermove", (event) => pointAt(event));
  canvas.addEventListener("pointerdown", (event) => pointAt(event));
  canvas.addEventListener("pointerleave", (event) => {
    if (event.pointerType === "mouse") point(now.spot.row, null);
  });

  function pointAt(event) {
    const box = canvas.getBoundingClientRect();
    const column = drawing.columnAt(event.clientX - box.left, event.clientY - box.top);
    if (column !== null) point(now.spot.row, column);
  }

  function showAgain() {
    const exposure = now.exposures[now.spot.place];
    const { row, column } = now.spot;
    const view = offerLamps(lamps, scene, exposure);
    subtitle.textContent = `row ${row + 1} of ${exposure.window[0]}`;
    if (view === null) {
      drawing.clear();
      facts.textContent = "No lamp shines on this screen here.";
      return;
    }
    const points = pointsOf(cube, exposure, many);
    const sheet = sheetOf(cube, exposure, view, row, points);
    drawing.show(sheet, exposure.views[view], { column, dark: now.dark });
    heading.textContent = `Scan-line ${seenFrom(sheet.axis)}`;
    canvas.setAttribute("aria-label", `Beams of ${sheet.pixels.length} pixels through the cube, seen ${seenFrom(sheet.axis)}`);
    facts.textContent = column === null
      ? "Point at a beam, or at a pixel of the shown picture."
      : pixelText(pixelFacts(cube, exposure, view, row, column, points), column, scene.voxels.channels, now.thin);
  }

  return {
    element: element("section", { class: "card scanline", "aria-label": "Scan-line" },
      element("header", {}, heading, subtitle, lamps),
      canvas, facts),
    update(next, beams) {
      [now, many] = [next, beams];
      showAgain();
    },
  };
}

function seenFrom(axis) {
  return axis === 2 ? "from above" : "from the side";
}

/** "The light of pixel 12 passes 187 voxels; on average 42 / 13 / 5 % of it is left." */
function pixelText({ voxels, left }, column, channels, thin) {
  const light = `The ${thin ? "beam" : "light"} of pixel ${column + 1}`;
  if (voxels.size === 0) return `${light} misses the cube; all of it is left.`;
  const parts = left.slice(0, channels).map((part) => (100 * part).toFixed(part < 0.0995 ? 1 : 0));
  const few = voxels.size === 1 ? "voxel" : "voxels";
  return `${light} passes ${voxels.size} ${few}; ${thin ? "" : "on average "}${parts.join(" / ")} % of it is left.`;
}

/**
 * Offer the lamps that shine on a screen, where there are several; the view of the chosen one, null where none shines.
 *
 * The brightest is chosen at first. Of a lamp that has many samples it is the middle one's.
 */
function offerLamps(select, scene, exposure) {
  const views = new Map();
  exposure.views.forEach(({ lamp, power }, number) => {
    if (power.some((part) => part > 0)) views.set(lamp, [...(views.get(lamp) ?? []), number]);
  });
  const offered = [...views.keys()];
  if (offered.join() !== (select.dataset.offered ?? "")) {
    const chosen = select.value;
    select.replaceChildren(...offered.map((lamp) => element("option", { value: lamp, text: scene.lamps[lamp] })));
    select.value = chosen !== "" && offered.includes(Number(chosen)) ? chosen : brightestOf(exposure);
    select.dataset.offered = offered.join();
  }
  select.hidden = offered.length < 2;
  if (offered.length === 0) return null;
  const its = views.get(Number(select.value));
  return its[Math.floor(its.length / 2)];
}

function brightestOf(exposure) {
  const lights = [...lampPowers(exposure)].map(([lamp, power]) => [lamp, Math.max(...power)]);
  return lights.reduce((best, each) => (each[1] > best[1] ? each : best), [null, -Infinity])[0];
}
