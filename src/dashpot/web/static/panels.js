// The drawn panels: zoom and read-off, curves that follow, handles on their time axes.
import { Figure } from "../../plot/charts.js";
import { all, made, panelCard, put } from "./dom.js";
import { Handle } from "./handles.js";
import { state, together } from "./job.js";

/** @typedef {{first: number, last: number, step: number}} Clock Of a record, s */

/** @type {Record<string, Figure | null>} */
const figures = {};

/** @type {Record<string, Handle>} */
export const handles = {
  onset: new Handle("onset", "ramp", "contact"),
  ramp_end: new Handle("ramp_end", "ramp", "ramp end"),
  hold_end: new Handle("hold_end", "hold", "hold end"),
};

/** Panels whose axes of time are read off together; the one of the ramp is the record's clock. */
const LINKED = ["ramp", "hold", "residual"];

function link(/** @type {string} */ name) {
  const from = figures[name], onset = handles.onset.value;
  if (!from) return;
  const clock = (/** @type {string} */ one) => one === "ramp" ? 0 : onset;
  const time = from.at.x.value(from.x) + clock(name);
  for (const other of LINKED) {
    const figure = other === name ? null : figures[other];
    if (figure) figure.point(time - clock(other));
  }
}

/** What each panel says before there is anything to draw. */
const blank = new Map(
  all("[data-panel]").map((card) => [card.dataset.panel, card.querySelector(".body")?.innerHTML]),
);

/** Put a drawing in its panel; where there is none any more it says so again. */
export function panel(/** @type {string} */ name, /** @type {string} */ html) {
  const card = panelCard(name), body = card?.querySelector(".body");
  const out = card?.querySelector(".read");
  if (!card || !body || !out) return;
  body.innerHTML = html || blank.get(name) || "";
  out.textContent = "";
  card.classList.remove("stale");
  const svg = /** @type {SVGSVGElement | null} */ (body.querySelector("svg.figure"));
  const label = card.querySelector("figcaption")?.textContent || "";
  figures[name] = svg && new Figure(svg, out, label);
  if (svg && LINKED.includes(name)) {
    for (const kind of ["pointermove", "keyup"]) svg.addEventListener(kind, () => link(name));
  }
}

/** What is kept, by the verb that gave it. @type {Record<string, string>} */
const SAVED = {
  level: "Save the numbers (levels.json)",
  modes: "Save the modes (modes.json)",
};

/** Put the strips of a figure one after the other, each with its title, and a way to keep them. */
export function strips(
  /** @type {HTMLElement} */ home,
  /** @type {[string, string][]} */ drawn,
  /** @type {string} */ verb,
) {
  home.replaceChildren(...drawn.map(([title, html]) => {
    const body = made("div", { class: "body" }), out = made("p", { class: "read" });
    body.innerHTML = html;
    const svg = /** @type {SVGSVGElement | null} */ (body.querySelector("svg.figure"));
    if (svg) new Figure(svg, out, title);
    const card = { class: drawn.length > 1 ? "card" : "card only" };
    return made("figure", card, made("figcaption", {}, title), body, out);
  }));
  const what = SAVED[verb] || "Save the model (fit.json)";
  const button = made("button", { "data-act": "take-bench" }, what);
  home.append(made("p", { class: "buttons" }, button));
}

/** Lay bare curves into the drawings; their names are `panel/curve/x` and `panel/curve/y`. */
export function curves(/** @type {Record<string, Float32Array>} */ arrays) {
  for (const at of Object.keys(arrays).filter((one) => one.endsWith("/x"))) {
    const [name, curve] = at.split("/"), figure = figures[name];
    if (!figure) continue;
    const path = all(".plot path[data-name]", figure.svg)
      .find((one) => one.dataset.name?.startsWith(curve));
    path?.setAttribute("d", figure.panels[0].path(arrays[at], arrays[`${name}/${curve}/y`]));
  }
}

/** Stand where the cuts are: the handles, and the numbers in the fields. */
export function placeHandles(
  /** @type {Record<string, number>} */ cuts,
  /** @type {Clock | null} */ clock = null,
) {
  /** @type {Record<string, number>} */
  const at = { ...cuts, ...state.job.cuts };
  for (const [name, handle] of Object.entries(handles)) {
    // what is cut by hand is one test
    const figure = together().length ? null : figures[handle.panel];
    handle.place(figure, at[name], clock, handle.panel === "hold" ? at.onset : 0);
    handle.byHand(name in state.job.cuts);
    put(`cut-${name}`, String(+at[name].toFixed(4)));
  }
}
