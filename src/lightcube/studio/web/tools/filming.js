// Asks which part of a video is taken.

import { element } from "/viewer/tools/elements.js";
import { openDialog } from "./dialogs.js";

/** @returns {Promise<Object|null>} from_s, to_s, every, as far as they are said; null where it is left out */
export function askFilm(root, file) {
  const address = URL.createObjectURL(file);
  const film = element("video", { src: address, controls: true, muted: true, playsinline: true, class: "film" });
  const [from, to, every] = [["From, in seconds", "0"], ["To, in seconds", "the end"], ["One of so many pictures", "12 in all"]].map(([label, usual]) =>
    [label, element("input", { type: "number", min: "0", step: "any", placeholder: usual })]);
  every[1].min = "1";
  every[1].step = "1";
  const here = (which) => element("button", { type: "button", class: "switch", text: "here", title: "Where the video stands now",
    click: () => (which.value = film.currentTime.toFixed(1)) });
  const fields = [from, to, every].map(([label, input], number) =>
    element("label", {}, element("span", { text: label }), input, number < 2 ? here(input) : null));
  const part = () => Object.fromEntries([["from_s", from[1]], ["to_s", to[1]], ["every", every[1]]].map(([name, input]) => [name, input.value]).filter(([, value]) => value !== ""));
  return openDialog(root, `Pictures of ${file.name}`, [film, element("div", { class: "fields" }, ...fields)], "Take these", part)
    .finally(() => URL.revokeObjectURL(address));
}
