// The strip of all wanted pictures: a click turns the cube to one, and the nearest one is marked.

import { shortened } from "../model/words.js";
import { wantedImage } from "../tools/cards.js";
import { degreesText, element, overlapText, qualityOf } from "../tools/elements.js";

/**
 * The film strip, in the order of the turn.
 *
 * One of its pictures can be reached by Tab, the others from there by the arrow keys.
 *
 * @param {Object} scene
 * @param {function(number): void} chosen called with the number of a picture
 * @returns {{element: HTMLElement, update: function(number): void}} `update` takes the number of the nearest picture
 */
export function createFilmstrip(scene, chosen) {
  const { pictures } = scene;
  const order = pictures.map((_, i) => i);
  order.sort((a, b) => pictures[a].angle_deg - pictures[b].angle_deg || pictures[a].screen - pictures[b].screen);
  const names = shortened(pictures.map(({ name }) => name));
  const buttons = new Map(order.map((number) => [number, thumbnail(scene, number, names[number], () => chosen(number))]));
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
    update(nearest) {
      if (nearest === marked) return;
      if (marked !== null) mark(buttons.get(marked), false);
      marked = nearest;
      mark(buttons.get(marked), true);
      for (const [number, button] of buttons) button.tabIndex = number === marked ? 0 : -1;
      scrollInto(strip, buttons.get(marked));
    },
  };
}

function thumbnail(scene, number, name, pressed) {
  const picture = scene.pictures[number];
  const quality = qualityOf(picture.psnr);
  const angle = picture.told ?? degreesText(picture.angle_deg); // films are told apart by lamps
  const label = [picture.name, quality, overlapText(picture.overlap), picture.mirrored && "mirrored", angle].filter(Boolean).join(", ");
  const given = { type: "button", class: "thumbnail", "aria-label": label, title: label, tabindex: -1, click: pressed };
  return element("button", given,
    wantedImage(scene, picture),
    element("span", { class: "name", text: name }),
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
