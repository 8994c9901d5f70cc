// What the keys do.

/** Elements that need the keys themselves. */
const TYPED_IN = "select, textarea, input:not([type=range]), [contenteditable]";

/**
 * Call an action for a key that is pressed.
 *
 * @param {EventTarget} area the document, or an element of it
 * @param {Object} does `turn(degrees)`, `neighbour(way)`, `play()`, `nearest()`, `first()`, `zoom(factor)`, `whole()`,
 *   `thin()`, `lampsEye()`, `details()`, `tour()`, `walk(way)` (false where there is no tour), `big()`, `fullScreen()`,
 *   `theme()`, `help()`, `close()`
 * @returns {function(): void} stops listening
 */
export function listenToKeys(area, does) {
  const actions = actionsOf(does);
  const pressed = (event) => {
    if (event.defaultPrevented || event.altKey || event.ctrlKey || event.metaKey) return;
    if (event.target.closest?.(TYPED_IN)) return;
    if (event.target.closest?.("dialog") && event.key !== "?") return; // which closes itself by Escape
    if (event.key === " " && event.target.closest?.("button, a, summary")) return; // presses it
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (action === undefined || action(event) === false) return;
    event.preventDefault();
  };
  area.addEventListener("keydown", pressed);
  return () => area.removeEventListener("keydown", pressed);
}

function actionsOf(does) {
  const fine = (event) => (event.shiftKey ? 0.1 : 1);
  return {
    ArrowLeft: (event) => does.walk(-1) || does.turn(-fine(event)),
    ArrowRight: (event) => does.walk(1) || does.turn(fine(event)),
    PageUp: () => does.walk(-1) || does.neighbour(-1),
    ",": () => does.neighbour(-1),
    PageDown: () => does.walk(1) || does.neighbour(1),
    ".": () => does.neighbour(1),
    " ": () => does.walk(1) || does.play(),
    n: () => does.nearest(),
    Home: () => does.first(),
    "+": () => does.zoom(1.15),
    "=": () => does.zoom(1.15),
    "-": () => does.zoom(1 / 1.15),
    w: () => does.whole(),
    b: () => does.thin(),
    l: () => does.lampsEye(),
    d: () => does.details(),
    g: () => does.tour(),
    a: () => does.big(),
    f: () => does.fullScreen(),
    t: () => does.theme(),
    "?": () => does.help(),
    Escape: () => does.close(),
  };
}
