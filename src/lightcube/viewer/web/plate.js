// Puts a relief's page together: the plate, the lamp that goes round, and what it shows from above.

import { blurred, columnsLit, lampsOf, levelsOf, pixelsLit } from "./model/relief.js";
import { nearestOf, neighbourOf, shortestWay, Turning } from "./model/turning.js";
import { createBeckoning } from "./parts/beckoning.js";
import { createFilmstrip } from "./parts/filmstrip.js";
import { listenToGestures } from "./parts/gestures.js";
import { listenToKeys } from "./parts/keys.js";
import { controlsOfPlate, headerOfPlate, helpOfPlate, hintOfPlate, quietOfPlate } from "./parts/lamp.js";
import { createLoop } from "./parts/loop.js";
import { createPair, createSeen } from "./parts/seen.js";
import { followTheme } from "./parts/theme.js";
import { createPlate } from "./room/plate.js";
import { clampTo, degreesText, element, fitCanvas, toggleFullScreen } from "./tools/elements.js";

/** Degrees by which a pixel of a drag turns the lamp, and lifts it. */
const [TURN_SPEED, LIFT_SPEED] = [0.5, 0.15];
/** How high a lamp may stand, degrees. */
const [LOWEST, HIGHEST] = [10, 80];
/** How far off its stop a lamp may stand that shows the picture of it, degrees. */
const HERE = 0.05;

/**
 * Build the page of a relief in an element.
 *
 * @param {HTMLElement} root is emptied; keeps what is returned as `root.lightcube` too
 * @param {Object} scene
 * @param {Float64Array} heights
 * @param {{compact: boolean, inside: boolean}} options compact: the plate, the controls and the film strip alone, for
 *   notebooks; inside: as `mount` of a cube
 * @returns {{angle: number, resting: boolean, turnTo: function(number): void, onTurn: function(function(number): void): void,
 *   light: function(): Uint8ClampedArray, dispose: function(): void}} as `mount` of a cube; `light` is what is seen from
 *   above, as levels
 */
export function mountRelief(root, scene, heights, { compact = false, inside = compact } = {}) {
  const stops = [...new Set(scene.pictures.map(({ angle_deg }) => angle_deg))].sort((a, b) => a - b);
  const turning = new Turning(stops, matchMedia("(prefers-reduced-motion: reduce)").matches);
  const chosen = { elevation: scene.elevation_deg, blur: "near", details: false, big: false, dark: null };
  const canvas = element("canvas", { class: "room", tabindex: 0, role: "img", "aria-label": "The plate under its lamp" });
  const app = { root, scene, heights, turning, chosen, canvas, compact, lit: null };
  app.does = actionsOf(app);
  app.parts = partsOf(app);
  app.loop = createLoop(...showing(app));
  const beckoning = compact ? null : createBeckoning(root, turning, app.loop.ask);
  app.rested = () => beckoning?.drawn();
  const theme = followTheme(root, inside, (dark) => {
    if (!app.ownTheme && chosen.dark !== dark) setTheme(app, dark);
  });
  const ends = [() => beckoning?.end(), theme, listenToKeys(inside ? root : document, app.does), listenTo(app)];
  root.classList.add("lightcube");
  root.classList.toggle("compact", compact);
  root.replaceChildren(...layoutOf(app.parts, canvas, compact)); // its new size asks for the first drawing
  root.lightcube = {
    get angle() {
      return turning.angle;
    },
    get resting() {
      return app.loop.resting;
    },
    turnTo: app.does.slide,
    onTurn: (callback) => (app.told = callback),
    light: () => app.levels,
    dispose() {
      ends.forEach((end) => end());
      app.loop.stop();
      root.replaceChildren();
    },
  };
  return root.lightcube;
}

/** What can be done, each ending with a new drawing. */
function actionsOf(app) {
  const { root, scene, turning, chosen } = app;
  const nearest = () => turning.glideTo(turning.stops[nearestOf(turning.stops, turning.angle)]);
  const switched = (name, attribute) => () => {
    chosen[name] = !chosen[name];
    root.toggleAttribute(attribute, chosen[name]);
  };
  const all = {
    turn: (degrees) => turning.push(degrees),
    release: (degreesPerSecond) => turning.release(degreesPerSecond),
    neighbour: (way) => turning.glideTo(turning.stops[neighbourOf(turning.stops, turning.angle, way)]),
    nearest,
    first: () => turning.glideTo(turning.stops[0]),
    picture: (number) => turning.glideTo(scene.pictures[number].angle_deg),
    play: () => (turning.playing ? turning.release(0) : turning.play()),
    speed: (factor) => (turning.speed = factor),
    slide: (angle) => turning.set(angle),
    slid: () => turning.release(0),
    snap() {
      turning.snap = !turning.snap;
      if (turning.snap && !turning.playing) nearest();
    },
    lift: (degrees) => (chosen.elevation = clampTo(chosen.elevation + degrees, LOWEST, HIGHEST)),
    right: () => (chosen.elevation = scene.elevation_deg),
    blur: (name) => (chosen.blur = name),
    details: switched("details", "data-details"),
    big: switched("big", "data-big"),
    theme() {
      app.ownTheme = true;
      setTheme(app, !chosen.dark);
    },
    fullScreen: () => toggleFullScreen(root),
    help: () => app.parts.help.toggle(),
  };
  for (const name of ["walk", "zoom", "whole", "thin", "lampsEye", "tour", "close"]) all[name] = () => false; // a cube's
  return Object.fromEntries(Object.entries(all).map(([name, does]) => [name, (...given) => {
    const done = does(...given);
    if (done !== false) app.loop.ask();
    return done;
  }]));
}

function setTheme(app, dark) {
  app.chosen.dark = dark;
  app.root.dataset.theme = dark ? "dark" : "light";
  app.loop?.ask();
}

function partsOf({ scene, turning, does, compact }) {
  return {
    header: headerOfPlate(scene, does, compact),
    hint: hintOfPlate(),
    help: helpOfPlate(scene),
    controls: controlsOfPlate(scene, turning.stops, does),
    filmstrip: createFilmstrip(scene, does.picture),
    seen: compact ? null : createSeen(scene),
    pair: compact ? null : createPair(scene),
    quiet: compact ? null : quietOfPlate(scene),
    said: element("p", { class: "unseen", "aria-live": "polite" }),
  };
}

function layoutOf(parts, canvas, compact) {
  const stage = element("div", { class: "stage" }, canvas, parts.header.element, parts.hint.element);
  const dock = element("div", { class: "dock" }, parts.controls.element, parts.filmstrip.element);
  const rest = [parts.said, parts.help.element];
  if (compact) return [stage, dock, ...rest];
  const details = element("div", { class: "details" }, parts.pair.element, parts.quiet);
  return [stage, dock, element("aside", { class: "side", "aria-label": "From above" }, parts.seen.element, details), ...rest];
}

function listenTo({ does, canvas, loop, parts, compact }) {
  const nothing = () => {};
  listenToGestures(canvas, {
    begin: () => parts.hint.done(),
    turn: (pixels) => does.turn(TURN_SPEED * pixels),
    release: (pixelsPerSecond) => does.release(TURN_SPEED * pixelsPerSecond),
    eye: (_, down) => does.lift(-LIFT_SPEED * down),
    reset: does.right,
    ...{ zoom: nothing, point: nothing, leave: nothing },
  }, compact);
  const lifted = (event) => {
    const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (way === undefined) return;
    event.preventDefault();
    does.lift(way);
  };
  canvas.addEventListener("keydown", lifted);
  const resized = new ResizeObserver(loop.ask);
  resized.observe(canvas);
  return () => resized.disconnect();
}

/** How a frame is shown, and what is said once things rest. */
function showing(app) {
  const { scene, heights, turning, chosen, canvas, parts } = app;
  let told = turning.angle;

  /** Cast the light anew where the lamp has moved; at all points once it is still. */
  function cast(still) {
    const [angle, elevation] = [turning.angle, chosen.elevation];
    if (app.lit?.angle === angle && app.lit.elevation === elevation && (app.lit.judged || !still)) return;
    const lamps = lampsOf(scene, angle);
    const planes = lamps.map(({ azimuth }) => columnsLit(scene, heights, azimuth, elevation, still));
    app.lit = { angle, elevation, lamps, planes, judged: still, tops: levelsOf(planes), blur: null };
  }

  function see() {
    if (app.lit.blur === chosen.blur) return;
    app.lit.blur = chosen.blur;
    app.levels = levelsOf(app.lit.planes.map((plane) => blurred(scene, pixelsLit(scene, plane), scene.blurs[chosen.blur])));
  }

  function show(seconds, _, still) {
    turning.step(seconds);
    cast(still);
    see();
    const now = momentOf(app);
    fitCanvas(canvas);
    const head = app.compact ? 0 : Math.min(0.2, parts.header.element.offsetHeight / Math.max(1, canvas.clientHeight));
    app.draw ??= createPlate(canvas, scene, heights);
    app.draw({ levels: app.lit.tops, lamps: app.lit.lamps, elevation: chosen.elevation, dark: chosen.dark, head });
    parts.header.update(now);
    parts.controls.update(now);
    parts.filmstrip.update(now.picture);
    parts.seen?.update(now, app.levels);
    if (chosen.details) parts.pair?.update(now, app.levels);
    if (told !== turning.angle) {
      told = turning.angle;
      parts.hint.done();
      app.told?.(told);
    }
    return turning.moving;
  }

  function rested() {
    app.rested();
    app.root.dataset.drawn = "";
    const now = momentOf(app);
    canvas.setAttribute("aria-label", `The plate under its lamp, which has gone round by ${degreesText(now.angle)}`);
    parts.said.textContent = [now.here ? now.name : "between two pictures", degreesText(now.angle)].join(", ");
  }

  return [show, rested];
}

/** What all parts of the page know at a moment. */
function momentOf({ scene, turning, chosen }) {
  const stop = turning.stops[nearestOf(turning.stops, turning.angle)];
  const picture = scene.pictures.findIndex(({ angle_deg }) => angle_deg === stop);
  const away = shortestWay(stop, turning.angle);
  const { elevation, blur, details } = chosen;
  return {
    angle: turning.angle, away, picture, name: scene.pictures[picture].name,
    here: Math.abs(away) < HERE, right: elevation === scene.elevation_deg,
    elevation, blur, details, playing: turning.playing, snap: turning.snap,
  };
}
