// Turns to the next stop, once, so that one sees what this is; or on and on, where the page's address says so.

/** What a page's address ends in that is to turn on and on, as one does that is shown in a frame of another page. */
const PLAYS = "#play";
/** Milliseconds after which it turns, if nobody has touched anything. */
const AFTER = 3500;
/** Seconds that it takes for it. */
const LASTS = 2.4;

/**
 * Turn to the next stop, once, or begin to play, some time after all was drawn; whoever touches anything before is not disturbed.
 * @param {HTMLElement} root
 * @param {Turning} turning
 * @param {function(): void} ask for a new drawing
 * @returns {{drawn: function(): void, end: function(): void}} to be called when all was drawn, and when it is to end
 */
export function createBeckoning(root, turning, ask) {
  const touches = ["pointerdown", "wheel"];
  let [timer, waits] = [0, true];
  const go = () => {
    end();
    if (turning.calm || turning.moving || turning.stops.length < 2 || turning.angle !== turning.stops[0]) return;
    if (location.hash === PLAYS) turning.play();
    else turning.glideTo(turning.stops[1], LASTS);
    ask();
  };
  function end() {
    waits = false;
    clearTimeout(timer);
    for (const touch of touches) root.removeEventListener(touch, end, true);
    document.removeEventListener("keydown", end, true); // which need not have its focus in here
  }
  for (const touch of touches) root.addEventListener(touch, end, true);
  document.addEventListener("keydown", end, true);
  return {
    drawn() {
      if (waits) timer = setTimeout(go, AFTER);
      waits = false;
    },
    end,
  };
}
