// The frame of the page: its head, its doors, a section for each part, what is said, and the command at the bottom.

import { element, icon } from "/viewer/tools/elements.js";

const DOORS = [["make", "Make"], ["lessons", "Lessons"], ["room", "Room"]];
/** Milliseconds that a good sentence stays. */
const STAYS = 6000;

/**
 * @param {Object} studio
 * @param {{name: string, title: string, door: string}[]} known the parts
 */
export function createFrame(studio, known) {
  const sections = new Map(known.map((part) => [part.name, sectionOf(part)]));
  const doors = DOORS.filter(([door]) => known.some((part) => part.door === door));
  const opened = new Map();
  const said = element("div", { class: "said", role: "status", "aria-live": "polite" });
  const head = headOf(studio, doors, open);
  const main = element("main", { id: "main" }, ...sections.values());
  const command = commandLine(studio);
  let hiding = 0;

  function say(sentence, kind = "good") {
    clearTimeout(hiding);
    const close = element("button", { type: "button", class: "icon", "aria-label": "Close this", click: () => said.replaceChildren() }, icon("close"));
    said.replaceChildren(element("p", { class: kind, text: sentence }), close);
    if (kind === "good") hiding = setTimeout(() => said.replaceChildren(), STAYS);
  }

  function open(door) {
    if (![undefined, door].includes(studio.root.dataset.door)) scrollTo({ top: 0, behavior: "instant" });
    studio.root.dataset.door = door;
    for (const part of known) sections.get(part.name).hidden = part.door !== door;
    for (const [name, link] of head.doors) link.toggleAttribute("data-open", name === door);
    for (const [name, link] of head.doors) link.setAttribute("aria-current", name === door ? "page" : "false");
    command.element.hidden = door !== "make";
    if (location.hash !== `#${door}`) history.replaceState(null, "", `#${door}`);
    for (const part of known) if (part.door === door) opened.get(part.name)?.();
  }

  function goTo(name) {
    open(known.find((part) => part.name === name)?.door ?? "make");
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    sections.get(name)?.scrollIntoView({ behavior: calm ? "auto" : "smooth", block: "start" });
  }

  followTheme(studio.root);
  const asked = location.hash.slice(1);
  open(doors.some(([door]) => door === asked) ? asked : "make");
  return {
    elements: [element("a", { class: "skip", href: "#main", text: "Go to the content" }), head.element, said, main, command.element],
    sections,
    say,
    open,
    goTo,
    whenOpened: (name, callback) => {
      opened.set(name, callback);
      if (!sections.get(name).hidden) callback();
    },
    update(state) {
      head.update(state);
      command.update(state);
    },
  };
}

function sectionOf({ name, title }) {
  return element("section", { class: `part ${name}`, id: `part-${name}`, "aria-labelledby": `title-${name}` },
    element("h2", { id: `title-${name}`, text: title }));
}

function headOf(studio, doors, open) {
  const title = element("input", {
    class: "project", type: "text", maxlength: "120", "aria-label": "Title of this project", placeholder: "Untitled",
    change: async () => {
      const state = await studio.ask("/api/settings", { method: "PATCH", json: { title: title.value } });
      title.value = (state ?? studio.state).settings.title; // what was refused goes back
    },
  });
  const step = (way, label, key) => element("button", {
    type: "button", class: "switch", title: `${label} (${key})`, disabled: true, click: () => studio.ask(`/api/${way}`, { method: "POST" }),
  }, icon(way), element("span", { text: label }));
  const [undo, redo] = [step("undo", "Undo", "Ctrl Z"), step("redo", "Redo", "Ctrl Shift Z")];
  const theme = element("button", { type: "button", class: "icon", "aria-label": "Light or dark", title: "Light or dark",
    click: () => setTheme(studio.root, studio.root.dataset.theme !== "dark", true) }, icon("theme"));
  const links = doors.map(([door, text]) => [door, element("button", { type: "button", class: "door", click: () => open(door), text })]);
  document.addEventListener("keydown", (event) => {
    const typing = event.target.closest("input:not([type=range], [type=checkbox], [type=file]), textarea, dialog");
    if (typing || !(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
    event.preventDefault();
    (event.shiftKey ? redo : undo).click();
  });
  return {
    doors: links,
    element: element("header", { class: "head" },
      element("h1", {}, element("img", { src: "/web/icon.svg", alt: "", width: "26", height: "26" }), element("span", { text: "Lightcube studio" })),
      title,
      element("div", { class: "history" }, undo, redo),
      doors.length > 1 ? element("nav", { "aria-label": "Doors" }, ...links.map(([, link]) => link)) : null,
      theme),
    update(state) {
      if (document.activeElement !== title) title.value = state.settings.title;
      document.title = `${state.settings.title || "Untitled"} · Lightcube studio`;
      undo.disabled = !state.can_undo;
      redo.disabled = !state.can_redo;
    },
  };
}

/** The command that does the same in a terminal, to be copied. */
function commandLine(studio) {
  const code = element("code", { tabindex: "0", "aria-label": "The same as a command" });
  const copy = element("button", { type: "button", class: "switch", text: "Copy", click: async () => {
    const copied = await navigator.clipboard.writeText(code.textContent).then(() => true, () => false);
    studio.say(copied ? "The command is copied." : "Your browser does not let a page copy: select the command and copy it.", copied ? "good" : "bad");
  } });
  const line = element("footer", { class: "command" }, element("span", { text: "In a terminal" }), code, copy);
  return {
    element: line,
    update(state) {
      code.textContent = state.solving?.command ?? "";
      line.toggleAttribute("data-empty", !code.textContent);
    },
  };
}

function setTheme(root, dark, chosen = false) {
  root.dataset.theme = dark ? "dark" : "light";
  document.documentElement.dataset.theme = root.dataset.theme;
  if (chosen) root.dataset.chosen = "";
}

/** As the system has it, until a person chooses. */
function followTheme(root) {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const follow = () => {
    if (!("chosen" in root.dataset)) setTheme(root, system.matches);
  };
  system.addEventListener("change", follow);
  follow();
}
