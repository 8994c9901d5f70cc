// The room of a stack on a 2-D canvas: thin films with air between, the paper below with its picture, lamps and light.

import { encode } from "../model/light.js";
import { add, dot, norm, scaled, sub, unit } from "../tools/vectors.js";

/** Parts of the canvas that stay free at its edges, and its upper part that the title covers, at most. */
const [EDGE, HEAD] = [0.07, 0.16];
/** How far parallel lamps are drawn from the films, in widths of these; a lamp's radius likewise. */
const [AWAY, RADIUS] = [0.95, 0.035];
/** Films are drawn this much clearer than they are. */
const CLEARER = 0.45;
const COLOURS = {
  dark: { ground: ["#22262d", "#0b0c0f"], paper: "#17191d", edge: "220, 232, 255", beam: "255, 240, 210", lamp: "#fff6e0" },
  light: { ground: ["#4a4f58", "#24272c"], paper: "#2c3036", edge: "230, 238, 255", beam: "255, 240, 210", lamp: "#fff6e0" },
};

/**
 * Draw a stack's room.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {Object} scene
 * @param {Float32Array} films
 * @returns {function(Object): void} draws {picture, levels, azimuth, height, near, dark}
 */
export function createStack(canvas, scene, films) {
  const images = imagesOf(scene, films);
  const shown = document.createElement("canvas");
  const [rows, columns] = scene.raster;
  Object.assign(shown, { width: columns, height: rows });
  const lamps = scene.room.map((room) => placesOf(room));
  const solid = scene.room.flatMap(({ films: sheets, paper }) => [...sheets.flat(), ...paper]);
  const bounds = solid.concat(lamps.flat().map(({ place }) => place));
  return ({ picture, levels, azimuth, height, near, dark }) => {
    shown.getContext("2d").putImageData(new ImageData(levels, columns, rows), 0, 0);
    const context = canvas.getContext("2d");
    const view = { context, canvas, colours: COLOURS[dark ? "dark" : "light"], seen: seenFrom(canvas, bounds, azimuth, height, near) };
    const room = scene.room[picture];
    drawGround(view, solid);
    drawSheet(view, room.paper, shown, 1, false);
    lamps.forEach((each, number) => number !== picture && each.forEach((lamp) => drawLamp(view, scene, lamp, false)));
    drawBeam(view, room, lamps[picture]);
    const order = room.films.map((_, film) => film).sort((a, b) => room.films[a][0][2] - room.films[b][0][2]);
    for (const film of order) drawSheet(view, room.films[film], images[film], 1, true);
    lamps[picture].forEach((lamp) => drawLamp(view, scene, lamp, true));
  };
}

/** A picture of each film before light, clear where it is: its row 0 is the top, as of corners 3 and 2. */
function imagesOf({ shape: [count, ny, nx] }, films) {
  return Array.from({ length: count }, (_, film) => {
    const image = new ImageData(nx, ny);
    for (let row = 0; row < ny; row++) {
      for (let column = 0; column < nx; column++) {
        const at = 3 * ((film * ny + row) * nx + column);
        const through = [0, 1, 2].map((i) => Math.exp(-CLEARER * films[at + i]));
        const part = 1 - Math.min(...through);
        const colour = through.map((each) => 255 * encode(each, "srgb"));
        image.data.set([...colour, 255 * Math.min(1, 1.15 * part)], 4 * ((ny - 1 - row) * nx + column));
      }
    }
    const canvas = Object.assign(document.createElement("canvas"), { width: nx, height: ny });
    canvas.getContext("2d").putImageData(image, 0, 0);
    return canvas;
  });
}

/** Where the lamps of a picture are drawn: parallel light comes from some way off. */
function placesOf({ films, lamps }) {
  const high = films.reduce((most, film) => Math.max(most, film[0][2]), -Infinity);
  const wide = norm(sub(films[0][1], films[0][0]));
  return lamps.map(({ way, near }) => ({ way, near, place: near ? way : add([0, 0, high], scaled(unit(way), AWAY * wide)) }));
}

/** A function from places in the room to the canvas: seen from far away, so that what is parallel stays so. */
function seenFrom(canvas, bounds, azimuth, height, near) {
  const [around, above] = [azimuth, height].map((degrees) => (degrees * Math.PI) / 180);
  const right = [Math.cos(around), Math.sin(around), 0];
  const up = [-Math.sin(around) * Math.sin(above), Math.cos(around) * Math.sin(above), Math.cos(above)];
  const flat = bounds.map((point) => [dot(point, right), dot(point, up)]);
  const [low, high] = [Math.min, Math.max].map((most) => [0, 1].map((i) => most(...flat.map((point) => point[i]))));
  const [wide, tall] = [canvas.width * (1 - 2 * EDGE), canvas.height * (1 - HEAD - EDGE)];
  const scale = near * Math.min(wide / (high[0] - low[0]), tall / (high[1] - low[1]));
  const middle = [canvas.width / 2, canvas.height * (HEAD + (1 - HEAD - EDGE) / 2)];
  const centre = [0, 1].map((i) => (low[i] + high[i]) / 2);
  return (point) => [middle[0] + scale * (dot(point, right) - centre[0]), middle[1] - scale * (dot(point, up) - centre[1])];
}

function drawGround({ context, canvas, colours, seen }, solid) {
  const at = seen([0, 0, Math.min(...solid.map((point) => point[2]))]);
  const rings = context.createRadialGradient(at[0], at[1], 0, at[0], at[1], 0.75 * Math.max(canvas.width, canvas.height));
  colours.ground.forEach((colour, i) => rings.addColorStop(i, colour));
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.fillStyle = rings;
  context.fillRect(0, 0, canvas.width, canvas.height);
  const low = Math.min(...solid.map((point) => point[2]));
  const level = solid.filter((point) => point[2] < low + 1e-6);
  const [left, right, near, far] = [[0, Math.min], [0, Math.max], [1, Math.min], [1, Math.max]].map(([i, most]) => most(...level.map((p) => p[i])));
  const rim = 0.05 * (right - left);
  trace(context, [[left - rim, near - rim, low], [right + rim, near - rim, low], [right + rim, far + rim, low], [left - rim, far + rim, low]].map(seen));
  context.fillStyle = colours.paper;
  context.fill();
}

function trace(context, points) {
  context.beginPath();
  points.forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.closePath();
}

/** An image on a sheet whose corners are given: of films from the lower left, of paper from the upper left on. */
function drawSheet({ context, colours, seen }, corners, image, part, isFilm) {
  const at = (isFilm ? [corners[3], corners[2], corners[0]] : [corners[0], corners[1], corners[3]]).map(seen);
  const [wide, high] = [image.width, image.height];
  const across = [0, 1].map((i) => (at[1][i] - at[0][i]) / wide);
  const down = [0, 1].map((i) => (at[2][i] - at[0][i]) / high);
  context.setTransform(...across, ...down, ...at[0]);
  context.imageSmoothingEnabled = !isFilm;
  context.globalAlpha = part;
  context.drawImage(image, 0, 0);
  context.globalAlpha = 1;
  context.setTransform(1, 0, 0, 1, 0, 0);
  if (!isFilm) return;
  trace(context, corners.map(seen));
  context.fillStyle = `rgba(${colours.edge}, 0.04)`;
  context.fill();
  context.strokeStyle = `rgba(${colours.edge}, 0.85)`;
  context.lineWidth = 1.4 * density(context.canvas);
  context.stroke();
}

function density(canvas) {
  return canvas.width / (canvas.clientWidth || canvas.width);
}

/** Light from the lamps to the corners of the picture: bright above the films, faint below. */
function drawBeam({ context, colours, seen }, { films, paper }, lamps) {
  const high = films.reduce((most, film) => Math.max(most, film[0][2]), -Infinity);
  for (const { way, near, place } of lamps) {
    const top = paper.map((corner) => {
      const slope = near ? sub(way, corner) : way;
      const up = place[2] - corner[2];
      return add(corner, scaled(slope, up / slope[2]));
    });
    const middle = [0, 1, 2].map((i) => top.reduce((sum, corner) => sum + corner[i], 0) / 4);
    const [from, to] = [seen(middle), seen([0, 0, high])];
    const fades = context.createLinearGradient(...from, ...to);
    [0.04, 0.3].forEach((part, i) => fades.addColorStop(i, `rgba(${colours.beam}, ${part})`));
    context.globalCompositeOperation = "lighter";
    for (let i = 0; i < 4; i++) {
      const next = (i + 1) % 4;
      trace(context, [paper[i], paper[next], top[next], top[i]].map(seen));
      context.fillStyle = fades;
      context.globalAlpha = 0.5;
      context.fill();
    }
    context.globalAlpha = 1;
    context.globalCompositeOperation = "source-over";
  }
}

function drawLamp({ context, canvas, colours, seen }, { room }, { place }, lit) {
  const [x, y] = seen(place);
  const wide = norm(sub(room[0].films[0][1], room[0].films[0][0]));
  const [from, to] = [[0, 0, 0], [wide, 0, 0]].map(seen);
  const radius = Math.max(RADIUS * Math.hypot(to[0] - from[0], to[1] - from[1]), 4 * density(canvas));
  if (lit) {
    const halo = context.createRadialGradient(x, y, 0, x, y, 5 * radius);
    [0.7, 0.2, 0.05, 0].forEach((part, i) => halo.addColorStop(i / 3, `rgba(${colours.beam}, ${part})`));
    context.fillStyle = halo;
    context.beginPath();
    context.arc(x, y, 5 * radius, 0, 2 * Math.PI);
    context.fill();
  }
  context.fillStyle = lit ? colours.lamp : "rgba(150, 154, 162, 0.5)";
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}
