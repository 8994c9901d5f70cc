// Asks the studio's API; what it refuses is said in the page.

const GONE = "The studio does not answer. Where it was started again, go on in the tab that it opened; else start it in its terminal: nothing is lost.";

/**
 * A function that asks; what does something waits until settings that were changed before it are kept.
 *
 * @param {Object} studio says what is refused
 * @returns {function(string, Object): Promise<any>} takes a path and `{method, json, body, refused}`; returns what the
 *   API answers, or null where it refuses or has nothing; `refused` is told the sentence, which is else said in the page
 */
export function askOf(studio) {
  let changed = null;
  return async (path, { method, json, body, refused = (sentence) => studio.say(sentence, "bad") } = {}) => {
    const given = { method: method ?? (json === undefined && body === undefined ? "GET" : "POST"), body };
    if (json !== undefined) Object.assign(given, { body: JSON.stringify(json), headers: { "content-type": "application/json" } });
    const before = given.method === "GET" ? null : changed;
    const answering = (before ?? Promise.resolve()).then(() => fetch(path, given));
    if (given.method === "PATCH") changed = answering.catch(() => {});
    try {
      const answer = await answering;
      if (answer.status === 204) return null;
      const said = await answer.json();
      if (answer.ok) return said;
      refused(sentenceOf(said.sentence));
    } catch {
      refused(GONE);
    }
    return null;
  };
}

/** A sentence as it stands in a page: with a capital, but where a file's name begins it, and a full stop. */
export function sentenceOf(text) {
  const isName = /^\S*\.\w/.test(text);
  const said = isName ? text : text ? `${text[0].toUpperCase()}${text.slice(1)}` : "This could not be done";
  return /[.!?…]$/.test(said) ? said : `${said}.`;
}
