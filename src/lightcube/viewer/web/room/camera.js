// A camera on an orbit round the cube, and what its rays meet; lengths are mm, in the room.

import { add, cross, dot, modulo, norm, scaled, sub, unit } from "../tools/vectors.js";
import { extentOf, lampOfEye, screenCorners } from "./furniture.js";

/** Heights of the eye above its target's level, degrees: above the floor, and with an upright picture. */
export const LOWEST = 2;
export const HIGHEST = 88;
/** Width by height of the picture whose width spans the orbit's field. */
const ASPECT = 16 / 9;
/** Part of the picture that stays free at each edge. */
const MARGIN = 0.05;

/** From the lamp a picture fills so much of the sight, and what is far away is seen under so many degrees. */
const [LAMPS_SIGHT, FAR_FIELD] = [0.72, 0.8];

const RADIANS = Math.PI / 180;

/** The same of an eye that is where a lamp is, which may be anywhere. */
const OF_LAMPS = [-89.9, 89.9];

/**
 * The orbit that a described camera is on.
 * @param {{eye: number[], target: number[], field_deg: number}} described
 * @param {number[]} [bounds] of the eye's height, degrees
 * @returns {{azimuth: number, height: number, distance: number, target: number[], field_deg: number, bounds: number[]}}
 *   angles in degrees
 */
export function orbitFrom({ eye, target, field_deg }, bounds = [LOWEST, HIGHEST]) {
  const way = sub(eye, target);
  const distance = norm(way);
  const azimuth = Math.atan2(way[1], way[0]) / RADIANS;
  return limited({ azimuth, height: Math.asin(way[2] / distance) / RADIANS, distance, target, field_deg, bounds });
}

/** The orbit with its height within bounds: the eye stays above the floor, and up is up in its picture. */
function limited(orbit) {
  const [lowest, highest] = orbit.bounds;
  return { ...orbit, height: Math.min(Math.max(orbit.height, lowest), highest) };
}

/** Where the eye is. */
export function eyeOf(orbit) {
  return add(orbit.target, scaled(fromTarget(orbit), orbit.distance));
}

function fromTarget(orbit) {
  const [azimuth, height] = [orbit.azimuth * RADIANS, limited(orbit).height * RADIANS];
  return [Math.cos(height) * Math.cos(azimuth), Math.cos(height) * Math.sin(azimuth), Math.sin(height)];
}

/**
 * The camera of an orbit. The orbit's field is what the width of a 16:9 picture spans; a narrower one spans less in
 * width and more in height, so that neither is distorted.
 * @param {object} orbit
 * @param {number} aspect width by height of the picture
 * @returns {{eye: number[], right: number[], up: number[], ahead: number[], across: number, tall: number}} unit
 *   vectors, and the tangents of half the angles that its width and height span
 */
export function cameraOf(orbit, aspect) {
  const ahead = scaled(fromTarget(orbit), -1);
  const right = unit(cross(ahead, [0, 0, 1]));
  const across = Math.tan((orbit.field_deg / 2) * RADIANS) * Math.sqrt(aspect / ASPECT);
  return { eye: eyeOf(orbit), right, up: cross(right, ahead), ahead, across, tall: across / aspect };
}

/**
 * The orbit moved along its own direction and aside until rooms fill the picture; it turns about what is ahead of the
 * eye, nearest to the cube's middle.
 *
 * To see p to the right of it, an eye at e needs p.r - s p.f <= e.r - s e.f, with r to the right, f ahead, and s the
 * tangent of half the width; and so on. Where there is more room than needed, all is in its middle.
 * @param {object} orbit
 * @param {object} scene
 * @param {object[]} rooms all that is to be seen
 * @param {number} aspect width by height
 * @param {number} [head] the part of the height that stays free above
 */
export function fitted(orbit, scene, rooms, aspect, head = 0) {
  const { right, up, ahead, across, tall } = cameraOf(orbit, aspect);
  const points = rooms.flatMap((room) => extentOf(scene, room));
  const bounds = [[right, across, 0], [up, tall, head]].map(([axis, half, more]) => {
    const [above, below] = [1 - 2 * MARGIN - 2 * more, 1 - 2 * MARGIN].map((part) => half * part);
    const most = Math.max(...points.map((point) => dot(point, axis) - above * dot(point, ahead)));
    const least = Math.max(...points.map((point) => -dot(point, axis) - below * dot(point, ahead)));
    return { axis, above, below, most, least };
  });
  const depth = Math.min(...bounds.map(({ above, below, most, least }) => -(most + least) / (above + below)));
  const eye = bounds.map(({ axis, above, below, most, least }) =>
    scaled(axis, (most - least + (above - below) * depth) / 2)).reduce(add);
  return { ...orbit, target: eye, distance: -depth };
}

/**
 * The orbit of an eye where the brightest lamp is: the picture that it throws on the first lit screen fills its sight.
 * @param {object} scene
 * @param {object[]} exposures that the room's screens show
 * @param {object} room
 */
export function lampsOrbit(scene, exposures, room) {
  const { screen, lamp } = lampOfEye(scene, exposures, room);
  const middle = scaled(screenCorners(screen).reduce(add), 1 / 4);
  const high = Math.max(norm(screen.down) * screen.pixels[0], norm(screen.right) * screen.pixels[1]);
  if (!lamp.parallel) {
    const half = (high * ASPECT) / (2 * LAMPS_SIGHT * norm(sub(lamp.place, middle)));
    return orbitFrom({ eye: lamp.place, target: middle, field_deg: (2 * Math.atan(half)) / RADIANS }, OF_LAMPS);
  }
  const distance = (high * ASPECT) / (2 * LAMPS_SIGHT * Math.tan((FAR_FIELD / 2) * RADIANS));
  const ahead = unit(scaled(lamp.place, -1));
  const target = sub(middle, scaled(ahead, dot(middle, ahead))); // where its light passes the cube's middle
  return orbitFrom({ eye: sub(target, scaled(ahead, distance)), target, field_deg: FAR_FIELD }, OF_LAMPS);
}

/** An orbit between two, the way that is shorter round the cube; what is seen of the target grows evenly. */
export function between(one, other, part) {
  const mixed = (a, b) => a + (b - a) * part;
  const sight = ({ distance, field_deg }) => Math.log(distance * Math.tan((field_deg / 2) * RADIANS));
  const field_deg = mixed(one.field_deg, other.field_deg);
  return {
    azimuth: one.azimuth + (modulo(other.azimuth - one.azimuth + 180, 360) - 180) * part,
    height: mixed(one.height, other.height),
    distance: Math.exp(mixed(sight(one), sight(other))) / Math.tan((field_deg / 2) * RADIANS),
    target: one.target.map((each, axis) => mixed(each, other.target[axis])),
    field_deg,
    bounds: other.bounds,
  };
}

/**
 * The ray through a place of the picture.
 * @param {object} camera
 * @param {number} x 0..1 from the left
 * @param {number} y 0..1 from the top
 * @returns {{start: number[], way: number[]}} `way` has length 1
 */
export function rayAt({ eye, right, up, ahead, across, tall }, x, y) {
  const aside = add(scaled(right, across * (2 * x - 1)), scaled(up, tall * (1 - 2 * y)));
  return { start: eye, way: unit(add(ahead, aside)) };
}

/**
 * Where a point is seen: the inverse of `rayAt`.
 * @returns {{x: number, y: number, depth: number}} depth in mm along the camera's axis; x and y mean nothing where it
 *   is not above 0
 */
export function seenAt({ eye, right, up, ahead, across, tall }, point) {
  const way = sub(point, eye);
  const depth = dot(way, ahead);
  return { x: 0.5 + dot(way, right) / (2 * across * depth), y: 0.5 - dot(way, up) / (2 * tall * depth), depth };
}

/**
 * The part of a line that lies before the eye.
 * @param {object} camera
 * @param {number[][]} ends
 * @param {number} near least depth
 * @returns {number[][] | null}
 */
export function beforeEye({ eye, ahead }, [start, end], near) {
  const depths = [start, end].map((point) => dot(sub(point, eye), ahead));
  if (Math.max(...depths) <= near) return null;
  const crossing = () => add(start, scaled(sub(end, start), (near - depths[0]) / (depths[1] - depths[0])));
  return [depths[0] > near ? start : crossing(), depths[1] > near ? end : crossing()];
}

/** Where the middle of a pixel is. */
export function middleOfPixel(room, { screen, row, column }) {
  const { corner, right, down } = room.screens[screen];
  return add(corner, add(scaled(right, column + 0.5), scaled(down, row + 0.5)));
}

/**
 * The pixel of a screen's lit side that a ray meets.
 * @param {object} room
 * @param {{start: number[], way: number[]}} ray
 * @returns {{screen: number, row: number, column: number} | null} null too where another screen's back is nearer
 */
export function pointed(room, { start, way }) {
  let [found, nearest] = [null, Infinity];
  room.screens.forEach(({ corner, right, down, pixels, facing }, screen) => {
    const distance = dot(sub(corner, start), facing) / dot(way, facing);
    if (!(distance > 0 && distance < nearest)) return;
    const place = sub(add(start, scaled(way, distance)), corner);
    const [row, column] = [down, right].map((step) => Math.floor(dot(place, step) / dot(step, step)));
    if (row < 0 || column < 0 || row >= pixels[0] || column >= pixels[1]) return;
    nearest = distance;
    found = dot(way, facing) < 0 ? { screen, row, column } : null;
  });
  return found;
}
