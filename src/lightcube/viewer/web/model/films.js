// Light through films, exactly: the edges of a pixel and of all films' cells cut it into rectangles of one light each.

import { encode } from "./light.js";

/** Edges nearer to each other than this, in pixels, are one. */
const SAME = 1e-7;

/**
 * Absorbances of all films, and the wanted display values, or null where none were kept.
 * @param {Uint8Array} bytes
 * @param {object} scene
 * @returns {{films: Float32Array, wanted: Float32Array|null}} [film][row][column][colour], [picture][row][column][colour]
 */
export function filmsOf(bytes, scene) {
  const [cells, pixels] = [scene.shape, [scene.pictures.length, ...scene.raster]].map((shape) => shape.reduce((a, b) => a * b, 3));
  const kept = scene.wanted.length > 0 ? pixels : 0;
  if (bytes.length !== 4 * (cells + kept)) {
    throw new Error(`the page's films have ${bytes.length} bytes, not ${4 * (cells + kept)}: write or send the page again`);
  }
  const numbers = new Float32Array(bytes.buffer, bytes.byteOffset, cells + kept);
  return { films: numbers.subarray(0, cells), wanted: kept ? numbers.subarray(cells) : null };
}

/**
 * What a picture's sheet shows: means over its pixels.
 * @param {object} scene
 * @param {Float32Array} films
 * @param {number} picture
 * @param {number} off how far films lie off, mm; each the way that chance has given it
 * @returns {Float32Array} rows * columns * 3, linear light, never clipped
 */
export function castFilms(scene, films, picture, off) {
  const [rows, columns] = scene.raster;
  const light = new Float32Array(3 * rows * columns);
  for (const view of scene.views.filter((each) => each.picture === picture)) addView(light, scene, films, view, off);
  return light;
}

function addView(light, scene, films, view, off) {
  const [count, ny, nx] = scene.shape;
  const [rows, columns] = scene.raster;
  const lines = view.lines.map((line, film) => line.map((each, i) => [each[0], each[1], each[2] + off * view.off[film][i]]));
  // which of a film's sides columns run along: 0 = its rows of cells go on with the picture's columns
  const crossed = lines.map(([u]) => Math.abs(u[1]) > Math.abs(u[0]));
  const along = pieces(columns, lines.map((line, film) => sideOf(line, crossed[film] ? 1 : 0, 0, scene, crossed[film] ? ny : nx)), view.slants[0]);
  const down = pieces(rows, lines.map((line, film) => sideOf(line, crossed[film] ? 0 : 1, 1, scene, crossed[film] ? nx : ny)), view.slants[1]);
  const steps = crossed.map((each) => (each ? [3 * nx, 3] : [3, 3 * nx])); // in the array, for a cell along and down
  for (let line = 0; line < rows; line++) {
    for (let column = 0; column < columns; column++) {
      const place = 3 * ((rows - 1 - line) * columns + column);
      for (const across of along[column]) {
        for (const below of down[line]) {
          const longer = Math.sqrt(1 + across.slant + below.slant);
          let [red, green, blue] = [0, 0, 0];
          for (let film = 0; film < count; film++) {
            const [i, j] = [across.cells[film], below.cells[film]];
            if (i < 0 || j < 0) continue;
            const at = 3 * film * ny * nx + i * steps[film][0] + j * steps[film][1];
            red += films[at];
            green += films[at + 1];
            blue += films[at + 2];
          }
          const part = across.wide * below.wide;
          light[place] += part * view.power[0] * Math.exp(-longer * red);
          light[place + 1] += part * view.power[1] * Math.exp(-longer * green);
          light[place + 2] += part * view.power[2] * Math.exp(-longer * blue);
        }
      }
    }
  }
}

/** One side of a film in pixels of the picture: where the first cell begins, how wide cells are, and how many. */
function sideOf(line, side, axis, { cell_mm }, count) {
  const [step, first] = [line[side][axis], line[side][2]];
  return { begins: ((-count / 2) * cell_mm - first) / step, wide: cell_mm / step, count };
}

/** For each pixel of a row the pieces that all films' cells cut it into: how wide, which cell of each film, how aslant. */
function pieces(pixels, sides, [slope, more]) {
  return Array.from({ length: pixels }, (_, pixel) => {
    const [low, high] = [pixel - 0.5, pixel + 0.5];
    const edges = [low, high];
    for (const { begins, wide, count } of sides) {
      const [one, other] = [low, high].map((edge) => (edge - begins) / wide);
      const last = Math.min(Math.floor(Math.max(one, other)), count);
      for (let edge = Math.max(Math.ceil(Math.min(one, other)), 0); edge <= last; edge++) edges.push(begins + edge * wide);
    }
    const inside = edges.filter((edge) => edge >= low && edge <= high).sort((a, b) => a - b);
    const found = [];
    for (let i = 1; i < inside.length; i++) {
      const width = inside[i] - inside[i - 1];
      if (width < SAME) continue;
      const middle = (inside[i] + inside[i - 1]) / 2;
      const cells = sides.map(({ begins, wide, count }) => {
        const cell = Math.floor((middle - begins) / wide);
        return cell >= 0 && cell < count ? cell : -1;
      });
      found.push({ wide: width, cells, slant: (slope + more * middle) ** 2 });
    }
    return found;
  });
}

/**
 * How near a picture is to what was wanted, dB, in display values; null where that is not known.
 * @param {object} scene
 * @param {Float32Array|null} wanted of all pictures
 * @param {number} picture
 * @param {Float32Array} light that it shows
 */
export function psnrOf(scene, wanted, picture, light) {
  if (wanted === null) return null;
  let [sum, count] = [0, 0];
  for (let i = 0; i < light.length; i++) {
    const asked = wanted[picture * light.length + i];
    if (Number.isNaN(asked)) continue;
    sum += (encode(light[i], scene.transfer) - asked) ** 2;
    count++;
  }
  return count === 0 ? null : -10 * Math.log10(Math.max(sum / count, 1e-10));
}

/** Levels of red, green, blue and 255, of linear light. */
export function displayLevels(light, transfer) {
  const levels = new Uint8ClampedArray((4 * light.length) / 3);
  for (let pixel = 0; 3 * pixel < light.length; pixel++) {
    for (let i = 0; i < 3; i++) levels[4 * pixel + i] = 255 * encode(Math.min(light[3 * pixel + i], 1), transfer);
    levels[4 * pixel + 3] = 255;
  }
  return levels;
}
