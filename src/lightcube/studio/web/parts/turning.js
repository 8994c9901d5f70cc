// Turn: the newest cube in the viewer, its wall large; also while it is still becoming.

import { readScene, readVoxels } from "/viewer/model/data.js";
import { element } from "/viewer/tools/elements.js";
import { wear } from "../tools/wearing.js";

/** Fill the section of the turning cube. */
export function mount(section, studio) {
  wear("/web/turning/turning.css");
  const empty = element("p", { class: "quiet", text: "Here the cube is turned, as soon as there is something of it." });
  const area = element("div", { class: "turned", hidden: true });
  section.append(empty, area);
  const now = { shown: null, wanted: "", got: "", busy: false, touched: false };

  /** A made cube counts more than the forecast's, which is shown while there is none. */
  function want({ solving, forecast }) {
    const isMade = solving?.version > 0;
    if (isMade) now.wanted = `made ${solving.version}`;
    else if (forecast?.cube > 0) now.wanted = `first ${forecast.cube}`;
    follow();
  }

  /** Show the newest cube, at the angle to which the one before was turned; one at a time, and none that is not seen or is being held. */
  async function follow() {
    if (now.busy || section.hidden || now.wanted === now.got || area.matches(":active")) return;
    now.busy = true;
    const wanted = now.wanted;
    try {
      const parts = await Promise.all(["scene", "voxels"].map((part) => fetch(`/api/cube/${part}`)));
      if (parts.every((part) => part.status === 200)) await show(...await Promise.all(parts.map(async (part) => new Uint8Array(await part.arrayBuffer()))));
    } catch (error) {
      studio.say(`${error.message[0].toUpperCase()}${error.message.slice(1)}.`, "bad");
    }
    Object.assign(now, { busy: false, got: wanted });
    follow();
  }

  async function show(scene, voxels) {
    const [described, { mount: mountViewer }] = await Promise.all([readScene(scene), import("/viewer/app.js")]);
    const cube = await readVoxels(voxels, described);
    const before = now.shown;
    const angle = before?.angle;
    const focused = places().indexOf(document.activeElement);
    before?.dispose();
    const root = element("div", { tabindex: "-1" });
    area.replaceChildren(root);
    [area.hidden, empty.hidden] = [false, true];
    now.shown = mountViewer(root, described, cube, { inside: true });
    if (angle !== undefined && now.touched) now.shown.turnTo(angle);
    places()[focused]?.focus({ preventScroll: true });
  }

  /** All in the viewer that can have the focus. */
  function places() {
    return [...area.querySelectorAll("button, input, select, [tabindex]")];
  }

  for (const name of ["pointerdown", "keydown", "wheel"]) area.addEventListener(name, () => (now.touched = true), { passive: true });
  for (const name of ["pointerup", "pointercancel"]) addEventListener(name, () => setTimeout(follow));
  studio.on("solving", (facts) => facts.version !== undefined && want({ solving: facts }));
  studio.on("forecast", ({ cube }) => {
    if (cube === undefined) return;
    if (now.shown === null) now.got = ""; // a cube that was made is not there yet
    want({ solving: studio.state.solving, forecast: { cube } });
  });
  return { update: want, opened: follow };
}
