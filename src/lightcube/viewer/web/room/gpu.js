// The renderer on WebGL2: exact shadows into textures, and the room with the cube as coloured glass, or with a shape's body.

import { pointsOf } from "../model/area.js";
import { bodyOf } from "../model/body.js";
import { add, apply, applyInverse, cross, dot, norm, scaled, sub, unit } from "../tools/vectors.js";
import { beforeEye, seenAt } from "./camera.js";
import { isCutRound } from "./clearbody.js";
import { TONES, floorOf, fromFar, halfSides, lampOfEye, lampRadius, lampsLighting } from "./furniture.js";
import { linesOf, longestSide, markedSheet, pureColour, tableOf, wallWidth } from "./furniture.js";
import { EVERYWHERE, MOST_BEAMS, castProgram, roomProgram } from "./shaders.js";

/** What is infinite, in single precision. */
const NEVER = 1e30;
/** As in the tie rule: parts of directions, and distances from a face in voxel sides, below which they are zero. */
const PARALLEL = 1e-12;
const ON_FACE = 1e-9;
/** Texture units. */
const [VOXEL_UNIT, VIEW_UNIT, SHADOW_UNIT, BODY_UNIT] = [0, 1, 2, 3];
/** Screens, lamps and lines that are drawn at most: as many as the room's program has room for. */
const MOST_THINGS = 256;
/** Rays that are cast at once: systems end programs that compute for seconds. */
const MOST_RAYS = 2 ** 20;

/**
 * A renderer that computes shadows and draws the room on a canvas.
 *
 * `cast(exposures, beams, parts)` computes the shadows of all screens, of `beams` as `pointsOf` takes them, with so many
 * `parts` along a pixel's side in the room; `fill(cube)` puts other glass of the same size there, for what is cast next;
 * `shadow(number)` reads one's whole pixels back as {rows, columns, pixels},
 * RGBA from the upper left; `drawShadow(number, canvas)` copies them into another canvas of that size;
 * `draw(room, camera, {dark, mark, scale})` draws the room at a part of the canvas's resolution. The drawing context
 * may be lost and come back: then everything is made again, and `onRestored` called.
 * @param {HTMLCanvasElement} canvas
 * @param {object} scene
 * @param {object} cube
 * @returns {{kind: string, onRestored: function | null, cast: function, shadow: function, drawShadow: function,
 *   draw: function, dispose: function}}
 */
export function createRenderer(canvas, scene, cube) {
  const gl = canvas.getContext("webgl2", { alpha: false, antialias: false, depth: false });
  if (!gl) throw new Error("This browser does not offer WebGL 2.");
  const longest = gl.getParameter(gl.MAX_3D_TEXTURE_SIZE);
  if (Math.max(...cube.shape) > longest) {
    const most = Math.max(...cube.shape);
    throw new Error(`The cube has ${most} voxels along a side, more than the ${longest} that this browser draws.`);
  }
  const floor = floorOf(scene);
  let [kit, shown] = [makeKit(gl, scene, cube), { exposures: [], beams: null, parts: 1 }];
  const renderer = {
    kind: "webgl2",
    onRestored: null,
    cast(exposures, beams, parts) {
      shown = { exposures, beams, parts };
      castAll(kit, scene, cube, shown);
    },
    fill(glass) {
      cube = glass;
      uploadVoxels(kit, cube);
    },
    shadow: (number) => readShadow(kit, cube, shown, number),
    drawShadow(number, target) {
      const { rows, columns, pixels } = readShadow(kit, cube, shown, number);
      target.getContext("2d").putImageData(new ImageData(pixels, columns, rows), 0, 0);
    },
    draw: (room, camera, look) => drawRoom(kit, { scene, floor: floor(room), room, camera, ...shown, ...look }),
    dispose() {
      canvas.removeEventListener("webglcontextlost", lost);
      canvas.removeEventListener("webglcontextrestored", restored);
      gl.getExtension("WEBGL_lose_context")?.loseContext();
    },
  };
  const lost = (event) => event.preventDefault(); // else it would not come back
  const restored = () => {
    kit = makeKit(gl, scene, cube);
    castAll(kit, scene, cube, shown);
    renderer.onRestored?.();
  };
  canvas.addEventListener("webglcontextlost", lost);
  canvas.addEventListener("webglcontextrestored", restored);
  return renderer;
}

/** All that lives on the graphics processor. */
function makeKit(gl, scene, cube) {
  const kit = {
    gl,
    caster: makeProgram(gl, castProgram(scene.glass)),
    painter: makeProgram(gl, roomProgram(scene.solid, isCutRound(scene))),
    voxels: makeTexture(gl, gl.TEXTURE_3D, VOXEL_UNIT, gl.NEAREST),
    shadows: null,
    layers: "",
    target: gl.createFramebuffer(),
    views: makeTexture(gl, gl.TEXTURE_2D, VIEW_UNIT, gl.NEAREST),
    things: gl.createBuffer(),
    small: { frame: gl.createFramebuffer(), texture: null, size: "" },
    picture: { frame: gl.createFramebuffer(), texture: null, size: "" },
  };
  uploadVoxels(kit, cube);
  const { rates, least, voxel_mm } = scene.voxels;
  for (const program of [kit.caster, kit.painter]) {
    gl.useProgram(program.made);
    gl.uniform1i(program.at("voxels"), VOXEL_UNIT);
    gl.uniform3fv(program.at("rates"), [0, 1, 2].map((i) => rates[rates.length === 1 ? 0 : i] / Math.LN2));
    gl.uniform1f(program.at("least"), least * voxel_mm);
  }
  gl.useProgram(kit.caster.made);
  gl.uniform1i(kit.caster.at("views"), VIEW_UNIT);
  gl.uniform1i(kit.caster.at("linear"), scene.transfer === "linear" ? 1 : 0);
  if (scene.glass) setGlass(gl, kit.caster, scene);
  gl.useProgram(kit.painter.made);
  gl.uniform1i(kit.painter.at("shadows"), SHADOW_UNIT);
  if (scene.solid) uploadBody(kit, bodyOf(cube));
  gl.uniformBlockBinding(kit.painter.made, gl.getUniformBlockIndex(kit.painter.made, "Things"), 0);
  gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, kit.things);
  gl.bufferData(gl.UNIFORM_BUFFER, 64 * MOST_THINGS, gl.DYNAMIC_DRAW);
  return kit;
}

/** The clear body, in voxel sides; what is endless is higher than anything. */
function setGlass(gl, caster, { glass, voxels }) {
  gl.uniform3fv(caster.at("body"), glass.half.map((side) => (side === null ? NEVER : side / voxels.voxel_mm)));
  gl.uniform1i(caster.at("blocked"), glass.blocked ? 1 : 0);
}

/** Codes of 10 bits take four bytes a voxel; longer ones take six, in the browser, and often eight on the card. */
function uploadVoxels({ gl }, { shape, bits, codes }) {
  const size = [shape[2], shape[1], shape[0], 0];
  gl.activeTexture(gl.TEXTURE0 + VOXEL_UNIT); // where it stays bound
  if (bits > 10) {
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 2); // rows of an odd number of voxels
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGB16UI, ...size, gl.RGB_INTEGER, gl.UNSIGNED_SHORT, codes);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    return;
  }
  const texels = new Uint32Array(codes.length / 3);
  for (let i = 0; i < texels.length; i++) texels[i] = codes[3 * i] | (codes[3 * i + 1] << 10) | (codes[3 * i + 2] << 20);
  const kind = [gl.RGBA_INTEGER, gl.UNSIGNED_INT_2_10_10_10_REV];
  gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGB10_A2UI, ...size, ...kind, texels);
}

/** The body of an opaque shape, for the painter. */
function uploadBody({ gl, painter }, { shape, levels }) {
  makeTexture(gl, gl.TEXTURE_3D, BODY_UNIT, gl.LINEAR); // it stays bound there
  gl.texParameteri(gl.TEXTURE_3D, gl.TEXTURE_WRAP_R, gl.CLAMP_TO_EDGE);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage3D(gl.TEXTURE_3D, 0, gl.R8, shape[2], shape[1], shape[0], 0, gl.RED, gl.UNSIGNED_BYTE, levels);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
  gl.uniform1i(painter.at("body"), BODY_UNIT);
}

function makeProgram(gl, fragments) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, EVERYWHERE], [gl.FRAGMENT_SHADER, fragments]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS) && !gl.isContextLost()) {
    const said = gl.getAttachedShaders(made).map((shader) => gl.getShaderInfoLog(shader)).join(" ");
    throw new Error(`This machine's graphics refuse the page's programs: ${said}${gl.getProgramInfoLog(made)}`);
  }
  const places = {};
  return { made, at: (name) => (places[name] ??= gl.getUniformLocation(made, name)) };
}

function makeTexture(gl, kind, place, filter, smaller = filter) {
  const texture = gl.createTexture();
  gl.activeTexture(gl.TEXTURE0 + place);
  gl.bindTexture(kind, texture);
  gl.texParameteri(kind, gl.TEXTURE_MAG_FILTER, filter);
  gl.texParameteri(kind, gl.TEXTURE_MIN_FILTER, smaller);
  for (const axis of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(kind, axis, gl.CLAMP_TO_EDGE);
  return texture;
}

/** Make room for the shadows: a layer of each screen. */
function makeLayers(kit, rows, columns, count) {
  const layers = `${rows} ${columns} ${count}`;
  if (kit.layers === layers) return;
  const { gl } = kit;
  gl.deleteTexture(kit.shadows);
  kit.shadows = makeTexture(gl, gl.TEXTURE_2D_ARRAY, SHADOW_UNIT, gl.LINEAR, gl.LINEAR_MIPMAP_LINEAR);
  const levels = 1 + Math.floor(Math.log2(Math.max(rows, columns)));
  gl.texStorage3D(gl.TEXTURE_2D_ARRAY, levels, gl.RGBA8, columns, rows, count);
  kit.layers = layers;
}

function castAll(kit, scene, cube, { exposures, beams, parts }) {
  const { gl } = kit;
  if (exposures.length === 0 || gl.isContextLost()) return;
  const [rows, columns] = exposures[0].raster;
  makeLayers(kit, rows * parts, columns * parts, exposures.length);
  uploadViews(kit, scene, exposures.flatMap((exposure) => exposure.views), rows, columns);
  gl.bindFramebuffer(gl.FRAMEBUFFER, kit.target);
  exposures.forEach((_, number) => {
    gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, kit.shadows, 0, number);
    castOne(kit, cube, exposures, number, beams, parts);
  });
  gl.activeTexture(gl.TEXTURE0 + SHADOW_UNIT);
  gl.generateMipmap(gl.TEXTURE_2D_ARRAY);
}

/** Cast a screen's shadow into what is bound, some rows at a time. */
function castOne({ gl, caster }, cube, exposures, number, beams, parts) {
  const { window, raster, views } = exposures[number];
  const points = pointsOf(cube, exposures[number], beams, parts);
  const first = exposures.slice(0, number).reduce((sum, exposure) => sum + exposure.views.length, 0);
  gl.useProgram(caster.made);
  gl.uniform2i(caster.at("raster"), raster[1], raster[0]);
  gl.uniform2i(caster.at("window"), window[1], window[0]);
  gl.uniform2i(caster.at("range"), first, first + views.length);
  gl.uniform1i(caster.at("parts"), parts);
  gl.uniform1i(caster.at("beams"), points.length);
  gl.uniform2fv(caster.at("points"), points.flat());
  const [rows, columns] = raster.map((count) => count * parts);
  gl.viewport(0, 0, columns, rows);
  gl.enable(gl.SCISSOR_TEST);
  const high = Math.max(1, Math.floor(MOST_RAYS / (columns * points.length * views.length)));
  for (let row = 0; row < rows; row += high) {
    gl.scissor(0, row, columns, high);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
  gl.disable(gl.SCISSOR_TEST);
}

/** A table of the views, five rows of texels for each. */
function uploadViews({ gl, views: table }, scene, views, rows, columns) {
  const width = Math.max(rows, columns, 8);
  const numbers = new Float32Array(20 * width * views.length);
  views.forEach((view, i) => {
    const put = (row, texel, values) => numbers.set(values, 4 * ((5 * i + row) * width + texel));
    putBeams(put, scene, inVoxels(view, scene.voxels.voxel_mm), rows, columns);
  });
  gl.activeTexture(gl.TEXTURE0 + VIEW_UNIT);
  gl.bindTexture(gl.TEXTURE_2D, table);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, 5 * views.length, 0, gl.RGBA, gl.FLOAT, numbers);
}

/** A view with all lengths in voxel sides, and nothing infinite. */
function inVoxels(view, voxel_mm) {
  const [lamp, origin, right, down] = [view.light.slice(0, 3), view.origin, view.right, view.down].map((each) =>
    scaled(each, 1 / voxel_mm),
  );
  const [reach, falloff, [fullAt]] = [view.reach_mm, view.falloff_mm, [view.full_at_mm]].map((lengths) =>
    lengths.map((length) => Math.min(length / voxel_mm, NEVER)),
  );
  return { ...view, lamp, origin, right, down, reach, falloff, fullAt, point: view.light[3] !== 0 };
}

/**
 * One view's rows: where its rays start, as the sum of a column's and a row's part, each a whole number of voxel sides
 * (rows 0 and 2) and a small rest (1 and 3); then its light and its screen, and how its rays go on across and down.
 *
 * Rays start near the cube's middle, where parallel light is nearest to it, and where a point lamp's light passes a
 * plane that is parallel to the screen: there too the starts lie on a raster.
 */
function putBeams(put, scene, view, rows, columns) {
  const half = halfSides(scene).map((side) => side / scene.voxels.voxel_mm);
  const { point, lamp, origin, right, down } = view;
  const normal = unit(cross(right, down));
  const way = unit(lamp).map((part) => nearZero(part, PARALLEL));
  const nearness = point ? towardsMiddle(lamp, origin, normal) : 1;
  const moved = (vector) => (point ? scaled(vector, nearness) : sub(vector, scaled(way, dot(vector, way))));
  const start = add(half, point ? add(lamp, scaled(sub(origin, lamp), nearness)) : moved(origin));
  const putPlace = (row, texel, place) => {
    const whole = place.map(Math.round);
    put(row, texel, whole);
    put(row + 1, texel, sub(place, whole).map((rest) => nearZero(rest, ON_FACE)));
  };
  for (let i = 0; i < columns; i++) putPlace(0, i, add(start, scaled(moved(right), i - (columns - 1) / 2)));
  for (let i = 0; i < rows; i++) putPlace(2, i, scaled(moved(down), i - (rows - 1) / 2));
  const stood = add(lamp, half);
  const whole = stood.map(Math.round);
  put(4, 0, point ? [...whole, 1] : [...way, 0]);
  put(4, 1, [...sub(stood, whole).map((rest) => nearZero(rest, ON_FACE)), 1 / nearness]);
  put(4, 2, [...view.power, view.cosine ? 1 : 0]);
  put(4, 3, [view.reach[0], view.falloff[0], view.reach[1], view.falloff[1]]);
  put(4, 4, [...normal, view.fullAt]);
  put(4, 5, [dot(way, origin), dot(way, right), dot(way, down), view.glass?.ior ?? 1]);
  put(4, 6, [...moved(right), view.veil, ...moved(down), 0]);
}

/** The part of the way from a lamp to the screen at which a plane parallel to that passes the cube's middle. */
function towardsMiddle(lamp, origin, normal) {
  const part = -dot(lamp, normal) / dot(sub(origin, lamp), normal);
  return part > 0.01 && part < 100 ? part : 1;
}

function nearZero(value, least) {
  return Math.abs(value) < least ? 0 : value;
}

/** The pixels of a screen: its layer, or where that has parts of them, cast again. */
function readShadow(kit, cube, { exposures, beams, parts }, number) {
  const { gl } = kit;
  const { window: [rows, columns], raster } = exposures[number];
  const pixels = new Uint8ClampedArray(4 * rows * columns);
  if (gl.isContextLost()) return { rows, columns, pixels };
  if (parts === 1) {
    gl.bindFramebuffer(gl.FRAMEBUFFER, kit.target);
    gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, kit.shadows, 0, number);
  } else {
    bindTarget(gl, kit.picture, raster[1], raster[0]);
    castOne(kit, cube, exposures, number, beams, 1);
  }
  gl.readPixels(0, 0, columns, rows, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return { rows, columns, pixels };
}

function drawRoom(kit, seen) {
  const { gl, painter, small } = kit;
  const { canvas } = gl;
  if (gl.isContextLost() || !kit.shadows || canvas.width * canvas.height === 0) return;
  const part = Math.min(seen.scale ?? 1, 1);
  const [width, height] = [canvas.width, canvas.height].map((side) => Math.max(1, Math.round(side * part)));
  const dense = width / (canvas.clientWidth || canvas.width); // pixels to a pixel of the page
  const { counts, numbers } = thingTable(seen, width, height, dense);
  gl.bufferSubData(gl.UNIFORM_BUFFER, 0, numbers);
  gl.useProgram(painter.made);
  setSight(gl, painter, seen, width, height);
  setThings(gl, painter, seen, counts);
  if (part < 1) bindTarget(gl, small, width, height, gl.RGB8); // as the canvas: for another kind it is compiled anew
  else gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.viewport(0, 0, width, height);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  if (part === 1) return;
  gl.bindFramebuffer(gl.READ_FRAMEBUFFER, small.frame);
  gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
  gl.blitFramebuffer(0, 0, width, height, 0, 0, canvas.width, canvas.height, gl.COLOR_BUFFER_BIT, gl.LINEAR);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
}

/** Draw into a picture of some size that nobody sees. */
function bindTarget(gl, target, width, height, kind = gl.RGBA8) {
  const size = `${width} ${height}`;
  gl.bindFramebuffer(gl.FRAMEBUFFER, target.frame);
  if (target.size === size) return;
  gl.deleteRenderbuffer(target.texture);
  target.texture = gl.createRenderbuffer();
  target.size = size;
  gl.bindRenderbuffer(gl.RENDERBUFFER, target.texture);
  gl.renderbufferStorage(gl.RENDERBUFFER, kind, width, height);
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, target.texture);
}

/** From where the room is seen, and where the cube is. */
function setSight(gl, painter, { scene, room, camera, floor }, width, height) {
  const { eye, right, up, ahead, across, tall } = camera;
  const { voxel_mm } = scene.voxels;
  const inside = add(scaled(applyInverse(room.turn, eye), 1 / voxel_mm), scaled(halfSides(scene), 1 / voxel_mm));
  const whole = inside.map(Math.round);
  gl.uniform2f(painter.at("canvas"), width, height);
  gl.uniformMatrix3fv(painter.at("sight"), false, [...scaled(right, across), ...scaled(up, tall), ...ahead]);
  // row by row in `turn` is column by column of its transpose
  gl.uniformMatrix3fv(painter.at("inCube"), false, room.turn.map((each) => each / voxel_mm));
  gl.uniform3iv(painter.at("eyeWhole"), whole);
  gl.uniform3fv(painter.at("eyeRest"), sub(inside, whole));
  gl.uniform3fv(painter.at("middle"), scaled(eye, -1));
  gl.uniform3fv(painter.at("ground"), sub([0, 0, floor], eye));
  gl.uniform1f(painter.at("unit"), longestSide(scene));
}

/** What stands in the room, in which colours. */
function setThings(gl, painter, { scene, exposures, parts, room, camera, dark, mark, bare = 0 }, counts) {
  const tones = TONES[dark ? "dark" : "light"];
  const { middle, right, down } = tableOf(scene, room);
  gl.uniform1f(painter.at("parts"), parts);
  gl.uniform3iv(painter.at("counts"), counts);
  gl.uniformMatrix3fv(painter.at("table"), false, [...sub(middle, camera.eye), ...right, ...down]);
  gl.uniform3fv(painter.at("foot"), footOf(scene, room, right, down));
  for (const name of ["floor", "far", "grid", "table", "rim", "wall", "back", "off", "mark", ...(scene.solid ? ["body"] : [])]) {
    gl.uniform3fv(painter.at(`${name}Tone`), tones[name]);
  }
  gl.uniform1f(painter.at("shade"), tones.shade);
  gl.uniform1f(painter.at("glow"), tones.glow);
  const lit = room.lamps.reduce((sum, { light }) => add(sum, light), [0, 0, 0]);
  gl.uniform3fv(painter.at("emberTone"), scaled(pureColour(lit) ?? [0, 0, 0], tones.ember));
  gl.uniform1f(painter.at("bare"), bare);
  gl.uniform3fv(painter.at("bareTone"), lampOfEye(scene, exposures, room).light);
  setBeams(gl, painter, scene, exposures, room, camera.eye);
  const sheet = markedSheet(scene, exposures, room, mark);
  gl.uniform1i(painter.at("sheetKind"), sheet ? sheet.kind : 0);
  if (sheet) gl.uniformMatrix3fv(painter.at("sheet"), false, [...sub(sheet.corner, camera.eye), ...sheet.sides.flat()]);
}

/** The light of each screen's brightest lamp, in the order in which screens are drawn. */
function setBeams(gl, painter, scene, exposures, room, eye) {
  const [ways, tones] = [new Float32Array(4 * MOST_BEAMS), new Float32Array(3 * MOST_BEAMS)];
  fromFar(room, eye).slice(0, MOST_BEAMS).forEach(({ number }, i) => {
    const [brightest] = lampsLighting(scene, exposures[number]).map((lamp) => room.lamps[lamp]);
    if (brightest === undefined || scene.glass) return; // its light is drawn in lines
    const { place, parallel, light } = brightest;
    ways.set(parallel ? [...scaled(unit(place), -longestSide(scene)), 0] : [...sub(place, eye), 1], 4 * i);
    tones.set(pureColour(light), 3 * i);
  });
  gl.uniform4fv(painter.at("beams"), ways);
  gl.uniform3fv(painter.at("beamTones"), tones);
}

/** What the cube covers of the disc, in its radii; it shades it where it stands upright. */
function footOf(scene, room, right, down) {
  const half = halfSides(scene);
  const sides = [0, 1, 2].map((axis) => apply(room.turn, [0, 1, 2].map((i) => (i === axis ? half[axis] : 0))));
  const shares = (step) => sides.map((side) => Math.abs(dot(side, step)) / dot(step, step));
  const reach = [right, down].map((step) => Math.max(...shares(step)));
  const upright = sides.filter((side) => Math.abs(dot(side, room.axis)) < 1e-6 * norm(side)).length === 2;
  return [...reach, upright ? 0.5 : 0];
}

/** Screens (from far to near), lamps and lines, four texels each, places seen from the eye. */
function thingTable({ scene, exposures, room, camera, dark, mark }, width, height, dense) {
  const seen = (point) => {
    const { x, y, depth } = seenAt(camera, point);
    return [x * width, (1 - y) * height, 1 / depth];
  };
  const near = 1e-3 * longestSide(scene);
  const screens = screenRows(scene, room, camera.eye);
  const lamps = room.lamps.map((lamp) => lampRow(scene, lamp, camera, seen, height));
  const lines = linesOf(scene, exposures, room, camera.eye, mark, TONES[dark ? "dark" : "light"])
    .map((line) => ({ ...line, ends: beforeEye(camera, line.ends, near) }))
    .filter((line) => line.ends !== null)
    .map((line) => lineRow(line, seen, dense));
  let left = MOST_THINGS;
  const drawn = [screens, lamps, lines].map((things) => {
    const kept = things.slice(0, left);
    left -= kept.length;
    return kept;
  });
  return { counts: drawn.map((things) => things.length), numbers: new Float32Array(drawn.flat(2)) };
}

function screenRows(scene, room, eye) {
  return fromFar(room, eye).map(({ corner, right, down, pixels, facing, number }) => [
    ...[...sub(corner, eye), pixels[0]],
    ...[...right, pixels[1]],
    ...[...down, number],
    ...[...facing, wallWidth(scene, { right, pixels })],
  ]);
}

function lampRow(scene, { place, light }, camera, seen, height) {
  const at = seen(place);
  const pure = pureColour(light);
  const radius = Math.max((lampRadius(scene) * at[2] * height) / (2 * camera.tall), 2.5);
  return [...at, radius, ...(pure ?? light), pure ? 1 : 0, ...Array(8).fill(0)];
}

function lineRow({ ends, colour, parts, width, over }, seen, dense) {
  const [start, end] = ends.map(seen);
  const thin = Math.min(width * dense, 1); // lines thinner than a pixel are fainter instead
  const broad = Math.max(width * dense, 1);
  return [...start, broad, ...end, over ? 1 : 0, ...colour, thin * parts[0], thin * parts[1], 0, 0, 0];
}
