// Follows the stream of events; where it breaks off the browser goes on after the last one that it heard.

const NAMES = ["state", "forecast", "solving", "taking"];
/** Milliseconds until it is said that the studio is gone, and until it is tried again where the browser has given up. */
const [PATIENCE, AGAIN] = [2500, 3000];

/** Hand every event of the stream on to whoever hears its name; say once when the studio is gone, and why. */
export function listenTo(studio) {
  const { root } = studio;
  const stream = new EventSource("/api/events");
  for (const name of NAMES) {
    stream.addEventListener(name, (event) => studio.hear(name, JSON.parse(event.data)));
  }
  let waiting = 0;
  stream.addEventListener("open", () => {
    clearTimeout(waiting);
    waiting = 0;
    if (root.hasAttribute("data-gone")) studio.say("The studio is back.", "good");
    root.removeAttribute("data-gone");
  });
  stream.addEventListener("error", () => {
    // the browser tries again every second and tells of it each time, but not where it was refused
    if (stream.readyState === EventSource.CLOSED) setTimeout(() => listenTo(studio), AGAIN);
    waiting ||= setTimeout(() => {
      const how = stream.readyState === EventSource.CLOSED ? "refused" : "silent";
      if (root.dataset.gone !== how) studio.ask("/api/state"); // which says why there is no answer
      root.dataset.gone = how;
    }, PATIENCE);
  });
}
