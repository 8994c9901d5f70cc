// Light falls on areas: where the beams meet a pixel whose light is their mean.

import { norm } from "../tools/vectors.js";

/** Parts of voxel sides, and of directions, below which they are none. */
const NONE = 1e-9;

/**
 * How many beams make a pixel: as many as the package's judge takes, fewer while things move, and one through its
 * middle, as in the paper. `square` is spread over it, `row` along it where the light does not vary from its top to its
 * bottom, and `least` is for a part of a pixel.
 */
export const JUDGED = { square: 55, row: 16, least: 3 };
export const QUICK = { square: 3, row: 3, least: 1 };
export const THIN = { square: 1, row: 1, least: 1 };

/**
 * Where beams meet a pixel, or one of its parts.
 * @param {object} cube
 * @param {object} exposure of one screen
 * @param {object} beams how many: `JUDGED`, `QUICK` or `THIN`
 * @param {number} [parts] along either side of a pixel
 * @returns {number[][]} [across, down] from its middle, in its sides
 */
export function pointsOf(cube, exposure, beams, parts = 1) {
  const atLeast = (count) => Math.max(beams.least, Math.ceil(count));
  if (inOneSlice(cube, exposure)) return alongRow(atLeast(beams.row / parts));
  return overSquare(atLeast(beams.square / parts ** 2));
}

/** So many points along a row of side 1. */
export function alongRow(count) {
  return Array.from({ length: count }, (_, i) => [(i + 0.5) / count - 0.5, 0]);
}

/** A lattice of so many points on a square of side 1, or of as many more as make a number of Fibonacci's. */
function overSquare(least) {
  let [before, count] = [1, 1];
  while (count < least) [before, count] = [count, before + count];
  return alongRow(count).map(([across], i) => [across, (((before * i) % count) + 0.5) / count - 0.5]);
}

/** Whether an exposure's light is level, in glass too, and every row of its pixels exactly a slice of the cube's voxels. */
export function inOneSlice({ shape, voxel_mm }, { views, raster }) {
  return views.every(({ light, origin, right, down, glass }) => {
    const top = (origin[2] - (down[2] * raster[0]) / 2) / voxel_mm + shape[0] / 2;
    const steps = [right[2], down[0], down[1], Math.abs(down[2]) - voxel_mm].map((step) => step / voxel_mm);
    const off = [light[2] / norm(light), top - Math.round(top), ...steps];
    return light[3] === 0 && glass?.form !== "sphere" && off.every((part) => Math.abs(part) < NONE);
  });
}

/**
 * Where a part of a pixel has its middle.
 * @param {number} part counted from the raster's edge
 * @param {number} parts along a pixel's side
 * @returns {number} in pixels, of which number 0 has its middle at 0
 */
export function middleOf(part, parts) {
  return (part + 0.5) / parts - 0.5;
}
