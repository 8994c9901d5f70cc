// One scan-line from above: the voxels and the beams in the plane through a row of pixels and the light that makes it.

import { add, cross, dot, scaled } from "../tools/vectors.js";
import { alongRow, middleOf } from "./area.js";
import { beamOf, stretchInside, walk } from "./beam.js";
import { castRow, transmittance } from "./cast.js";
import { encode } from "./light.js";

/** A plane counts as on a face within this distance, in voxel sides. */
const ON_FACE = 1e-9;
/** Beams that stand for all those of a pixel. */
const BUNDLE = 5;

/**
 * What the plane of a row meets, seen along the axis of the cube that it is most upright on.
 *
 * Beams, their ends and what is shown are exact. Cells are the voxels at the plane's height over the middle of each:
 * with level light exactly one slice of voxels, all that the row's beams meet; where the plane is tilted, beams meet
 * voxels next to these too, before or behind them (`pixelFacts` has them all). A plane along a face between two slices
 * shows the one of the higher number, although its beams run half in each.
 * @param {object} cube
 * @param {object} exposure of one screen
 * @param {number} viewNumber into exposure.views
 * @param {number} row of the raster
 * @param {number[][]} points of `pointsOf`, over which each pixel is averaged
 * @returns {{axis: number, shape: number[], cells: Int32Array, pixels: object[]}}
 *   axis: the one that is left out, 0 = x, 1 = y, 2 = z;
 *   shape: counts [n, m] of the other two, in the order z, y, x;
 *   cells: n * m indices of voxels, m running fastest, -1 where the plane is outside;
 *   pixels: for each column of the window {column, shown (display values 0..1 of all the light on it), beams: some of
 *   those that make it, {start, end (mm, where it enters and leaves the cube, null where it misses), pixel (where it
 *   lands), shown (of all the light there)}}
 */
export function sheetOf(cube, exposure, viewNumber, row, points) {
  const view = exposure.views[viewNumber];
  const bundle = points.length === 1 ? 1 : BUNDLE;
  const means = shownOf(castRow(cube, exposure, row, points), exposure);
  const each = shownOf(castRow(cube, exposure, row, alongRow(1), bundle), exposure);
  const beamAt = (part) => {
    const beam = beamOf(view, row, middleOf(part, bundle), exposure.raster);
    const inside = stretchInside(cube.shape, cube.voxel_mm, beam);
    return { start: inside?.start ?? null, end: inside?.end ?? null, pixel: beam.pixel, shown: each[part] };
  };
  const pixels = Array.from({ length: exposure.window[1] }, (_, column) => {
    const beams = Array.from({ length: bundle }, (__, i) => beamAt(column * bundle + i));
    return { column, shown: means[column], beams };
  });
  return { ...cellsOf(cube, ...planeOf(view, row, exposure.raster)), pixels };
}

/** Display values [red, green, blue] of light, none above white. */
function shownOf(light, { transfer }) {
  const levels = Array.from(light, (each) => Math.min(encode(each, transfer), 1));
  return Array.from({ length: levels.length / 3 }, (_, i) => levels.slice(3 * i, 3 * i + 3));
}

/**
 * What the beams of one pixel meet: exact.
 * @param {object} cube
 * @param {object} exposure of one screen
 * @param {number} viewNumber into exposure.views
 * @param {number} row of the raster
 * @param {number} column of the raster
 * @param {number[][]} points of `pointsOf`
 * @returns {{voxels: Set<number>, left: number[]}} indices, and the part of each colour's light that is left behind the
 *   cube, on average
 */
export function pixelFacts(cube, exposure, viewNumber, row, column, points) {
  const met = new Set();
  let sum = [0, 0, 0];
  for (const [across, down] of points) {
    const beam = beamOf(exposure.views[viewNumber], row + down, column + across, exposure.raster);
    const { voxels, lengths } = walk(cube.shape, cube.voxel_mm, beam.start, beam.way, beam.first, beam.last);
    voxels.forEach((voxel) => met.add(voxel));
    sum = add(sum, transmittance(cube, voxels, lengths));
  }
  return { voxels: met, left: scaled(sum, 1 / points.length) };
}

/** Normal of the plane through a row's beams, and a point of it, mm. */
function planeOf(view, row, raster) {
  const { way, pixel } = beamOf(view, row, (raster[1] - 1) / 2, raster);
  return [cross(way, view.right), pixel];
}

function cellsOf({ shape, voxel_mm }, normal, point) {
  const steep = normal.map(Math.abs);
  const axis = [2, 1, 0].reduce((best, each) => (steep[each] > steep[best] + ON_FACE ? each : best));
  const [slow, fast] = [2, 1, 0].filter((each) => each !== axis);
  const count = (each) => shape[2 - each];
  const [n, m] = [count(slow), count(fast)];
  const strides = [1, shape[2], shape[1] * shape[2]];
  const cells = new Int32Array(n * m).fill(-1);
  for (let i = 0; i < n; i++) {
    for (let j = 0; j < m; j++) {
      const middle = [0, 0, 0];
      middle[slow] = (i + 0.5 - n / 2) * voxel_mm;
      middle[fast] = (j + 0.5 - m / 2) * voxel_mm;
      const height = (dot(normal, point) - dot(normal, middle)) / normal[axis] / voxel_mm + count(axis) / 2;
      const place = sliceAt(height, count(axis));
      if (place >= 0) cells[i * m + j] = i * strides[slow] + j * strides[fast] + place * strides[axis];
    }
  }
  return { axis, shape: [n, m], cells };
}

/** Number of the slice at a height in voxel sides, or -1 outside. */
function sliceAt(height, count) {
  if (!(height >= -ON_FACE && height <= count + ON_FACE)) return -1;
  return Math.min(Math.max(Math.floor(height + ON_FACE), 0), count - 1);
}
