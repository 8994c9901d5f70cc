// Style sheets of parts, each asked for when its part comes.

/** Let the page have a style sheet, once. */
export function wear(address) {
  if (document.querySelector(`link[href="${address}"]`) !== null) return;
  const link = document.createElement("link");
  Object.assign(link, { rel: "stylesheet", href: address });
  document.head.append(link);
}
