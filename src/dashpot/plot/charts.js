// Zoom and read-off for drawn figures; a page is whole without it.

/** @typedef {[number, number]} Place in units of a drawing */
/** @typedef {{name: string, edge: string | undefined, at: Place[], rising: boolean}} Curve */

const NS = "http://www.w3.org/2000/svg", FINE = 20;
/**
 * @param {string} name
 * @param {Record<string, string | number>} attributes
 * @param {Element} parent
 */
const createSvg = (name, attributes, parent) => {
  const made = document.createElementNS(NS, name);
  for (const key in attributes) made.setAttribute(key, String(attributes[key]));
  parent.append(made);
  return made;
};
/** @type {(v: number, low: number, high: number) => number} */
const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
const formatNumber = (/** @type {number} */ v) => {
  if (!v) return "0";
  const size = Math.abs(v);
  const text = size >= 1e5 || size < 1e-3 ? v.toExponential(2) : String(+v.toPrecision(4));
  return text.replace("-", "\u2212");
};

// one pair of axes: from the units of its inner drawing to the data and back
export class Axis {
  /** @param {string} text @param {number} length @param {boolean} flipped */
  constructor(text, length, flipped) {
    const [kind, low, high] = text.split(" ");
    this.log = kind === "log";
    this.low = +low;
    this.high = +high;
    this.length = length;
    this.flipped = flipped;
  }
  value(/** @type {number} */ unit) {
    const share = this.flipped ? 1 - unit / this.length : unit / this.length;
    return this.log
      ? this.low * (this.high / this.low) ** share
      : this.low + (this.high - this.low) * share;
  }
  unit(/** @type {number} */ value) {
    const share = this.log
      ? Math.log(value / this.low) / Math.log(this.high / this.low)
      : (value - this.low) / (this.high - this.low);
    return this.length * (this.flipped ? 1 - share : share);
  }
  // round values between two ends, about `most` of them
  /** @param {number} a @param {number} b @param {number} most */
  round(a, b, most) {
    const low = Math.min(a, b), high = Math.max(a, b), values = [];
    if (this.log && high / low > 8) {
      const subs = high / low > 300 ? [1] : [1, 2, 5];
      for (let d = Math.floor(Math.log10(low)); d <= Math.log10(high); d++) {
        for (const m of subs) values.push(m * 10 ** d);
      }
    } else {
      const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
      const step = [1, 2, 2.5, 5, 10].map((m) => m * power).find((s) => s >= raw * 0.999) || raw;
      for (let i = Math.ceil(low / step); i * step <= high; i++) {
        values.push(+(i * step).toPrecision(12));
      }
    }
    return values.filter((v) => v >= low * (1 - 1e-9) && v <= high * (1 + 1e-9) || v === 0);
  }
}

const points = (/** @type {string} */ d) => {
  /** @type {Place[]} */
  const values = [];
  for (const share of d.split("M").slice(1)) {
    const n = (share.match(/-?\d+/g) || []).map(Number);
    let x = n[0], y = n[1];
    values.push([x, y]);
    if (share.includes("h")) continue;
    for (let i = 2; i + 1 < n.length; i += 2) values.push([x += n[i], y += n[i + 1]]);
  }
  return values;
};

/** @type {(root: ParentNode, query: string) => SVGElement[]} */
const parts = (root, query) =>
  [...root.querySelectorAll(query)].map((element) => /** @type {SVGElement} */ (element));

export class Panel {
  constructor(/** @type {SVGElement} */ group) {
    this.group = group;
    this.plot = parts(group, ".plot")[0];
    this.ticks = parts(group, ".ticks")[0];
    this.still = this.ticks.cloneNode(true);
    const { box = "", x = "", y = "", label = "" } = group.dataset;
    this.box = box.split(" ").map(Number);
    this.named = parts(this.ticks, "text").some((t) => t.getAttribute("text-anchor") === "middle");
    this.whole = (this.plot.getAttribute("viewBox") || "").split(" ").map(Number);
    this.view = [...this.whole];
    this.x = new Axis(x, this.whole[2], false);
    this.y = new Axis(y, this.whole[3], true);
    const [xName, yName] = label.split("|");
    this.xName = xName;
    this.yName = yName;
    /** @type {Curve[]} */
    this.curves = parts(this.plot, "[data-name]").map((path) => {
      const at = points(path.getAttribute("d") || "");
      const rising = at.every((p, i) => !i || p[0] >= at[i - 1][0]);
      return { name: path.dataset.name || "", edge: path.dataset.edge, at, rising };
    });
  }
  // what a curve is at a place, in units
  /** @param {Curve} curve @param {number} x @param {number} y @returns {Place | null} */
  on(curve, x, y) {
    const at = curve.at;
    if (!curve.rising) {
      return at.reduce((
        a,
        b,
      ) => (Math.hypot(b[0] - x, b[1] - y) < Math.hypot(a[0] - x, a[1] - y) ? b : a));
    }
    if (x < at[0][0] - FINE || x > at[at.length - 1][0] + FINE) return null;
    let low = 0, high = at.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (at[middle][0] <= x) low = middle;
      else high = middle;
    }
    const [a, b] = [at[low], at[high]];
    if (b[0] - a[0] > 60 * FINE) return Math.abs(x - a[0]) < Math.abs(x - b[0]) ? a : b;
    const share = b[0] === a[0] ? 0 : clamp((x - a[0]) / (b[0] - a[0]), 0, 1);
    return [x, a[1] + share * (b[1] - a[1])];
  }
  // the curve through these values, as a path
  /** @param {ArrayLike<number>} x @param {ArrayLike<number>} y */
  path(x, y) {
    let d = "";
    for (let i = 0; i < x.length; i++) {
      const px = Math.round(this.x.unit(x[i])), py = Math.round(this.y.unit(y[i]));
      if (Number.isFinite(px) && Number.isFinite(py)) d += `${d ? "L" : "M"}${px} ${py}`;
    }
    return d;
  }
  // the curves at a place, each with its value in words
  /** @param {number} x @param {number} y @returns {[string, string][]} */
  values(x, y) {
    /** @type {Map<string, string[]>} */
    const values = new Map();
    for (const curve of this.curves) {
      const at = this.on(curve, x, y);
      if (!at) continue;
      const value = formatNumber(this.y.value(at[1]));
      const text = curve.rising ? value : `${formatNumber(this.x.value(at[0]))} | ${value}`;
      const texts = values.get(curve.name) || [];
      texts.push(text);
      values.set(curve.name, texts);
    }
    return [...values].map(([name, v]) => {
      const pair = this.curves.some((c) => c.name === name && c.edge);
      return [name, v.slice(0, 6).join(pair ? " to " : ", ")];
    });
  }
  // quantity and unit of either axis
  axes() {
    const [[what, unit], [quantity, per]] = [this.yName, this.xName].map((name) =>
      name.split(/, (?=[^,]*$)/)
    );
    return { what, unit: unit === "1" ? "no unit" : unit, quantity, per };
  }
  /** @param {number} x */
  where(x) {
    return formatNumber(this.x.value(x));
  }
  /** @param {number} x @param {number} y */
  read(x, y) {
    const { what, unit, quantity, per } = this.axes();
    const values = this.values(x, y).map(([name, v]) => `${name} ${v}`);
    return `${quantity} ${this.where(x)} ${per}; ${what}, ${unit}: ${values.join("; ")}`;
  }
  show(/** @type {number[]} */ view) {
    this.view = view;
    this.plot.setAttribute(
      "viewBox",
      [view[0], view[1], view[2] - view[0], view[3] - view[1]].join(" "),
    );
    const still = view.every((v, i) => Math.abs(v - this.whole[i]) < 1);
    this.group.classList.toggle("zoomed", !still);
    this.ticks.replaceChildren(...(still ? [...this.still.cloneNode(true).childNodes] : []));
    if (!still) this.mark();
  }
  mark() {
    const [bx, by, w, h] = this.box, [x0, y0, x1, y1] = this.view, soft = "var(--soft)";
    /** @param {number} x @param {number} y @param {string} words @param {string} anchor */
    const text = (x, y, words, anchor) => {
      createSvg("text", { x, y, "font-size": 12, fill: soft, "text-anchor": anchor }, this.ticks)
        .textContent = words;
    };
    const line = (/** @type {string} */ d, /** @type {string} */ colour) =>
      createSvg("path", { d, stroke: `var(--${colour})` }, this.ticks);
    for (const v of this.y.round(this.y.value(y0), this.y.value(y1), Math.max(2, h / 40))) {
      const y = by + h * (this.y.unit(v) - y0) / (y1 - y0);
      line(`M${bx} ${y}H${bx + w}`, "line");
      text(bx - 6, y + 4, formatNumber(v), "end");
    }
    line(`M${bx} ${by + h}H${bx + w}`, "edge");
    for (const v of this.x.round(this.x.value(x0), this.x.value(x1), Math.max(2, w / 80))) {
      const x = bx + w * (this.x.unit(v) - x0) / (x1 - x0);
      line(`M${x} ${by + h}v5`, "edge");
      if (this.named) text(x, by + h + 18, formatNumber(v), "middle");
    }
  }
}

export class Figure {
  /** @param {SVGSVGElement} svg @param {Element} out @param {string} label */
  constructor(svg, out, label) {
    this.svg = svg;
    this.out = out;
    this.panels = parts(svg, ".panel").map((group) => new Panel(group));
    this.at = this.panels[0];
    this.x = this.at.whole[2] / 2;
    this.y = this.at.whole[3] / 2;
    /** @type {ReturnType<Figure["place"]> | null} */
    this.from = null;
    this.cross = createSvg("path", { class: "cross" }, svg);
    this.frame = createSvg("rect", { class: "frame" }, svg);
    this.framed([0, 0, 0, 0]);
    // what is read off is told; numbers at the axes, one by one, are noise
    for (const element of svg.children) element.setAttribute("aria-hidden", "true");
    svg.tabIndex = 0;
    svg.setAttribute("role", "application");
    svg.removeAttribute("aria-hidden");
    svg.setAttribute(
      "aria-label",
      `${label} Arrows read values, plus and minus zoom, 0 shows all.`,
    );
    svg.addEventListener("pointermove", (e) => this.move(e));
    svg.addEventListener("pointerdown", (e) => this.press(e));
    svg.addEventListener("pointerup", (e) => this.release(e));
    svg.addEventListener("pointercancel", () => this.forget());
    svg.addEventListener("dblclick", () => this.reset());
    svg.addEventListener("keydown", (e) => this.key(e));
    svg.addEventListener("focus", () => this.showValues());
  }
  // where a pointer is: the panel under it and the place in units
  place(/** @type {PointerEvent} */ e) {
    const box = this.svg.getBoundingClientRect(),
      scale = this.svg.viewBox.baseVal.width / box.width;
    const px = (e.clientX - box.left) * scale, py = (e.clientY - box.top) * scale;
    const near = (/** @type {Panel} */ p) =>
      Math.abs(clamp(py, p.box[1], p.box[1] + p.box[3]) - py);
    const panel = this.panels.reduce((a, b) => (near(b) < near(a) ? b : a));
    const [bx, by, w, h] = panel.box, [x0, y0, x1, y1] = panel.view;
    return {
      panel,
      px: clamp(px, bx, bx + w),
      py: clamp(py, by, by + h),
      x: x0 + clamp((px - bx) / w, 0, 1) * (x1 - x0),
      y: y0 + clamp((py - by) / h, 0, 1) * (y1 - y0),
    };
  }
  move(/** @type {PointerEvent} */ e) {
    const to = this.place(e);
    if (this.from && to.panel === this.from.panel) {
      const { px, py } = this.from;
      const flat = Math.abs(to.py - py) < 20;
      const [, by, , h] = to.panel.box;
      const [y, tall] = flat ? [by, h] : [Math.min(py, to.py), Math.abs(py - to.py)];
      this.framed([Math.min(px, to.px), y, Math.abs(px - to.px), tall]);
    }
    this.at = to.panel;
    this.x = to.x;
    this.y = to.y;
    this.showValues();
  }
  press(/** @type {PointerEvent} */ e) {
    if (e.button) return;
    this.from = this.place(e);
    if (e.pointerType === "mouse") this.svg.setPointerCapture(e.pointerId);
    this.move(e);
  }
  release(/** @type {PointerEvent} */ e) {
    const from = this.from, to = this.place(e);
    this.forget();
    if (!from || from.panel !== to.panel || Math.abs(from.px - to.px) < 12) return;
    const tall = Math.abs(from.py - to.py) >= 20;
    const y = tall ? [from.y, to.y] : [to.panel.view[1], to.panel.view[3]];
    this.zoom(
      to.panel,
      Math.min(from.x, to.x),
      Math.min(...y),
      Math.max(from.x, to.x),
      Math.max(...y),
    );
  }
  forget() {
    this.from = null;
    this.framed([0, 0, 0, 0]);
  }
  framed(/** @type {number[]} */ box) {
    ["x", "y", "width", "height"].forEach((name, i) =>
      this.frame.setAttribute(name, String(box[i]))
    );
  }
  /** @param {Panel} panel @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 */
  zoom(panel, x0, y0, x1, y1) {
    const scale = 1 / panel.whole[2];
    for (const element of this.panels) {
      const [, v0, , v1] = element.view, w = element.whole[2];
      element.show(element === panel ? [x0, y0, x1, y1] : [x0 * scale * w, v0, x1 * scale * w, v1]);
    }
    this.zoomed();
  }
  reset() {
    for (const element of this.panels) element.show([...element.whole]);
    this.zoomed();
  }
  zoomed() {
    this.showValues();
    this.svg.dispatchEvent(new Event("zoomed", { bubbles: true }));
  }
  about(/** @type {number} */ factor) {
    const [x0, y0, x1, y1] = this.at.view, w = this.at.whole[2];
    const wide = clamp((x1 - x0) * factor, w / 500, w),
      start = clamp(this.x - wide / 2, 0, w - wide);
    this.zoom(this.at, start, y0, start + wide, y1);
  }
  key(/** @type {KeyboardEvent} */ e) {
    const [x0, , x1] = this.at.view, step = (x1 - x0) / (e.shiftKey ? 20 : 200);
    const i = this.panels.indexOf(this.at), n = this.panels.length;
    /** @type {Record<string, () => void>} */
    const acts = {
      ArrowLeft: () => {
        this.x -= step;
      },
      ArrowRight: () => {
        this.x += step;
      },
      ArrowUp: () => {
        this.at = this.panels[(i + n - 1) % n];
      },
      ArrowDown: () => {
        this.at = this.panels[(i + 1) % n];
      },
      Home: () => {
        this.x = x0;
      },
      End: () => {
        this.x = x1;
      },
      "+": () => this.about(0.5),
      "=": () => this.about(0.5),
      "-": () => this.about(2),
      0: () => this.reset(),
      Escape: () => this.reset(),
    };
    if (!acts[e.key] || e.ctrlKey || e.metaKey || e.altKey) return;
    e.preventDefault();
    acts[e.key]();
    const [a, , b] = this.at.view;
    this.x = clamp(this.x, a, b);
    this.showValues();
  }
  // panels below each other share the horizontal axis, and the line that reads it off
  mark() {
    const share = this.x / this.at.whole[2];
    const d = this.panels.map(({ box: [bx, by, w, h], view: [x0, , x1], whole }) =>
      `M${bx + w * (share * whole[2] - x0) / (x1 - x0)} ${by}v${h}`
    );
    this.cross.setAttribute("d", d.join(""));
  }
  showValues() {
    this.mark();
    this.out.textContent = this.at.read(this.x, this.y);
  }
}
