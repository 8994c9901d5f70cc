// The controls below the room: the slider over the turn with a tick at every stop, playing, and what can be chosen.

import { PLAY_SPEED } from "../model/turning.js";
import { degreesText, element, icon, iconButton, setPressed, svg, wordButton } from "../tools/elements.js";

/** Speeds of playing. */
const SPEEDS = [0.25, 0.5, 1, 2, 4];
/** Steps of the slider, in degrees. */
const SLIDER_STEP = 0.01;
/** Ticks that stand apart even on a phone. */
const MOST_TICKS = 60;
/** What the switch does that stays on. */
const SNAP = "When you let go it turns on to the nearest picture, and playing rests on each; off, it stays wherever you leave it.";

/**
 * The row of controls.
 *
 * @param {number[]} stops
 * @param {Object} does `play()`, `neighbour(way)`, `snap()`, `speed(factor)`, `slide(angle)`, `slid()`
 * @param {string} angle what the slider sets
 * @param {HTMLElement[]} choices buttons of this page, after those that all have
 * @returns {{element: HTMLElement, update: function(Object): void}} `update` takes {angle, away, name, snap, playing}
 */
export function createControls(stops, does, angle, choices) {
  const play = iconButton("play", "Play", "Space", does.play);
  const snap = wordButton("magnet", "Snap", SNAP, does.snap);
  const readout = element("output", { class: "readout", "aria-live": "off" });
  const slider = createSlider(stops, does, angle);
  const row = element("div", { class: "controls", role: "group", "aria-label": "Turning" },
    element("div", { class: "transport" },
      iconButton("previous", "Previous picture", "Page Up", () => does.neighbour(-1)), play,
      iconButton("next", "Next picture", "Page Down", () => does.neighbour(1))),
    readout, slider.element,
    element("div", { class: "choices" }, speedChoice(does.speed), snap, ...choices));

  return {
    element: row,
    update(now) {
      setPressed(snap, now.snap);
      if (play.dataset.playing !== String(now.playing)) {
        play.dataset.playing = now.playing;
        play.replaceChildren(icon(now.playing ? "pause" : "play"));
        play.setAttribute("aria-label", now.playing ? "Pause" : "Play");
        play.title = now.playing ? "Pause (Space)" : "Play (Space)";
      }
      readout.textContent = degreesText(now.angle);
      slider.update(now);
    },
  };
}

/** The slider over 360° with its ticks. */
function createSlider(stops, does, angle) {
  const input = element("input", {
    type: "range", min: 0, max: 360, step: SLIDER_STEP, "aria-label": angle,
    input: () => does.slide(Number(input.value)),
    change: () => does.slid(),
  });
  return {
    element: element("div", { class: "slider" }, ticksOf(stops), input),
    update(now) {
      if (Number(input.value) !== now.angle) input.value = now.angle;
      input.style.setProperty("--part", now.angle / 360);
      input.setAttribute("aria-valuetext", spokenPlace(now));
    },
  };
}

/** "23.4°, 0.8° from 'coffee'". */
function spokenPlace(now) {
  const off = degreesText(Math.abs(now.away));
  return `${degreesText(now.angle)}, ${off === "0.0°" ? "at" : `${off} from`} '${now.name}'`;
}

/** A tick for every stop, or evenly for some of very many. */
function ticksOf(stops) {
  const every = Math.ceil(stops.length / MOST_TICKS);
  const marked = stops.filter((_, i) => i % every === 0);
  const lines = svg("path", { d: marked.map((stop) => `M${stop} 0V1`).join(""), "vector-effect": "non-scaling-stroke" });
  return svg("svg", { viewBox: "0 0 360 1", preserveAspectRatio: "none", "aria-hidden": "true" }, lines);
}

function speedChoice(chosen) {
  const options = SPEEDS.map((speed) =>
    element("option", { value: speed, selected: speed === 1, text: `${speed}×` }));
  const say = () => (select.title = `Speed of playing: ${PLAY_SPEED * Number(select.value)}° per second`);
  const choose = () => {
    chosen(Number(select.value));
    say();
  };
  const select = element("select", { "aria-label": "Speed of playing", change: choose }, ...options);
  say();
  return select;
}
