// Elements of the page by id; a missing one is a programming error.

export function $(/** @type {string} */ id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no #${id}`);
  return element;
}

export const field = (/** @type {string} */ id) => /** @type {HTMLInputElement} */ ($(id));

/** Set the value of a field, unless the user types into it. */
export function setField(/** @type {string} */ id, /** @type {string} */ value) {
  if (!field(id).dataset.typed) field(id).value = value;
}

document.addEventListener("input", (event) => {
  /** @type {HTMLInputElement} */ (event.target).dataset.typed = "true";
});
// before other listeners set the value as it was read
document.addEventListener("change", (event) => {
  delete /** @type {HTMLInputElement} */ (event.target).dataset.typed;
}, true);

/** Set the text of an element if it differs: each write costs a layout. */
export function setText(/** @type {Element} */ at, /** @type {string} */ text) {
  if (at.textContent !== text) at.textContent = text;
}

/** @type {Map<string, string>} */
const renderedHtml = new Map();

/** Set the HTML of an element if it differs: a replaced table loses a click that has begun. */
export function setHtml(/** @type {string} */ id, /** @type {string} */ html) {
  if (renderedHtml.get(id) === html) {
    for (const box of $(id).querySelectorAll("input")) box.checked = box.defaultChecked;
    return;
  }
  renderedHtml.set(id, html);
  $(id).innerHTML = html;
}

/** @returns {HTMLElement[]} */
export const all = (/** @type {string} */ query, /** @type {ParentNode} */ root = document) =>
  [
    ...root.querySelectorAll(query),
  ].map((element) => /** @type {HTMLElement} */ (element));

/** @type {(card: string) => HTMLElement | null} */
export const panelCard = (name) => document.querySelector(`[data-panel="${name}"]`);

export const words = (/** @type {unknown} */ error) =>
  error instanceof Error ? error.message : String(error);

export function status(/** @type {string} */ text) {
  $("status").textContent = text;
}

let cancellable = 0;

/** Count requests that can be cancelled; show the button while there are any. */
export function countWorking(/** @type {1 | -1} */ by) {
  cancellable += by;
  $("cancel").hidden = !cancellable;
}

const SVG = "http://www.w3.org/2000/svg";

/** Icon of a state: good, care, bad, note or open. */
export function icon(/** @type {string} */ name, kind = "icon") {
  const svg = document.createElementNS(SVG, "svg"), use = document.createElementNS(SVG, "use");
  svg.setAttribute("class", kind);
  svg.setAttribute("aria-hidden", "true");
  use.setAttribute("href", `#i-${name}`);
  svg.append(use);
  return svg;
}

/** Create an element with attributes and children. */
export function createElement(
  /** @type {string} */ tag,
  /** @type {Record<string, string>} */ attributes = {},
  /** @type {(Node | string)[]} */ ...inner
) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...inner);
  return element;
}
