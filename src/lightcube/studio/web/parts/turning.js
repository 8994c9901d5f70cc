// Turn: the newest thing in its viewer, its wall large; also while it is still becoming.

import { fromBase64, gunzip, readScene, readVoxels } from "/viewer/model/data.js";
import { element } from "/viewer/tools/elements.js";
import { wear } from "../tools/wearing.js";

/** Fill the section of what is turned. */
export function mount(section, studio) {
  wear("/web/turning/turning.css");
  const empty = element("p", { class: "quiet", text: "Here it is turned, as soon as there is something of it." });
  const area = element("div", { class: "turned", hidden: true });
  section.append(empty, area);
  const now = { kind: null, shown: null, wanted: "", got: "", busy: false, touched: false };

  /** A thing that is made counts more than the forecast's, which is shown while there is none. */
  function want({ solving, forecast }) {
    if (solving === undefined) return;
    const { kind, version } = solving;
    if (kind !== now.kind) leave(kind);
    if (version > 0) now.wanted = `${kind} made ${version}`;
    else if (forecast?.cube > 0) now.wanted = `${kind} first ${forecast.cube}`;
    follow();
  }

  /** Show nothing, until there is something of another kind. */
  function leave(kind) {
    now.shown?.dispose();
    Object.assign(now, { kind, shown: null, wanted: "", got: "", touched: false });
    [area.hidden, empty.hidden] = [true, false];
  }

  /** Show the newest thing, at the angle to which the one before was turned; one at a time, and none that is not seen or is being held. */
  async function follow() {
    if (now.busy || section.hidden || now.wanted === now.got || area.matches(":active")) return;
    now.busy = true;
    const { kind, wanted } = now;
    try {
      const made = await studio.ask("/api/cube", { refused: () => {} }); // what is gone is said by the stream
      const open = made && await viewerOf(await readScene(fromBase64(made.scene)), fromBase64(made.voxels));
      if (open !== null && kind === now.kind) show(open);
    } catch (error) {
      studio.say(`${error.message[0].toUpperCase()}${error.message.slice(1)}.`, "bad");
    }
    Object.assign(now, { busy: false, got: wanted });
    follow();
  }

  function show(open) {
    const before = now.shown;
    const angle = before?.angle;
    const focused = places().indexOf(document.activeElement);
    before?.dispose();
    const root = element("div", { tabindex: "-1" });
    area.replaceChildren(root);
    [area.hidden, empty.hidden] = [false, true];
    now.shown = open(root);
    if (angle !== undefined && now.touched) now.shown.turnTo?.(angle);
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
    if (now.shown === null) now.got = ""; // what was made is not there yet
    want({ solving: studio.state.solving, forecast: { cube } });
  });
  return { update: want, opened: follow };
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
