// The light of a relief's columns under a lamp in any direction, seen from above, as an eye blurs it: the package's law.

import { decode, encode } from "./light.js";

/** Points of a column that its light is judged at, and that it is seen at while the lamp moves; Fibonacci's numbers. */
const [JUDGED, QUICK] = [[55, 34], [8, 5]];
/** Parts of a sine below which it is none. */
const NONE = 1e-12;
/** How many widths of a blur its mean goes. */
const WIDE = 4;

/**
 * The heights of a relief, from the bytes that a page carries: float64, the first row furthest away.
 * @param {Uint8Array} bytes not gzipped
 * @param {object} scene
 * @returns {Float64Array}
 */
export function heightsOf(bytes, { columns: [rows, columns] }) {
  if (bytes.length !== 8 * rows * columns) {
    throw new Error(`the page's heights have ${bytes.length} bytes, not those of ${columns} x ${rows} columns: write or send the page again`);
  }
  return new Float64Array(bytes.slice().buffer);
}

/**
 * The light of every column, the mean over points of it, with what the plate throws into its own shadows.
 * @param {object} scene
 * @param {Float64Array} heights
 * @param {number} azimuth degrees from the right, against the clock from above
 * @param {number} elevation degrees
 * @param {boolean} judged at all points, or at some
 * @returns {Float64Array} rows * columns
 */
export function columnsLit({ columns: [rows, columns], elevation_deg, bounce }, heights, azimuth, elevation, judged = true) {
  const radians = (degrees) => (degrees * Math.PI) / 180;
  const exact = (value) => (Math.abs(value) < NONE ? 0 : value);
  const [down, right] = [-exact(Math.sin(radians(azimuth))), exact(Math.cos(radians(azimuth)))];
  const rise = Math.tan(radians(elevation)) / Math.tan(radians(elevation_deg));
  const highest = heights.reduce((most, each) => Math.max(most, each), 0);
  const [count, step] = judged ? JUDGED : QUICK;
  const lamp = { rows, columns, down, right, rise, highest };
  const points = Array.from({ length: count }, (_, i) => [(i + 0.5) / count, (((step * i) % count) + 0.5) / count]);
  const lit = new Float64Array(rows * columns);
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      let sum = 0;
      for (const [y, x] of points) if (isLit(heights, row, column, y, x, lamp)) sum++;
      lit[row * columns + column] = sum / count;
    }
  }
  const thrown = (bounce * lit.reduce((sum, each) => sum + each, 0)) / lit.length;
  return lit.map((each) => each + thrown * (1 - each));
}

/** Whether nothing stands between a point on a column's top and the lamp: from column to column, as the ray goes. */
function isLit(heights, row, column, y, x, { rows, columns, down, right, rise, highest }) {
  const own = heights[row * columns + column];
  const perRow = down === 0 ? Infinity : 1 / Math.abs(down);
  const perColumn = right === 0 ? Infinity : 1 / Math.abs(right);
  let nextRow = down === 0 ? Infinity : (down > 0 ? 1 - y : y) * perRow;
  let nextColumn = right === 0 ? Infinity : (right > 0 ? 1 - x : x) * perColumn;
  for (;;) {
    let way = nextRow;
    if (nextColumn < nextRow) {
      way = nextColumn;
      column += right > 0 ? 1 : -1;
      nextColumn += perColumn;
    } else {
      row += down > 0 ? 1 : -1;
      nextRow += perRow;
    }
    const ray = own + way * rise;
    if (row < 0 || column < 0 || row >= rows || column >= columns || ray >= highest) return true;
    if (heights[row * columns + column] > ray) return false;
  }
}

/** Means over the squares of columns that are a picture's pixels. */
export function pixelsLit({ columns: [, columns], window: [rows, across], cell }, lit) {
  if (cell === 1) return lit;
  const light = new Float64Array(rows * across);
  for (let row = 0; row < rows * cell; row++) {
    for (let column = 0; column < across * cell; column++) {
      light[Math.floor(row / cell) * across + Math.floor(column / cell)] += lit[row * columns + column] / cell ** 2;
    }
  }
  return light;
}

/**
 * A picture as an eye sees it that blurs so many columns; beyond its edges it is mirrored.
 * @param {object} scene
 * @param {Float64Array} light of pixels
 * @param {number} blur columns, 0 = none
 * @returns {Float64Array}
 */
export function blurred({ window: [rows, columns], cell }, light, blur) {
  if (blur === 0) return light;
  const [width, reach] = [blur / cell, Math.floor((WIDE * blur) / cell + 0.5)];
  const taps = Array.from({ length: 2 * reach + 1 }, (_, i) => Math.exp(-0.5 * ((i - reach) / width) ** 2));
  const whole = taps.reduce((sum, tap) => sum + tap, 0);
  const along = (before, count, step, starts) => {
    const after = new Float64Array(before.length);
    for (const start of starts) {
      for (let i = 0; i < count; i++) {
        let sum = 0;
        for (let k = -reach; k <= reach; k++) sum += taps[k + reach] * before[start + step * mirrored(i + k, count)];
        after[start + step * i] = sum / whole;
      }
    }
    return after;
  };
  const downwards = along(light, rows, columns, Array.from({ length: columns }, (_, i) => i));
  return along(downwards, columns, 1, Array.from({ length: rows }, (_, i) => i * columns));
}

/** A place beyond a line's ends, as in a mirror there. */
function mirrored(place, count) {
  const turn = ((place % (2 * count)) + 2 * count) % (2 * count);
  return turn < count ? turn : 2 * count - 1 - turn;
}

/**
 * The lamps that shine where one has gone round so far: one, or those of the three colours together.
 * @param {object} scene
 * @param {number} angle degrees
 * @returns {{azimuth: number, colour: number[]}[]}
 */
export function lampsOf({ colours }, angle) {
  if (colours === null) return [{ azimuth: angle, colour: [1, 1, 1] }];
  const pure = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  return colours.map((azimuth, i) => ({ azimuth: (azimuth + angle) % 360, colour: pure[i] }));
}

/**
 * Display levels of linear light, one plane for all colours or one for each: red, green, blue, opaque.
 * @param {Float64Array[]} planes one or three
 * @returns {Uint8ClampedArray}
 */
export function levelsOf(planes) {
  const levels = new Uint8ClampedArray(4 * planes[0].length).fill(255);
  for (let channel = 0; channel < 3; channel++) {
    const plane = planes[Math.min(channel, planes.length - 1)];
    plane.forEach((light, i) => (levels[4 * i + channel] = 255 * encode(Math.min(light, 1), "srgb")));
  }
  return levels;
}

/** Display level of a part of the light that a level stands for. */
export function dimmed(level, part) {
  return 255 * encode(part * decode(level / 255, "srgb"), "srgb");
}
