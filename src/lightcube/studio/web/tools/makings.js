// What can be said of how each kind of thing is made: a table of sliders and choices.

const part = (value) => `${Math.round(100 * value)} %`;
const mm = (value) => `${value} mm`;
const LAMP = { name: "lamp", label: "Lamp", low: 0, high: 6, step: 0.5, ends: ["a gentle lamp", "a strong lamp"], to: (value) => Math.log2(value), from: (value) => 2 ** value,
  text: (value) => (value === 1 ? "as white as the wall" : `${Number(value.toPrecision(2))} times as strong`) };
const HOLD = { name: "hold_deg", label: "Hold", low: 0, high: 3, step: 0.25, ends: ["a blink", "long"], text: (value) => (value ? `stands for ± ${value}°` : "only at its stop") };
const GLASS = { name: "richness", label: "Glass", low: 0.02, high: 0.5, step: 0.02, ends: ["clear", "rich"], to: (value) => value || 0.5, from: (value) => (value >= 0.5 ? 0 : value),
  text: (value) => (value ? `lets ${part(Math.exp(-10 * value))} through 1 cm of the darkest` : "as rich as can be") };
const FINE = { name: "voxels", label: "How fine", low: 32, high: 128, step: 16, ends: ["quick", "fine"], text: (value) => `${value} voxels a side` };
const LOW = { name: "elevation_deg", label: "How high the lamp stands", ends: ["low", "high"], text: (value) => `${value}° above level` };
const FIT = { name: "fit", label: "Other shapes", options: [["crop", "cut to fit"], ["pad", "keep all"]] };
const CARE = { name: "quality", label: "Care", options: [["draft", "quick"], ["normal", "normal"], ["best", "best"]] };
const onTable = ({ where }) => where === "table";
const onWalls = ({ where }) => where === "walls";

/**
 * By kind: sliders and choices; `where(making)` says when one of them counts. How many pictures are used is asked of
 * light cubes only.
 */
export const MAKINGS = {
  cube: {
    counted: true,
    sliders: [
      { name: "width", label: "How wide", low: 0.2, high: 1, step: 0.05, ends: ["small pictures", "wide pictures"], text: (value) => `${part(value)} of the cube` },
      LAMP, HOLD, GLASS, FINE,
    ],
    choices: [
      { name: "mat", label: "Around the pictures", options: [["dark", "dark"], ["grey", "grey"], ["light", "light"], ["none", "anything"]] },
      FIT,
      { name: "order", label: "Order", options: [["given", "as given"], ["best", "the best one"]] },
      CARE,
      { name: "stands", label: "The light enters", options: [["air", "without bending"], ["block", "a block of glass"], ["cylinder", "a glass cylinder"]] },
    ],
  },
  room: { sliders: [HOLD, GLASS, FINE], choices: [CARE] },
  shape: {
    sliders: [
      { name: "size_mm", label: "How large", low: 20, high: 240, step: 10, ends: ["small", "large"], text: mm },
      { name: "voxels", label: "How fine", low: 32, high: 192, step: 16, ends: ["quick", "fine"], text: (value) => `${value} voxels along it` },
      { ...LOW, low: 0, high: 60, step: 5, where: onTable },
      { name: "wall_mm", label: "Walls", low: 0, high: 4, step: 0.2, ends: ["thin", "thick"], text: (value) => (value ? `${value} mm thick at least` : "as thin as they come") },
    ],
    choices: [
      { name: "where", label: "Its shadows fall", options: [["walls", "on three walls"], ["table", "on one wall, as it turns"]] },
      { name: "placement", label: "Which picture where", options: [["given", "front, side, top as given"], ["best", "as is best"]], where: onWalls },
      { name: "dark", label: "The shape is", options: [["found", "found by itself"], ["dark", "what is dark"], ["light", "what is light"]] },
      { name: "repair", label: "Where they contradict", options: [["auto", "mend as is best"], ["warp", "bend"], ["trim", "leave out"], ["grow", "add"], ["none", "do nothing"]] },
      { name: "carve", label: "Inside", options: [["none", "solid"], ["shell", "hollow"], ["lace", "lace"]] },
    ],
  },
  plate: {
    sliders: [
      { name: "columns", label: "How fine", low: 32, high: 256, step: 16, ends: ["quick", "fine"], text: (value) => `${value} columns a side` },
      { name: "pitch_mm", label: "A column", low: 0.2, high: 2, step: 0.1, ends: ["fine printer", "coarse printer"], text: mm },
      { name: "relief", label: "How high the relief is", low: 2, high: 30, step: 1, ends: ["flat", "high"], text: (value) => `throws shadows ${value} columns long` },
      { ...LOW, low: 15, high: 70, step: 5 },
    ],
    choices: [{ name: "colour", label: "Lamps", options: [["false", "white, one for each picture"], ["true", "red, green and blue, for one picture"]] }, CARE],
  },
  films: {
    sliders: [
      { name: "films", label: "How many films", low: 2, high: 8, step: 1, ends: ["two", "eight"], text: String },
      { name: "gap_mm", label: "Between them", low: 2, high: 40, step: 1, ends: ["close", "far apart"], text: mm },
      { name: "size_mm", label: "How large", low: 40, high: 180, step: 10, ends: ["small", "a page"], text: mm },
      { name: "cells", label: "How fine", low: 32, high: 160, step: 16, ends: ["coarse", "fine"], text: (value) => `${value / 2} pixels, two cells each` },
      { name: "assembly_mm", label: "May lie off", low: 0, high: 1, step: 0.1, ends: ["laid exactly", "laid by hand"], text: (value) => (value ? `by ${value} mm` : "not at all") },
      LAMP,
    ],
    choices: [
      { name: "inks", label: "Printed with", options: [["cmyk-film", "four inks"], ["cmy-film", "three inks"], ["any", "any colours"]] },
      FIT, CARE,
    ],
  },
};
