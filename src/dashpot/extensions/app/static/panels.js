// The drawn panels: zoom and read-off, curves that follow, handles on their time axes.
import { Figure } from "../../../plot/charts.js";
import { all, createElement, panelCard, setField } from "./dom.js";
import { Handle } from "./handles.js";
import { state, together } from "./job.js";

/** @typedef {{first: number, last: number, step: number}} Clock Of a record, s */

const WHEEL = 1.25;
/** Of a drawing, px, below which ranges are not read off. */
const NARROW = 400;

/** @type {Record<string, Figure | null>} */
const figures = {};

/** @type {Record<string, Handle>} */
export const handles = {
  onset: new Handle("onset", "ramp", "contact"),
  ramp_end: new Handle("ramp_end", "ramp", "ramp end"),
  hold_end: new Handle("hold_end", "hold", "hold end"),
};

/** A figure that is read off in a block of its own, and zoomed by the wheel. */
class Reading extends Figure {
  constructor(
    /** @type {SVGSVGElement} */ svg,
    /** @type {Element} */ out,
    /** @type {string} */ label,
  ) {
    super(svg, out, label);
    const leave = () => {
      if (document.activeElement === svg) return;
      this.cross.setAttribute("d", "");
      out.replaceChildren();
    };
    svg.addEventListener("pointerleave", leave);
    svg.addEventListener("blur", leave);
    svg.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
  }

  /** @override */
  showValues() {
    this.mark();
    const { panels, at } = this, { quantity, unit, per } = at.axes();
    const cell = (/** @type {string} */ tag, /** @type {string} */ words, kind = "") =>
      createElement(tag, kind ? { class: kind } : {}, words);
    const rows = [cell("dt", `${at.where(this.x)} ${per}`, "at"), cell("dd", unit, "at")];
    rows[0].title = quantity;
    const share = this.x / at.whole[2], narrow = this.svg.clientWidth < NARROW;
    for (const chart of panels) {
      const unitSuffix = chart === at ? "" : `, ${chart.axes().unit}`;
      for (const [name, value] of chart.values(share * chart.whole[2], this.y)) {
        if (narrow && chart.curves.some((each) => each.name === name && each.edge)) continue;
        const kind = name === "measured" ? "upon" : "";
        const called = unitSuffix && !/[a-z] /.test(name) ? `${name}${unitSuffix}` : name;
        rows.push(cell("dt", called, kind), cell("dd", value, kind));
      }
    }
    this.out.replaceChildren(...rows);
  }

  /** Zoom about the pointer; where the page itself can be scrolled, with Ctrl alone. */
  wheel(/** @type {WheelEvent} */ event) {
    const scroller = this.svg.closest("main, .scrolls");
    const scrolls = scroller && scroller.scrollHeight > scroller.clientHeight + 1;
    if (scrolls && !event.ctrlKey) return;
    event.preventDefault();
    const [x0, y0, x1, y1] = this.at.view, whole = this.at.whole[2];
    const factor = event.deltaY < 0 ? 1 / WHEEL : WHEEL;
    const wide = Math.min(Math.max((x1 - x0) * factor, whole / 500), whole);
    const at = this.x - (this.x - x0) * wide / (x1 - x0);
    const start = Math.min(Math.max(at, 0), whole - wide);
    this.zoom(this.at, start, y0, start + wide, y1);
  }
}

/** Text of each panel before there is anything to draw. */
const blank = new Map(
  all("[data-panel]").map((card) => [card.dataset.panel, card.querySelector(".body")?.innerHTML]),
);

/** Show a drawing in its panel; without one, the text of an empty panel. */
export function panel(/** @type {string} */ name, /** @type {string} */ html) {
  const card = panelCard(name), body = card?.querySelector(".body");
  const out = card?.querySelector(".read");
  if (!card || !body || !out) return;
  body.innerHTML = html || blank.get(name) || "";
  out.replaceChildren();
  card.classList.remove("stale", "past");
  const svg = /** @type {SVGSVGElement | null} */ (body.querySelector("svg.figure"));
  const caption = card.querySelector("figcaption");
  const title = /** @type {HTMLElement | null} */ (body.querySelector("[data-title]"));
  if (caption && title) caption.textContent = title.dataset.title || "";
  figures[name] = svg && new Reading(svg, out, caption?.textContent || "");
}

/** Label of the save button, by the request that computed the numbers. @type {Record<string, string>} */
const SAVED = {
  level: "Save the numbers (levels.json)",
  standalone: "Save the numbers (JSON)",
  modes: "Save the modes (modes.json)",
};

/** Show the panels of a figure in sequence, each with its title, and a button to save them. */
export function strips(
  /** @type {HTMLElement} */ home,
  /** @type {[string, string, number][]} */ drawn,
  /** @type {string} */ verb,
  /** @type {[string, string][]} */ facts = [],
) {
  const factList = createElement("dl", { class: "facts" });
  for (const [name, text] of facts) {
    factList.append(
      createElement("div", {}, createElement("dt", {}, name), createElement("dd", {}, text)),
    );
  }
  home.replaceChildren(
    ...(facts.length ? [factList] : []),
    ...drawn.map(([title, html, across]) => {
      const body = createElement("div", { class: "body" }),
        out = createElement("div", { class: "read" });
      body.innerHTML = html;
      for (const svg of all("svg.figure", body)) {
        new Reading(/** @type {any} */ (svg), out, title);
      }
      const card = createElement(
        "figure",
        { class: "card" },
        createElement("figcaption", {}, title),
        body,
        out,
      );
      card.style.setProperty("--across", String(across));
      return card;
    }),
  );
  const what = SAVED[verb] || "Save the model (fit.json)";
  const button = createElement("button", { "data-act": "take-bench" }, what);
  home.append(createElement("p", { class: "buttons" }, button));
}

/** The unit of the lowest strip of a panel, as it is drawn. */
export const unitOf = (/** @type {string} */ name) =>
  figures[name]?.panels.at(-1)?.axes().unit || "";

/** Replace curves of the drawings while something moves; their names are `panel/curve/x` and `panel/curve/y`. */
export function curves(/** @type {Record<string, Float32Array>} */ arrays) {
  for (const at of Object.keys(arrays).filter((key) => key.endsWith("/x"))) {
    const [name, curve] = at.split("/");
    for (const chart of figures[name]?.panels || []) {
      const path = all("path[data-name]", chart.plot)
        .find((each) => each.dataset.name?.startsWith(curve));
      path?.setAttribute("d", chart.path(arrays[at], arrays[`${name}/${curve}/y`]));
    }
  }
}

/** Distance of a click from a pole that it selects, px. */
const NEAR = 14;

/** The pole of the stabilisation chart under a click; 0 if there is none. */
export function poleAt(/** @type {MouseEvent} */ event, /** @type {number[]} */ poles) {
  const figure = figures.poles, on = figure?.svg.getBoundingClientRect();
  if (!figure || !on || !figure.svg.contains(/** @type {Node} */ (event.target))) return 0;
  const [axes] = figure.panels, scale = on.width / figure.svg.viewBox.baseVal.width;
  const [x, , w] = axes.box, [x0, , x1] = axes.view;
  let nearest = 0, least = NEAR;
  for (const hertz of poles) {
    const share = (axes.x.unit(hertz) - x0) / (x1 - x0);
    const far = Math.abs(on.left + scale * (x + w * share) - event.clientX);
    if (far < least) [nearest, least] = [hertz, far];
  }
  return nearest;
}

/** Zero of the axis of the hold, on the clock of the record. */
export let since = 0;

/** Show the time limits: the handles, and the numbers in the fields. */
export function placeHandles(
  /** @type {Record<string, number>} */ time_limits,
  /** @type {Clock | null} */ clock = null,
  anew = false,
) {
  /** @type {Record<string, number>} */
  const at = { ...time_limits, ...state.job.time_limits };
  /** @type {Handle[]} */
  const movedHandles = [];
  // the drawn axis begins at the end of the ramp of that drawing
  if (anew) since = time_limits.ramp_end;
  for (const [name, handle] of Object.entries(handles)) {
    // time limits are set by hand for one test only
    const figure = together().length ? null : figures[handle.panel];
    const shift = handle.panel === "hold" ? since : 0;
    if (handle.place(figure, at[name], clock, shift)) movedHandles.push(handle);
  }
  // read of all before any is put, where they are is laid out once
  for (const { handle, on } of movedHandles.map((handle) => ({ handle, on: handle.ground() }))) {
    handle.draw(on);
  }
  for (const [name, handle] of Object.entries(handles)) {
    handle.byHand(name in state.job.time_limits);
    setField(`cut-${name}`, String(+at[name].toFixed(4)));
  }
}
