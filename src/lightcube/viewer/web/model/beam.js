// One beam through the cube: which voxels it meets, and for how long (Siddon's method, Medical Physics 12 (1985) 252).

import { add, norm, scaled, sub } from "../tools/vectors.js";

/** A direction's part below this is zero. */
const PARALLEL = 1e-12;
/** A beam along a face counts as on it within this distance, in voxel sides. */
const ON_FACE = 1e-9;

/**
 * The beam that lights a place of the raster: the points start + t way, first <= t <= last.
 *
 * Of parallel light it is the whole line, of a point lamp the stretch from the lamp to the place. It is seen from there,
 * because lamps may be very far away.
 * @param {object} view of an exposure
 * @param {number} row whole in the middle of a pixel
 * @param {number} column
 * @param {number[]} raster [rows, columns] of the exposure
 * @returns {{start: number[], way: number[], first: number, last: number, pixel: number[]}} mm in the cube's axes;
 *   `way` has length 1, and `pixel` is where the place lies (`start` too)
 */
export function beamOf(view, row, column, raster) {
  const across = scaled(view.right, column - (raster[1] - 1) / 2);
  const pixel = add(add(view.origin, across), scaled(view.down, row - (raster[0] - 1) / 2));
  const point = view.light[3] !== 0;
  const way = point ? sub(pixel, view.light) : view.light.slice(0, 3);
  const length = norm(way);
  if (length === 0) return { start: pixel, way: [1, 0, 0], first: 0, last: 0, pixel }; // the lamp stands on the pixel
  const ahead = scaled(way, 1 / length);
  return { start: pixel, way: ahead, first: point ? -length : -Infinity, last: point ? 0 : Infinity, pixel };
}

/**
 * The voxels that a beam meets, and its length in each.
 *
 * A beam that runs along a face gives half of its length to each neighbour, a quarter along an edge; halves outside the
 * cube vanish.
 * @param {number[]} shape [nz, ny, nx]
 * @param {number} voxel_mm side of a voxel
 * @param {number[]} start mm in the cube's axes, whose origin is the cube's middle
 * @param {number[]} way of length 1
 * @param {number} [first] where along the way the beam begins, mm from the start
 * @param {number} [last] where it ends
 * @returns {{voxels: Int32Array, lengths: Float64Array}} index (z * ny + y) * nx + x, and mm
 */
export function walk(shape, voxel_mm, start, way, first = -Infinity, last = Infinity) {
  const most = mostPieces(shape);
  const [voxels, lengths] = [new Int32Array(most), new Float64Array(most)];
  const count = walkInto(voxels, lengths, shape, voxel_mm, start, way, first, last);
  return { voxels: voxels.slice(0, count), lengths: lengths.slice(0, count) };
}

/** Upper bound on the pieces of one beam, with room for one more. */
export function mostPieces(shape) {
  return 4 * (shape[0] + shape[1] + shape[2] + 5) + 1;
}

/** As `walk`, into arrays that have room for `mostPieces`; returns how many pieces there are. */
export function walkInto(voxels, lengths, shape, voxel_mm, start, way, first, last) {
  const counts = [shape[2], shape[1], shape[0]];
  const places = start.map((value, axis) => value / voxel_mm + counts[axis] / 2);
  const sides = places.map((place, axis) => sidesAt(place, way[axis]));
  const scale = voxel_mm / (sides[0].length * sides[1].length * sides[2].length);
  let count = 0;
  for (const x of sides[0]) {
    for (const y of sides[1]) {
      for (const z of sides[2]) {
        count = walkOffFaces(voxels, lengths, count, counts, [x, y, z], way, first / voxel_mm, last / voxel_mm, scale);
      }
    }
  }
  return count;
}

/** Where a beam runs on one axis: half a voxel to either side where that is along a face. */
function sidesAt(place, part) {
  if (!runsOnFace(place, part)) return [place];
  return [Math.round(place) - 0.5, Math.round(place) + 0.5];
}

function runsOnFace(place, part) {
  return Math.abs(part) < PARALLEL && Math.abs(place - Math.round(place)) <= ON_FACE;
}

/** Append the pieces of a beam that runs along no face, in voxel sides from the cube's lowest corner. */
function walkOffFaces(voxels, lengths, count, counts, p, d, first, last, scale) {
  let [t, end] = [first, last];
  for (let axis = 0; axis < 3; axis++) {
    const [into, out] = crossings(p[axis], d[axis], counts[axis]);
    t = Math.max(t, into);
    end = Math.min(end, out);
  }
  if (!(t < end)) return count;
  const at = [0, 1, 2].map((axis) => Math.min(Math.max(Math.floor(p[axis] + t * d[axis]), 0), counts[axis] - 1));
  const [xWay, yWay, zWay] = d.map((part) => (Math.abs(part) < PARALLEL ? 0 : Math.sign(part)));
  let [tx, ty, tz] = at.map((cell, axis) => nextFace(p[axis], d[axis], cell));
  const [xGap, yGap, zGap] = d.map((part) => (Math.abs(part) < PARALLEL ? Infinity : 1 / Math.abs(part)));
  let [x, y, z] = at;
  const [nx, ny, nz] = counts;
  while (t < end) {
    const stop = Math.min(tx, ty, tz, end);
    if (stop > t && x >= 0 && x < nx && y >= 0 && y < ny && z >= 0 && z < nz) {
      voxels[count] = (z * ny + y) * nx + x;
      lengths[count++] = (stop - t) * scale;
    }
    t = Math.max(t, stop);
    if (tx <= stop) {
      x += xWay;
      tx += xGap;
    }
    if (ty <= stop) {
      y += yWay;
      ty += yGap;
    }
    if (tz <= stop) {
      z += zWay;
      tz += zGap;
    }
  }
  return count;
}

/** Parameters at which p + t d enters and leaves [0, n]; empty where it misses. */
function crossings(p, d, n) {
  if (Math.abs(d) < PARALLEL) return p > 0 && p < n ? [-Infinity, Infinity] : [Infinity, -Infinity];
  const [one, other] = [-p / d, (n - p) / d];
  return one < other ? [one, other] : [other, one];
}

function nextFace(p, d, cell) {
  if (Math.abs(d) < PARALLEL) return Infinity;
  return d > 0 ? (cell + 1 - p) / d : (cell - p) / d;
}

/**
 * The stretch of a beam within the cube, or null where it misses: exactly where `walk` finds nothing.
 * @param {number[]} shape [nz, ny, nx]
 * @param {number} voxel_mm side of a voxel
 * @param {object} beam of `beamOf`
 * @returns {{start: number[], end: number[]} | null} where it enters and leaves, mm
 */
export function stretchInside(shape, voxel_mm, beam) {
  let [enter, leave] = [beam.first / voxel_mm, beam.last / voxel_mm];
  for (let axis = 0; axis < 3; axis++) {
    const place = beam.start[axis] / voxel_mm + shape[2 - axis] / 2;
    const kept = sidesAt(place, beam.way[axis]).map((side) => crossings(side, beam.way[axis], shape[2 - axis]));
    enter = Math.max(enter, Math.min(...kept.map((ends) => ends[0])));
    leave = Math.min(leave, Math.max(...kept.map((ends) => ends[1])));
  }
  if (!(enter < leave)) return null;
  const [start, end] = [enter, leave].map((t) => add(beam.start, scaled(beam.way, t * voxel_mm)));
  return { start, end };
}
