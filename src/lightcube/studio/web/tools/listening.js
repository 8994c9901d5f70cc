// Follows the stream of events; where it breaks off the browser goes on after the last one that it heard.

const NAMES = ["state", "forecast", "solving", "taking"];

/** Hand every event of the stream on to whoever hears its name; say once when the studio is gone. */
export function listenTo(studio) {
  const stream = new EventSource("/api/events");
  for (const name of NAMES) {
    stream.addEventListener(name, (event) => studio.hear(name, JSON.parse(event.data)));
  }
  let gone = 0;
  stream.addEventListener("open", () => {
    clearTimeout(gone);
    gone = 0;
    if (studio.root.hasAttribute("data-gone")) studio.say("The studio is back.", "good");
    studio.root.removeAttribute("data-gone");
  });
  stream.addEventListener("error", () => {
    gone ||= setTimeout(() => { // the browser tries again every second, and each time tells of it
      studio.root.setAttribute("data-gone", "");
      studio.say("The studio does not answer: start it again in its terminal; nothing is lost.", "bad");
      if (stream.readyState === EventSource.CLOSED) setTimeout(() => location.reload(), 5000);
    }, 2500);
  });
}
