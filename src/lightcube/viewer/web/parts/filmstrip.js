// The strip of all wanted pictures: a click turns the cube to one, and the nearest one is marked.

import { wantedImage } from "../tools/cards.js";
import { degreesText, element, qualityOf } from "../tools/elements.js";

/**
 * The film strip, in the order of the turn.
 *
 * One of its pictures can be reached by Tab, the others from there by the arrow keys.
 *
 * @param {Object} scene
 * @param {function(number): void} chosen called with the number of a picture
 * @returns {{element: HTMLElement, update: function(Object): void}}
 */
export function createFilmstrip(scene, chosen) {
  const { pictures } = scene;
  const order = pictures.map((_, i) => i);
  order.sort((a, b) => pictures[a].angle_deg - pictures[b].angle_deg || pictures[a].screen - pictures[b].screen);
  const buttons = new Map(order.map((number) => [number, thumbnail(scene, number, () => chosen(number))]));
  const strip = element("div", { class: "filmstrip", role: "group", "aria-label": "Wanted pictures" });
  strip.append(...buttons.values());
  let marked = null;

  strip.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const at = order.findIndex((number) => buttons.get(number) === event.target);
    if (way === undefined || at < 0) return;
    event.preventDefault();
    const next = order[(at + way + order.length) % order.length];
    buttons.get(next).focus({ preventScroll: true });
    chosen(next);
  });

  return {
    element: strip,
    update(now) {
      const chosen = now.exposures[now.spot.place].picture;
      if (chosen === marked) return;
      if (marked !== null) mark(buttons.get(marked), false);
      marked = chosen;
      mark(buttons.get(marked), true);
      for (const [number, button] of buttons) button.tabIndex = number === marked ? 0 : -1;
      scrollInto(strip, buttons.get(marked));
    },
  };
}

function thumbnail(scene, number, pressed) {
  const picture = scene.pictures[number];
  const quality = qualityOf(picture.psnr);
  const angle = degreesText(picture.angle_deg);
  const label = [picture.name, quality, picture.mirrored && "mirrored", angle].filter(Boolean).join(", ");
  const given = { type: "button", class: "thumbnail", "aria-label": label, title: label, tabindex: -1, click: pressed };
  return element("button", given,
    wantedImage(scene, picture),
    element("span", { class: "name", text: picture.name }),
    quality ? element("span", { class: `mark ${quality}`, "aria-hidden": "true" }) : null);
}

function mark(button, on) {
  if (on) button.setAttribute("aria-current", "true");
  else button.removeAttribute("aria-current");
}

/** Scroll the strip alone, not what it stands in. */
function scrollInto(strip, button) {
  const middle = button.offsetLeft + button.offsetWidth / 2 - strip.clientWidth / 2;
  strip.scrollTo({ left: middle, behavior: "auto" });
}
