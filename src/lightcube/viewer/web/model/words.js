// What the page calls what it shows, and names as short as they can be told apart.

/** Letters of a name below a picture that are read without being cut off. */
const SHORT = 9;
/** What parts names into words. */
const PARTS = /[\s_.-]/;

const GLASS = {
  name: "cube",
  title: "Turning a light cube",
  lit: "Light falls through a block of coloured glass",
  drawn: "So that one sees into it the glass is drawn clearer than it is, and shining; what the wall shows, and what the lamp's eye sees, is exact.",
};
const BENT = "What the wall shows is light bent by the glass, exactly, but for what is thrown back inside and comes out elsewhere; " +
  "the glass itself is drawn, for the lamp's eye too, as if sight went straight through it.";
const SHAPE = {
  name: "shape",
  title: "Looking at a shape and its shadows",
  lit: "A solid stands in the light",
  drawn: "Its edges are drawn a little smoother than its voxels are; what the walls show is what these cast, exactly.",
};

/** What bends the light. */
const BODIES = {
  block: "a block of coloured glass, which bends it",
  cylinder: "a cylinder of coloured glass, which bends it",
  sphere: "a sphere of coloured glass, which bends it",
  bath: "a block of coloured glass in a bath, which bends it",
  "round-bath": "a block of coloured glass in a round bath, which bends it",
};

/** Words for a cube of glass, which bends light or does not, or for an opaque shape. */
export function wordsOf(scene) {
  if (!scene.glass) return scene.solid ? SHAPE : GLASS;
  return { ...GLASS, lit: `Light falls through ${BODIES[scene.glass.form]}`, drawn: BENT };
}

/**
 * Names without the words that all of them begin or end with, where one is too long to be read below a picture.
 * @param {string[]} names
 * @returns {string[]} as different as they were; what is left out is marked by "…"
 */
export function shortened(names) {
  if (names.length < 2 || Math.max(...names.map((name) => name.length)) <= SHORT) return names;
  const [first, ...others] = names;
  const shortest = Math.min(...names.map((name) => name.length));
  let [start, end] = [0, 0];
  for (let i = 0; i < shortest && others.every((name) => name[i] === first[i]); i++) if (PARTS.test(first[i])) start = i + 1;
  const from = (name, i) => name[name.length - i];
  for (let i = 1; i < shortest - start && others.every((name) => from(name, i) === from(first, i)); i++) {
    if (PARTS.test(from(first, i))) end = i;
  }
  const cut = names.map((name) => name.slice(start, name.length - end));
  if (cut.some((name) => name === "")) return names;
  return cut.map((name) => `${start > 0 ? "…" : ""}${name}${end > 0 ? "…" : ""}`);
}
