// Making the cube: the wall becomes sharper as it is solved; pause, keep, go on.

import { element } from "/viewer/tools/elements.js";
import { sentenceOf } from "../tools/asking.js";

const BUTTONS = [
  ["start", "Make it", "main"],
  ["stop", "Stop", "switch"],
  ["pause", "Pause", "switch"],
  ["resume", "Go on", "main"],
  ["keep", "Stop and keep", "switch"],
  ["discard", "Throw it away", "switch"],
];

/** Fill the section in which the cube is made. */
export function mount(section, studio) {
  const does = Object.fromEntries(BUTTONS.map(([deed, text, kind]) => [deed, element("button", { type: "button", class: kind, text, "data-deed": deed,
    click: () => studio.ask(`/api/solving/${deed}`, { method: "POST" }) })]));
  const said = element("p", { class: "state", role: "status" });
  const found = element("ul", { class: "notes" });
  const bar = element("progress", { max: "1", value: "0", "aria-label": "How far it is" });
  const walls = element("ol", { class: "walls live", "aria-label": "What the wall shows now" });
  const curve = element("canvas", { width: "600", height: "120", "aria-hidden": "true" });
  const more = element("details", { class: "curve" }, element("summary", { text: "How it went" }), curve,
    element("p", { class: "quiet", text: "The higher, the nearer the pictures come to what is wanted (decibels)." }));
  const turn = element("button", { type: "button", class: "switch", text: "Turn it", click: () => studio.goTo("turning") });
  section.append(element("div", { class: "row" }, ...Object.values(does), turn), bar, said, found, walls, more);
  let [points, kind] = [[], ""];

  function show(facts) {
    const { status, can, done, of, changed } = facts;
    section.dataset.status = status;
    for (const [deed, button] of Object.entries(does)) button.hidden = !can.includes(deed);
    const { called, are } = studio.kind();
    const { used, least } = studio.state.pictures;
    const enough = used >= least;
    does.start.disabled = !enough;
    does.start.textContent = status === "idle" ? `Make ${called}` : are === "are" ? "Make them anew" : "Make it anew";
    does.start.className = ["done", "kept", "paused", "failed"].includes(status) && !changed ? "switch" : "main";
    does.resume.className = does.start.className === "main" ? "switch" : "main";
    turn.hidden = facts.version === 0 || document.getElementById("part-turning") === null;
    bar.hidden = !["running", "stopping", "resting", "paused"].includes(status);
    if (status === "running" && of === 0) bar.removeAttribute("value");
    else bar.value = of ? done / of : 0;
    said.textContent = stateOf(facts, enough, studio.kind());
    found.replaceChildren(...(facts.said ?? []).map((line) => element("li", { text: sentenceOf(line) })));
    section.toggleAttribute("data-bad", status === "failed");
    if (facts.psnr !== null && of) {
      if (points.at(-1)?.[0] > done / of) points = [];
      points.push([done / of, facts.psnr]);
      draw(curve, points);
    }
    more.hidden = points.length < 2;
    if (status === "idle") walls.replaceChildren();
    if (kind !== facts.kind) {
      kind = facts.kind;
      walls.classList.toggle("on-paper", kind === "shape");
      begin();
    }
  }

  function look({ pictures, voxels }) {
    const items = [...walls.children];
    if (items.length !== pictures.length) {
      walls.replaceChildren(...pictures.map(({ name, image }) => element("li", {}, element("img", { alt: `${name} on the wall now`, src: `data:image/png;base64,${image}` }), element("span", { class: "name", text: name }))));
    } else {
      for (const [number, { name, image }] of pictures.entries()) {
        items[number].querySelector("img").src = `data:image/png;base64,${image}`;
        items[number].querySelector(".name").textContent = name;
      }
    }
    walls.dataset.voxels = voxels;
  }

  studio.on("solving", (facts) => (facts.wall ? look(facts.wall) : show({ ...studio.state.solving, ...facts })));
  studio.on("solving", (facts) => {
    if (!facts.wall) studio.state.solving = facts;
  });
  /** Show how it stands where nothing was heard of it yet. */
  async function begin() {
    const facts = await studio.ask("/api/solving");
    if (facts === null || facts.kind !== kind) return;
    points = facts.curve;
    look(facts.wall);
    show(facts);
    if (points.length > 1) draw(curve, points);
  }

  return { update: (state) => show(state.solving) };
}

/** What is said of how it stands. */
function stateOf({ status, sentence, left_s, psnr, changed, done, of }, enough, { called, are, can_pause: canPause }) {
  const name = `${called[0].toUpperCase()}${called.slice(1)}`;
  const were = are === "are" ? "were" : "was";
  if (status === "running" && sentence) return `${sentenceOf(sentence).replace(/\.$/, "")} …`;
  const part = `${Math.round((100 * done) / Math.max(of, 1))} %`;
  if (status === "running") return left_s === null ? (of ? `${part} …` : "Begun …") : `${leftOf(left_s)}${qualityOf(psnr)}`;
  if (status === "stopping") return "Stopping after this pass …";
  if (status === "resting") return "Going on in a moment …";
  if (status === "paused") return sentence ? sentenceOf(sentence) : `Paused at ${part}. Nothing is lost.`;
  if (status === "failed") return sentenceOf(sentence);
  if (status === "kept") return `Stopped and kept: ${called} ${are} as far as ${are === "are" ? "they were" : "it was"}. You can still go on.`;
  if (status === "done") return changed ? `${name} ${are} finished, and ${were} made before your last changes.` : `${name} ${are} finished${qualityOf(psnr)}`;
  if (!enough) return "More pictures are needed.";
  return `It takes a minute or so. You can watch, ${canPause ? "pause" : "stop"}, and come back later.`;
}

function leftOf(seconds) {
  if (seconds < 5) return "A few seconds left";
  if (seconds < 90) return `About ${Math.ceil(seconds / 5) * 5} s left`;
  return `About ${Math.ceil(seconds / 60)} min left`;
}

function qualityOf(psnr) {
  if (psnr === null) return ".";
  const word = psnr >= 38 ? "hard to tell from what you dropped" : psnr >= 33 ? "good" : psnr >= 26 ? "fair" : "still rough";
  return `. The pictures are ${word}.`;
}

/** Draw the curve of how good the pictures were. */
function draw(canvas, points) {
  const paint = canvas.getContext("2d");
  const style = getComputedStyle(canvas);
  const [low, high] = [Math.min(...points.map(([, y]) => y)) - 1, Math.max(...points.map(([, y]) => y)) + 1];
  paint.clearRect(0, 0, canvas.width, canvas.height);
  paint.strokeStyle = style.getPropertyValue("--accent");
  paint.lineWidth = 3;
  paint.beginPath();
  for (const [x, y] of points) paint.lineTo(8 + x * (canvas.width - 60), canvas.height - 8 - ((y - low) / (high - low)) * (canvas.height - 16));
  paint.stroke();
  const [x, y] = points.at(-1);
  paint.fillStyle = style.getPropertyValue("--soft");
  paint.font = "20px system-ui";
  paint.fillText(y.toFixed(0), 14 + x * (canvas.width - 60), canvas.height - 2 - ((y - low) / (high - low)) * (canvas.height - 16));
}
