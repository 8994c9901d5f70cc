// Opens the page: reads the data behind this text, shows the cube, the films or the relief, and says a sentence where that fails.

import { mount } from "./app.js";
import { mountFilms } from "./films.js";
import { fromBase64, gunzip, readScene, readVoxels } from "./model/data.js";
import { filmsOf } from "./model/films.js";
import { heightsOf } from "./model/relief.js";
import { mountRelief } from "./plate.js";

/** Say a sentence instead of the page; it comes without capital and full stop. */
function saySentence(root, sentence) {
  const said = document.createElement("p");
  said.className = "message";
  said.setAttribute("role", "alert");
  said.textContent = `${sentence[0].toUpperCase()}${sentence.slice(1)}.`;
  root.replaceChildren(said);
}

/** Bytes of a part of the document, by its id. */
function bytesOf(id) {
  const part = document.getElementById(id);
  const text = part === null ? "" : part.textContent.trim();
  if (text === "") throw new Error(`this page is incomplete, it ends before its ${id}: save or write it again`);
  return fromBase64(text);
}

async function openPage(root) {
  try {
    const scene = await readScene(bytesOf("scene"));
    if (scene.kind === "relief") mountRelief(root, scene, heightsOf(await gunzip(bytesOf("voxels"), "heights"), scene));
    else if (scene.kind === "films") mountFilms(root, scene, filmsOf(await gunzip(bytesOf("voxels"), "films"), scene));
    else mount(root, scene, await readVoxels(bytesOf("voxels"), scene));
  } catch (error) {
    const damaged = error instanceof ReferenceError || error instanceof TypeError || error instanceof SyntaxError;
    const said = `this page's program is damaged (${error.message}): write or send the page again`;
    saySentence(root, damaged ? said : error.message);
  }
}

// the data may come after this text
document.getElementById("lightcube").dataset.opened = "";
openPage(document.getElementById("lightcube"));
