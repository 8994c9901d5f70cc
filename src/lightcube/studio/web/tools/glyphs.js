// The studio's own icons, drawn as the viewer's are.

const LINES = {
  drop: "M12 3v11M7.500 9.500L12 14l4.500-4.500M4 15v4a2 2 0 0 0 2 2h12a2 2 0 0 0 2-2v-4",
  camera: "M4 8a2 2 0 0 1 2-2h2l1.500-2h5L16 6h2a2 2 0 0 1 2 2v9a2 2 0 0 1-2 2H6a2 2 0 0 1-2-2zM12 9.500a3.300 3.300 0 1 0 0 6.600 3.300 3.300 0 0 0 0-6.600",
  crop: "M7 2v15h15M2 7h15v15",
  remove: "M6 6l12 12M18 6L6 18",
};

/** An icon of 24 × 24 in the colour of its text. */
export function glyph(name) {
  const space = "http://www.w3.org/2000/svg";
  const drawing = document.createElementNS(space, "svg");
  drawing.setAttribute("viewBox", "0 0 24 24");
  drawing.setAttribute("aria-hidden", "true");
  const line = document.createElementNS(space, "path");
  line.setAttribute("d", LINES[name]);
  drawing.append(line);
  return drawing;
}
