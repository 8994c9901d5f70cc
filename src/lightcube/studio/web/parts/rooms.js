// The room: its plan from above and from the side, in which lamps and screens are dragged.

import { element } from "/viewer/tools/elements.js";
import { createPlan } from "../rooms/plan.js";
import { sentenceOf } from "../tools/asking.js";
import { wear } from "../tools/wearing.js";

/** Milliseconds after a move until it is asked what cannot be. */
const CALM = 120;
const spread = (count) => Array.from({ length: count }, (_, i) => Math.round(100 * ((i + 1 / 3) * 360) / count) / 100);
const PRESETS = [
  ["One wall", { stops: 8, lamps: [["lamp", -150, 0, 105]], screens: [["wall", 150, 0, -105, "lamp"]] }],
  ["Two walls", { stops: [11.25, 33.75, 56.25, 78.75, 191.25, 213.75, 236.25, 258.75], lamps: [["front", -150, 0, 105], ["left", 0, -150, 105]],
    screens: [["back wall", 150, 0, -105, "front"], ["side wall", 0, 150, -105, "left"]] }],
  ["Wall and floor", { stops: [0], lamps: [["lamp", -170, 40, 0], ["above", 20, 0, 190]], screens: [["wall", 150, -35, 0, "lamp"], ["floor", -12, 0, -115, "above", true]] }],
];

function roomOf({ stops, lamps, screens }) {
  return {
    stops_deg: Array.isArray(stops) ? stops : spread(stops),
    lamps: lamps.map(([name, x, y, z]) => ({ name, x, y, z, far: true })),
    screens: screens.map(([name, x, y, z, lamp, lying = false]) => ({ name, x, y, z, lamp, lying, side_mm: 50 })),
  };
}

/** Fill the section of the room. */
export function mount(section, studio) {
  wear("/web/rooms/rooms.css");
  const now = { room: null, chosen: null, waiting: 0, asked: 0, bad: new Map(), kept: "" };
  const plans = [["xy", "From above"], ["xz", "From the side"]].map(([axes, title]) => createPlan(axes, title, now, { choose, move, moved }));
  const list = element("ul", { class: "troubles", "aria-live": "polite" });
  const things = element("div", { class: "row things-of" });
  const about = element("div", { class: "row about" });
  const stops = element("input", { type: "number", min: 1, max: 24, id: "rooms-stops", change: () => {
    const count = Math.min(24, Math.max(1, Math.round(Number(stops.value) || 1)));
    now.room.stops_deg = spread(count);
    moved();
  } });
  const keep = element("button", { type: "button", class: "main", text: "Make a cube for this room", click: save });
  section.append(
    element("p", { class: "quiet", text: "Drag lamps and screens, or choose one and move it with the arrow keys. What cannot be is red, and says why." }),
    element("div", { class: "row presets" }, element("span", { class: "quiet", text: "Begin with" }), ...PRESETS.map(([text, preset]) =>
      element("button", { type: "button", class: "switch", text, click: () => take(roomOf(preset)) }))),
    element("div", { class: "plans" }, ...plans.map((plan) => plan.element)),
    things, about,
    element("div", { class: "row" }, element("label", { for: "rooms-stops", text: "Stops of the turntable" }), stops),
    list, element("div", { class: "row" }, keep));

  function take(room) {
    Object.assign(now, { room, chosen: room.screens[0].name });
    moved();
  }

  function all() {
    return [...now.room.lamps, ...now.room.screens];
  }

  function choose(name) {
    now.chosen = name;
    draw();
  }

  /** Put a thing somewhere, along the axes of a plan. */
  function move(name, axes, place) {
    const thing = all().find((each) => each.name === name);
    [...axes].forEach((axis, i) => (thing[axis] = Math.min(600, Math.max(-600, Math.round(place[i])))));
    draw();
  }

  function moved() {
    draw();
    clearTimeout(now.waiting);
    now.waiting = setTimeout(check, CALM);
  }

  async function check() {
    const number = ++now.asked;
    const found = await studio.ask("/api/rooms/check", { json: now.room });
    if (number !== now.asked) return;
    if (found === null) {
      keep.disabled = true;
      return;
    }
    now.bad = new Map(found.impossible.flatMap(({ about: names }) => names.map((name) => [name, true])));
    const lines = (told, kind) => told.map(({ sentence }) => element("li", { class: kind, text: sentenceOf(sentence) }));
    const well = found.impossible.length ? [] : [element("li", { class: "well", text: `Nothing here is impossible: ${found.pictures === 1 ? "one picture" : `${found.pictures} pictures`}, one on each screen at each stop.` })];
    list.replaceChildren(...lines(found.impossible, "bad"), ...well, ...lines(found.doubtful, "doubt"));
    keep.disabled = found.impossible.length > 0;
    draw();
    const text = JSON.stringify(now.room);
    if (text === now.kept) return;
    now.kept = text;
    studio.ask("/api/settings", { method: "PATCH", json: { part: "rooms", kept: now.room } });
  }

  async function save() {
    if ((await studio.ask("/api/rooms/keep", { json: now.room })) === null) return;
    studio.open("make");
    studio.say("This is a project for your room now. Drop a picture for each wall at each stop.", "good");
  }

  function draw() {
    if (now.room === null) return;
    stops.value = now.room.stops_deg.length;
    plans.forEach((plan) => plan.draw());
    things.replaceChildren(...all().map(({ name }) => element("button", { type: "button", class: `switch${now.bad.has(name) ? " bad" : ""}`,
      "aria-pressed": String(name === now.chosen), text: name, click: () => choose(name) })));
    about.replaceChildren(...aboutOf(all().find((each) => each.name === now.chosen)));
  }

  /** What can be said of the chosen thing. */
  function aboutOf(thing) {
    if (thing === undefined) return [];
    const number = (axis, label) => element("label", {}, `${label} `, element("input", { type: "number", step: 5, min: -600, max: 600, value: thing[axis],
      "aria-label": `${thing.name}: ${label}, mm`, change: (event) => {
        move(thing.name, axis, [Number(event.target.value) || 0]);
        moved();
      } }), " mm");
    const places = [number("x", "right"), number("y", "back"), number("z", "up")];
    if ("far" in thing) {
      return [...places, element("label", {}, element("input", { type: "checkbox", checked: thing.far, change: (event) => set(thing, "far", event.target.checked) }), " far away, like the sun")];
    }
    const lamps = element("select", { "aria-label": `Lamp of ${thing.name}`, change: (event) => set(thing, "lamp", event.target.value) },
      ...now.room.lamps.map(({ name }) => element("option", { value: name, text: `lit by ${name}`, selected: name === thing.lamp })));
    const side = element("label", {}, "wide ", element("input", { type: "number", min: 5, max: 400, step: 5, value: thing.side_mm, "aria-label": `${thing.name}: wide, mm`,
      change: (event) => set(thing, "side_mm", Math.min(400, Math.max(5, Number(event.target.value) || 50))) }), " mm");
    return [...places, side, lamps, element("button", { type: "button", class: "switch", text: "Into the shadow", click: () => shade(thing) })];
  }

  function set(thing, key, value) {
    thing[key] = value;
    moved();
  }

  /** Put a screen where the shadow of the cube's middle falls, as far away as it is. */
  function shade(screen) {
    const { x, y, z } = now.room.lamps.find(({ name }) => name === screen.lamp);
    const times = -Math.hypot(screen.x, screen.y, screen.z) / Math.hypot(x, y, z);
    Object.assign(screen, { x: Math.round(times * x), y: Math.round(times * y), z: Math.round(times * z) });
    moved();
  }

  return {
    opened() {
      if (now.room !== null) return;
      const room = studio.state?.settings.parts.rooms ?? roomOf(PRESETS[1][1]);
      now.kept = JSON.stringify(room); // what nobody has changed is no change
      take(room);
    },
    update(state) {
      const kept = state.settings.parts.rooms;
      if (now.room === null || !kept || JSON.stringify(kept) === now.kept || section.contains(document.activeElement)) return;
      now.kept = JSON.stringify(kept);
      take(kept);
    },
  };
}
