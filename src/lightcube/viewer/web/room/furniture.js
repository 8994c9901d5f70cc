// What stands in the room besides pictures, and its colours: the same for both renderers. Lengths are mm, in the room.

import { standing } from "../model/stage.js";
import { add, apply, applyInverse, cross, dot, norm, scaled, sub, unit } from "../tools/vectors.js";
import { bentWay, bodyEdges, isCutRound } from "./clearbody.js";

/** Linear light of the room and of what stands in it. */
export const TONES = {
  dark: {
    floor: [0.05, 0.052, 0.058],
    far: [0.009, 0.0095, 0.0115],
    grid: [0.1, 0.103, 0.11],
    table: [0.16, 0.16, 0.165],
    rim: [0.5, 0.5, 0.5],
    wall: [0.022, 0.023, 0.026],
    back: [0.03, 0.03, 0.032],
    off: [0.12, 0.12, 0.13],
    body: [0.62, 0.42, 0.25],
    edge: [0.75, 0.86, 1.0],
    hint: [0.9, 0.92, 1.0],
    mark: [0.55, 0.9, 1.0],
    shade: 0.6,
    glow: 0.5,
    ember: 0.5,
  },
  light: {
    floor: [0.4, 0.4, 0.395],
    far: [0.24, 0.245, 0.255],
    grid: [0.3, 0.302, 0.305],
    table: [0.55, 0.55, 0.545],
    rim: [0.2, 0.205, 0.215],
    wall: [0.2, 0.2, 0.205],
    back: [0.16, 0.163, 0.17],
    off: [0.24, 0.245, 0.26],
    body: [0.72, 0.47, 0.27],
    edge: [0.9, 0.95, 1.0],
    hint: [0.95, 0.95, 1.0],
    mark: [0.0, 0.25, 0.75],
    shade: 0.45,
    glow: 0.4,
    ember: 0.7,
  },
};

/**
 * What is marked.
 * @typedef {object} Mark
 * @property {number} screen by its place among the exposures
 * @property {number | null} row
 * @property {number | null} column
 * @property {boolean} [beam] the way of the light to that pixel instead of the row
 * @property {number[][] | null} [frame] a box of voxels, [first [x, y, z], after the last]
 */

/** Angles that stand for all that the table comes to, degrees. */
const AROUND = Array.from({ length: 12 }, (_, i) => 30 * i);
/** A lamp so many times as far from the cube as anything else need not be seen. */
const FAR = 3;
/** A lamp's radius, in widths of the cube. */
const LAMP_RADIUS = 0.036;
/** Width of a frame, in widths of the cube, and of a wall around a picture, in widths of that. */
const [FRAME, WALL] = [0.014, 0.85];
/** With more lamps than this, lines to the corners of all pictures would hide the room. */
const MOST_HINTED = 6;
/** Beams that glass bends are drawn at these parts of a picture's sides, on so many screens at most, a marked one's in so many colours. */
const [BENT_AT, MOST_BENT, MOST_COLOURS] = [[0.12, 0.37, 0.63, 0.88], 3, 3];

/** Half the cube's sides along x, y, z. */
export function halfSides({ voxels }) {
  return [...voxels.shape].reverse().map((count) => (count * voxels.voxel_mm) / 2);
}

/** The cube's longest side. */
export function longestSide({ voxels }) {
  return Math.max(...voxels.shape) * voxels.voxel_mm;
}

/** Radius that lamps are drawn with. */
export function lampRadius(scene) {
  return LAMP_RADIUS * longestSide(scene);
}

/** How far a wall goes on beyond its picture; a screen with edges has a frame. */
export function wallWidth(scene, { right, pixels }) {
  return scene.whole_shadow === null ? FRAME * longestSide(scene) : WALL * norm(right) * Math.max(...pixels);
}

/** The colour of light, its brightest part 1; null of no light. */
export function pureColour(light) {
  const most = Math.max(...light);
  return most > 0 ? scaled(light, 1 / most) : null;
}

/** A room's screens with their numbers, the one that is farthest from the eye first. */
export function fromFar(room, eye) {
  const away = (screen) => norm(sub(scaled(screenCorners(screen).reduce(add), 1 / 4), eye));
  return room.screens
    .map((screen, number) => ({ ...screen, number }))
    .sort((one, other) => away(other) - away(one));
}

/** The cube's eight corners; those whose numbers differ in one bit share an edge. */
export function cubeCorners(scene, room) {
  const half = halfSides(scene);
  return cornersOf(scaled(half, -1), half).map((corner) => apply(room.turn, corner));
}

/** A screen's corners, in order around it from the upper left. */
export function screenCorners({ corner, right, down, pixels }) {
  const [across, below] = [scaled(right, pixels[1]), scaled(down, pixels[0])];
  return [corner, add(corner, across), add(add(corner, across), below), add(corner, below)];
}

/** The table's disc: its middle, and two radii of it that turn with the cube. */
export function tableOf(scene, room) {
  const { axis, turn } = room;
  const corners = cubeCorners(scene, room);
  const along = corners.map((corner) => dot(corner, axis));
  const radius = 1.12 * Math.max(...corners.map((corner, i) => norm(sub(corner, scaled(axis, along[i])))));
  const aside = Math.abs(axis[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0];
  const start = apply(turn, unit(sub(aside, scaled(axis, dot(aside, axis)))));
  return {
    middle: scaled(axis, Math.min(...along) - 0.03 * radius),
    right: scaled(start, radius),
    down: scaled(cross(start, axis), radius),
  };
}

/** Points between which everything lies, but lamps that stand far from all else. */
export function extentOf(scene, room) {
  const { middle, right, down } = tableOf(scene, room);
  const disc = Array.from({ length: 24 }, (_, i) => (i * Math.PI) / 12).map((turn) =>
    add(middle, add(scaled(right, Math.cos(turn)), scaled(down, Math.sin(turn)))),
  );
  const points = [...cubeCorners(scene, room), ...disc, ...room.screens.flatMap(screenCorners)];
  const far = FAR * Math.max(...points.map(norm));
  const around = 0.1 * longestSide(scene);
  for (const { place } of room.lamps) {
    if (norm(place) >= far) continue;
    for (let axis = 0; axis < 3; axis++) {
      const aside = [0, 1, 2].map((i) => (i === axis ? around : 0));
      points.push(add(place, aside), sub(place, aside));
    }
  }
  return points;
}

/** Rooms that stand for all that the table comes to. */
export function roomsAround(scene, whole = false) {
  return AROUND.map((angle) => standing(scene, angle, whole));
}

/**
 * Height of the floor below everything, at all angles.
 * @param {object} scene
 * @returns {(room: object) => number} for the pictures' windows, and lower where a room has the whole shadow
 */
export function floorOf(scene) {
  const [narrow, whole] = [false, true].map((all) => {
    const heights = roomsAround(scene, all).flatMap((room) => extentOf(scene, room).map((point) => point[2]));
    return Math.min(...heights) - 0.02 * longestSide(scene);
  });
  return (room) => (scene.whole_shadow && room.screens[0].pixels.join() === scene.whole_shadow.join() ? whole : narrow);
}

/**
 * Thin lines, the most important first: the marked row, the edges of a cube of glass, the beams' outlines.
 * @param {object} scene
 * @param {object[]} exposures that the room's screens show
 * @param {object} room
 * @param {number[]} eye
 * @param {Mark | null} mark
 * @param {object} tones
 * @returns {{ends: number[][], colour: number[], parts: number[], width: number, over: boolean}[]} `parts` is how
 *   strong a line is at either end, `width` in pixels of the page; `over` lines are seen through the cube as if it
 *   were clear
 */
export function linesOf(scene, exposures, room, eye, mark, tones) {
  return [
    ...(mark && room.screens[mark.screen] ? markLines(scene, exposures, room, mark, tones) : []),
    ...(scene.solid || isCutRound(scene) ? [] : edgeLines(scene, room, eye, tones)),
    ...(scene.glass ? glassLines(scene, exposures, room, tones) : hintLines(scene, exposures, room, tones)),
  ];
}

function edgeLines(scene, room, eye, tones) {
  const [corners, half, inside] = [cubeCorners(scene, room), halfSides(scene), applyInverse(room.turn, eye)];
  return edgesOf(corners).map(([a, b]) => {
    const faces = [0, 1, 2].filter((axis) => 1 << axis !== b - a); // those that meet there
    const before = faces.some((axis) => ((a >> axis) & 1 ? 1 : -1) * inside[axis] > half[axis]);
    const part = before ? 0.75 : 0.16;
    return { ends: [corners[a], corners[b]], colour: tones.edge, parts: [part, part], width: before ? 1.3 : 1, over: true };
  });
}

/** The lamps that light a screen, by their numbers in the room, the brightest first. */
export function lampsLighting(scene, exposure) {
  const numbers = [...new Set(scene.views.map((view) => view.lamp))].sort((a, b) => a - b);
  const light = numbers.map((lamp) =>
    exposure.views.filter((view) => view.lamp === lamp).reduce((sum, view) => sum + Math.max(...view.power), 0),
  );
  return numbers.map((_, i) => i).filter((i) => light[i] > 0).sort((a, b) => light[b] - light[a]);
}

/**
 * The lamp whose eye one takes: the brightest one that lights the first lit screen, and its light there alone.
 * @returns {{screen: object, lamp: object, light: number[]}}
 */
export function lampOfEye(scene, exposures, room) {
  const lit = Math.max(0, exposures.findIndex((exposure) => exposure.lit));
  const number = lampsLighting(scene, exposures[lit])[0] ?? 0;
  const own = [...new Set(scene.views.map((view) => view.lamp))].sort((a, b) => a - b)[number];
  const light = exposures[lit].views.filter((view) => view.lamp === own).map((view) => view.power);
  return { screen: room.screens[lit], lamp: room.lamps[number], light: light.reduce(add, [0, 0, 0]) };
}

function hintLines(scene, exposures, room, tones) {
  const lines = [];
  const addLine = (...ends) => (parts) => lines.push({ ends, colour: tones.hint, parts, width: 1, over: false });
  room.lamps.forEach((lamp) => {
    if (lamp.parallel && Math.max(...lamp.light) > 0) addLine(lamp.place, [0, 0, 0])([0.4, 0.1]);
  });
  exposures.forEach((exposure, i) => {
    const lamps = lampsLighting(scene, exposure).map((number) => room.lamps[number]);
    if (!room.screens[i] || lamps.length > MOST_HINTED) return;
    const part = 0.26 / Math.sqrt(Math.max(lamps.length, 1));
    for (const lamp of lamps) {
      for (const corner of screenCorners(room.screens[i])) {
        addLine(beamStart(lamp, corner), corner)(lamp.parallel ? [0, part] : [part, part]);
      }
    }
  });
  return lines;
}

/** The outline of what bends the light, and some beams that it bends. */
function glassLines(scene, exposures, room, tones) {
  const edges = bodyEdges(scene, exposures[0]).map((ends) => (
    { ends: ends.map((end) => apply(room.turn, end)), colour: tones.edge, parts: [0.5, 0.5], width: 1.1, over: true }
  ));
  const beams = exposures.slice(0, MOST_BENT).flatMap((exposure) => {
    const [rows, columns] = exposure.window;
    const view = exposure.views[Math.floor(exposure.views.length / 2)];
    const places = BENT_AT.flatMap((down) => BENT_AT.map((across) => [down * rows - 0.5, across * columns - 0.5]));
    return places.flatMap(([row, column]) => bentPieces(scene, exposure, room, [view], [row, column], tones.hint, 0.3));
  });
  return [...edges, ...beams];
}

/** The way of the light to a pixel: from the lamp, through the glass, and on, in each view's colour where there are several. */
function bentPieces(scene, exposure, room, views, [row, column], tone, part) {
  const [lamp] = lampsLighting(scene, exposure);
  if (lamp === undefined) return [];
  return views.flatMap((view) => {
    const way = bentWay(view, row, column, exposure.raster);
    if (way === null) return [];
    const [enters, leaves, pixel] = way.map((place) => apply(room.turn, place));
    const colour = views.length > 1 ? pureColour(view.power) ?? tone : tone;
    const piece = (ends, parts) => ({ ends, colour, parts, width: part > 0.5 ? 1.8 : 1, over: true });
    return [
      piece([beamStart(room.lamps[lamp], enters), enters], [0, part]),
      piece([enters, leaves], [part, part]),
      piece([leaves, pixel], [part, part]),
    ];
  });
}

/** Where the light that falls on a point comes from: the lamp, or as far back as parallel light is drawn. */
function beamStart({ place, parallel }, point) {
  if (!parallel) return place;
  const way = scaled(unit(place), -1);
  return sub(point, scaled(way, dot(sub(point, place), way)));
}

/** Both ends of the middle of a row of a screen. */
function rowEnds({ corner, right, down, pixels }, row) {
  const start = add(corner, scaled(down, row + 0.5));
  return [start, add(start, scaled(right, pixels[1]))];
}

/** The marked row with its pixel, or that pixel alone with the beam to it; and the frame around some of the glass. */
function markLines(scene, exposures, room, { screen, row, column, beam, frame }, tones) {
  if (scene.glass && column !== null) {
    const { views } = exposures[screen];
    const drawn = views.length > MOST_COLOURS ? views.slice(0, 1) : views; // of the points of a disc one
    return bentPieces(scene, exposures[screen], room, drawn, [row, column], tones.mark, 0.95);
  }
  const { right, down } = room.screens[screen];
  const line = (ends, over, width = 1.6) => ({ ends, colour: tones.mark, parts: [0.95, 0.95], width, over });
  const lines = frame ? frameEdges(scene, room, frame).map((ends) => line(ends, true)) : [];
  if (row === null) return lines;
  const [start, end] = rowEnds(room.screens[screen], row);
  const middle = column === null ? null : add(start, scaled(right, column + 0.5));
  if (!beam) lines.push(line([start, end], false));
  if (middle !== null) lines.push(line([sub(middle, scaled(down, 2)), add(middle, scaled(down, 2))], false));
  if (!beam) return lines;
  lines.push(line([sub(middle, scaled(right, 2)), add(middle, scaled(right, 2))], false));
  const [lamp] = lampsLighting(scene, exposures[screen]);
  if (lamp !== undefined) lines.push(line([beamStart(room.lamps[lamp], middle), middle], true, 2.2));
  return lines;
}

/** The edges of a box of voxels, [first [x, y, z], after the last]. */
function frameEdges(scene, room, box) {
  const half = halfSides(scene);
  const corners = cornersOf(...box.map((place) => place.map((count, axis) => count * scene.voxels.voxel_mm - half[axis])));
  return edgesOf(corners).map(([a, b]) => [apply(room.turn, corners[a]), apply(room.turn, corners[b])]);
}

/** A box's eight corners; those whose numbers differ in one bit share an edge. */
function cornersOf(low, high) {
  return Array.from({ length: 8 }, (_, i) => [0, 1, 2].map((axis) => ((i >> axis) & 1 ? high : low)[axis]));
}

/** The pairs of corners, by their numbers, between which a box's edges run. */
function edgesOf(corners) {
  return corners.flatMap((_, a) => [1, 2, 4].filter((bit) => !(a & bit)).map((bit) => [a, a | bit]));
}

/**
 * The beams of the marked row under the brightest lamp that lights it.
 * @returns {{kind: number, corner: number[], sides: number[][]} | null} kind 1: a parallelogram that fades along its
 *   second side; 2: a triangle with the lamp in its corner
 */
export function markedSheet(scene, exposures, room, mark) {
  const screen = mark && mark.row !== null && !mark.beam && !scene.glass && room.screens[mark.screen];
  const [lamp] = screen && exposures[mark.screen] ? lampsLighting(scene, exposures[mark.screen]) : [];
  if (lamp === undefined) return null;
  const [start, end] = rowEnds(screen, mark.row);
  const from = beamStart(room.lamps[lamp], start);
  if (room.lamps[lamp].parallel) return { kind: 1, corner: start, sides: [sub(end, start), sub(from, start)] };
  return { kind: 2, corner: from, sides: [sub(start, from), sub(end, from)] };
}
