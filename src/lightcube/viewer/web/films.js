// Puts a stack's page together: the films in the room, lamp by lamp, and what each lamp shows on the paper.

import { castFilms, displayLevels, psnrOf } from "./model/films.js";
import { createFilmstrip } from "./parts/filmstrip.js";
import { listenToGestures } from "./parts/gestures.js";
import { listenToKeys } from "./parts/keys.js";
import { createLoop } from "./parts/loop.js";
import { controlsOfFilms, createPaper, headerOfFilms, helpOfFilms, quietOfFilms } from "./parts/paper.js";
import { createHint } from "./parts/help.js";
import { followTheme } from "./parts/theme.js";
import { createStack } from "./room/films.js";
import { clampTo, element, fitCanvas, toggleFullScreen } from "./tools/elements.js";

/** Degrees by which a pixel of a drag moves the eye, and how high it may stand. */
const EYE_SPEED = 0.35;
const [LOWEST, HIGHEST] = [8, 88];
/** Where the eye begins, and how far it may come and go. */
const FIRST = { azimuth: 24, height: 34, near: 1 };
const [FARTHEST, NEAREST] = [0.5, 5];
/** Seconds that a picture stands while they are played. */
const STAYS = 2;

/**
 * Build the page of a stack of films in an element.
 *
 * @param {HTMLElement} root is emptied; keeps what is returned as `root.lightcube` too
 * @param {Object} scene
 * @param {{films: Float32Array, wanted: Float32Array|null}} given
 * @param {{inside: boolean}} options as `mount` of a cube
 * @returns {{picture: number, off: number, resting: boolean, show: function(number, number): void,
 *   light: function(): Float32Array, dispose: function(): void}} the picture that is shown, and how far films lie off,
 *   mm; `show` sets both; `light` is what the paper shows, linear
 */
export function mountFilms(root, scene, given, { inside = false } = {}) {
  const chosen = { picture: 0, off: 0, ...FIRST, details: false, big: false, dark: null, playing: false };
  const canvas = element("canvas", { class: "room", tabindex: 0, role: "img", "aria-label": "The films in their room" });
  const app = { root, scene, given, chosen, canvas, calm: matchMedia("(prefers-reduced-motion: reduce)").matches };
  app.does = actionsOf(app);
  app.parts = partsOf(app);
  app.loop = createLoop(...showing(app));
  const theme = followTheme(root, inside, (dark) => {
    if (!app.ownTheme && chosen.dark !== dark) setTheme(app, dark);
  });
  const ends = [theme, listenToKeys(inside ? root : document, app.does), listenTo(app, inside)];
  root.classList.add("lightcube");
  root.replaceChildren(...layoutOf(app.parts, canvas)); // its new size asks for the first drawing
  root.lightcube = {
    get picture() {
      return chosen.picture;
    },
    get off() {
      return chosen.off;
    },
    get resting() {
      return app.loop.resting;
    },
    show(picture, off) {
      Object.assign(chosen, { picture, off, playing: false });
      app.loop.ask();
    },
    light: () => app.lit.light,
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
  const { root, scene, chosen } = app;
  const count = scene.pictures.length;
  const switched = (name, attribute) => () => {
    chosen[name] = !chosen[name];
    root.toggleAttribute(attribute, chosen[name]);
  };
  const to = (picture) => Object.assign(chosen, { picture: (picture + count) % count, playing: false });
  const all = {
    neighbour: (way) => to(chosen.picture + way),
    turn: (way) => to(chosen.picture + Math.sign(way)),
    picture: to,
    first: () => to(0),
    play() {
      Object.assign(chosen, { playing: !chosen.playing });
      app.shownFor = 0;
    },
    off: (mm) => (chosen.off = mm),
    eye(across, down) {
      chosen.azimuth -= EYE_SPEED * across;
      chosen.height = clampTo(chosen.height + EYE_SPEED * down, LOWEST, HIGHEST);
    },
    zoom: (factor) => (chosen.near = clampTo(chosen.near * factor, FARTHEST, NEAREST)),
    reset: () => Object.assign(chosen, FIRST),
    details: switched("details", "data-details"),
    big: switched("big", "data-big"),
    theme() {
      app.ownTheme = true;
      setTheme(app, !chosen.dark);
    },
    fullScreen: () => toggleFullScreen(root),
    help: () => app.parts.help.toggle(),
  };
  for (const name of ["walk", "whole", "thin", "lampsEye", "tour", "close", "nearest"]) all[name] = () => false; // a cube's
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

function partsOf({ scene, does }) {
  return {
    header: headerOfFilms(scene, does),
    hint: createHint("look around the films"),
    help: helpOfFilms(),
    controls: controlsOfFilms(scene, does),
    filmstrip: createFilmstrip(scene, does.picture),
    paper: createPaper(scene),
    quiet: quietOfFilms(scene),
    said: element("p", { class: "unseen", "aria-live": "polite" }),
  };
}

function layoutOf(parts, canvas) {
  const stage = element("div", { class: "stage" }, canvas, parts.header.element, parts.hint.element);
  const dock = element("div", { class: "dock" }, parts.controls.element, parts.filmstrip.element);
  const details = element("div", { class: "details" }, parts.paper.pair, parts.quiet);
  const side = element("aside", { class: "side", "aria-label": "The paper" }, parts.paper.element, details);
  return [stage, dock, side, parts.said, parts.help.element];
}

function listenTo({ does, canvas, loop, parts }, inside) {
  const nothing = () => {};
  listenToGestures(canvas, {
    begin: () => parts.hint.done(),
    turn: null,
    ...{ eye: does.eye, zoom: does.zoom, reset: does.reset, release: nothing, point: nothing, leave: nothing },
  }, inside);
  const resized = new ResizeObserver(loop.ask);
  resized.observe(canvas);
  return () => resized.disconnect();
}

/** How a frame is shown, and what is said once things rest. */
function showing(app) {
  const { root, scene, given, chosen, canvas, parts } = app;

  /** Cast the picture anew where another is shown, or films lie otherwise. */
  function cast() {
    const { picture, off } = chosen;
    if (app.lit?.picture === picture && app.lit.off === off) return;
    const light = castFilms(scene, given.films, picture, off);
    app.lit = { picture, off, light, levels: displayLevels(light, scene.transfer), psnr: psnrOf(scene, given.wanted, picture, light) };
  }

  function show(seconds) {
    if (chosen.playing) {
      app.shownFor = (app.shownFor ?? 0) + seconds;
      if (app.shownFor > STAYS) {
        chosen.picture = (chosen.picture + 1) % scene.pictures.length;
        app.shownFor = 0;
      }
    }
    cast();
    const now = { ...chosen, ...app.lit, name: scene.pictures[chosen.picture].name, told: scene.pictures[chosen.picture].told };
    fitCanvas(canvas);
    app.draw ??= createStack(canvas, scene, given.films);
    app.draw(now);
    parts.header.update(now);
    parts.controls.update(now);
    parts.filmstrip.update(now.picture);
    parts.paper.update(now);
    return chosen.playing;
  }

  function rested() {
    root.dataset.drawn = "";
    const { name, told } = scene.pictures[chosen.picture];
    canvas.setAttribute("aria-label", `The films in their room, ${told}`);
    parts.said.textContent = [name, told].join(", ");
  }

  return [show, rested];
}
