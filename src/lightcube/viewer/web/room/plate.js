// A relief's plate on a table, seen a little aslant, and the lamp on its way round: on a 2-D canvas, without perspective.

import { dimmed } from "../model/relief.js";
import { encode } from "../model/light.js";
import { TONES } from "./furniture.js";

/** How high the eye stands, degrees. */
const EYE_DEG = 72;
/** How far lamps are drawn from the plate's middle, in widths of it. */
const AWAY = 1.12;
/** What all of it takes of a canvas: across, above the plate's middle and below, in widths of it. */
const [ACROSS, ABOVE, BELOW] = [2.0, 1.15, 0.7];
/** How light a front is under a lamp before it, and under none. */
const [FRONT, UNLIT] = [0.75, 0.16];
/** Pixels of a column at most: more is not seen. */
const LARGEST = 4;

const radians = (degrees) => (degrees * Math.PI) / 180;
const [SINE, COSINE] = [Math.sin(radians(EYE_DEG)), Math.cos(radians(EYE_DEG))];

/**
 * What draws a plate.
 * @param {HTMLCanvasElement} canvas
 * @param {object} scene
 * @param {Float64Array} heights
 * @returns {function(object): void} takes {levels, lamps, elevation, dark, head}: display levels of the columns' tops, the
 *   lamps that shine, how high they stand, the theme, and the part of the canvas that the title covers
 */
export function createPlate(canvas, scene, heights) {
  const plate = Object.assign(document.createElement("canvas"), { width: 1, height: 1 });
  return ({ levels, lamps, elevation, dark, head }) => {
    const [tones, context] = [TONES[dark ? "dark" : "light"], canvas.getContext("2d")];
    const free = canvas.height * (1 - head);
    const wide = Math.min(canvas.width / ACROSS, free / (ABOVE + BELOW)); // of the plate, pixels
    const middle = [canvas.width / 2, head * canvas.height + (free * ABOVE) / (ABOVE + BELOW)];
    const at = (x, y, z) => [middle[0] + wide * x, middle[1] - wide * (y * SINE + z * COSINE)];
    const room = { context, canvas, scene, tones, wide, at, density: canvas.width / (canvas.clientWidth || canvas.width) };
    drawFloor(room);
    drawWay(room, elevation);
    drawSlab(room);
    paintPlate(plate, scene, heights, levels, lamps, wide);
    const [rows, columns] = scene.columns;
    const [left, back] = at(-0.5, 0.5 * (rows / columns), top(scene));
    context.imageSmoothingQuality = "high";
    const scale = wide / (columns * plate.zoom);
    context.drawImage(plate, left, back, plate.width * scale, plate.height * scale);
    for (const lamp of lamps) drawLamp(room, lamp, elevation);
  };
}

/** The greatest height above the table, in widths of the plate. */
function top({ size_mm, columns, pitch_mm }) {
  return size_mm[2] / (columns[1] * pitch_mm);
}

function css(light, part = 1) {
  const [red, green, blue] = light.map((x) => Math.round(255 * encode(Math.min(x, 1), "srgb")));
  return `rgba(${red}, ${green}, ${blue}, ${part})`;
}

function drawFloor({ context, canvas, tones, wide, at }) {
  const [x, y] = at(0, 0, 0);
  const glow = context.createRadialGradient(x, y, 0, x, y, 2.1 * wide);
  for (let i = 0; i <= 8; i++) {
    const part = Math.exp(-((i / 4) ** 2));
    glow.addColorStop(i / 8, css(tones.far.map((far, k) => far + part * (tones.floor[k] - far))));
  }
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.fillStyle = glow;
  context.fillRect(0, 0, canvas.width, canvas.height);
}

/** The lamp's way round, with a mark at each picture. */
function drawWay({ context, scene, tones, wide, at, density }, elevation) {
  const [radius, high] = [AWAY * Math.cos(radians(elevation)), AWAY * Math.sin(radians(elevation))];
  const [x, y] = at(0, 0, high);
  context.strokeStyle = css(tones.rim, 0.55);
  context.lineWidth = 1.2 * density;
  context.beginPath();
  context.ellipse(x, y, wide * radius, wide * radius * SINE, 0, 0, 2 * Math.PI);
  context.stroke();
  context.lineWidth = 2.4 * density;
  for (const { angle_deg } of scene.pictures) {
    for (const azimuth of scene.colours === null ? [angle_deg] : scene.colours) {
      const turn = radians(azimuth);
      const ends = [0.96, 1.04].map((part) => at(part * radius * Math.cos(turn), part * radius * Math.sin(turn), high));
      context.beginPath();
      ends.forEach((end, i) => (i ? context.lineTo(...end) : context.moveTo(...end)));
      context.stroke();
    }
  }
}

/** What lies below the columns: a shadow on the table, the base, and the frame that stands out around them. */
function drawSlab({ context, scene, tones, wide, at }) {
  const { size_mm, columns: [, columns], pitch_mm, base_mm } = scene;
  const unit = columns * pitch_mm;
  const [half, deep, high] = [size_mm[0] / unit / 2, size_mm[1] / unit / 2, base_mm / unit];
  const [left, back] = at(-half, deep, high);
  const front = wide * high * COSINE;
  context.fillStyle = css([0, 0, 0], tones.shade);
  context.filter = `blur(${Math.max(1, 0.02 * wide)}px)`;
  context.fillRect(left, back + 0.02 * wide, 2 * half * wide, 2 * deep * wide * SINE + front);
  context.filter = "none";
  context.fillStyle = css([0.75, 0.74, 0.72]);
  context.fillRect(left, back, 2 * half * wide, 2 * deep * wide * SINE);
  context.fillStyle = css([0.3, 0.295, 0.285]);
  context.fillRect(left, back + 2 * deep * wide * SINE, 2 * half * wide, front);
}

/** The columns, from the back to the front: of each its top, and the front below it. */
function paintPlate(plate, scene, heights, levels, lamps, wide) {
  const { columns: [rows, columns], px_mm, pitch_mm, size_mm, base_mm } = scene;
  const zoom = Math.min(LARGEST, Math.max(1, Math.round(wide / columns)));
  const rise = zoom * COSINE * (px_mm / pitch_mm);
  const above = zoom * COSINE * ((size_mm[2] - base_mm) / pitch_mm); // where a height of 0 is seen, below the edge
  const [width, height] = [columns * zoom, Math.ceil(rows * zoom * SINE + above)];
  if (plate.width !== width || plate.height !== height) Object.assign(plate, { width, height });
  plate.zoom = zoom;
  const context = plate.getContext("2d");
  const picture = context.createImageData(width, height);
  const pixels = new Uint32Array(picture.data.buffer);
  const colours = new Uint32Array(levels.buffer);
  const before = [0, 1, 2].map((i) => {
    const light = lamps.reduce((sum, { azimuth, colour }) => sum + colour[i] * Math.max(0, -Math.sin(radians(azimuth))), 0);
    return UNLIT + FRONT * Math.min(1, light);
  });
  const front = Array.from({ length: 256 }, (_, level) => before.map((part) => dimmed(level, part * 0.6)));
  const white = front[255];
  const face = new Uint32Array(new Uint8ClampedArray([...white, 255]).buffer)[0];
  for (let row = 0; row < rows; row++) {
    const base = above + (row + 1) * zoom * SINE;
    for (let column = 0; column < columns; column++) {
      const place = row * columns + column;
      const nearest = Math.round(base - rise * heights[place]);
      const furthest = Math.round(base - zoom * SINE - rise * heights[place]);
      const end = Math.min(height, Math.round(base));
      for (let y = Math.max(0, furthest); y < end; y++) {
        pixels.fill(y < nearest ? colours[place] : face, y * width + column * zoom, y * width + (column + 1) * zoom);
      }
    }
  }
  context.putImageData(picture, 0, 0);
}

/** A lamp, and the ray that it sends to the plate's middle. */
function drawLamp({ context, scene, tones, wide, at, density }, { azimuth, colour }, elevation) {
  const [radius, high] = [AWAY * Math.cos(radians(elevation)), AWAY * Math.sin(radians(elevation))];
  const turn = radians(azimuth);
  const [x, y] = at(radius * Math.cos(turn), radius * Math.sin(turn), high);
  const [there, near] = [at(0, 0, top(scene)), at(0.62 * Math.cos(turn) * radius, 0.62 * Math.sin(turn) * radius, 0.62 * high)];
  const ray = context.createLinearGradient(x, y, ...near);
  ray.addColorStop(0, css(colour, 0.55));
  ray.addColorStop(1, css(colour, 0));
  context.strokeStyle = ray;
  context.lineWidth = 1.4 * density;
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(...there);
  context.stroke();
  const size = 0.036 * wide;
  const halo = context.createRadialGradient(x, y, size, x, y, 4 * size);
  [0.6, 0.24, 0.1, 0.03, 0].forEach((part, i) => halo.addColorStop(i / 4, css(colour, part)));
  const disc = (reach, style) => {
    context.fillStyle = style;
    context.beginPath();
    context.arc(x, y, reach, 0, 2 * Math.PI);
    context.fill();
  };
  disc(4 * size, halo);
  disc(1.09 * size, css(tones.off, 0.45));
  disc(size, css(colour.map((part) => 0.45 + 0.55 * part)));
}
