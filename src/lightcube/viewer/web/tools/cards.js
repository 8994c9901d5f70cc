// What several cards show alike: a wanted picture as an image, and the power of each lamp.

import { element } from "./elements.js";

/**
 * A wanted picture as an image that is loaded when it is seen; an empty frame where none was kept.
 *
 * @param {Object} scene
 * @param {Object} picture of the scene
 * @returns {HTMLElement}
 */
export function wantedImage(scene, picture) {
  if (picture.wanted === null) return element("span", { class: "image empty", "aria-hidden": "true" });
  const classes = picture.mirrored ? "image mirrored" : "image";
  const src = scene.wanted[picture.wanted];
  return element("img", { class: classes, src, alt: "", loading: "lazy", decoding: "async", draggable: "false" });
}

/** Light of each lamp that is lit, summed over its samples: lamp → [red, green, blue]. */
export function lampPowers(exposure) {
  const powers = new Map();
  for (const { lamp, power } of exposure.views) {
    const before = powers.get(lamp) ?? [0, 0, 0];
    if (power.some((part) => part > 0)) powers.set(lamp, before.map((part, i) => part + power[i]));
  }
  return powers;
}
