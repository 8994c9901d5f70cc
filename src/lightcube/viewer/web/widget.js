// A light cube in a notebook, for anywidget: the angle is the model's.

import { mount } from "./app.js";
import { readScene, readVoxels } from "./model/data.js";

/**
 * Show the cube of a model in an element.
 *
 * @param {{model: Object, el: HTMLElement}} given `model` has "scene" and "voxels" (gzipped, as in a page) and "angle"
 *   (degrees), which follows the cube, and the cube it
 * @returns {Promise<function(): void>} takes it away again
 */
export async function render({ model, el }) {
  const root = document.createElement("div");
  el.append(root);
  try {
    const scene = await readScene(bytesFrom(model.get("scene")));
    const cube = await readVoxels(bytesFrom(model.get("voxels")), scene);
    return widgetOf(model, root, mount(root, scene, cube, { compact: true }));
  } catch (error) {
    root.textContent = error.message;
    return () => root.remove();
  }
}

function bytesFrom(view) {
  return view instanceof Uint8Array ? view : new Uint8Array(view.buffer, view.byteOffset, view.byteLength);
}

function widgetOf(model, root, shown) {
  const follow = () => {
    if (model.get("angle_deg") !== shown.angle) shown.turnTo(model.get("angle_deg"));
  };
  shown.turnTo(model.get("angle_deg"));
  shown.onTurn((angle) => {
    if (model.get("angle_deg") === angle) return;
    model.set("angle_deg", angle);
    model.save_changes();
  });
  model.on("change:angle_deg", follow);
  return () => {
    model.off("change:angle_deg", follow);
    shown.dispose();
    root.remove();
  };
}
