// Draws one slice of the cube with bundles of beams: the light goes from left to right, seen along the axis left out.

import { encode } from "../model/light.js";
import { fitCanvas } from "../tools/elements.js";
import { scaled, sub, unit } from "../tools/vectors.js";

/** How much light a deep voxel (nine in ten are lighter) lets through as it is drawn; real ones hardly take any. */
const DEEP = 0.15;
/** Display level of a clear voxel. */
const CLEAR = 238;
/** Voxels that are looked at to find the deep one. */
const LOOKED_AT = 20000;
/** Where the screen is drawn, in half diagonals of the slice behind its middle, where it stands farther away. */
const NEAR_SCREEN = 1.1;
/** Where beams begin, in the same unit before the middle; what stays free around. */
const [BEGIN, MARGIN] = [1.08, 4];
/** Width of the strip of pixels, in pixels of the page. */
const STRIP = 9;

/** A canvas with the slice of a scan-line. */
export class SliceDrawing {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {Object} cube
   */
  constructor(canvas, cube) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.cube = cube;
    this.colours = voxelColours(cube);
    this.cells = document.createElement("canvas");
    this.bundles = [];
  }

  clear() {
    this.bundles = [];
    this.context.setTransform(1, 0, 0, 1, 0, 0);
    this.context.clearRect(0, 0, this.canvas.width, this.canvas.height);
  }

  /**
   * @param {Object} sheet of `sheetOf`
   * @param {Object} view whose beams these are
   * @param {{column: number|null, dark: boolean}} look the column that is pointed at, and the theme
   */
  show(sheet, view, look) {
    fitCanvas(this.canvas);
    this.clear();
    const place = placing(sheet, view, this.cube, this.canvas.clientWidth, this.canvas.clientHeight);
    this.bundles = sheet.pixels.map(({ column, shown, beams }) => {
      return { column, shown, lines: beams.map((beam) => lineOf(beam, view, place)) };
    });
    this.drawCells(sheet, place);
    const density = this.canvas.width / this.canvas.clientWidth;
    this.context.setTransform(density, 0, 0, density, 0, 0);
    this.drawBeams(look);
    this.drawStrip(look);
  }

  /** The column one of whose beams is nearest to a place on the canvas (pixels of the page). */
  columnAt(x, y) {
    let [found, least] = [null, Infinity];
    for (const { column, lines } of this.bundles) {
      for (const { from, to } of lines) {
        const along = [to[0] - from[0], to[1] - from[1]];
        const off = Math.abs((x - from[0]) * along[1] - (y - from[1]) * along[0]) / Math.hypot(...along);
        if (off < least) [found, least] = [column, off];
      }
    }
    return found;
  }

  drawCells({ axis, shape: [n, m], cells }, place) {
    const image = new ImageData(m, n);
    const texels = new Uint32Array(image.data.buffer);
    for (let i = 0; i < cells.length; i++) if (cells[i] >= 0) texels[i] = this.colourOf(cells[i]);
    Object.assign(this.cells, { width: m, height: n });
    this.cells.getContext("2d").putImageData(image, 0, 0);
    const fast = axis === 0 ? 1 : 0;
    const slow = axis === 2 ? 1 : 2;
    const at = (i, j) => {
      const point = [0, 0, 0];
      point[slow] = (i - n / 2) * this.cube.voxel_mm;
      point[fast] = (j - m / 2) * this.cube.voxel_mm;
      return place(point);
    };
    const [corner, next, below] = [at(0, 0), at(0, 1), at(1, 0)];
    const density = this.canvas.width / this.canvas.clientWidth;
    const matrix = [...minus(next, corner), ...minus(below, corner), ...corner];
    this.context.setTransform(...matrix.map((part) => part * density));
    this.context.imageSmoothingEnabled = false;
    this.context.drawImage(this.cells, 0, 0);
  }

  /** A voxel's colour as a texel. */
  colourOf(voxel) {
    const [red, green, blue] = this.colours.map((levels, channel) => levels[this.cube.codes[3 * voxel + channel]]);
    return (255 << 24) | (blue << 16) | (green << 8) | red;
  }

  /** All bundles, the one that is pointed at last. */
  drawBeams({ column, dark }) {
    const others = this.bundles.filter((bundle) => bundle.column !== column);
    const own = this.bundles.filter((bundle) => bundle.column === column);
    const many = this.bundles.length * this.bundles[0].lines.length;
    others.forEach(({ lines }) => this.drawBundle(lines, Math.min(1, 40 / many), dark, false));
    own.forEach(({ lines }) => this.drawBundle(lines, 1, dark, true));
    this.context.globalAlpha = 1;
  }

  /** Beams in the colour that arrives, on their way to the cube and inside it as faint as so many are. */
  drawBundle(lines, faint, dark, own) {
    const paint = this.context;
    const thick = own && lines.length === 1 ? 2 : 1;
    for (const { from, enters, leaves, to, shown } of lines) {
      paint.globalAlpha = own ? 1 : 0.35 * faint;
      stroke(paint, from, enters ?? to, dark ? "#fff3d6" : "#8a6a2a", thick);
      if (enters === null) continue;
      paint.globalAlpha = own ? 1 : 0.12 * faint;
      stroke(paint, enters, leaves, dark ? "#fff" : "#000", thick);
      paint.globalAlpha = own ? 1 : 0.8 * Math.max(faint, 0.4);
      stroke(paint, leaves, to, colourText(shown), 1.5 * thick);
    }
  }

  /** The row of pixels where the bundles land, each in the colour of all its light. */
  drawStrip({ column, dark }) {
    const paint = this.context;
    const places = this.bundles.map(({ lines }) => lines[(lines.length - 1) / 2].to);
    const steps = 2 * (places.length - 1);
    const half = steps === 0 ? [0, 4] : minus(places[places.length - 1], places[0]).map((part) => part / steps);
    const length = Math.hypot(...half) || 1;
    const way = half[1] < 0 ? -1 : 1; // away from the cube
    this.bundles.forEach((bundle, i) => {
      const own = bundle.column === column;
      const thick = (way * STRIP * (own ? 1.6 : 1)) / length;
      boxPath(paint, minus(places[i], half), plus(places[i], half), [thick * half[1], -thick * half[0]]);
      paint.fillStyle = colourText(bundle.shown);
      paint.fill();
      if (!own) return;
      paint.strokeStyle = dark ? "#fff" : "#000";
      paint.lineWidth = 1.5;
      paint.stroke();
    });
  }
}

/**
 * Display levels by code and colour, of what a voxel lets through, as if it were so many times thicker that a deep one
 * lets through `DEEP`.
 */
function voxelColours({ codes, tables, voxel_mm }) {
  const step = 3 * Math.max(1, Math.floor(codes.length / 3 / LOOKED_AT));
  const absorbed = [];
  for (let i = 0; i < codes.length; i += step) {
    const each = tables.reduce((sum, table, channel) => sum + table[codes[i + channel]], 0) / 3;
    if (each > 0) absorbed.push(each * voxel_mm);
  }
  absorbed.sort((a, b) => a - b);
  const deep = absorbed[Math.floor(0.9 * absorbed.length)] ?? 1;
  const thicker = Math.max(1, -Math.log(DEEP) / deep);
  const level = (extinction) => Math.round(CLEAR * encode(Math.exp(-extinction * voxel_mm * thicker), "srgb"));
  return tables.map((table) => Uint8Array.from(table, level));
}

/**
 * From points in the cube's axes (mm) to the canvas (pixels of the page), as seen along the axis that is left out.
 *
 * The scale is the same at all angles of the table.
 */
function placing(sheet, view, cube, width, height) {
  const [a, b] = [(sheet.axis + 1) % 3, (sheet.axis + 2) % 3];
  const sides = cube.shape.map((count) => count * cube.voxel_mm).reverse();
  const radius = Math.hypot(sides[a], sides[b]) / 2;
  const sign = view.light[3] === 0 ? 1 : -1;
  const along = [sign * view.light[a], sign * view.light[b]];
  const length = Math.hypot(...along) || 1;
  const [cos, sin] = [along[0] / length, along[1] / length];
  const turned = (point) => [cos * point[a] + sin * point[b], cos * point[b] - sin * point[a]];
  const far = screenAt(sheet.pixels.flatMap(({ beams }) => beams), view, turned, radius);
  const reach = Math.max(...far.spots.map((spot) => Math.abs(spot[1])), radius);
  const end = Math.max(...far.spots.map((spot) => spot[0]), radius);
  const long = end + BEGIN * radius;
  const scale = Math.min((width - 2 * MARGIN - STRIP) / long, (height - 2 * MARGIN) / (2 * reach));
  const left = (width - scale * long - STRIP) / 2 + scale * BEGIN * radius;
  const place = (point) => {
    const [x, y] = turned(point);
    return [left + scale * x, height / 2 - scale * y];
  };
  return Object.assign(place, { nearer: far.nearer, begin: left - scale * BEGIN * radius });
}

/** Where the pixels are drawn: the screen moved along the light towards the cube, its shadow the same. */
function screenAt(beams, view, turned, radius) {
  const pixels = beams.map((beam) => turned(beam.pixel));
  const nearest = Math.min(...pixels.map((pixel) => pixel[0]));
  const wanted = NEAR_SCREEN * radius;
  if (nearest <= wanted) return { nearer: (pixel) => pixel, spots: pixels };
  const lamp = view.light.slice(0, 3);
  const parallel = view.light[3] === 0;
  const nearer = parallel ? movedBy(lamp, turned, nearest - wanted) : shrunkTo(lamp, turned, nearest, wanted);
  return { nearer, spots: beams.map((beam) => turned(nearer(beam.pixel))) };
}

function movedBy(way, turned, by) {
  const back = by / turned(way)[0];
  return (pixel) => pixel.map((part, i) => part - back * way[i]);
}

function shrunkTo(lamp, turned, nearest, wanted) {
  const from = turned(lamp)[0];
  const part = (wanted - from) / (nearest - from);
  return (pixel) => pixel.map((each, i) => lamp[i] + part * (each - lamp[i]));
}

/** A beam on the canvas: whence it comes, where it enters and leaves the cube (null: it misses), where it lands. */
function lineOf({ start, end, pixel, shown }, view, place) {
  const to = place(place.nearer(pixel));
  const lamp = view.light.slice(0, 3);
  const source = view.light[3] === 0 ? place(sub(pixel, scaled(unit(lamp), 1e3))) : place(lamp);
  const part = Math.min(1, (to[0] - place.begin) / (to[0] - source[0]));
  const from = plus(to, minus(source, to).map((each) => part * each));
  return { from, enters: start && place(start), leaves: end && place(end), to, shown };
}

function plus(one, other) {
  return [one[0] + other[0], one[1] + other[1]];
}

function minus(one, other) {
  return [one[0] - other[0], one[1] - other[1]];
}

function stroke(paint, from, to, colour, thick) {
  paint.strokeStyle = colour;
  paint.lineWidth = thick;
  paint.beginPath();
  paint.moveTo(...from);
  paint.lineTo(...to);
  paint.stroke();
}

/** The path of a parallelogram on a side, as wide as `back`. */
function boxPath(paint, from, to, back) {
  paint.beginPath();
  paint.moveTo(...from);
  paint.lineTo(...to);
  paint.lineTo(to[0] + back[0], to[1] + back[1]);
  paint.lineTo(from[0] + back[0], from[1] + back[1]);
  paint.closePath();
}

function colourText(shown) {
  return `rgb(${shown.map((part) => Math.round(255 * part)).join(" ")})`;
}
