// What all parts of the page know at a moment: where the cube stands, which pictures are near, and what is chosen.

import { nearestPicture } from "./stage.js";
import { nearestOf, shortestWay } from "./turning.js";

/**
 * A description of the moment.
 *
 * @param {Object} scene
 * @param {Turning} turning
 * @param {Object[]} exposures of all screens at its angle
 * @param {{place: number, row: number|null, column: number|null, whole: boolean, thin: boolean, dark: boolean}} chosen
 *   the screen (by its place among the exposures), the pixel of it that is pointed at, whether the whole shadow is shown,
 *   and by thin beams, the theme
 * @returns {Object} angle, away (signed degrees from the nearest stop), pictures (numbers of those that are lit, or
 *   nearest), name (of these), exposures, spot ({place, row, column} on a lit screen), playing, snap, whole, thin,
 *   lampsEye, details, big, dark, lesson (the step of the tour, or null)
 */
export function momentOf(scene, turning, exposures, chosen) {
  const stop = turning.stops[nearestOf(turning.stops, turning.angle)];
  const lit = exposures.filter((exposure) => exposure.lit);
  const pictures = lit.map((exposure) => nearestPicture(scene, exposure.screen, stop));
  return {
    angle: turning.angle,
    away: shortestWay(stop, turning.angle),
    pictures,
    name: pictures.map((number) => scene.pictures[number].name).join(", "),
    exposures,
    spot: spotOn(exposures, chosen),
    playing: turning.playing,
    snap: turning.snap,
    whole: chosen.whole,
    thin: chosen.thin,
    lampsEye: chosen.lampsEye,
    details: chosen.details,
    big: chosen.big,
    lesson: chosen.lesson,
    dark: chosen.dark,
  };
}

/** The pixel that is chosen, moved to a screen that is lit and into it. */
function spotOn(exposures, { place, row, column }) {
  const on = exposures[place].lit ? place : Math.max(0, exposures.findIndex((exposure) => exposure.lit));
  const [rows, columns] = exposures[on].window;
  return {
    place: on,
    row: row === null ? Math.floor(rows / 2) : Math.min(row, rows - 1),
    column: column === null ? null : Math.min(column, columns - 1),
  };
}
