// A lesson in steps: how much of the glass there is, under which light, which beam is meant, and the words for it.

import { JUDGED, QUICK, inOneSlice, pointsOf } from "./area.js";
import { beamOf, walk } from "./beam.js";
import { castPixel, transmittance } from "./cast.js";
import { exposures, stops } from "./stage.js";
import { add, cross, dot, scaled, sub } from "../tools/vectors.js";

/** A cube is so many small pieces long: as small as one still sees from the back of a room. */
const PIECES = 14;
/** Pieces of glass that are looked at for one that two pictures want different things of. */
const TRIED = 240;
/** Turns of a lattice that is spread evenly over a cube: powers of the inverse of the root of x⁴ = x + 1. */
const SPREAD = [0.8191725133961645, 0.6710436067037893, 0.5497004779019703];

/**
 * The cube with all glass outside of a box clear.
 * @param {object} cube
 * @param {number[][]} box first voxels [x, y, z], and the ones after the last
 * @returns {object} of the same shape
 */
export function partOf(cube, [low, high]) {
  const [, ny, nx] = cube.shape;
  const codes = new Uint16Array(cube.codes.length);
  for (let z = low[2]; z < high[2]; z++) {
    for (let y = low[1]; y < high[1]; y++) {
      const [first, last] = [low[0], high[0]].map((x) => 3 * ((z * ny + y) * nx + x));
      codes.set(cube.codes.subarray(first, last), first);
    }
  }
  return { ...cube, codes };
}

/**
 * The steps, from the dark room to the whole.
 * @param {object} scene
 * @param {object} cube
 * @returns {object[]} of each its title and text; `angle` (degrees) and `screen` (its place among the exposures); `lamp`,
 *   what its light is multiplied by in each colour; `box` of the glass that there is, null of all; `mark` as the room
 *   draws it; whether the wall is `nameless`, no picture of the cube's, and whether the table `plays`
 */
export function lessonOf(scene, cube) {
  const sights = sightsOf(scene);
  const [first, size] = [sights[0], Math.ceil(Math.max(...cube.shape) / PIECES)];
  const quarrel = sights.length > 1 ? quarrelOf(cube, sights, size) : null;
  const about = quarrel?.bright ?? { ...first, pixel: first.exposure.window.map((count) => Math.floor(count / 2)) };
  const steps = [
    { ...at(first), title: "The lamp is off", text: "A block of coloured glass, and a wall. There is nothing on it.", lamp: [0, 0, 0], nameless: true },
    { ...at(first), title: "The lamp is on", text: `Its light falls through the glass, and the shadow is a picture: ${nameOf(scene, first)}.` },
    pieceStep(cube, first, size),
    beamStep(cube, about),
    rowStep(cube, about),
    pictureStep(about),
    ...(quarrel === null ? [] : quarrelSteps(scene, cube, quarrel)),
    togetherStep(scene, cube, first),
  ];
  return steps.map((step) => ({ lamp: [1, 1, 1], box: null, mark: null, nameless: false, plays: false, ...step }));
}

/** All that is lit at all stops. */
function sightsOf(scene) {
  return stops(scene).flatMap((angle) =>
    exposures(scene, angle).map((exposure, screen) => ({ angle, screen, exposure }))).filter(({ exposure }) => exposure.lit);
}

function at({ angle, screen }) {
  return { angle, screen };
}

function nameOf(scene, { exposure }) {
  return scene.pictures[exposure.picture].name;
}

function pieceStep(cube, sight, size) {
  const [nz, ny, nx] = cube.shape;
  const box = most(boxes(cube, size).filter((each) => pixelOf(cube, sight.exposure, each) !== null), (each) => colourOf(cube, each));
  const power = sight.exposure.views.map((view) => view.power).reduce(add);
  const few = size === 1 ? "one" : `${size} × ${size} × ${size}`;
  const [they, their] = size === 1 ? ["it takes", "its"] : ["they take", "their"];
  return {
    ...at(sight),
    title: size === 1 ? "One voxel" : "A few voxels",
    text: `The block is ${nx} × ${ny} × ${nz} small boxes of glass, voxels. Here all are clear but ${few}, in white light: ` +
      `${they} away some red, green and blue, and ${their} shadow is a spot.`,
    lamp: power.map((each) => (each > 0 ? 1 / each : 1)),
    nameless: true,
    box,
    mark: { screen: sight.screen, row: null, column: null, frame: box },
  };
}

function beamStep(cube, about) {
  const { exposure, pixel: [row, column] } = about;
  const beams = pointsOf(cube, exposure, JUDGED).map(([across, down]) => {
    const { start, way, first, last } = beamOf(exposure.views[0], row + down, column + across, exposure.raster);
    const { voxels, lengths } = walk(cube.shape, cube.voxel_mm, start, way, first, last);
    return { left: transmittance(cube, voxels, lengths), count: new Set(voxels).size };
  });
  const mean = (each) => beams.reduce((sum, beam) => sum + each(beam), 0) / beams.length;
  const [red, green, blue] = [0, 1, 2].map((channel) => percent(mean(({ left }) => left[channel])));
  return {
    ...at(about),
    title: "One beam",
    text: `Light goes straight to one pixel, through some ${Math.round(mean(({ count }) => count))} voxels. Each takes its ` +
      `part. ${red} of the red is left, ${green} of the green and ${blue} of the blue: the lamp is as bright as that needs.`,
    mark: { screen: about.screen, row, column, beam: true, frame: null },
  };
}

function rowStep(cube, about) {
  const { exposure, pixel: [row] } = about;
  const [nz, ny, nx] = cube.shape;
  const mark = { screen: about.screen, row, column: null, frame: null };
  const step = { ...at(about), title: "One row", mark };
  if (!inOneSlice(cube, exposure)) {
    return { ...step, text: "Beams side by side make one row of the picture. Under a raised lamp they lie in a slanted sheet." };
  }
  const height = exposure.views[0].origin[2] + (row - (exposure.raster[0] - 1) / 2) * exposure.views[0].down[2];
  const z = Math.min(Math.max(Math.floor(height / cube.voxel_mm + nz / 2), 0), nz - 1);
  const text = "Beams side by side make one row of the picture. They all go through one layer of voxels, which is here alone.";
  return { ...step, text, box: [[0, 0, z], [nx, ny, z + 1]], nameless: true };
}

function pictureStep(about) {
  const [rows, columns] = about.exposure.window;
  const text = `${rows} rows, one below the other, are the picture: ${counted(rows * columns)} pixels, each with beams of its own.`;
  return { ...at(about), title: "One picture", text };
}

/**
 * A piece of glass that one picture has much light through, and another little: {box, bright, dark}, each of these a
 * sight with its pixel and light; null where no piece lies before two pictures.
 */
function quarrelOf(cube, sights, size) {
  const found = boxes(cube, size).map((box) => {
    const lights = sights.flatMap((sight) => {
      const pixel = pixelOf(cube, sight.exposure, box);
      return pixel === null ? [] : [{ ...sight, pixel, light: lightOf(cube, sight.exposure, pixel, QUICK) }];
    });
    const [bright, dark] = [1, -1].map((way) => most(lights, ({ light }) => way * light));
    return { box, bright, dark, count: lights.length };
  });
  const { box, bright, dark, count } = most(found, (each) => (each.count > 1 ? each.bright.light - each.dark.light : -1));
  return count > 1 ? { box, bright, dark } : null;
}

function quarrelSteps(scene, cube, { box, bright, dark }) {
  const [much, little] = [bright, dark].map(({ exposure, pixel }) => percent(lightOf(cube, exposure, pixel, JUDGED)));
  const step = (sight, title, text) => {
    const [row, column] = sight.pixel;
    return { ...at(sight), title, text, mark: { screen: sight.screen, row, column, beam: true, frame: box } };
  };
  const [one, other] = [bright, dark].map((sight) => nameOf(scene, sight));
  const moved = bright.angle === dark.angle ? "On another wall" : "After turning";
  return [
    step(bright, "One picture wants it clear", `The glass in the frame lies before a bright pixel of “${one}”: the wall has ${much} of white's light there.`),
    step(dark, "Another wants it dark", `${moved}, the same glass lies before a dark pixel of “${other}”: ${little}. It cannot do as both wish.`),
  ];
}

function togetherStep(scene, cube, first) {
  const pixels = scene.pictures.reduce((sum, { window: [rows, columns] }) => sum + rows * columns, 0);
  const voxels = cube.shape.reduce((product, count) => product * count, 1);
  const wishes = scene.pictures.length > 1 ? `${scene.pictures.length} pictures have ${counted(pixels)} pixels` : `The picture has ${counted(pixels)} pixels`;
  const text = `${wishes}, and the block ${counted(voxels)} voxels. None of these can please all of those; together they nearly do. ` +
    "Their tints are what was computed.";
  return { ...at(first), title: "All together", text, plays: true };
}

/** Boxes of a side, spread over the inner part of a cube, no voxel of them outside. */
function boxes(cube, size) {
  const counts = [...cube.shape].reverse();
  return Array.from({ length: TRIED }, (_, i) => {
    const low = counts.map((count, axis) => {
      const place = 0.15 + 0.7 * ((SPREAD[axis] * (i + 1)) % 1);
      return Math.min(Math.max(Math.round(place * count - size / 2), 0), Math.max(count - size, 0));
    });
    return [low, low.map((start, axis) => Math.min(start + size, counts[axis]))];
  });
}

/** The pixel [row, column] that light through a box's middle falls on, null where it misses the picture. */
function pixelOf(cube, { views, raster, window: sides }, [low, high]) {
  const { light, origin, right, down } = views[0];
  const middle = low.map((start, axis) => ((start + high[axis]) / 2 - cube.shape[2 - axis] / 2) * cube.voxel_mm);
  const way = light[3] === 0 ? light.slice(0, 3) : sub(middle, light);
  const normal = cross(right, down);
  const hit = sub(middle, scaled(way, dot(sub(middle, origin), normal) / dot(way, normal)));
  const steps = [down, right].map((step) => dot(sub(hit, origin), step) / dot(step, step));
  const pixel = steps.map((step, i) => Math.floor(step + raster[i] / 2));
  return pixel.every((place, i) => place >= 0 && place < sides[i]) ? pixel : null;
}

/** What the wall has of white's light on a pixel. */
function lightOf(cube, exposure, [row, column], beams) {
  const light = castPixel(cube, exposure, row, column, pointsOf(cube, exposure, beams));
  return (light[0] + light[1] + light[2]) / 3;
}

/** How much of a box is coloured glass: the mean of what its voxels take of one colour more than of another. */
function colourOf(cube, [low, high]) {
  const [, ny, nx] = cube.shape;
  let sum = 0;
  for (let z = low[2]; z < high[2]; z++) {
    for (let y = low[1]; y < high[1]; y++) {
      for (let x = low[0]; x < high[0]; x++) {
        const left = cube.tables.map((table, channel) =>
          Math.exp(-table[cube.codes[3 * ((z * ny + y) * nx + x) + channel]] * cube.voxel_mm));
        sum += Math.max(...left) - Math.min(...left);
      }
    }
  }
  return sum;
}

/** The first of the things that a function has the largest value of. */
function most(things, value) {
  return things.reduce((best, each) => (value(each) > value(best) ? each : best), things[0]);
}

function percent(part) {
  return `${Math.round(100 * part)} %`;
}

function counted(number) {
  return number.toLocaleString("en");
}
