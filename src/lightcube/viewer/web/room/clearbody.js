// The clear body in the room: its outline, and the bent way of the light through it. Lengths are mm, in the cube's axes.

import { beamOf } from "../model/beam.js";
import { bentBeam } from "../model/glass.js";

/** Straight pieces of a circle, and how high a bath is drawn, in heights of the block. */
const [PIECES, BATH_HIGH] = [24, 1.25];

/** Whether the glass is cut round, so that the block's edges are not there. */
export function isCutRound({ glass }) {
  return glass?.form === "cylinder" || glass?.form === "sphere";
}

/**
 * The edges of what the light enters, besides those of the block; and bars across a bottom that lets none out.
 * @param {object} scene with glass
 * @param {object} exposure of a screen: a bath with flat sides stands square to its light
 * @returns {number[][][]} pairs of ends
 */
export function bodyEdges({ glass: { form, half, blocked }, voxels }, { views: [{ light }] }) {
  const [radius, , height] = half;
  if (form === "block") return blocked ? bars(half) : [];
  if (form === "sphere") {
    return [0, 1, 2].flatMap((axis) => circle((a, b) => [[0, a, b], [a, 0, b], [a, b, 0]][axis].map((part) => radius * part)));
  }
  const high = height ?? (BATH_HIGH * voxels.shape[0] * voxels.voxel_mm) / 2;
  const level = Math.hypot(light[0], light[1]);
  const [x, y] = [light[0] / level, light[1] / level];
  const at = (ahead, left, z) => [radius * (ahead * x - left * y), radius * (ahead * y + left * x), z];
  if (form === "bath") {
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
    const around = (z) => corners.map(([a, b], i) => [at(a, b, z), at(...corners[(i + 1) % 4], z)]);
    return [...around(-high), ...around(high), ...corners.map(([a, b]) => [at(a, b, -high), at(a, b, high)])];
  }
  const sides = [-1, 1].map((left) => [at(0, left, -high), at(0, left, high)]);
  return [...[-high, high].flatMap((z) => circle((a, b) => [radius * a, radius * b, z])), ...sides];
}

/** Lines across the bottom of a block. */
function bars([x, y, z]) {
  return [-3, -2, -1, 0, 1, 2, 3].map((k) => [-1, 1].map((end) => [(k / 4) * x, end * y, -z]));
}

function circle(at) {
  const place = (i) => at(Math.cos((2 * Math.PI * i) / PIECES), Math.sin((2 * Math.PI * i) / PIECES));
  return Array.from({ length: PIECES }, (_, i) => [place(i), place(i + 1)]);
}

/** Where the light of a pixel enters the glass, leaves it, and falls: null where none comes through. */
export function bentWay(view, row, column, raster) {
  const { pixel } = beamOf(view, row, column, raster);
  const { through, enters, leaves } = bentBeam(view, pixel);
  return through > 0 ? [enters, leaves, pixel] : null;
}
