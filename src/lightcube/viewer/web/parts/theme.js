// Light or dark: as the system has it, or the notebook around, until a person chooses.

/** A browser's opacity of 255 above which a background is what one sees. */
const OPAQUE = 127;

/**
 * Follow a theme.
 *
 * @param {HTMLElement} root
 * @param {boolean} inside whether it stands in a notebook, whose ground it should match
 * @param {function(boolean): void} set called with whether it is dark, at once and with every change
 * @returns {function(): void} ends it
 */
export function followTheme(root, inside, set) {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const follow = () => set((inside ? darkGround(root.parentElement) : null) ?? system.matches);
  const changed = new MutationObserver(follow);
  const placed = new ResizeObserver(follow); // a notebook may put it into the page later
  system.addEventListener("change", follow);
  if (inside) {
    for (const each of [document.documentElement, document.body]) changed.observe(each, { attributes: true });
    placed.observe(root);
  }
  follow();
  return () => {
    system.removeEventListener("change", follow);
    changed.disconnect();
    placed.disconnect();
  };
}

/** Whether the nearest background behind an element is dark; null where there is none. */
function darkGround(element) {
  const paint = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  for (let each = element; each; each = each.parentElement ?? each.getRootNode().host) {
    paint.clearRect(0, 0, 1, 1);
    paint.fillStyle = "transparent"; // stays where there is no style yet
    paint.fillStyle = getComputedStyle(each).backgroundColor;
    paint.fillRect(0, 0, 1, 1);
    const [red, green, blue, opacity] = paint.getImageData(0, 0, 1, 1).data;
    if (opacity > OPAQUE) return 0.3 * red + 0.59 * green + 0.11 * blue < 128;
  }
  return null;
}
