// The room on its canvas: which renderer draws it, from where it is seen, and what one points at in it.

import { JUDGED, QUICK, THIN } from "../model/area.js";
import { partOf } from "../model/lesson.js";
import { exposures, standing } from "../model/stage.js";
import { wordsOf } from "../model/words.js";
import { clampTo, element, fitCanvas } from "../tools/elements.js";
import { add, norm, scaled, sub } from "../tools/vectors.js";
import { HIGHEST, LOWEST, between, cameraOf, eyeOf, fitted, lampsOrbit, middleOfPixel, orbitFrom } from "./camera.js";
import { pointed, rayAt, seenAt } from "./camera.js";
import { createFlat } from "./flat.js";
import { roomsAround, screenCorners } from "./furniture.js";
import { createRenderer } from "./gpu.js";

/** Degrees that the eye moves by for a pixel. */
const EYE_SPEED = 0.3;
/** How far the eye may go, in parts of the distance at which all is seen. */
const [NEAREST, FARTHEST] = [0.2, 3];
/** Above the room at most such a part of its height stays free for the title. */
const MOST_HEAD = 0.2;
/** Seconds that the eye takes to the lamp. */
const TO_THE_LAMP = 1.4;
/** Parts along the longer side of a shadow at most: all browsers have textures of twice as many. */
const MOST_PARTS = 1024;

/**
 * The room, drawn by WebGL2 or, where there is none, plainly.
 *
 * @param {Object} scene
 * @param {Object} cube
 */
export class RoomView {
  constructor(scene, cube) {
    Object.assign(this, { scene, cube, box: null });
    const { canvas, renderer, note } = rendererFor(scene, cube);
    Object.assign(this, { canvas, renderer, note });
    this.comeBack();
    this.bases = {};
    this.atLamp = 0; // how far the eye is on its way there, 0..1
    this.head = () => 0; // the part of the canvas's height that something above it covers
  }

  /**
   * Cast the shadows of an angle, at a step of the tour under its light and through its glass: of the whole turntable's shadow or of its picture window, by thin beams or by all of a
   * pixel's light; more finely where things are `still`, and then in parts of pixels where one has come near.
   */
  aim(angle, { whole, thin, lesson }, still) {
    const filled = this.fill(lesson?.box ?? null);
    const lamp = lesson?.lamp;
    const turned = filled || this.angle !== angle || this.whole !== whole || this.lamp !== lamp;
    if (turned) {
      Object.assign(this, { angle, whole, lamp });
      this.exposures = exposures(this.scene, angle, whole, lamp);
      this.room = standing(this.scene, angle, whole, lamp);
    }
    const beams = thin ? THIN : still ? JUDGED : QUICK;
    const parts = thin ? 1 : this.partsSeen();
    const finer = still && (this.beams !== beams || this.parts !== parts);
    if (!turned && !finer && thin === (this.beams === THIN)) return; // while the eye moves what was cast stays
    Object.assign(this, { beams, parts });
    this.renderer.cast(this.exposures, beams, parts);
  }

  /** Let all glass outside of a box be clear, or none of it (null); returns whether that changes anything. */
  fill(box) {
    if (this.box === box) return false;
    this.box = box;
    this.renderer.fill(box === null ? this.cube : partOf(this.cube, box));
    return true;
  }

  /** Parts along a pixel's side that look as large as a whole pixel does from where the eye began. */
  partsSeen() {
    const [began, now] = [eyeOf(this.base()), this.camera().eye];
    const nearer = this.room.screens.map((screen) => {
      const middle = scaled(screenCorners(screen).reduce(add), 1 / 4);
      return norm(sub(began, middle)) / norm(sub(now, middle));
    });
    const most = Math.floor(MOST_PARTS / Math.max(...this.exposures[0].raster));
    return clampTo(Math.round(Math.max(...nearer)), 1, Math.max(1, most));
  }

  /** Draw at a part of the full resolution; `mark` is the pixel that is pointed at, or null. */
  draw(dark, mark, scale) {
    fitCanvas(this.canvas);
    this.renderer.draw(this.room, this.camera(), { dark, mark, scale, bare: soft(this.atLamp) });
  }

  /** Go on towards the lamp's eye, or back from it, for some seconds, or at once; returns whether there is way left. */
  look(seconds, lampsEye, atOnce) {
    const goal = lampsEye ? 1 : 0;
    const step = atOnce ? 1 : seconds / TO_THE_LAMP;
    this.atLamp += clampTo(goal - this.atLamp, -step, step);
    return this.atLamp !== goal;
  }

  /** Where a screen's corners are seen, from the upper left around, 0..1 from the canvas's upper left. */
  cornersSeen(place) {
    const camera = this.camera();
    return screenCorners(this.room.screens[place]).map((corner) => seenAt(camera, corner)).map(({ x, y }) => [x, y]);
  }

  /** Move the eye around the room by pixels of a drag. */
  moveEye(across, down) {
    this.away.azimuth -= EYE_SPEED * across;
    const { height } = this.base();
    this.away.height = clampTo(height + this.away.height + EYE_SPEED * down, LOWEST, HIGHEST) - height;
  }

  /** Go nearer (factor above 1), to a pixel {screen, row, column} or to the middle, or farther, back from where one is. */
  zoom(factor, pixel) {
    const { far, aside } = this.away;
    this.away.far = clampTo(far / factor, NEAREST, FARTHEST);
    const [before, after] = [far, this.away.far].map((each) => Math.min(each, 1)); // farther, one looks at the middle
    if (after > before) this.away.aside = scaled(aside, (1 - after) / (1 - before));
    else if (pixel !== null) {
      const way = sub(middleOfPixel(this.room, pixel), add(this.base().target, aside));
      this.away.aside = add(aside, scaled(way, 1 - after / before)); // so that the pixel stays where it is seen
    }
  }

  /** Put the eye back where it began. */
  comeBack() {
    this.away = { azimuth: 0, height: 0, far: 1, aside: [0, 0, 0] };
  }

  /** What a place on the canvas (0..1 from its upper left) lies on: {screen, row, column}, or null. */
  pointed(x, y) {
    return pointed(this.room, rayAt(this.camera(), x, y));
  }

  /** Copy the shadow on a screen, by its place in the list, into a canvas. */
  copyShadow(place, canvas) {
    const [rows, columns] = this.exposures[place].window;
    if (canvas.width !== columns || canvas.height !== rows) Object.assign(canvas, { width: columns, height: rows });
    this.renderer.drawShadow(place, canvas);
  }

  /** The eye, where it has been moved to. */
  camera() {
    return cameraOf(this.orbit(), this.aspect());
  }

  orbit() {
    const own = this.ownOrbit();
    return this.atLamp === 0 ? own : between(own, lampsOrbit(this.scene, this.exposures, this.room), soft(this.atLamp));
  }

  ownOrbit() {
    const [base, { azimuth, height, far, aside }] = [this.base(), this.away];
    return {
      ...base,
      azimuth: base.azimuth + azimuth,
      height: base.height + height,
      distance: base.distance * far,
      target: add(base.target, aside),
    };
  }

  /** The eye that sees everything on a canvas of this shape. */
  base() {
    const head = Math.min(this.head(), MOST_HEAD);
    const key = `${this.whole} ${this.aspect().toFixed(3)} ${head.toFixed(3)}`;
    if (!(key in this.bases)) {
      const rooms = roomsAround(this.scene, this.whole);
      this.bases = { [key]: fitted(orbitFrom(this.scene.camera), this.scene, rooms, this.aspect(), head) };
    }
    return this.bases[key];
  }

  aspect() {
    return Math.max(1, this.canvas.clientWidth) / Math.max(1, this.canvas.clientHeight);
  }

  dispose() {
    this.renderer.dispose();
  }
}

/** Begin and end softly: 0..1 to 0..1. */
function soft(part) {
  return part * part * (3 - 2 * part);
}

/** A canvas with its renderer, and a sentence for people where it is not WebGL2 that draws. */
function rendererFor(scene, cube) {
  const canvas = newCanvas(scene);
  try {
    return { canvas, renderer: createRenderer(canvas, scene, cube), note: null };
  } catch (error) {
    // a canvas that has been asked for WebGL2 may not give another context
    const plain = newCanvas(scene);
    const note = `${error.message} The room is drawn more plainly.`;
    return { canvas: plain, renderer: createFlat(plain, scene, cube), note };
  }
}

function newCanvas(scene) {
  return element("canvas", { class: "room", tabindex: 0, role: "img", "aria-label": `The ${wordsOf(scene).name} in its room` });
}
