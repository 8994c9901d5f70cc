// What a mouse, fingers and a wheel do on the room: turn the cube, move the eye, zoom, point.

import { placeIn } from "../tools/elements.js";

/** Milliseconds before letting go that say how fast it went. */
const RECENT = 90;
/** Pixels that a tap may move, and a drag before it turns anything. */
const STILL = 6;
const STUCK = 3;

/**
 * Listen to the gestures on an element.
 *
 * One pointer turns; the right or middle button, Shift, or two fingers move the eye; wheel and pinch zoom.
 *
 * @param {HTMLElement} area
 * @param {Object} does what is called: `begin()` at every gesture, `turn(pixels)` (or null, then every drag moves the eye), `release(pixelsPerSecond)`,
 *   `eye(across, down)` in pixels, `zoom(factor, x, y)` (above 1: nearer) and `point(x, y)` in 0..1 from the upper left,
 *   `leave()`, `reset()`
 * @param {boolean} polite zoom by wheel only while Ctrl is held, so that what is around can be scrolled
 */
export function listenToGestures(area, does, polite) {
  const fingers = new Map();
  let drag = null; // whether it moves the eye, whether it has turned, [time, x] of late, and how far it went

  area.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse" && fingers.size > 0) return;
    area.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    const eye = does.turn === null || fingers.size > 1 || event.button > 0 || event.shiftKey;
    const far = fingers.size > 1 ? Infinity : 0;
    drag = { eye, turned: drag !== null && drag.turned, trail: [[event.timeStamp, event.clientX]], far };
    does.begin();
  });

  area.addEventListener("pointermove", (event) => {
    if (!fingers.has(event.pointerId)) {
      if (event.pointerType === "mouse") does.point(...placeIn(area, event));
      return;
    }
    const before = middleOf(fingers);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    const after = middleOf(fingers);
    const [across, down] = [after.x - before.x, after.y - before.y];
    drag.far += Math.hypot(across, down);
    if (drag.eye) does.eye(across, down);
    else if (drag.far > STUCK) does.turn(across);
    drag.turned ||= !drag.eye && drag.far > STUCK;
    if (fingers.size > 1 && before.spread > 0 && after.spread > 0) {
      does.zoom(after.spread / before.spread, ...placeIn(area, { clientX: after.x, clientY: after.y }));
    }
    drag.trail = drag.trail.filter(([time]) => event.timeStamp - time < RECENT);
    drag.trail.push([event.timeStamp, event.clientX]);
  });

  const lift = (event) => {
    if (!fingers.delete(event.pointerId) || fingers.size > 0) return;
    const { eye, turned, trail, far } = drag;
    drag = null;
    const recent = trail.find(([time]) => event.timeStamp - time < RECENT && event.timeStamp > time);
    const thrown = !eye && far >= STILL && recent !== undefined;
    if (turned) does.release(thrown ? (1000 * (event.clientX - recent[1])) / (event.timeStamp - recent[0]) : 0);
    if (far < STILL && event.pointerType !== "mouse") does.point(...placeIn(area, event));
  };
  area.addEventListener("pointerup", lift);
  area.addEventListener("pointercancel", lift);
  area.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && does.leave());
  area.addEventListener("contextmenu", (event) => event.preventDefault());
  area.addEventListener("dblclick", () => does.reset());
  area.addEventListener("wheel", (event) => {
    if (polite && !event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    const lines = event.deltaMode === 0 ? event.deltaY / 16 : event.deltaY;
    does.begin();
    does.zoom(Math.exp(-0.02 * lines * (event.ctrlKey ? 4 : 1)), ...placeIn(area, event));
  }, { passive: false });
}

/** Middle of the fingers, and their mean distance from it (pixels). */
function middleOf(fingers) {
  const all = [...fingers.values()];
  const x = all.reduce((sum, place) => sum + place[0], 0) / all.length;
  const y = all.reduce((sum, place) => sum + place[1], 0) / all.length;
  return { x, y, spread: all.reduce((sum, place) => sum + Math.hypot(place[0] - x, place[1] - y), 0) / all.length };
}
