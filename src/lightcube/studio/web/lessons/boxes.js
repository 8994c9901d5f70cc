// Boxes to draw silhouettes in: by hand, or with the keys.

import { element } from "/viewer/tools/elements.js";

/** Pixels along a side of a box, as the studio has it. */
export const SIDE = 24;
/** Pixels of the canvas to one of a box. */
const CELL = 10;
const ARROWS = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] };

/** Rows of a box, of which `inside(x, y)` says what is filled; x to the right and y up, -1 to 1. */
export function rowsOf(inside) {
  const at = (i) => (2 * (i + 0.5)) / SIDE - 1;
  return Array.from({ length: SIDE }, (_, row) =>
    Array.from({ length: SIDE }, (_, column) => (inside(at(column), -at(row)) ? "#" : ".")).join(""));
}

/** Rows of a box of a letter of 8 x 8. */
export function letterOf(lines) {
  return lines.flatMap((line) => Array(3).fill([...line].map((each) => each.repeat(3)).join("")));
}

/**
 * A box to draw in.
 *
 * @param {string} name for people
 * @param {string} where what it is seen from
 * @param {function(): void} changed called with every change
 */
export function createBox(name, where, changed) {
  const canvas = element("canvas", {
    width: SIDE * CELL, height: SIDE * CELL, tabindex: 0, role: "img", class: "box",
    "aria-label": `The ${name}, to draw in: move with the arrows, fill or clear with the space bar`,
  });
  const share = element("span", { class: "share" });
  const figure = element("figure", { class: "drawn" }, canvas,
    element("figcaption", {}, element("b", { text: name[0].toUpperCase() + name.slice(1) }), ` ${where} `, share));
  const box = { element: figure, rows: rowsOf(() => false), lost: null, cast: null, cursor: null };
  let filling = null;
  let before = null;

  const pixels = () => box.rows.map((row) => [...row]);
  const put = (made) => {
    const rows = made.map((row) => row.join(""));
    if (rows.join() === box.rows.join()) return;
    Object.assign(box, { rows, lost: null, cast: null });
    paint();
    changed();
  };
  const placeOf = (event) => {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    return [Math.floor(((event.clientY - top) / height) * SIDE), Math.floor(((event.clientX - left) / width) * SIDE)];
  };
  /** Fill or clear all pixels on the way from where the pointer was. */
  const drawTo = (place) => {
    const made = pixels();
    const steps = Math.max(1, ...place.map((end, axis) => Math.abs(end - before[axis])));
    for (let i = 0; i <= steps; i++) {
      const [row, column] = before.map((start, axis) => Math.round(start + ((place[axis] - start) * i) / steps));
      for (const [r, c] of [[row, column], [row + 1, column], [row, column + 1], [row + 1, column + 1]]) {
        if (made[r]?.[c] !== undefined) made[r][c] = filling;
      }
    }
    before = place;
    put(made);
  };
  const paint = () => {
    const pen = canvas.getContext("2d");
    const style = getComputedStyle(canvas);
    const tone = (each) => style.getPropertyValue(each).trim();
    const colours = { full: tone("--full"), lost: tone("--lost"), added: tone("--added"), line: tone("--line") };
    pen.clearRect(0, 0, canvas.width, canvas.height);
    for (let row = 0; row < SIDE; row++) {
      for (let column = 0; column < SIDE; column++) {
        const given = box.rows[row][column] === "#";
        const isLost = box.lost !== null && box.lost[row][column] !== ".";
        const isCast = box.cast === null ? given : box.cast[row][column] === "#";
        if (!given && !isCast) continue;
        pen.fillStyle = isLost || (given && !isCast) ? colours.lost : given ? colours.full : colours.added;
        pen.fillRect(column * CELL, row * CELL, CELL, CELL);
      }
    }
    pen.strokeStyle = colours.line;
    pen.lineWidth = 1;
    for (let i = 1; i < SIDE; i++) {
      pen.globalAlpha = i % 6 === 0 ? 0.9 : 0.35;
      pen.strokeRect(i * CELL, -1, 0, canvas.height + 2);
      pen.strokeRect(-1, i * CELL, canvas.width + 2, 0);
    }
    pen.globalAlpha = 1;
    if (box.cursor === null || document.activeElement !== canvas) return;
    pen.strokeStyle = tone("--accent");
    pen.lineWidth = 3;
    pen.strokeRect(box.cursor[1] * CELL + 1, box.cursor[0] * CELL + 1, CELL - 2, CELL - 2);
  };

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    before = placeOf(event);
    box.cursor = null;
    filling = box.rows[before[0]]?.[before[1]] === "#" ? "." : "#";
    drawTo(before);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (filling !== null) drawTo(placeOf(event));
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (filling = null));
  canvas.addEventListener("keydown", (event) => {
    const way = ARROWS[event.key];
    if ((way === undefined && event.key !== " ") || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    const place = box.cursor ?? [SIDE / 2, SIDE / 2];
    if (way === undefined) {
      const made = pixels();
      made[place[0]][place[1]] = made[place[0]][place[1]] === "#" ? "." : "#";
      box.cursor = place;
      put(made);
    } else box.cursor = place.map((at, axis) => Math.min(SIDE - 1, Math.max(0, at + way[axis])));
    paint();
  });
  canvas.addEventListener("focus", paint);
  canvas.addEventListener("blur", paint);

  return Object.assign(box, {
    paint,
    /** Give it other rows, without a word. */
    fill(rows) {
      Object.assign(box, { rows, lost: null, cast: null });
      paint();
    },
    /** Show what is lost of it, and what is cast in its place; null = what is drawn. */
    show(lost, cast, said) {
      Object.assign(box, { lost, cast });
      share.textContent = said;
      paint();
    },
  });
}
