// Elements of the page by name; one that is not there is a fault of the page's own.

export function $(/** @type {string} */ id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found;
}

export const field = (/** @type {string} */ id) => /** @type {HTMLInputElement} */ ($(id));

/** Put a value in a field, unless it is being typed into. */
export function put(/** @type {string} */ id, /** @type {string} */ value) {
  if (!field(id).dataset.typed) field(id).value = value;
}

document.addEventListener("input", (event) => {
  /** @type {HTMLInputElement} */ (event.target).dataset.typed = "true";
});
// before whoever hears of it puts the value as it was understood
document.addEventListener("change", (event) => {
  delete /** @type {HTMLInputElement} */ (event.target).dataset.typed;
}, true);

/** Say it there, unless it stands there: what is written anew is laid out anew. */
export function tell(/** @type {Element} */ at, /** @type {string} */ said) {
  if (at.textContent !== said) at.textContent = said;
}

/** @type {Map<string, string>} */
const standing = new Map();

/** Put a table there, unless it stands there: one that is put anew loses a click that has begun. */
export function stand(/** @type {string} */ id, /** @type {string} */ html) {
  if (standing.get(id) === html) {
    for (const box of $(id).querySelectorAll("input")) box.checked = box.defaultChecked;
    return;
  }
  standing.set(id, html);
  $(id).innerHTML = html;
}

/** @returns {HTMLElement[]} */
export const all = (/** @type {string} */ query, /** @type {ParentNode} */ root = document) =>
  [
    ...root.querySelectorAll(query),
  ].map((one) => /** @type {HTMLElement} */ (one));

/** @type {(card: string) => HTMLElement | null} */
export const panelCard = (name) => document.querySelector(`[data-panel="${name}"]`);

export const words = (/** @type {unknown} */ error) =>
  error instanceof Error ? error.message : String(error);

export function status(/** @type {string} */ said) {
  $("status").textContent = said;
}

let cancellable = 0;

/** Offer to cancel while anything is at work that can be. */
export function atWork(/** @type {1 | -1} */ by) {
  cancellable += by;
  $("cancel").hidden = !cancellable;
}

const SVG = "http://www.w3.org/2000/svg";

/** A mark of the page: what is good, limited, bad, a note, or open. */
export function icon(/** @type {string} */ name, kind = "icon") {
  const drawn = document.createElementNS(SVG, "svg"), use = document.createElementNS(SVG, "use");
  drawn.setAttribute("class", kind);
  drawn.setAttribute("aria-hidden", "true");
  use.setAttribute("href", `#i-${name}`);
  drawn.append(use);
  return drawn;
}

/** An element with what it has and holds. */
export function made(
  /** @type {string} */ tag,
  /** @type {Record<string, string>} */ attributes = {},
  /** @type {(Node | string)[]} */ ...inner
) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...inner);
  return element;
}
