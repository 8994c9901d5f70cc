// Turn: the newest cube in the viewer, its wall large; also while it is still becoming.

import { mount as mountViewer } from "/viewer/app.js";
import { readScene, readVoxels } from "/viewer/model/data.js";
import { element } from "/viewer/tools/elements.js";
import { wear } from "../tools/wearing.js";

/** Fill the section of the turning cube. */
export function mount(section, studio) {
  wear("/web/turning/turning.css");
  const empty = element("p", { class: "quiet", text: "Here the cube is turned, as soon as there is something of it." });
  const area = element("div", { class: "turned", hidden: true });
  section.append(empty, area);
  const now = { shown: null, wanted: null, version: null, busy: false };

  /** Show the newest cube, at the angle of the one before; one at a time, and none while it is not to be seen. */
  async function follow() {
    if (now.busy || section.hidden || now.wanted === null || now.wanted === now.version) return;
    now.busy = true;
    const version = now.wanted;
    try {
      const parts = await Promise.all(["scene", "voxels"].map((part) => fetch(`/api/cube/${part}`)));
      if (parts.every((part) => part.ok)) await show(...await Promise.all(parts.map(async (part) => new Uint8Array(await part.arrayBuffer()))));
      now.version = version;
    } catch (error) {
      now.version = version;
      studio.say(`${error.message[0].toUpperCase()}${error.message.slice(1)}.`, "bad");
    }
    now.busy = false;
    follow();
  }

  async function show(scene, voxels) {
    const described = await readScene(scene);
    const cube = await readVoxels(voxels, described);
    const before = now.shown;
    const angle = before?.angle;
    before?.dispose();
    const root = element("div", { tabindex: "-1" });
    area.replaceChildren(root);
    [area.hidden, empty.hidden] = [false, true];
    now.shown = mountViewer(root, described, cube, { inside: true });
    if (angle !== undefined) now.shown.turnTo(angle);
  }

  return {
    update({ solving }) {
      if (solving && solving.version > 0) now.wanted = solving.version;
      follow();
    },
    opened: follow,
  };
}
