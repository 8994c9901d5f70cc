// Turn: the newest thing in its viewer, its wall large; also while it is still becoming.

import { gunzip, readScene, readVoxels } from "/viewer/model/data.js";
import { element } from "/viewer/tools/elements.js";
import { wear } from "../tools/wearing.js";

/** Fill the section of what is turned. */
export function mount(section, studio) {
  wear("/web/turning/turning.css");
  const empty = element("p", { class: "quiet", text: "Here it is turned, as soon as there is something of it." });
  const area = element("div", { class: "turned", hidden: true });
  section.append(empty, area);
  const now = { shown: null, wanted: null, version: null, busy: false, kind: null };

  /** Show the newest thing, at the angle of the one before; one at a time, and none while it is not to be seen. */
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

  /** Show nothing, until there is something of another kind. */
  function leave(kind) {
    now.shown?.dispose();
    Object.assign(now, { kind, shown: null, wanted: null, version: null });
    [area.hidden, empty.hidden] = [true, false];
  }

  async function show(scene, voxels) {
    const described = await readScene(scene);
    const open = await viewerOf(described, voxels);
    const before = now.shown;
    const angle = before?.angle;
    before?.dispose();
    const root = element("div", { tabindex: "-1" });
    area.replaceChildren(root);
    [area.hidden, empty.hidden] = [false, true];
    now.shown = open(root);
    if (angle !== undefined) now.shown.turnTo?.(angle);
  }

  function hear({ kind, version = 0 }) {
    if (kind === undefined) return;
    if (kind !== now.kind) leave(kind);
    if (version > 0) now.wanted = `${kind} ${version}`;
    follow();
  }

  studio.on("solving", hear);
  return {
    update: (state) => hear(state.solving),
    opened: follow,
  };
}

/** What opens the viewer of a thing; its modules come when the first of its kind is there. */
async function viewerOf(scene, data) {
  if (scene.kind === "relief") {
    const [{ mountRelief }, { heightsOf }] = await Promise.all([import("/viewer/plate.js"), import("/viewer/model/relief.js")]);
    const heights = heightsOf(await gunzip(data, "heights"), scene);
    return (root) => mountRelief(root, scene, heights, { inside: true });
  }
  if (scene.kind === "films") {
    const [{ mountFilms }, { filmsOf }] = await Promise.all([import("/viewer/films.js"), import("/viewer/model/films.js")]);
    const films = filmsOf(await gunzip(data, "films"), scene);
    return (root) => mountFilms(root, scene, films, { inside: true });
  }
  const [{ mount }, voxels] = await Promise.all([import("/viewer/app.js"), readVoxels(data, scene)]);
  return (root) => mount(root, scene, voxels, { inside: true });
}
