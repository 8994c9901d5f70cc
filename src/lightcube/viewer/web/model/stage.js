// What stands where at a turntable angle, in the cube's axes (exposures) and in the room's (standing); lengths are mm.

import { add, apply, cross, dot, modulo, norm, rotation, scaled, sub, unit } from "../tools/vectors.js";
import { riseOf } from "./glass.js";

/** Stops nearer to each other than this, in degrees, are one. */
const SAME = 1e-6;

/**
 * The angles at which pictures are wanted.
 * @param {object} scene
 * @returns {number[]} degrees in [0, 360), rising, each once
 */
export function stops(scene) {
  const angles = scene.pictures.map((picture) => modulo(picture.angle_deg, 360)).sort((a, b) => a - b);
  return angles.filter((angle, i) => i === 0 || angle - angles[i - 1] > SAME);
}

/**
 * Number of the picture of a screen whose stop is nearest to an angle.
 * @param {object} scene
 * @param {number} screen
 * @param {number} angle degrees
 * @returns {number} -1 where no picture is wanted on that screen
 */
export function nearestPicture(scene, screen, angle) {
  let [found, least] = [-1, Infinity];
  scene.pictures.forEach((picture, number) => {
    const away = degreesApart(angle, picture.angle_deg);
    if (picture.screen === screen && away < least) [found, least] = [number, away];
  });
  return found;
}

function degreesApart(one, other) {
  return Math.abs(modulo(one - other + 180, 360) - 180);
}

/**
 * The light on every screen at any angle, in the cube's axes.
 *
 * The room is lit as at the stop that is nearest: a screen that no picture is wanted on there is dark. The power of
 * each lamp is linear in ln P between the stops at which it shines on that screen, constant where a stop is held.
 * @param {object} scene
 * @param {number} angle degrees
 * @param {boolean} [whole] a turntable's whole shadow instead of the picture's window
 * @param {number[]} [lamp] what all light is multiplied by, in each colour
 * @returns {object[]} one exposure for each screen that has pictures, rising: {screen, angle, picture, lit, window,
 *   raster, transfer, views}; of each view the power is the lamp's times its share, and 0 where the screen is dark
 */
export function exposures(scene, angle, whole = false, lamp = [1, 1, 1]) {
  const screens = [...new Set(scene.pictures.map((picture) => picture.screen))].sort((a, b) => a - b);
  const full = whole ? scene.whole_shadow : null;
  const nearest = Math.min(...scene.pictures.map((picture) => degreesApart(angle, picture.angle_deg)));
  return screens.map((screen) => {
    const number = nearestPicture(scene, screen, angle);
    const { angle_deg: stop, window } = scene.pictures[number];
    const lit = degreesApart(angle, stop) < nearest + SAME;
    const exposed = viewsOf(scene, number).map((view) => {
      const power = lit ? powerBetween(scene, view.pair, angle) : [0];
      return exposedView(scene, view, angle - stop, lamp.map((part, channel) => part * ofChannel(power, channel)));
    });
    const views = full === null ? exposed : exposed.map((view) => (
      { ...view, origin: middleOfShadow(exposed, view.lamp) }
    ));
    const parts = { window: full ?? window, raster: full ?? scene.raster, transfer: scene.transfer, views };
    return { screen, angle, picture: number, lit, ...parts };
  });
}

function viewsOf(scene, picture) {
  return scene.views.filter((view) => view.picture === picture);
}

function exposedView(scene, view, degrees, power) {
  const [lampTurn, screenTurn] = turnsOf(scene, view, degrees);
  const light = [...apply(lampTurn, view.light), view.light[3]];
  const [origin, right, down] = [view.origin, view.right, view.down].map((vector) => apply(screenTurn, vector));
  return {
    light,
    origin,
    right,
    down,
    power: power.map((each, channel) => ofChannel(view.share, channel) * each),
    reach_mm: view.reach_mm.map(orInfinite),
    falloff_mm: view.falloff_mm.map(orInfinite),
    full_at_mm: orInfinite(view.full_at_mm),
    cosine: view.cosine,
    veil: view.veil,
    lamp: view.lamp,
    glass: glassOf(scene, view.ior),
  };
}

/** The clear body that a view's light meets, or null. */
function glassOf({ glass }, ior) {
  return glass ? { ...glass, half: glass.half.map(orInfinite), ior } : null;
}

/** How the lamp, and the screen, have gone round the cube when the table has turned on by so many degrees. */
function turnsOf(scene, view, degrees) {
  return [0, 1].map((i) => rotation(scene.axis, view.turning[i] ? view.way[i] * degrees : 0));
}

/** Where the light from the middle of a parallel lamp's disc through the cube's middle meets the plane of its views. */
export function middleOfShadow(views, lamp) {
  const own = views.filter((view) => view.lamp === lamp); // the samples of its disc
  const light = meanOf(own.map((view) => view.light));
  const { origin, right, down, glass } = own[0];
  const normal = cross(right, down);
  const start = [0, 0, glass ? riseOf(glass, unit(light)) : 0]; // of straight light that lands there
  return add(start, scaled(light, dot(sub(origin, start), normal) / dot(light, normal)));
}

function ofChannel(values, channel) {
  return values[values.length === 1 ? 0 : channel];
}

function orInfinite(value) {
  return value ?? Infinity;
}

/** Power of the lamp of a pair, by channel, at an angle between the stops of its screen. */
function powerBetween(scene, pair, angle) {
  const { lamp, picture } = scene.pairs[pair];
  const { screen } = scene.pictures[picture];
  const alike = scene.pairs.filter((each) => each.lamp === lamp && scene.pictures[each.picture].screen === screen);
  const angles = alike.map((each) => scene.pictures[each.picture].angle_deg);
  // just short of the middle between two stops, so that the ends of their holds keep their order
  const hold = Math.min(scene.hold_deg, smallestGap(angles) / 2 - 1e-6);
  const offsets = hold > 0 ? [-hold, hold] : [0];
  const marks = offsets.flatMap((offset) =>
    alike.map((each, i) => ({ at: modulo(angles[i] + offset, 360), logs: each.power.map(Math.log) })),
  );
  return interpolated(marks.sort((one, other) => one.at - other.at), modulo(angle, 360)).map(Math.exp);
}

/** Degrees between the two nearest of the angles that differ, round the circle. */
function smallestGap(angles) {
  const found = angles.map((angle) => modulo(Math.round(modulo(angle, 360) * 1e9) / 1e9, 360));
  const sorted = [...new Set(found)].sort((a, b) => a - b);
  return Math.min(...sorted.map((angle, i) => (i + 1 < sorted.length ? sorted[i + 1] : sorted[0] + 360) - angle));
}

/** Linear between marks in rising order, which repeat after 360 degrees. */
function interpolated(marks, angle) {
  const last = marks[marks.length - 1];
  const laps = [{ at: last.at - 360, logs: last.logs }, ...marks, { at: marks[0].at + 360, logs: marks[0].logs }];
  const next = laps.findIndex((mark) => mark.at > angle);
  const [before, after] = [laps[next - 1], laps[next]];
  const part = (angle - before.at) / (after.at - before.at);
  return before.logs.map((log, channel) => log + part * (after.logs[channel] - log));
}

/**
 * Where the cube, the screens and the lamps stand at an angle, in the room's axes: the cube's at angle 0.
 * @param {object} scene
 * @param {number} angle degrees
 * @param {boolean} [whole] as for `exposures`
 * @param {number[]} [lamp] too
 * @returns {{turn: number[], axis: number[], screens: object[], lamps: object[]}} `turn` leads from the cube's axes to
 *   the room's; parallel lamps are suns on the lines of their light, clear of the cube
 */
export function standing(scene, angle, whole = false, lamp = [1, 1, 1]) {
  const shown = exposures(scene, angle, whole, lamp);
  const turn = rotation(scene.axis, scene.carried ? angle : 0);
  const screens = shown.map((exposure) => placedScreen(turn, exposure));
  const away = sunsAway(scene, screens);
  const lamps = [...new Set(scene.views.map((view) => view.lamp))].sort((a, b) => a - b);
  return {
    turn,
    axis: unit(scaled(scene.axis, scene.axis[2] >= 0 ? 1 : -1)),
    screens,
    lamps: lamps.map((lamp) => {
      const { place, parallel } = lampPlace(scene, lamp, angle);
      const stood = apply(turn, place);
      const light = shown
        .flatMap((exposure) => exposure.views)
        .filter((view) => view.lamp === lamp)
        .reduce((total, view) => add(total, view.power), [0, 0, 0]);
      return { place: parallel ? scaled(unit(stood), -away) : stood, parallel, light };
    }),
  };
}

function placedScreen(turn, { views, raster, window }) {
  const middle = meanOf(views.map((view) => view.origin)); // of a pixel's samples
  const { right, down } = views[0];
  const corner = sub(sub(middle, scaled(right, raster[1] / 2)), scaled(down, raster[0] / 2));
  const [inRoom, across, below] = [corner, right, down].map((vector) => apply(turn, vector));
  return { corner: inRoom, right: across, down: below, pixels: window, facing: unit(cross(below, across)) };
}

/** Where a lamp stands, or the way its light travels, in the cube's axes, lit or not. */
function lampPlace(scene, lamp, angle) {
  const { picture } = scene.views.find((view) => view.lamp === lamp);
  const own = viewsOf(scene, picture).filter((view) => view.lamp === lamp); // the samples of its disc
  const degrees = angle - scene.pictures[picture].angle_deg;
  const places = own.map((view) => apply(turnsOf(scene, view, degrees)[0], view.light));
  return { place: meanOf(places), parallel: own[0].light[3] === 0 };
}

/** How far from the cube suns are drawn, mm: clear of it, and not much nearer than the screens. */
function sunsAway({ voxels }, screens) {
  const middles = screens.map(({ corner, right, down, pixels }) =>
    norm(add(corner, add(scaled(right, pixels[1] / 2), scaled(down, pixels[0] / 2)))),
  );
  return Math.max((1.45 * norm(voxels.shape) * voxels.voxel_mm) / 2, 0.6 * Math.max(...middles));
}

function meanOf(vectors) {
  return scaled(vectors.reduce(add, [0, 0, 0]), 1 / vectors.length);
}
