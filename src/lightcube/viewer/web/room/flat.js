// The renderer where there is no WebGL2: the same room on a 2-D canvas, plainer, its shadows cast one ray at a time.

import { pointsOf } from "../model/area.js";
import { walk } from "../model/beam.js";
import { bodyOf, brightness, meets } from "../model/body.js";
import { castPicture, transmittance } from "../model/cast.js";
import { encode } from "../model/light.js";
import { add, applyInverse, dot, norm, scaled, sub, unit } from "../tools/vectors.js";
import { beforeEye, rayAt, seenAt } from "./camera.js";
import { TONES, cubeCorners, floorOf, fromFar, halfSides, lampRadius, lampsLighting, wallWidth } from "./furniture.js";
import { linesOf, longestSide, markedSheet, pureColour, screenCorners, tableOf } from "./furniture.js";

/** Shadows that are kept. */
const KEPT = 64;
/** Rays along each side of the picture of the cube's glass, at rest and in motion; of a body twice as many. */
const [FINE, COARSE] = [72, 28];
/** Part of a picture that is seen through the screen's paper from behind. */
const THROUGH = 0.5;
/** Patches along each side of a screen's picture, each drawn without perspective. */
const PATCHES = 8;

/**
 * A renderer with the interface of gpu.js's, on a 2-D canvas; what it draws of the cube is coarse.
 * @param {HTMLCanvasElement} canvas
 * @param {object} scene
 * @param {object} cube
 */
export function createFlat(canvas, scene, cube) {
  const [kept, floor] = [new Map(), floorOf(scene)];
  const body = scene.solid ? bodyOf(cube) : null;
  let [exposed, asked, seen, shadows] = [[], null, 1, []];
  const shadowOf = (exposure, parts) => keptShadow(kept, cube, scene, exposure, asked, parts);
  return {
    kind: "flat",
    onRestored: null,
    cast(exposures, beams, parts) {
      [exposed, asked, seen] = [exposures, beams, parts];
      shadows = exposures.map((exposure) => shadowOf(exposure, parts));
    },
    fill(glass) {
      cube = glass;
      kept.clear();
    },
    shadow(number) {
      const picture = shadowOf(exposed[number], 1);
      const { width, height } = picture;
      const { data } = picture.getContext("2d").getImageData(0, 0, width, height);
      return { rows: height, columns: width, pixels: data };
    },
    drawShadow: (number, target) => target.getContext("2d").drawImage(shadowOf(exposed[number], 1), 0, 0),
    draw(room, camera, { dark, mark, scale, bare = 0 }) {
      const tones = TONES[dark ? "dark" : "light"];
      const what = { scene, cube, body, room, camera, tones, shadows, parts: seen, mark, exposed, floor: floor(room), bare };
      drawRoom({ ...what, canvas, context: canvas.getContext("2d"), rays: scale < 1 ? COARSE : FINE });
    },
    dispose: () => kept.clear(),
  };
}

/** A canvas with a screen's shadow, computed where it is not among those seen last. */
function keptShadow(kept, cube, scene, exposure, beams, parts) {
  const key = [exposure.screen, exposure.angle, ...exposure.raster, beams.square, parts].join(" ");
  const shadow = kept.get(key) ?? castShadow(cube, scene, exposure, beams, parts);
  kept.delete(key);
  kept.set(key, shadow);
  if (kept.size > KEPT) kept.delete(kept.keys().next().value);
  return shadow;
}

function castShadow(cube, scene, exposure, beams, parts) {
  const picture = castPicture(cube, exposure, pointsOf(cube, exposure, beams, parts), parts);
  const [rows, columns, wide] = [...exposure.window, exposure.raster[1]].map((count) => count * parts);
  const light = (row, column) => picture.subarray(3 * (row * wide + column), 3 * (row * wide + column) + 3);
  return paintPicture(rows, columns, light, scene.transfer);
}

/** A small canvas of linear light by row and column; clear where that is null. */
function paintPicture(rows, columns, lightAt, transfer) {
  const picture = Object.assign(document.createElement("canvas"), { width: columns, height: rows });
  const levels = new ImageData(columns, rows);
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const light = lightAt(row, column);
      if (light === null) continue;
      const shown = Array.from(light, (x) => 255 * encode(Math.min(x, 1), transfer));
      levels.data.set([...shown, 255], 4 * (row * columns + column));
    }
  }
  picture.getContext("2d").putImageData(levels, 0, 0);
  return picture;
}

function drawRoom(stage) {
  const { context, canvas, camera, room, tones } = stage;
  stage.seen = (point) => {
    const { x, y, depth } = seenAt(camera, point);
    return [x * canvas.width, y * canvas.height, depth];
  };
  context.setTransform(1, 0, 0, 1, 0, 0);
  drawFloor(stage);
  const cubeAway = norm(camera.eye);
  const before = ({ corner, right, down, pixels }) =>
    norm(sub(camera.eye, add(corner, add(scaled(right, pixels[1] / 2), scaled(down, pixels[0] / 2))))) < cubeAway;
  const screens = fromFar(room, camera.eye);
  const lines = linesOf(stage.scene, stage.exposed, room, camera.eye, stage.mark, tones);
  const lamps = room.lamps.map((lamp) => ({ ...lamp, near: norm(sub(camera.eye, lamp.place)) < cubeAway }));
  screens.filter((screen) => !before(screen)).forEach((screen) => drawScreen(stage, screen));
  drawTable(stage); // before walls that go on below it
  lamps.filter((lamp) => !lamp.near).forEach((lamp) => drawLamp(stage, lamp));
  drawSheet(stage);
  lines.filter((line) => !line.over).forEach((line) => drawLine(stage, line));
  drawCube(stage);
  lines.filter((line) => line.over).forEach((line) => drawLine(stage, line));
  screens.filter(before).forEach((screen) => drawScreen(stage, screen));
  lamps.filter((lamp) => lamp.near).forEach((lamp) => drawLamp(stage, lamp));
}

/** A colour of linear light as CSS has it. */
function cssColour(light, part = 1) {
  const [red, green, blue] = light.map((x) => Math.round(255 * encode(Math.min(x, 1), "srgb")));
  return `rgba(${red}, ${green}, ${blue}, ${part})`;
}

function tracePath({ context, seen }, points) {
  context.beginPath();
  points.map(seen).forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.closePath();
}

/** Fill everything with rings round a place on a plane, as they are seen near it. */
function drawGlow({ context, canvas, seen }, middle, right, down, stops) {
  const at = seen(middle);
  const steps = [right, down].map((step) => seen(add(middle, scaled(step, 0.01)))); // near it nothing is out of view
  context.save();
  context.transform(...steps.flatMap(([x, y]) => [100 * (x - at[0]), 100 * (y - at[1])]), at[0], at[1]);
  const rings = context.createRadialGradient(0, 0, 0, 0, 0, 1);
  stops.forEach(([place, colour]) => rings.addColorStop(place, colour));
  context.fillStyle = rings;
  context.beginPath();
  const inverse = context.getTransform().inverse();
  for (const [x, y] of [[0, 0], [canvas.width, 0], [canvas.width, canvas.height], [0, canvas.height]]) {
    const corner = inverse.transformPoint({ x, y });
    context.lineTo(corner.x, corner.y);
  }
  context.fill();
  context.restore();
}

/** Stops of a bell-shaped fading between two colours of light. */
function bellStops(colour, width) {
  return Array.from({ length: 9 }, (_, i) => [i / 8, colour(Math.exp(-((i / 8 / width) ** 2)))]);
}

function drawFloor(stage) {
  const { scene, room, camera, floor, tones } = stage;
  const size = longestSide(scene);
  const [middle, right] = [[0, 0, floor], scaled(camera.right, size)];
  const down = [right[1], -right[0], 0];
  const mixed = (part) => cssColour(tones.far.map((far, i) => far + part * (tones.floor[i] - far)));
  const wide = (steps, factor) => steps.map((step) => scaled(step, factor));
  drawGlow(stage, add(middle, down), scaled(right, 7), scaled(down, 6), bellStops(mixed, 0.5));
  const [east, north] = [[size, 0, 0], [0, size, 0]];
  for (let i = -8; i <= 8; i++) {
    for (const [along, across] of [[east, north], [north, east]]) {
      const start = add(middle, scaled(across, i));
      for (const way of [-5, 5]) {
        const strength = 0.5 * Math.exp(-(i * i) / 14);
        const ends = [start, add(start, scaled(along, way))];
        drawLine(stage, { ends, colour: tones.grid, parts: [strength, 0], width: 1 });
      }
    }
  }
  const shadow = (part) => cssColour([0, 0, 0], 0.6 * tones.shade * part * (part > 0.02));
  const table = tableOf(scene, room);
  const below = [table.middle[0], table.middle[1], floor];
  drawGlow(stage, below, ...wide([right, down], (2.4 * norm(table.right)) / size), bellStops(shadow, 0.4));
}

function drawTable(stage) {
  const { context, scene, room, tones } = stage;
  const { middle, right, down } = tableOf(scene, room);
  const at = (turn, radius) =>
    add(middle, add(scaled(right, radius * Math.cos(turn)), scaled(down, radius * Math.sin(turn))));
  tracePath(stage, Array.from({ length: 90 }, (_, i) => at((i * Math.PI) / 45, 1)));
  context.fillStyle = cssColour(tones.table, 0.5);
  context.fill();
  context.strokeStyle = cssColour(tones.rim, 0.75);
  context.lineWidth = 2 * density(stage);
  context.stroke();
  for (let i = 0; i < 72; i++) {
    const ends = [at((i * Math.PI) / 36, i % 6 ? 0.95 : 0.925), at((i * Math.PI) / 36, 1)];
    drawLine(stage, { ends, colour: tones.rim, parts: [0.6, 0.6], width: i % 6 ? 1 : 1.6 });
  }
}

/** Pixels to a pixel of the page. */
function density({ canvas }) {
  return canvas.width / (canvas.clientWidth || canvas.width);
}

function drawLine(stage, { ends, colour, parts, width }) {
  const { context, camera, scene, seen } = stage;
  const kept = beforeEye(camera, ends, 0.05 * longestSide(scene));
  if (kept === null) return;
  const [start, end] = kept.map(seen);
  const fades = context.createLinearGradient(start[0], start[1], end[0], end[1]);
  parts.forEach((part, i) => fades.addColorStop(i, cssColour(colour, part)));
  context.strokeStyle = fades;
  context.lineWidth = width * density(stage);
  context.beginPath();
  context.moveTo(start[0], start[1]);
  context.lineTo(end[0], end[1]);
  context.stroke();
}

function drawScreen(stage, { corner, right, down, pixels, facing, number }) {
  const { context, scene, camera, tones, shadows } = stage;
  const rim = [right, down].map((step) => scaled(unit(step), wallWidth(scene, { right, pixels })));
  const corners = screenCorners({ corner, right, down, pixels });
  const outside = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
  const rimmed = (each, [x, y]) => add(each, add(scaled(rim[0], x), scaled(rim[1], y)));
  tracePath(stage, corners.map((each, i) => rimmed(each, outside[i])));
  context.fillStyle = cssColour(tones.wall);
  context.fill();
  for (let i = 0; i < PATCHES; i++) {
    for (let j = 0; j < PATCHES; j++) {
      const at = (y, x) =>
        add(corner, add(scaled(right, (x * pixels[1]) / PATCHES), scaled(down, (y * pixels[0]) / PATCHES)));
      const patch = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
      const place = { x: (j * pixels[1]) / PATCHES, y: (i * pixels[0]) / PATCHES };
      drawPatch(stage, shadows[number], patch, place, pixels);
    }
  }
  if (dot(sub(camera.eye, corner), facing) > 0) return;
  tracePath(stage, corners);
  context.globalAlpha = 1 - THROUGH;
  context.fillStyle = cssColour(tones.back);
  context.fill();
  context.globalAlpha = 1;
}

/** A patch of a picture, a little larger on the right and below, so that no seams are seen. */
function drawPatch({ context, seen, parts }, picture, patch, { x, y }, pixels) {
  const [at, beside, below, across] = patch.map(seen);
  const [wide, high] = [pixels[1] / PATCHES, pixels[0] / PATCHES];
  const right = [0, 1].map((i) => (beside[i] - at[i] + across[i] - below[i]) / 2);
  const down = [0, 1].map((i) => (below[i] - at[i] + across[i] - beside[i]) / 2);
  const centre = [0, 1].map((i) => (at[i] + beside[i] + below[i] + across[i]) / 4 - (right[i] + down[i]) / 2);
  context.save();
  context.transform(right[0] / wide, right[1] / wide, down[0] / high, down[1] / high, centre[0], centre[1]);
  const more = [x + wide < pixels[1] - 1e-6 ? wide / 12 : 0, y + high < pixels[0] - 1e-6 ? high / 12 : 0];
  const sides = [wide + more[0], high + more[1]];
  context.drawImage(picture, ...[x, y, ...sides].map((each) => parts * each), 0, 0, ...sides);
  context.restore();
}

/** What the cube lets through, a coarse picture that dims what is behind it; of a shape its body, which hides that. */
function drawCube(stage) {
  const { context, canvas, scene, cube, room, camera, rays } = stage;
  const around = facesSeen(stage);
  if (around === null) return;
  const { eye, left, top, wide, high } = around;
  const wayAt = (row, column) => {
    const [x, y] = [left + ((column + 0.5) / rays) * wide, top + ((row + 0.5) / rays) * high];
    return applyInverse(room.turn, rayAt(camera, x / canvas.width, y / canvas.height).way);
  };
  const through = (row, column) => {
    const { voxels, lengths } = walk(cube.shape, cube.voxel_mm, eye, wayAt(row, column), 0);
    return transmittance(cube, voxels, lengths);
  };
  const cast = scene.solid ? bodyLight(stage, eye) : null;
  const drawn = scene.solid
    ? paintPicture(2 * rays, 2 * rays, (row, column) => cast(wayAt((row - 0.5) / 2, (column - 0.5) / 2)), "srgb")
    : paintPicture(rays, rays, through, "srgb");
  context.save();
  around.clip();
  if (!scene.solid) context.globalCompositeOperation = "multiply"; // of display values: nearly that of light
  context.imageSmoothingQuality = "high";
  context.drawImage(drawn, left, top, wide, high);
  context.restore();
}

/** The light of a shape's body by the way of a ray from the eye, in the cube's axes; null where that misses it. */
function bodyLight({ scene, exposed, room, body, tones, bare }, eye) {
  const { voxel_mm } = scene.voxels;
  const half = halfSides(scene);
  const inVoxels = (place) => scaled(add(place, half), 1 / voxel_mm);
  const up = applyInverse(room.turn, [0, 0, 1]);
  const numbers = new Set(exposed.flatMap((exposure) => lampsLighting(scene, exposure).slice(0, 1)));
  const lamps = [...numbers].map((number) => {
    const { place, parallel, light } = room.lamps[number];
    const there = applyInverse(room.turn, place);
    return { ways: (at) => unit(parallel ? there : sub(inVoxels(there), at)), light: pureColour(light) };
  });
  const start = inVoxels(eye);
  return (way) => {
    const met = meets(body, start, unit(way));
    if (met === null) return null;
    return brightness(body, met, up, lamps).map((part, i) => (1 - bare) * part * tones.body[i]);
  };
}

/** The box of the canvas that the cube is seen in, the eye in the cube's axes, and what clips to the faces seen. */
function facesSeen({ context, scene, room, camera, seen }) {
  const corners = cubeCorners(scene, room);
  const places = corners.map(seen);
  if (Math.min(...places.map(([, , depth]) => depth)) <= 0) return null;
  const [xs, ys] = [0, 1].map((i) => places.map((place) => place[i]));
  const [left, top] = [Math.min(...xs), Math.min(...ys)];
  const [wide, high] = [Math.max(...xs) - left, Math.max(...ys) - top];
  const [eye, half] = [applyInverse(room.turn, camera.eye), halfSides(scene)];
  const clip = () => {
    context.beginPath();
    for (let axis = 0; axis < 3; axis++) {
      if (Math.abs(eye[axis]) <= half[axis]) continue; // neither of these two faces is seen
      const face = corners.map((_, i) => i).filter((i) => ((i >> axis) & 1) === (eye[axis] > 0 ? 1 : 0));
      [0, 1, 3, 2].map((i) => places[face[i]]).forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
      context.closePath();
    }
    context.clip("nonzero");
  };
  return { eye, left, top, wide, high, clip };
}

function drawLamp({ context, scene, canvas, camera, seen, tones }, { place, light }) {
  const [x, y, depth] = seen(place);
  if (depth <= 0) return;
  const radius = Math.max((lampRadius(scene) * canvas.height) / (2 * camera.tall * depth), 2.5);
  const pure = pureColour(light);
  const disc = (reach, style) => {
    context.fillStyle = style;
    context.beginPath();
    context.arc(x, y, reach, 0, 2 * Math.PI);
    context.fill();
  };
  if (pure) {
    const halo = context.createRadialGradient(x, y, radius, x, y, 4 * radius);
    [0.6, 0.24, 0.1, 0.03, 0].forEach((part, i) => halo.addColorStop(i / 4, cssColour(pure, part)));
    disc(4 * radius, halo);
  }
  disc(1.09 * radius, cssColour(tones.off, 0.45));
  disc(radius, cssColour(pure ? pure.map((part) => 0.45 + 0.55 * part) : tones.off));
}

function drawSheet(stage) {
  const sheet = markedSheet(stage.scene, stage.exposed, stage.room, stage.mark);
  if (!sheet) return;
  const { kind, corner, sides } = sheet;
  const [one, other] = sides.map((side) => add(corner, side));
  tracePath(stage, kind === 1 ? [corner, one, add(one, sides[1]), other] : [corner, one, other]);
  stage.context.fillStyle = cssColour(stage.tones.mark, 0.12);
  stage.context.fill();
}
