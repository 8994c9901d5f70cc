// A plan of the room along two axes, in which what stands there is dragged.

import { element, svg } from "/viewer/tools/elements.js";

/** Half a side of the cube, mm, and what is seen around it at least. */
const [HALF, LEAST] = [50, 210];
/** Millimetres that an arrow key moves by; with shift. */
const [STEP, FINE] = [5, 1];

/**
 * @param {"xy"|"xz"} axes to the right, and up
 * @param {string} title
 * @param {Object} now the room, what is chosen, and what cannot be, by name
 * @param {Object} does `choose(name)`, `move(name, axes, place)`, `moved()`
 */
export function createPlan(axes, title, now, does) {
  const drawing = svg("svg", { class: "plan-of", role: "group", "aria-label": `The room, ${title.toLowerCase()}` });
  const figure = element("figure", {}, drawing, element("figcaption", { text: title }));
  let held = null;
  let half = LEAST;

  const flat = (thing) => [thing[axes[0]], -thing[axes[1]]];
  const placeOf = (event) => {
    const box = drawing.getBoundingClientRect();
    return [((event.clientX - box.left) / box.width - 0.5) * 2 * half, -((event.clientY - box.top) / box.height - 0.5) * 2 * half];
  };
  drawing.addEventListener("pointermove", (event) => {
    if (held === null) return;
    const place = placeOf(event);
    does.move(held.name, axes, place.map((at, i) => at - held.off[i]));
  });
  for (const end of ["pointerup", "pointercancel"]) {
    drawing.addEventListener(end, () => {
      if (held !== null) does.moved();
      held = null;
      draw();
    });
  }

  function handle(thing, name, above, ...shapes) {
    const made = svg("g", { class: `handle${now.bad.has(thing.name) ? " bad" : ""}${now.chosen === thing.name ? " chosen" : ""}`, tabindex: "0", role: "button",
      "aria-label": `${name} ${thing.name}, ${axes[0] === "x" ? "right" : ""} ${thing[axes[0]]} mm, ${axes[1] === "y" ? "back" : "up"} ${thing[axes[1]]} mm`, "data-name": thing.name }, ...shapes);
    const label = svg("text", { x: flat(thing)[0], y: above - half / 32, class: "label" });
    label.textContent = thing.name;
    made.append(label);
    made.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      drawing.setPointerCapture(event.pointerId);
      const place = placeOf(event);
      held = { name: thing.name, off: [...axes].map((axis, i) => place[i] - thing[axis]) };
      does.choose(thing.name);
    });
    made.addEventListener("keydown", (event) => {
      const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (way === undefined) return;
      event.preventDefault();
      const step = event.shiftKey ? FINE : STEP;
      now.chosen = thing.name;
      does.move(thing.name, axes, way.map((each, i) => thing[axes[i]] + step * each));
      does.moved();
      drawing.querySelector(`[data-name="${thing.name}"]`)?.focus();
    });
    return made;
  }

  function lampOf(lamp) {
    const [x, y] = flat(lamp);
    const size = half / 22;
    const rays = lamp.far ? Array.from({ length: 8 }, (_, i) => {
      const [c, s] = [Math.cos((i * Math.PI) / 4), Math.sin((i * Math.PI) / 4)];
      return svg("line", { x1: x + 1.3 * size * c, y1: y + 1.3 * size * s, x2: x + 1.9 * size * c, y2: y + 1.9 * size * s, class: "ray" });
    }) : [];
    return handle(lamp, "Lamp", y - 2 * size, svg("circle", { cx: x, cy: y, r: 2.6 * size, class: "area" }), svg("circle", { cx: x, cy: y, r: size, class: "bulb" }), ...rays);
  }

  function screenOf(screen) {
    const [one, other] = edgeOf(screen);
    const line = { x1: one[0], y1: one[1], x2: other[0], y2: other[1] };
    return handle(screen, "Screen", Math.min(one[1], other[1]), svg("line", { ...line, class: "area" }), svg("line", { ...line, class: "screen" }));
  }

  /** The two ends of a screen as it is seen along this plan. */
  function edgeOf(screen) {
    const [x, y] = flat(screen);
    const aside = Math.hypot(screen.x, screen.y);
    const lies = screen.lying || aside < 1;
    const far = screen.side_mm / 2;
    if (lies) return [[x - far, y], [x + far, y]];
    if (axes === "xy") return [[x - (far * screen.y) / aside, y - (far * screen.x) / aside], [x + (far * screen.y) / aside, y + (far * screen.x) / aside]];
    return [[x, y - far], [x, y + far]];
  }

  /** The light that goes from a lamp through the cube to a screen. */
  function beamOf(screen) {
    const lamp = now.room.lamps.find(({ name }) => name === screen.lamp);
    if (lamp === undefined) return [];
    const [ends, from, to] = [edgeOf(screen), flat(lamp), flat(screen)];
    const points = lamp.far ? [...ends, ...ends.map((end) => end.map((at, i) => at + (from[i] - to[i]))).reverse()] : [...ends, from];
    return [svg("polygon", { points: points.map((point) => point.join(",")).join(" "), class: `light${now.bad.has(screen.name) ? " bad" : ""}` })];
  }

  function draw() {
    const { lamps, screens } = now.room;
    if (held === null) half = Math.max(LEAST, ...[...lamps, ...screens].flatMap((thing) => [Math.abs(thing.x), Math.abs(thing.y), Math.abs(thing.z)]).map((far) => 1.12 * far + 45));
    drawing.setAttribute("viewBox", `${-half} ${-half} ${2 * half} ${2 * half}`);
    drawing.setAttribute("font-size", String(half / 15));
    const focused = drawing.contains(document.activeElement) ? document.activeElement.dataset.name : null;
    drawing.replaceChildren(
      ...(axes === "xy" ? [svg("circle", { cx: 0, cy: 0, r: 1.5 * HALF, class: "table" })] : [svg("line", { x1: -1.5 * HALF, y1: HALF + 2, x2: 1.5 * HALF, y2: HALF + 2, class: "table" })]),
      ...screens.flatMap(beamOf),
      svg("rect", { x: -HALF, y: -HALF, width: 2 * HALF, height: 2 * HALF, class: "cube" }),
      ...screens.map(screenOf), ...lamps.map(lampOf));
    if (focused !== null) drawing.querySelector(`[data-name="${focused}"]`)?.focus();
  }

  return { element: figure, draw };
}
