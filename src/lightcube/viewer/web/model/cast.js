// What a screen shows: the sum of the lamps' light behind the cube, averaged over areas, in linear light.

import { middleOf } from "./area.js";
import { mostPieces, walkInto } from "./beam.js";
import { litBeam } from "./light.js";

/**
 * A screen's whole picture.
 * @param {object} cube
 * @param {object} exposure of one screen
 * @param {number[][]} points of `pointsOf`, over which each pixel or part of one is averaged
 * @param {number} [parts] along either side of a pixel
 * @returns {Float32Array} rows * columns * 3 of the raster's parts, row 0 the top, linear light, never clipped
 */
export function castPicture(cube, exposure, points, parts = 1) {
  const [rows, columns] = exposure.raster.map((count) => count * parts);
  const picture = new Float32Array(rows * columns * 3);
  for (let i = 0; i < rows; i++) picture.set(castRow(cube, exposure, middleOf(i, parts), points, parts), 3 * i * columns);
  return picture;
}

/**
 * One row of a screen's picture.
 * @param {object} cube
 * @param {object} exposure of one screen
 * @param {number} row where its middle is
 * @param {number[][]} points of `pointsOf`
 * @param {number} [parts] along either side of a pixel
 * @returns {Float32Array} columns * 3 of the raster's parts, linear light, never clipped
 */
export function castRow(cube, exposure, row, points, parts = 1) {
  const columns = exposure.raster[1] * parts;
  const light = new Float32Array(columns * 3);
  const scratch = scratchFor(cube);
  const own = points.map((point) => point.map((each) => each / parts));
  for (let i = 0; i < columns; i++) light.set(meanOn(cube, exposure, row, middleOf(i, parts), own, scratch), 3 * i);
  return light;
}

/**
 * One pixel of a screen's picture.
 * @param {object} cube
 * @param {object} exposure of one screen
 * @param {number} row
 * @param {number} column
 * @param {number[][]} points of `pointsOf`
 * @returns {number[]} red, green and blue, linear light, never clipped
 */
export function castPixel(cube, exposure, row, column, points) {
  return meanOn(cube, exposure, row, column, points, scratchFor(cube));
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

/** Mean light at points around a place, in pixels; none beside the screen. */
function meanOn(cube, exposure, row, column, points, scratch) {
  const total = [0, 0, 0];
  if (Math.round(row) >= exposure.window[0] || Math.round(column) >= exposure.window[1]) return total;
  for (const [across, down] of points) castInto(total, cube, exposure, row + down, column + across, scratch);
  return total.map((sum) => sum / points.length);
}

/** Add the light of one beam for each view: what comes through the glass, and past it. */
function castInto(total, cube, exposure, row, column, { voxels, lengths }) {
  for (const view of exposure.views) {
    const { start, way, first, last, light, shadow } = litBeam(view, row, column, exposure.raster);
    if (light === 0) continue;
    const count = walkInto(voxels, lengths, cube.shape, cube.voxel_mm, start, way, first, last);
    const left = transmittance(cube, voxels, lengths, count);
    for (let channel = 0; channel < 3; channel++) {
      total[channel] += view.power[channel] * light * (1 - shadow * (1 - left[channel]));
    }
  }
}
