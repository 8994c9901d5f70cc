// Asks the studio's API; what it refuses is said in the page.

/**
 * A function that asks.
 *
 * @param {Object} studio says what is refused
 * @returns {function(string, Object): Promise<any>} takes a path and `{method, json, body, quiet}`; returns what the
 *   API answers, or null where it refuses, which is said unless `quiet`
 */
export function askOf(studio) {
  return async (path, { method, json, body, quiet = false } = {}) => {
    const given = { method: method ?? (json === undefined && body === undefined ? "GET" : "POST"), body };
    if (json !== undefined) Object.assign(given, { body: JSON.stringify(json), headers: { "content-type": "application/json" } });
    let answer = null;
    try {
      answer = await fetch(path, given);
      const said = await answer.json();
      if (answer.ok) return said;
      if (!quiet) studio.say?.(sentenceOf(said.sentence), "bad");
    } catch {
      if (!quiet) studio.say?.("The studio does not answer: is it still running in its terminal?", "bad");
    }
    return null;
  };
}

/** A sentence as it stands in a page: with a capital and a full stop. */
export function sentenceOf(text) {
  const said = text ? `${text[0].toUpperCase()}${text.slice(1)}` : "This could not be done";
  return /[.!?]$/.test(said) ? said : `${said}.`;
}
