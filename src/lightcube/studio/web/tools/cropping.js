// Crops a picture: a frame over it with handles at its corners, by hand or by arrow keys.

import { clampTo, element } from "/viewer/tools/elements.js";
import { openDialog } from "./dialogs.js";

const LEAST = 0.1;
const CORNERS = [["upper left", 0, 0], ["upper right", 1, 0], ["lower left", 0, 1], ["lower right", 1, 1]];
/** Parts of the picture that an arrow key moves by. */
const STEP = 0.02;

/** @returns {Promise<Object|null>} the new crop, or null where it stays */
export function openCrop(root, address, name, before) {
  const now = { ...before };
  const frame = element("div", { class: "frame", tabindex: "0", role: "group", "aria-label": "What is taken: arrow keys move it" });
  const area = element("div", { class: "crop-area" }, element("img", { src: address, alt: name, draggable: "false" }), frame);

  function draw() {
    Object.assign(frame.style, { left: `${100 * now.left}%`, top: `${100 * now.top}%`, width: `${100 * now.width}%`, height: `${100 * now.height}%` });
  }

  function move(across, down) {
    now.left = clampTo(now.left + across, 0, 1 - now.width);
    now.top = clampTo(now.top + down, 0, 1 - now.height);
    draw();
  }

  function size(right, low, across, down) {
    const [x, y] = [now.left + (right ? now.width : 0) + across, now.top + (low ? now.height : 0) + down];
    const [far, deep] = [now.left + now.width, now.top + now.height];
    if (right) now.width = clampTo(x, now.left + LEAST, 1) - now.left;
    else Object.assign(now, { left: clampTo(x, 0, far - LEAST), width: far - clampTo(x, 0, far - LEAST) });
    if (low) now.height = clampTo(y, now.top + LEAST, 1) - now.top;
    else Object.assign(now, { top: clampTo(y, 0, deep - LEAST), height: deep - clampTo(y, 0, deep - LEAST) });
    draw();
  }

  for (const [label, right, low] of CORNERS) {
    const handle = element("button", { type: "button", class: `handle ${right ? "right" : "left"} ${low ? "low" : "high"}`, "aria-label": `Corner ${label}: arrow keys move it` });
    drag(handle, area, (across, down) => size(right, low, across, down));
    frame.append(handle);
  }
  drag(frame, area, move);
  draw();
  const whole = element("button", { type: "button", class: "switch", text: "All of it", click: () => {
    Object.assign(now, { left: 0, top: 0, width: 1, height: 1 });
    draw();
  } });
  return openDialog(root, `Crop ${name}`, [area, whole], "Take this", () => now);
}

/** Call with how far an element is dragged, or moved by arrow keys, as parts of an area. */
function drag(part, area, moved) {
  let [x, y] = [0, 0];
  part.addEventListener("pointerdown", (event) => {
    if (event.target !== part) return;
    event.preventDefault();
    part.focus();
    part.setPointerCapture(event.pointerId);
    [x, y] = [event.clientX, event.clientY];
  });
  part.addEventListener("pointermove", (event) => {
    if (!part.hasPointerCapture(event.pointerId)) return;
    const box = area.getBoundingClientRect();
    moved((event.clientX - x) / box.width, (event.clientY - y) / box.height);
    [x, y] = [event.clientX, event.clientY];
  });
  part.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, -STEP], ArrowDown: [0, STEP] }[event.key];
    if (way === undefined || event.target !== part) return;
    event.preventDefault();
    moved(...way);
  });
}
