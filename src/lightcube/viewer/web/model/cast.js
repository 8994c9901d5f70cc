// What a screen shows: the sum of the lamps' light behind the cube, in linear light.

import { beamOf, mostPieces, walkInto } from "./beam.js";
import { fallingLight } from "./light.js";

/**
 * A screen's whole picture.
 * @param {object} cube
 * @param {object} exposure of one screen
 * @returns {Float32Array} rows * columns * 3 of the raster, row 0 the top, linear light, never clipped
 */
export function castPicture(cube, exposure) {
  const [rows, columns] = exposure.raster;
  const picture = new Float32Array(rows * columns * 3);
  for (let row = 0; row < rows; row++) picture.set(castRow(cube, exposure, row), 3 * row * columns);
  return picture;
}

/**
 * One row of a screen's picture.
 * @param {object} cube
 * @param {object} exposure of one screen
 * @param {number} row
 * @returns {Float32Array} columns * 3 of the raster, linear light, never clipped
 */
export function castRow(cube, exposure, row) {
  const columns = exposure.raster[1];
  const light = new Float32Array(columns * 3);
  const scratch = scratchFor(cube);
  for (let column = 0; column < columns; column++) {
    light.set(castInto([0, 0, 0], cube, exposure, row, column, scratch), 3 * column);
  }
  return light;
}

/**
 * Part of the light that a beam keeps through the pieces of its way, [red, green, blue].
 * @param {object} cube
 * @param {Int32Array} voxels
 * @param {Float64Array} lengths mm
 * @param {number} [count] of the pieces; default all
 */
export function transmittance(cube, voxels, lengths, count = voxels.length) {
  const [reds, greens, blues] = cube.tables;
  let [red, green, blue] = [0, 0, 0];
  for (let piece = 0; piece < count; piece++) {
    const first = 3 * voxels[piece];
    red += lengths[piece] * reds[cube.codes[first]];
    green += lengths[piece] * greens[cube.codes[first + 1]];
    blue += lengths[piece] * blues[cube.codes[first + 2]];
  }
  return [Math.exp(-red), Math.exp(-green), Math.exp(-blue)];
}

function scratchFor(cube) {
  const most = mostPieces(cube.shape);
  return { voxels: new Int32Array(most), lengths: new Float64Array(most) };
}

function castInto(total, cube, exposure, row, column, { voxels, lengths }) {
  if (row >= exposure.window[0] || column >= exposure.window[1]) return total;
  for (const view of exposure.views) {
    const { start, way, first, last, pixel } = beamOf(view, row, column, exposure.raster);
    const { light, shadow } = fallingLight(view, pixel);
    const count = walkInto(voxels, lengths, cube.shape, cube.voxel_mm, start, way, first, last);
    const left = transmittance(cube, voxels, lengths, count);
    for (let channel = 0; channel < 3; channel++) {
      total[channel] += view.power[channel] * light * (1 - shadow * (1 - left[channel]));
    }
  }
  return total;
}
