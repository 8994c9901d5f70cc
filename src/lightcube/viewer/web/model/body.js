// An opaque shape as a body: its surface between the voxels, where a ray meets it, and how bright that is under lamps.

import { add, dot, norm, scaled, sub, unit } from "../tools/vectors.js";

/** Voxels around the block that are empty: as far as a mean reaches, and one more, so that the surface is closed. */
export const MARGIN = 3;
/** Levels of 255 from which on a place is inside. */
export const SURFACE = 127.5;
/** Voxels that a ray goes on by. */
export const STEP = 0.75;
/** How often such a step is halved where it meets the surface. */
export const HALVINGS = 5;
/** Voxels that a place is lifted off the surface before one looks from it to a lamp. */
export const LIFT = 1.5;
/** How bright a body is below, where no lamp shines on it. */
export const AMBIENT = 0.14;
/** And how much brighter above. */
export const SKY = 0.22;
/** Weights of a mean along a line. */
const WEIGHTS = [1 / 16, 4 / 16, 6 / 16, 4 / 16, 1 / 16];
/** Voxels whose mean is below the first of these are of a piece so thin that it would vanish; they get the second. */
const [THIN, KEPT] = [0.4, 0.75];

/**
 * How far inside each place is: a mean over neighbouring voxels, so that the surface is smooth; what is thin stays.
 * @param {{shape: number[], codes: Uint16Array}} cube
 * @returns {{shape: number[], levels: Uint8Array}} [z][y][x], with a margin on all sides
 */
export function bodyOf({ shape, codes }) {
  const wide = shape.map((count) => count + 2 * MARGIN);
  const inside = new Float32Array(wide[0] * wide[1] * wide[2]);
  let voxel = 0;
  for (let z = 0; z < shape[0]; z++) {
    for (let y = 0; y < shape[1]; y++) {
      const line = ((z + MARGIN) * wide[1] + y + MARGIN) * wide[2] + MARGIN;
      for (let x = 0; x < shape[2]; x++, voxel++) inside[line + x] = codes[3 * voxel] > 0 ? 1 : 0;
    }
  }
  const levels = Uint8Array.from(meanOf(inside, wide), (each, i) => Math.round(255 * (inside[i] && each < THIN ? KEPT : each)));
  return { shape: wide, levels };
}

/** Weighted means along all three axes. */
function meanOf(values, shape) {
  const [reach, steps] = [(WEIGHTS.length - 1) / 2, [shape[1] * shape[2], shape[2], 1]];
  let before = values;
  steps.forEach((step, axis) => {
    const after = new Float32Array(values.length);
    for (let i = 0; i < values.length; i++) {
      const at = Math.floor(i / step) % shape[axis];
      if (at < reach || at >= shape[axis] - reach) continue; // nothing is there
      let sum = 0;
      for (let k = -reach; k <= reach; k++) sum += WEIGHTS[k + reach] * before[i + k * step];
      after[i] = sum;
    }
    before = after;
  });
  return before;
}

/** The level at a place in voxels from the block's lowest corner, between those of the eight voxels around it. */
export function levelAt({ shape, levels }, place) {
  const at = place.map((each, i) => Math.min(Math.max(each + MARGIN - 0.5, 0), shape[2 - i] - 1.001));
  const [x, y, z] = at.map(Math.floor);
  const [u, v, w] = at.map((each) => each - Math.floor(each));
  const [row, slice] = [shape[2], shape[1] * shape[2]];
  const i = z * slice + y * row + x;
  const along = (k) => levels[k] + u * (levels[k + 1] - levels[k]);
  const across = (k) => along(k) + v * (along(k + row) - along(k));
  return across(i) + w * (across(i + slice) - across(i));
}

/** The part of a ray that lies in the block and its margin, [from, to]; from is not below to where it misses. */
function within({ shape }, start, way) {
  let [from, to] = [0, Infinity];
  for (let axis = 0; axis < 3; axis++) {
    const [low, high] = [-1, shape[2 - axis] - 2 * MARGIN + 1].map((end) => (end - start[axis]) / (way[axis] || 1e-12));
    [from, to] = [Math.max(from, Math.min(low, high)), Math.min(to, Math.max(low, high))];
  }
  return [from, to];
}

/**
 * Where a ray first meets a body.
 * @param {object} body
 * @param {number[]} start voxels from the block's lowest corner
 * @param {number[]} way of length 1
 * @returns {{far: number, place: number[], normal: number[]} | null}
 */
export function meets(body, start, way) {
  const [from, to] = within(body, start, way);
  const at = (far) => add(start, scaled(way, far));
  for (let far = from; far < to; far += STEP) {
    if (levelAt(body, at(far)) < SURFACE) continue;
    let [out, inside] = [Math.max(from, far - STEP), far];
    for (let i = 0; i < HALVINGS; i++) {
      const middle = (out + inside) / 2;
      if (levelAt(body, at(middle)) < SURFACE) out = middle;
      else inside = middle;
    }
    const place = at(inside);
    return { far: inside, place, normal: normalAt(body, place) };
  }
  return null;
}

/** The way out of a body at its surface. */
function normalAt(body, place) {
  const steps = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  const ahead = steps.map((step) => levelAt(body, sub(place, step)) - levelAt(body, add(place, step)));
  return norm(ahead) > 0 ? unit(ahead) : [0, 0, 1];
}

/**
 * How bright a body is where a ray meets it, 1 at most.
 * @param {object} body
 * @param {{place: number[], normal: number[]}} met
 * @param {number[]} up in the block's axes
 * @param {{ways: function(number[]): number[], light: number[]}[]} lamps ways of length 1 to each from a place, in voxels
 * @returns {number[]} red, green and blue
 */
export function brightness(body, { place, normal }, up, lamps) {
  const bright = Array(3).fill(AMBIENT + SKY * (0.5 + 0.5 * dot(normal, up)));
  const start = add(place, scaled(normal, LIFT));
  // three lamps at right angles to each other light a face between them by the root of three
  const whole = [0, 1, 2].map((i) => Math.sqrt(Math.max(1, lamps.reduce((sum, { light }) => sum + light[i], 0))));
  for (const { ways, light } of lamps) {
    const way = ways(place);
    const slant = dot(normal, way);
    if (slant <= 0 || meets(body, start, way) !== null) continue;
    for (let i = 0; i < 3; i++) bright[i] += ((1 - AMBIENT - SKY) * slant * light[i]) / whole[i];
  }
  return bright.map((each) => Math.min(1, each));
}
