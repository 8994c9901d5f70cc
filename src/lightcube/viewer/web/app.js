// Puts the page together: the turntable, the room and the cards, and what is done to them.

import { lessonOf } from "./model/lesson.js";
import { momentOf } from "./model/moment.js";
import { stops } from "./model/stage.js";
import { nearestOf, neighbourOf, Turning } from "./model/turning.js";
import { wordsOf } from "./model/words.js";
import { controlsAround, headerAround, helpAround, hintAround } from "./parts/around.js";
import { createBeckoning } from "./parts/beckoning.js";
import { createCompare } from "./parts/compare.js";
import { createFilmstrip } from "./parts/filmstrip.js";
import { listenToGestures } from "./parts/gestures.js";
import { createQuietLine } from "./parts/header.js";
import { listenToKeys } from "./parts/keys.js";
import { createLoop } from "./parts/loop.js";
import { createScanline } from "./parts/scanline.js";
import { followTheme } from "./parts/theme.js";
import { createTour } from "./parts/tour.js";
import { createWall } from "./parts/wall.js";
import { RoomView } from "./room/roomview.js";
import { clampTo, degreesText, element, overlapText, qualityOf, toggleFullScreen } from "./tools/elements.js";

/** Degrees by which a pixel of a drag turns the cube. */
const TURN_SPEED = 0.35;
/** Milliseconds between two copies of the shadow into the cards while it changes. */
const COPY_EVERY = 80;
/**
 * Build the page in an element.
 *
 * @param {HTMLElement} root is emptied; keeps what is returned as `root.lightcube` too
 * @param {Object} scene
 * @param {Object} cube
 * @param {{compact: boolean, inside: boolean}} options compact: the room, the controls and the film strip alone, for
 *   notebooks; inside: among other things, so that keys, wheel and theme are not its own
 * @returns {{angle: number, resting: boolean, turnTo: function(number): void,
 *   onTurn: function(function(number): void): void, dispose: function(): void}} degrees; whether nothing moves and all
 *   is drawn; `turnTo` turns there at once, `onTurn` calls with every new angle
 */
export function mount(root, scene, cube, { compact = false, inside = compact } = {}) {
  const turning = new Turning(stops(scene), matchMedia("(prefers-reduced-motion: reduce)").matches);
  const view = new RoomView(scene, cube);
  const app = { root, scene, turning, view, chosen: nothingChosen() };
  app.does = actionsOf(app);
  app.parts = createParts(app, cube, compact);
  const [show, rested] = showing(app);
  app.loop = createLoop(show, rested);
  if (!compact) view.head = () => app.parts.header.element.offsetHeight / Math.max(1, view.canvas.clientHeight);
  view.aim(turning.angle, app.chosen, false);
  app.beckoning = compact ? null : createBeckoning(root, turning, app.loop.ask);
  const ends = [
    () => app.beckoning?.end(),
    listenToTheme(app, inside),
    listenToKeys(inside ? root : document, app.does),
    listenToRoom(app, inside),
    listenToClicks(app),
  ];

  view.renderer.onRestored = app.loop.ask;
  root.classList.add("lightcube");
  root.classList.toggle("compact", compact);
  root.replaceChildren(...layoutOf(app.parts, compact)); // its new size asks for the first drawing
  root.lightcube = {
    get angle() {
      return turning.angle;
    },
    get resting() {
      return app.loop.resting;
    },
    turnTo(angle) {
      turning.set(angle);
      app.loop.ask();
    },
    onTurn(callback) {
      app.told = callback;
    },
    dispose() {
      ends.forEach((end) => end());
      app.loop.stop();
      view.dispose();
      root.replaceChildren();
    },
  };
  return root.lightcube;
}

function nothingChosen() {
  return { place: 0, row: null, column: null, whole: false, thin: false, lampsEye: false, details: false, big: false, dark: null, lesson: null };
}

/** What can be done, each ending with a new drawing. */
function actionsOf(app) {
  const { root, scene, turning, view, chosen } = app;
  const toNeighbour = (way) => turning.glideTo(turning.stops[neighbourOf(turning.stops, turning.angle, way)]);
  const toNearest = () => turning.glideTo(turning.stops[nearestOf(turning.stops, turning.angle)]);
  const all = {
    turn: (degrees) => turning.push(degrees),
    release: (degreesPerSecond) => turning.release(degreesPerSecond),
    neighbour: toNeighbour,
    nearest: toNearest,
    first: () => turning.glideTo(turning.stops[0]),
    picture(number) {
      const { screen, angle_deg } = scene.pictures[number];
      const place = view.exposures.findIndex((exposure) => exposure.screen === screen);
      if (place !== chosen.place) Object.assign(chosen, { place, row: null, column: null });
      turning.glideTo(angle_deg);
    },
    play: () => (turning.playing ? turning.release(0) : turning.play()),
    speed: (factor) => (turning.speed = factor),
    slide: (angle) => turning.set(angle),
    slid: () => turning.release(0),
    snap() {
      turning.snap = !turning.snap;
      if (turning.snap && !turning.playing) toNearest();
    },
    whole() {
      if (scene.whole_shadow === null) return false;
      // the same beam is another row of the larger picture
      Object.assign(chosen, { whole: !chosen.whole, row: null, column: null });
      return true;
    },
    eye: (across, down) => view.moveEye(across, down),
    thin: () => (chosen.thin = !chosen.thin),
    lampsEye() {
      chosen.lampsEye = !chosen.lampsEye;
      app.parts.hint.done();
    },
    details() {
      chosen.details = !chosen.details;
      root.toggleAttribute("data-details", chosen.details);
    },
    big() {
      chosen.big = !chosen.big;
      root.toggleAttribute("data-big", chosen.big);
    },
    tour: () => goTo(app, chosen.lesson === null ? 0 : null),
    walk(way) {
      if (chosen.lesson === null) return false;
      return goTo(app, clampTo(chosen.lesson.number + way, 0, chosen.lesson.count - 1));
    },
    zoom: (factor, x, y) => view.zoom(factor, x === undefined ? chosenPixel(chosen) : view.pointed(x, y)),
    reset: () => view.comeBack(),
    screen: (place) => Object.assign(chosen, { place, row: null, column: null }),
    point: (row, column) => Object.assign(chosen, { row, column }),
    theme() {
      app.ownTheme = true;
      setTheme(app, !chosen.dark);
    },
    fullScreen: () => toggleFullScreen(root),
    help: () => app.parts.help.toggle(),
    close() {
      if (chosen.lesson === null) return false; // dialogs and full screen close themselves
      return all.tour();
    },
  };
  const useless = scene.turns ? [] : ["turn", "release", "neighbour", "nearest", "first", "play", "snap"];
  if (scene.solid) useless.push("tour", "thin", "point");
  if (scene.glass) useless.push("tour");
  for (const name of useless) all[name] = () => false;
  return Object.fromEntries(Object.entries(all).map(([name, does]) => [name, (...given) => {
    const done = does(...given);
    app.loop.ask();
    return done;
  }]));
}

/** Go to a step of the tour, by its number, or end it (null); returns true. */
function goTo(app, number) {
  const { root, scene, turning, view, chosen, parts } = app;
  const before = chosen.lesson;
  if (number === before?.number) return true;
  if (before?.plays) turning.release(0);
  parts.hint.done();
  root.toggleAttribute("data-tour", number !== null);
  app.steps ??= lessonOf(scene, view.cube);
  chosen.lesson = number === null ? null : { ...app.steps[number], number, count: app.steps.length };
  if (number === null) return true;
  const { angle, screen, plays } = chosen.lesson;
  Object.assign(chosen, { place: screen, row: null, column: null, whole: false });
  if (plays && !turning.calm) turning.play();
  else if (turning.angle !== angle) turning.glideTo(angle);
  return true;
}

/** The pixel that is pointed at, or null. */
function chosenPixel({ place, row, column }) {
  return column === null ? null : { screen: place, row, column };
}

function setTheme(app, dark) {
  app.chosen.dark = dark;
  app.root.dataset.theme = dark ? "dark" : "light";
}

/** Follow the theme of what is around until another one is chosen. */
function listenToTheme(app, inside) {
  return followTheme(app.root, inside, (dark) => {
    if (app.ownTheme || app.chosen.dark === dark) return;
    setTheme(app, dark);
    app.loop.ask();
  });
}

/** After a click the keys are the cube's again, but in the film strip; who walks by Tab stays where he is. */
function listenToClicks({ root, view }) {
  const clicked = (event) => {
    const pressed = event.detail > 0 && event.target.closest("button:not(.thumbnail)") !== null;
    if (pressed && !root.querySelector("dialog[open]")) view.canvas.focus({ preventScroll: true });
  };
  root.addEventListener("click", clicked);
  return () => root.removeEventListener("click", clicked);
}

function listenToRoom({ scene, does, view, chosen, loop, parts }, inside) {
  listenToGestures(view.canvas, {
    ...does,
    begin: () => parts.hint.done(),
    turn: scene.turns ? (pixels) => does.turn(TURN_SPEED * pixels) : null,
    release: (pixelsPerSecond) => does.release(TURN_SPEED * pixelsPerSecond),
    point(x, y) {
      if (scene.solid) return; // it has no scan-lines
      const found = view.pointed(x, y);
      view.canvas.classList.toggle("pointing", found !== null);
      if (found === null) does.point(chosen.row, null);
      else Object.assign(chosen, { place: found.screen, row: found.row, column: found.column });
      loop.ask();
    },
    leave: () => does.point(chosen.row, null),
  }, inside);
  const resized = new ResizeObserver(loop.ask);
  resized.observe(view.canvas);
  return () => resized.disconnect();
}

function createParts({ scene, turning, view, does }, cube, compact) {
  return {
    header: headerAround(scene, does, compact),
    wall: compact ? null : createWall(scene),
    quiet: createQuietLine(scene, view.note, compact),
    hint: hintAround(scene),
    help: helpAround(scene),
    controls: scene.turns ? controlsAround(scene, turning.stops, does) : null,
    filmstrip: createFilmstrip(scene, does.picture),
    tour: compact ? null : createTour(does),
    compare: compact ? null : createCompare(scene, does),
    scanline: compact || scene.solid || scene.glass ? null : createScanline(scene, cube, does.point),
    room: view.canvas,
    said: element("p", { class: "unseen", "aria-live": "polite" }),
  };
}

function layoutOf(parts, compact) {
  const stage = element("div", { class: "stage" }, parts.room, parts.header.element, parts.hint.element);
  const dock = element("div", { class: "dock" }, parts.controls?.element ?? null, parts.filmstrip.element, parts.tour?.element ?? null);
  const rest = [parts.said, parts.help.element];
  if (compact) {
    dock.append(...(parts.quiet === null ? [] : [parts.quiet]));
    return [stage, dock, ...rest];
  }
  const cards = [parts.compare.element, ...(parts.scanline === null ? [] : [parts.scanline.element]), parts.quiet];
  const details = element("div", { class: "details" }, ...cards);
  return [stage, dock, element("aside", { class: "side", "aria-label": "The wall" }, parts.wall.element, details), parts.wall.threads, ...rest];
}

/** How a frame is shown, and what is said once things rest. */
function showing(app) {
  const { scene, turning, view, chosen, parts } = app;
  let [copied, told] = [-Infinity, turning.angle];

  function show(seconds, scale, still) {
    turning.step(seconds);
    view.aim(turning.angle, chosen, still);
    const goes = view.look(seconds, chosen.lampsEye, turning.calm);
    const now = momentOf(scene, turning, view.exposures, chosen);
    const { place, row, column } = now.spot;
    view.draw(now.dark, now.lesson?.mark ?? (chosen.row === null ? null : { screen: place, row, column }), scale);
    parts.header.update(now);
    parts.tour?.update(now);
    parts.controls?.update(now);
    parts.wall?.tie(now, view);
    parts.filmstrip.update(now.exposures[place].picture);
    if (!still && performance.now() - copied > COPY_EVERY) showCards(now);
    if (told !== turning.angle) {
      told = turning.angle;
      parts.hint.done();
      app.told?.(told);
    }
    return turning.moving || goes;
  }

  function showCards(now) {
    copied = performance.now();
    parts.wall?.update(now, view);
    parts.compare?.update(now, view);
    parts.scanline?.update(now, view.beams);
  }

  function rested() {
    app.beckoning?.drawn();
    app.root.dataset.drawn = "";
    const now = momentOf(scene, turning, view.exposures, chosen);
    showCards(now);
    view.canvas.setAttribute("aria-label", `The ${wordsOf(scene).name} in its room, turned by ${degreesText(now.angle)}`);
    const scores = now.pictures.map((number) => qualityOf(scene.pictures[number].psnr) || overlapText(scene.pictures[number].overlap));
    parts.said.textContent = [now.name, degreesText(now.angle), ...scores].filter(Boolean).join(", ");
  }

  return [show, rested];
}
