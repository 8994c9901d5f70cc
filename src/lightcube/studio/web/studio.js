// Puts the studio's page together: its frame, its parts, and the stream of what happens.

import { askOf, sentenceOf } from "./tools/asking.js";
import { createFrame } from "./tools/frame.js";
import { listenTo } from "./tools/listening.js";

/**
 * What every part is given.
 *
 * `state` is how all stands, as /api/state tells it; `kinds` what can be made, `kind()` what is to be made; `ask(path, given)` asks the API and says a sentence where that is
 * refused (it then returns null); `on(name, heard)` hears events of the stream, "state" among them; `say(sentence, kind)`
 * says a sentence, kind "good" or "bad"; `open(door)` goes to a door, `goTo(part)` to a part.
 *
 * A part is a module `parts/NAME.js` that exports `mount(section, studio)`; it fills the section, which has its heading
 * already, and may return `{ update(state), opened() }`: called with every new state, and when its door is opened.
 */
async function openStudio(root) {
  const heard = new Map();
  const studio = {
    root,
    state: null,
    say: (sentence) => (root.firstElementChild.textContent = sentence), // until there is a frame to say it in
    on(name, callback) {
      heard.set(name, [...(heard.get(name) ?? []), callback]);
    },
    hear(name, facts) {
      for (const callback of heard.get(name) ?? []) callback(facts);
    },
  };
  studio.ask = askOf(studio);
  const [known, kinds, state] = await Promise.all(["parts", "kinds", "state"].map((asked) => studio.ask(`/api/${asked}`)));
  if (known === null || kinds === null || state === null) return;
  Object.assign(studio, { state, kinds, kind: () => kinds.find(({ name }) => name === studio.state.settings.kind) });
  const frame = createFrame(studio, known);
  Object.assign(studio, { say: frame.say, open: frame.open, goTo: frame.goTo });
  root.replaceChildren(...frame.elements);
  studio.on("state", (facts) => {
    studio.state = facts;
    frame.update(facts);
  });
  if (state.trouble) frame.say(sentenceOf(state.trouble), "bad");
  await Promise.all(known.map(async ({ name }) => {
    const { mount } = await import(`./parts/${name}.js`);
    const made = mount(frame.sections.get(name), studio) ?? {};
    if (made.update) {
      studio.on("state", made.update);
      made.update(studio.state);
    }
    if (made.opened) frame.whenOpened(name, made.opened);
  }));
  frame.update(studio.state);
  root.dataset.ready = "";
  listenTo(studio);
}

openStudio(document.getElementById("studio"));
