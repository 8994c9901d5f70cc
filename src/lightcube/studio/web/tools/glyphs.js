// The studio's own icons, drawn as the viewer's are.

import { iconOf } from "/viewer/tools/elements.js";

const LINES = {
  drop: "M12 3v11M7.500 9.500L12 14l4.500-4.500M4 15v4a2 2 0 0 0 2 2h12a2 2 0 0 0 2-2v-4",
  camera: "M4 8a2 2 0 0 1 2-2h2l1.500-2h5L16 6h2a2 2 0 0 1 2 2v9a2 2 0 0 1-2 2H6a2 2 0 0 1-2-2zM12 9.500a3.300 3.300 0 1 0 0 6.600 3.300 3.300 0 0 0 0-6.600",
  crop: "M7 2v15h15M2 7h15v15",
  cube: "M12 3l8 4.500v9L12 21l-8-4.500v-9zM4 7.500l8 4.500 8-4.500M12 12v9",
  shape: "M5 20V4h9v5h-4v3h6v8zM14 4l4 2v4M16 12l3-1.500v7.500l-3 2",
  plate: "M3 16l7 4 11-5-7-4zM3 16v-3l7 4v3M10 17l11-5v3M7 12.500V10l3 1.500M12 10.500V8l3 1.500",
  films: "M4 7l8-4 8 4-8 4zM4 12l8 4 8-4M4 17l8 4 8-4",
  room: "M3 20V6l9-3v14zM12 17l9 3V6l-9-3M8.500 20.500h7M10 18.500v-4l2-1 2 1v4",
};

/** An icon of 24 × 24 in the colour of its text; of the viewer's there is `icon`. */
export function glyph(name) {
  return iconOf(LINES[name]);
}
