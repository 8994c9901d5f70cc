// The pictures: dropped, pasted, taken by a webcam, or a set to try; the strip in which they are named, cropped, ordered.

import { element, icon } from "/viewer/tools/elements.js";
import { sentenceOf } from "../tools/asking.js";
import { openCrop } from "../tools/cropping.js";
import { askFilm } from "../tools/filming.js";
import { glyph } from "../tools/glyphs.js";
import { listenToOrder } from "../tools/ordering.js";
import { openWebcam } from "../tools/webcam.js";

/** Sentences on what was dropped that are said at once. */
const MOST_SAID = 3;
const FILMS = /\.(mp4|webm|mkv|mov|avi)$/i;
const TYPES = ".png,.jpg,.jpeg,.webp,.tif,.tiff,.avif,.heic,.heif,.gif,.apng,.mp4,.webm,.mkv,.mov,.avi,image/*,video/*";

/** Fill the section of the pictures. */
export function mount(section, studio) {
  const chooser = element("input", { type: "file", multiple: true, accept: TYPES, class: "unseen", tabindex: "-1", "aria-label": "Picture files",
    change: () => takeAll([...chooser.files]).then(() => (chooser.value = "")) });
  const strip = element("ol", { class: "strip", "aria-label": "Pictures, in the order of the turn" });
  const counted = element("p", { class: "quiet counted" });
  const progress = element("p", { class: "quiet taking-in", role: "status" });
  const samples = element("div", { class: "row samples" });
  const wants = element("p", { class: "quiet" });
  const welcome = element("div", { class: "welcome" },
    glyph("drop"),
    element("p", { class: "big", text: "Drop pictures here" }),
    wants);
  const tools = element("div", { class: "row tools-of-pictures" },
    element("button", { type: "button", class: "main choose", text: "Choose pictures", click: () => chooser.click() }),
    element("button", { type: "button", class: "switch", click: webcam }, glyph("camera"), element("span", { text: "Webcam" })),
    element("span", { class: "quiet paste", text: "or paste one with Ctrl V" }));
  const zone = element("div", { class: "zone" }, welcome, tools, chooser, samples, progress);
  const clear = element("button", { type: "button", class: "switch", text: "Remove all", click: () => studio.ask("/api/pictures", { method: "PUT", json: { keys: [] } }) });
  section.append(zone, element("div", { class: "row above-strip" }, counted, clear), strip);
  listenToOrder(strip, (keys) => studio.ask("/api/pictures", { method: "PUT", json: { keys } }));
  listenToDrops(section, takeAll);
  let known = "";

  async function takeAll(files) {
    const room = studio.state.pictures.most - studio.state.settings.pictures.length;
    if (files.length > room) {
      studio.say(`These are ${files.length} files, and there is room for ${room}: a project has at most ${studio.state.pictures.most} pictures. Drop fewer.`, "bad");
      return;
    }
    const [notes, refused] = [[], []];
    for (const [number, file] of files.entries()) {
      progress.textContent = files.length > 1 ? `Reading ${number + 1} of ${files.length}: ${file.name}` : `Reading ${file.name}`;
      const part = FILMS.test(file.name) ? await askFilm(studio.root, file) : {};
      if (part === null) continue;
      const asked = new URLSearchParams({ name: file.name || "pasted.png", ...part });
      const answer = await studio.ask(`/api/uploads?${asked}`, { method: "POST", body: file, refused: (sentence) => refused.push(sentence) });
      notes.push(...(answer?.notes ?? []));
    }
    progress.textContent = "";
    const said = [...new Set([...refused, ...notes.map(sentenceOf)])];
    const more = said.length > MOST_SAID ? ` And ${said.length - MOST_SAID} more of the kind.` : "";
    if (said.length) studio.say(`${said.slice(0, MOST_SAID).join(" ")}${more}`, refused.length ? "bad" : "good");
  }

  async function webcam() {
    const taken = await openWebcam(studio);
    if (taken !== null) await takeAll([taken]);
  }

  document.addEventListener("paste", (event) => {
    const files = [...(event.clipboardData?.files ?? [])].filter((file) => /^(image|video)\//.test(file.type));
    if (!files.length) return;
    event.preventDefault();
    takeAll(files);
  });

  return {
    update({ settings, pictures }) {
      const asked = JSON.stringify([settings.pictures, pictures, settings.kind]);
      if (asked === known) return;
      known = asked;
      const count = settings.pictures.length;
      section.toggleAttribute("data-empty", count === 0);
      counted.textContent = countedOf(count, pictures, settings);
      wants.textContent = studio.kind().wants;
      clear.hidden = count < 2;
      samples.replaceChildren(element("span", { class: "quiet", text: "To try:" }), ...pictures.samples.map(({ name, title }) =>
        element("button", { type: "button", class: "switch", text: title, click: () => studio.ask(`/api/samples/${name}`, { method: "POST" }) })));
      fill(strip, settings, pictures, studio);
    },
  };
}

/** What is said of how many pictures there are. */
function countedOf(count, { used, least, takes }, { kind }) {
  const pictures = count === 1 ? "1 picture" : `${count} pictures`;
  const more = least - count;
  if (more > 0) return `${pictures}: ${more === 1 ? "one more at least is" : `${more} more at least are`} needed`;
  if (used < count && takes < count) return `${pictures}, of which the first ${used === 1 ? "is" : `${used} are`} used`;
  return kind === "cube" ? `${pictures}, in the order of the turn` : pictures;
}

/** Make the strip anew, and keep the focus where it was. */
function fill(strip, settings, known, studio) {
  const at = document.activeElement?.closest?.("[data-key]")?.dataset.key;
  const what = document.activeElement?.dataset?.does;
  strip.replaceChildren(...settings.pictures.map((picture, number) => itemOf(picture, number, known, studio)));
  if (at !== undefined) strip.querySelector(`[data-key="${at}"] [data-does="${what}"]`)?.focus({ preventScroll: true });
}

function itemOf(picture, number, { used, missing, places }, studio) {
  const { key, name, crop } = picture;
  const change = (json) => studio.ask(`/api/pictures/${key}`, { method: "PATCH", json });
  const gone = missing.includes(key);
  const image = element("img", { src: `/api/pictures/${key}?small=true`, alt: "", draggable: "false" });
  const shown = element("div", { class: "cropped" }, image);
  placeCrop(image, crop);
  const named = element("input", { type: "text", maxlength: "80", value: name, "aria-label": `Name of picture ${number + 1}`, "data-does": "name",
    change: async () => {
      if (!named.value.trim() || await change({ name: named.value.trim() }) === null) named.value = name;
    } });
  return element("li", { "data-key": key, "data-unused": number >= used, tabindex: "0", "data-does": "item",
    "aria-label": `Picture ${number + 1}, ${name}. Alt with the arrow keys moves it.` },
    element("span", { class: "number", text: (number < used && places[number]) || number + 1 }),
    gone ? element("p", { class: "gone", text: "This picture vanished from the folder: remove it." }) : shown,
    named,
    element("div", { class: "deeds" },
      element("button", { type: "button", class: "icon", "aria-label": `Crop ${name}`, title: "Crop", disabled: gone, "data-does": "crop",
        click: async () => {
          const cropped = await openCrop(studio.root, `/api/pictures/${key}`, name, crop);
          if (cropped !== null) change({ crop: cropped });
        } }, glyph("crop")),
      element("button", { type: "button", class: "icon", "aria-label": `Remove ${name}`, title: "Remove", "data-does": "remove",
        click: () => studio.ask(`/api/pictures/${key}`, { method: "DELETE" }) }, icon("close"))));
}

/** Show of a picture what is taken of it. */
function placeCrop(image, { left, top, width, height }) {
  const whole = left === 0 && top === 0 && width === 1 && height === 1;
  if (whole) return;
  Object.assign(image.style, {
    clipPath: `inset(${100 * top}% ${100 * (1 - left - width)}% ${100 * (1 - top - height)}% ${100 * left}%)`,
    scale: String(Math.min(1 / width, 1 / height, 4)),
    translate: `${100 * (0.5 - left - width / 2) * Math.min(1 / width, 1 / height, 4)}% ${100 * (0.5 - top - height / 2) * Math.min(1 / width, 1 / height, 4)}%`,
  });
}

/** Files may be dropped anywhere; the zone shows that it sees them. */
function listenToDrops(section, take) {
  const isOfFiles = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  document.addEventListener("dragover", (event) => {
    if (!isOfFiles(event)) return;
    event.preventDefault();
    section.setAttribute("data-over", "");
  });
  for (const name of ["dragleave", "drop", "dragend"]) {
    document.addEventListener(name, (event) => {
      if (name !== "dragleave" || event.relatedTarget === null) section.removeAttribute("data-over");
    });
  }
  document.addEventListener("drop", async (event) => {
    if (!isOfFiles(event)) return;
    event.preventDefault();
    take(await filesOf(event.dataTransfer));
  });
}

/** The files that were dropped; of a folder those that lie in it. */
async function filesOf({ items, files }) {
  const folders = [...items].map((item) => item.webkitGetAsEntry?.()).filter((entry) => entry?.isDirectory);
  const names = new Set(folders.map(({ name }) => name));
  const own = [...files].filter((file) => file.type || !names.has(file.name)); // now: soon nothing is left of them
  return [...own, ...(await Promise.all(folders.map(readFolder))).flat()];
}

/** The files that lie in a folder, by their names; what a system keeps there for itself is left out. */
async function readFolder(folder) {
  const [reader, found] = [folder.createReader(), []];
  for (let some = null; some === null || some.length;) { // some at a time, until there are none
    some = await new Promise((resolve) => reader.readEntries(resolve, () => resolve([])));
    found.push(...some.filter(({ isFile, name }) => isFile && !name.startsWith(".")));
  }
  found.sort((one, other) => one.name.localeCompare(other.name, undefined, { numeric: true }));
  const read = await Promise.all(found.map((entry) => new Promise((resolve) => entry.file(resolve, () => resolve(null)))));
  return read.filter((file) => file !== null);
}
