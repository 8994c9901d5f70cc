// Draws when something has changed, coarser while it moves where the machine is slow, and once more when it rests.

import { clampTo } from "../tools/elements.js";

/** Milliseconds of a frame above which it is drawn coarser, and below which finer. */
const [TOO_SLOW, FAST] = [22, 17.5];
/** Parts of the full resolution. */
const COARSEST = 0.35;
/** Milliseconds after the last frame at which things are still, and at most where frames take long. */
const [AT_REST, LONG_REST] = [140, 400];
/** Most milliseconds that one frame may move things on by: time spent in another tab does not count. */
const LONGEST = 250;

/** The part of the full resolution to go on with after a frame that took so many milliseconds. */
function adapted(scale, cost) {
  if (cost > TOO_SLOW) return Math.max(COARSEST, 0.8 * scale);
  return cost < FAST ? Math.min(1, 1.02 * scale) : scale;
}

/**
 * A loop of animation frames that runs only while it is asked for.
 *
 * @param {function(number, number, boolean): boolean} frame draws, given the seconds since the frame before, the
 *   resolution in 0.35..1, and whether things are still, which is when it is 1; says whether things go on moving by
 *   themselves
 * @param {function(): void} rested called when things are still and drawn
 * @returns {{ask: function(): void, stop: function(): void, resting: boolean}} `resting` once `rested` was called
 */
export function createLoop(frame, rested) {
  let [asked, timer, before, goesOn, resting] = [0, 0, 0, false, false];
  let [scale, still] = [1, false];

  function run(now) {
    asked = 0;
    const since = now - before;
    before = now;
    const started = performance.now();
    const [wentOn, last] = [goesOn, still];
    still = false;
    goesOn = frame(Math.min(wentOn ? since : 16, LONGEST) / 1000, last ? 1 : scale, last);
    // between frames of its own accord the graphics card's time counts too
    const cost = Math.max(performance.now() - started, wentOn ? since : 0);
    clearTimeout(timer);
    if (last) {
      timer = setTimeout(rest);
      return;
    }
    scale = adapted(scale, cost);
    if (goesOn) request();
    else timer = setTimeout(settle, clampTo(2 * cost, AT_REST, LONG_REST));
  }

  function settle() {
    still = true;
    request();
  }

  function rest() {
    resting = true;
    rested();
  }

  function ask() {
    [resting, still] = [false, false];
    request();
  }

  function request() {
    if (asked === 0) asked = requestAnimationFrame(run);
  }

  return {
    ask,
    get resting() {
      return resting;
    },
    stop() {
      cancelAnimationFrame(asked);
      clearTimeout(timer);
      asked = -1;
    },
  };
}
