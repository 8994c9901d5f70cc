// Puts a list in order: items are dragged by hand, or moved by Alt with the arrow keys.

const FAR = 6;

/**
 * @param {HTMLElement} list of items with `data-key`
 * @param {function(string[]): void} ordered called with all keys in their new order
 */
export function listenToOrder(list, ordered) {
  let [held, begin, moving] = [null, null, false];
  const keys = () => [...list.children].map((item) => item.dataset.key);

  list.addEventListener("pointerdown", (event) => {
    const item = event.target.closest("[data-key]");
    if (item === null || event.button !== 0 || event.target.closest("button, input")) return;
    [held, begin, moving] = [item, [event.clientX, event.clientY], false];
  });
  addEventListener("pointermove", (event) => {
    if (held === null) return;
    if (!moving && Math.hypot(event.clientX - begin[0], event.clientY - begin[1]) < FAR) return;
    if (!moving) held.setPointerCapture(event.pointerId);
    moving = true;
    held.setAttribute("data-held", "");
    const below = [...list.children].find((item) => {
      const box = item.getBoundingClientRect();
      return item !== held && event.clientX > box.left && event.clientX < box.right && event.clientY > box.top && event.clientY < box.bottom;
    });
    if (below === undefined) return;
    const order = [...list.children];
    list.insertBefore(held, order.indexOf(below) > order.indexOf(held) ? below.nextSibling : below);
  });
  const end = () => {
    if (held === null) return;
    held.removeAttribute("data-held");
    if (moving) ordered(keys());
    [held, moving] = [null, false];
  };
  addEventListener("pointerup", end);
  addEventListener("pointercancel", end);
  list.addEventListener("keydown", (event) => {
    const item = event.target.closest("[data-key]");
    const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!event.altKey || way === undefined || item === null) return;
    event.preventDefault();
    const order = keys();
    const at = order.indexOf(item.dataset.key);
    if (at + way < 0 || at + way >= order.length) return;
    [order[at], order[at + way]] = [order[at + way], order[at]];
    ordered(order);
  });
}
