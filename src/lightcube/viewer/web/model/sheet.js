// One scan-line from above: the voxels and the beams in the plane through a row of pixels and the light that makes it.

import { cross, dot } from "../tools/vectors.js";
import { beamOf, stretchInside, walk } from "./beam.js";
import { castRow, transmittance } from "./cast.js";
import { encode } from "./light.js";

/** A plane counts as on a face within this distance, in voxel sides. */
const ON_FACE = 1e-9;

/**
 * What the plane of a row meets, seen along the axis of the cube that it is most upright on.
 *
 * Beams, their ends and what is shown are exact. Cells are the voxels at the plane's height over the middle of each:
 * with level light exactly one slice of voxels, all that the row's beams meet; where the plane is tilted, beams meet
 * voxels next to these too, before or behind them (`beamFacts` has them all). A plane along a face between two slices
 * shows the one of the higher number, although its beams run half in each.
 * @param {object} cube
 * @param {object} exposure of one screen
 * @param {number} viewNumber into exposure.views
 * @param {number} row of the raster
 * @returns {{axis: number, shape: number[], cells: Int32Array, beams: object[]}}
 *   axis: the one that is left out, 0 = x, 1 = y, 2 = z;
 *   shape: counts [n, m] of the other two, in the order z, y, x;
 *   cells: n * m indices of voxels, m running fastest, -1 where the plane is outside;
 *   beams: for each column of the window {column, start, end (mm, where the beam enters and leaves the cube, null where
 *   it misses), pixel, shown (display values 0..1 of all the light there)}
 */
export function sheetOf(cube, exposure, viewNumber, row) {
  const view = exposure.views[viewNumber];
  const displayed = castRow(cube, exposure, row).map((light) => encode(light, exposure.transfer));
  const beams = Array.from({ length: exposure.window[1] }, (_, column) => {
    const beam = beamOf(view, row, column, exposure.raster);
    const inside = stretchInside(cube.shape, cube.voxel_mm, beam);
    const shown = [0, 1, 2].map((channel) => Math.min(displayed[3 * column + channel], 1));
    return { column, start: inside?.start ?? null, end: inside?.end ?? null, pixel: beam.pixel, shown };
  });
  return { ...cellsOf(cube, ...planeOf(view, row, exposure.raster)), beams };
}

/**
 * What one beam meets: exact.
 * @param {object} cube
 * @param {object} exposure of one screen
 * @param {number} viewNumber into exposure.views
 * @param {number} row of the raster
 * @param {number} column of the raster
 * @returns {{voxels: Int32Array, lengths: Float64Array, left: number[]}} indices, mm, and the part of each colour's
 *   light that is left behind the cube
 */
export function beamFacts(cube, exposure, viewNumber, row, column) {
  const { start, way, first, last } = beamOf(exposure.views[viewNumber], row, column, exposure.raster);
  const { voxels, lengths } = walk(cube.shape, cube.voxel_mm, start, way, first, last);
  return { voxels, lengths, left: transmittance(cube, voxels, lengths) };
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
