// How display values follow from linear light, and how much light and shadow of a lamp reaches a pixel.

import { cross, dot, norm, scaled, sub } from "../tools/vectors.js";
import { beamOf } from "./beam.js";
import { bentBeam } from "./glass.js";

/** Shortest way from a lamp to a pixel that it stands on, mm. */
const SHORTEST = 1e-12;

/**
 * Linear light (1 = white) to a display value: IEC 61966-2-1, or the same number; never clipped.
 * @param {number} x
 * @param {"srgb" | "linear"} transfer
 */
export function encode(x, transfer) {
  if (transfer === "linear") return x;
  return x <= 0.0031308 ? x * 12.92 : 1.055 * x ** (1 / 2.4) - 0.055;
}

/** Display value to linear light: the inverse of `encode`. */
export function decode(x, transfer) {
  if (transfer === "linear") return x;
  return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
}

/**
 * Strength of a shadow so far behind the cube: 1 up to `reach`, then exp(-(distance - reach) / falloff).
 * @param {number} distance mm
 * @param {number} reach mm
 * @param {number} falloff mm; 0 = the shadow ends at its reach
 */
export function fading(distance, reach, falloff) {
  const beyond = Math.max(distance - reach, 0);
  if (falloff === 0) return beyond > 0 ? 0 : 1;
  return Math.exp(-beyond / falloff);
}

/**
 * Light g and strength of the shadow a at a pixel: of a lamp of power 1 it shows g (1 - a (1 - T)).
 *
 * With u the unit direction of the beam through the pixel at q, n the screen's normal and l the place of a point lamp:
 * g = (full_at / |q - l|)^2 |u.n|, each factor only where it is asked for; a fades with u.q beyond each reach.
 * @param {object} view of an exposure
 * @param {number[]} pixel mm, in the cube's axes
 * @returns {{light: number, shadow: number}}
 */
function fallingLight(view, pixel) {
  const point = view.light[3] !== 0;
  const way = point ? sub(pixel, view.light) : view.light.slice(0, 3);
  const length = Math.max(norm(way), SHORTEST);
  const ahead = scaled(way, 1 / length);
  let light = 1;
  if (view.cosine) {
    const normal = cross(view.right, view.down);
    light *= Math.abs(dot(ahead, normal)) / norm(normal);
  }
  if (point && view.full_at_mm < Infinity) light *= (view.full_at_mm / length) ** 2;
  const travelled = dot(ahead, pixel);
  const [lamp, screen] = [0, 1].map((end) => fading(travelled, view.reach_mm[end], view.falloff_mm[end]));
  const shadow = lamp * screen;
  return { light, shadow };
}

/**
 * The beam that lights a place of the raster, as `beamOf` has it, inside the glass where there is some; and its light,
 * with the veil over it, which has no shadow.
 * @param {object} view of an exposure
 * @param {number} row whole in the middle of a pixel
 * @param {number} column
 * @param {number[]} raster [rows, columns] of the exposure
 * @returns {{start: number[], way: number[], first: number, last: number, light: number, shadow: number}}
 */
export function litBeam(view, row, column, raster) {
  const lit = unveiledBeam(view, row, column, raster);
  const light = lit.light + view.veil;
  return { ...lit, light, shadow: light > 0 ? lit.light * lit.shadow / light : lit.shadow };
}

function unveiledBeam(view, row, column, raster) {
  const beam = beamOf(view, row, column, raster);
  const { light, shadow } = fallingLight(view, beam.pixel);
  if (!view.glass) return { ...beam, light, shadow };
  const { beside, through, enters, leaves } = bentBeam(view, beam.pixel);
  const inside = sub(leaves, enters);
  const long = norm(inside);
  const whole = beside + through;
  if (long === 0) return { ...beam, first: 0, last: 0, light: light * whole, shadow: 0 };
  const part = shadow * through / whole;
  return { start: enters, way: scaled(inside, 1 / long), first: 0, last: long, light: light * whole, shadow: part };
}
