// Where light goes in a clear body, and how bright it is: the laws of W. Snellius and A. Fresnel, in closed form.

import { add, cross, dot, norm, scaled, sub, unit } from "../tools/vectors.js";

/** A direction's part below this is zero. */
const NONE = 1e-12;
/** Roots are found to this, as a part of the radius; Newton's steps halve no interval more often. */
const [EXACT, MOST_STEPS] = [1e-14, 60];
/** Nearer to the axis than this, as a part of the radius, things are as on it. */
const AXIS = 1e-9;

/**
 * The piece of a pixel's beam inside the glass, and its light, of a lamp of power 1: past the glass, and through it.
 *
 * The lamp's light is parallel. What is thrown back inside and comes out elsewhere is left out.
 * @param {object} view of an exposure: `light`, `right`, `down`, and `glass` {form, half (mm), blocked, ior}
 * @param {number[]} pixel mm, in the cube's axes
 * @returns {{beside: number, through: number, enters: number[], leaves: number[]}} places in mm, the pixel's own where
 *   no light comes through
 */
export function bentBeam({ light, right, down, glass }, pixel) {
  const way = unit(light.slice(0, 3));
  if (glass.form === "block") return throughBlock(pixel, way, glass);
  if (glass.form === "bath") return throughBath(pixel, way, glass);
  const normal = unit(cross(right, down));
  return glass.form === "sphere" ? throughSphere(pixel, way, glass, normal) : throughCylinder(pixel, way, glass, normal);
}

/** How much higher than straight light that through the middle leaves, mm: of what stands upright and has no corners. */
export function riseOf({ form, half, ior }, way) {
  if (form === "block" || form === "sphere") return 0;
  return half[0] * -way[2] * (1 / Math.hypot(way[0], way[1]) - 1 / Math.sqrt(ior ** 2 - way[2] ** 2));
}

/** The part of unpolarised light that passes two faces, aslant by the angle of this cosine outside both. */
function letThrough(cosine, ior) {
  const inside = Math.sqrt(1 - (1 - cosine ** 2) / ior ** 2);
  const across = (cosine - ior * inside) / (cosine + ior * inside);
  const along = (inside - ior * cosine) / (inside + ior * cosine);
  return ((1 - across ** 2) ** 2 + (1 - along ** 2) ** 2) / 2;
}

function unlit(pixel, beside) {
  return { beside, through: 0, enters: pixel, leaves: pixel };
}

function throughBlock(pixel, way, { half, blocked, ior }) {
  if (!meetsBlock(pixel, way, half)) return unlit(pixel, 1);
  for (let face = 0; face < 3; face++) {
    if (Math.abs(way[face]) < NONE || (face === 2 && blocked)) continue;
    const side = Math.sign(way[face]) * half[face];
    const straight = Math.sqrt(ior ** 2 - (1 - way[face] ** 2)); // the part along the face's normal, times n
    const leaves = add(pixel, scaled(way, (side - pixel[face]) / way[face]));
    const enters = sub(leaves, scaled(way, (2 * half[face]) / straight));
    enters[face] = -side;
    const inside = (place, axis) => axis === face || Math.abs(place[axis]) < half[axis];
    if ([0, 1, 2].every((axis) => inside(leaves, axis) && inside(enters, axis))) {
      return { beside: 0, through: letThrough(Math.abs(way[face]), ior), enters, leaves };
    }
  }
  return unlit(pixel, 0);
}

/** Whether straight light through a pixel meets a block. */
function meetsBlock(pixel, way, half) {
  let [first, last] = [-Infinity, Infinity];
  for (let axis = 0; axis < 3; axis++) {
    if (Math.abs(way[axis]) < NONE) {
      if (Math.abs(pixel[axis]) >= half[axis]) return false;
      continue;
    }
    const ends = [-1, 1].map((side) => (side * half[axis] - pixel[axis]) / way[axis]);
    [first, last] = [Math.max(first, Math.min(...ends)), Math.min(last, Math.max(...ends))];
  }
  return first < last;
}

/** Of a bath whose faces stand square to the level light. */
function throughBath(pixel, way, { half, ior }) {
  const level = Math.hypot(way[0], way[1]);
  const ahead = [way[0] / level, way[1] / level, 0];
  const leaves = add(pixel, scaled(way, (half[0] - dot(pixel, ahead)) / level));
  const inside = [ahead[0], ahead[1], way[2] / Math.sqrt(ior ** 2 - way[2] ** 2)];
  return { beside: 0, through: letThrough(level, ior), enters: sub(leaves, scaled(inside, 2 * half[0])), leaves };
}

/**
 * Of a beam that meets a disc of radius 1 so far off the axis: where it lands on a line so far `away` from the middle,
 * beyond the axis, how fast that grows, and sine and cosine of the angles that it is turned by and leaves at.
 */
function landing(beta, ior, away) {
  const [cosI, sinR] = [Math.sqrt(Math.max(1 - beta ** 2, 0)), beta / ior];
  const cosR = Math.sqrt(1 - sinR ** 2);
  const [sin, cos] = [beta * cosR - cosI * sinR, cosI * cosR + beta * sinR]; // of half the turn
  const [sinTurn, cosTurn] = [2 * sin * cos, 1 - 2 * sin ** 2];
  const [sinOut, cosOut] = [sinR * cos - cosR * sin, cosR * cos + sinR * sin]; // of 2 r - i = r - (i - r)
  const [tangent, reach] = [sinTurn / cosTurn, away - cosOut];
  const [di, dr] = [1 / Math.max(cosI, 1e-150), 1 / (ior * cosR)];
  const off = (2 * dr - di) * (tangent * sinOut - cosOut);
  const growth = 2 * (di - dr) * (1 + tangent ** 2) * reach + off;
  return { place: tangent * reach - sinOut, growth, sinTurn, cosTurn, sinOut, cosOut };
}

/** How far off the axis the beam meets the disc that lands at a place beyond the focus; below 0 where none does. */
function meeting(place, ior, away) {
  const quarter = Math.sqrt(0.5);
  const strong = ior > Math.SQRT2; // some beam is turned by a right angle
  let [low, high] = [0, strong ? Math.min((ior * quarter) / Math.hypot(quarter, ior - quarter), 1) : 1];
  if (!strong && landing(high, ior, away).place <= place) return -1;
  let beta = Math.min(place / (away * 2 * (1 - 1 / ior) - 1), 0.9 * high);
  for (let i = 0; i < MOST_STEPS; i++) {
    const found = landing(beta, ior, away);
    if (found.place > place) high = beta;
    else low = beta;
    const step = beta - (found.place - place) / found.growth;
    if (Math.abs(step - beta) < EXACT) return step;
    beta = step > low && step < high ? step : (low + high) / 2;
  }
  return beta;
}

function throughCylinder(pixel, way, { half: [radius, , high], ior }, normal) {
  const level = Math.hypot(way[0], way[1]);
  const ahead = [way[0] / level, way[1] / level, 0];
  const aheadLeft = [-ahead[1], ahead[0], 0];
  const [away, aside] = [dot(pixel, ahead) / radius, dot(pixel, aheadLeft) / radius];
  const slope = way[2] / level;
  const beside = pastCylinder(pixel[2] / radius, slope, away, aside, high / radius);
  const index = Math.sqrt(ior ** 2 - way[2] ** 2) / level;
  const beta = meeting(Math.abs(aside), index, away);
  if (beta < 0) return unlit(pixel, beside);
  const { growth, sinTurn, cosTurn, sinOut, cosOut } = landing(beta, index, away);
  const side = aside > 0 ? -1 : 1; // of the axis, that the beam enters on
  const root = Math.sqrt(1 - beta ** 2);
  const place = (along, left, z) => add(add(scaled(ahead, radius * along), scaled(aheadLeft, radius * left)), [0, 0, z]);
  const leavesZ = pixel[2] - (slope * radius * (away - cosOut)) / cosTurn;
  const long = 2 * radius * Math.sqrt(1 - (beta / index) ** 2);
  const entersZ = leavesZ - (long * way[2]) / Math.sqrt(ior ** 2 - way[2] ** 2);
  if (Math.abs(leavesZ) >= high || Math.abs(entersZ) >= high) return unlit(pixel, beside);
  const out = add(scaled(add(scaled(ahead, cosTurn), scaled(aheadLeft, -side * sinTurn)), level), [0, 0, way[2]]);
  const through = (letThrough(level * root, ior) / (growth * cosTurn)) * slanted(out, way, normal);
  return { beside, through, enters: place(-root, side * beta, entersZ), leaves: place(cosOut, side * sinOut, leavesZ) };
}

/** Straight light that reaches a pixel past a cylinder, over or under it; all in its radii. */
function pastCylinder(z, slope, away, aside, high) {
  if (Math.abs(aside) >= 1) return 1;
  const chord = Math.sqrt(1 - aside ** 2);
  const [one, other] = [z - slope * (away + chord), z - slope * (away - chord)];
  return Math.min(one, other) > high || Math.max(one, other) < -high ? 1 : 0;
}

/** How much more light falls on a screen by the way out than by the lamp's. */
function slanted(out, way, normal) {
  return Math.abs(dot(out, normal)) / Math.abs(dot(way, normal));
}

function throughSphere(pixel, way, { half: [radius], ior }, normal) {
  const away = dot(pixel, way) / radius;
  const off = sub(scaled(pixel, 1 / radius), scaled(way, away));
  const aside = norm(off);
  const left = aside > 0 ? scaled(off, 1 / aside) : off;
  const beside = aside >= 1 ? 1 : 0;
  const beta = meeting(aside, ior, away);
  if (beta < 0) return unlit(pixel, beside);
  const { growth, sinTurn, cosTurn, sinOut, cosOut } = landing(beta, ior, away);
  const root = Math.sqrt(1 - beta ** 2);
  const place = (along, across) => add(scaled(way, radius * along), scaled(left, radius * across));
  const wider = aside < AXIS ? growth : aside / beta;
  const out = add(scaled(way, cosTurn), scaled(left, sinTurn));
  const through = (letThrough(root, ior) / (wider * growth * cosTurn)) * slanted(out, way, normal);
  return { beside, through, enters: place(-root, -beta), leaves: place(cosOut, -sinOut) };
}
