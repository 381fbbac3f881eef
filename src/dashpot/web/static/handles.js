// @ts-check
// A handle on the time axis of a panel: by pointer, by touch, by keyboard; a slider to who cannot see it.

export class Handle {
  /** @param {string} panel @param {string} label @param {(value: number | null, held: boolean) => void} moved */
  constructor(panel, label, moved) {
    this.panel = panel;
    this.label = label;
    this.moved = moved;
    this.value = 0;
    this.shift = 0;
    this.held = false;
    this.clock = { first: 0, last: 1, step: 0.001 };
    this.figure = null;
    const made = document.createElement("button");
    made.className = `handle ${label === "ramp end" ? "right" : "left-of"}`;
    made.setAttribute("role", "slider");
    made.setAttribute("aria-label", label);
    const words = document.createElement("span");
    words.textContent = label;
    words.setAttribute("aria-hidden", "true");
    made.append(words);
    made.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      made.focus();
      made.setPointerCapture(event.pointerId);
      this.held = true;
    });
    made.addEventListener("pointermove", (event) => { if (this.held) this.to(this.under(event.clientX), true); });
    const drop = () => { if (this.held) { this.held = false; this.moved(this.value, false); } };
    made.addEventListener("pointerup", drop);
    made.addEventListener("pointercancel", drop);
    made.addEventListener("keydown", (event) => this.key(event));
    made.addEventListener("keyup", (event) => { if (event.key.startsWith("Arrow") || event.key.startsWith("Page")) this.moved(this.value, false); });
    this.element = made;
    for (const kind of ["pointerup", "dblclick", "keyup"]) document.addEventListener(kind, () => requestAnimationFrame(() => this.put()));
    addEventListener("resize", () => this.put());
  }
  byHand(/** @type {boolean} */ yes) { this.element.classList.toggle("by-hand", yes); }
  /** Stand at a value on the clock of the record; the axis counts from `shift`. */
  place(/** @type {any} */ figure, /** @type {number} */ value, /** @type {any} */ clock, /** @type {number} */ shift) {
    if (!figure) { this.element.remove(); return; }
    this.figure = figure;
    this.clock = clock;
    this.shift = shift || 0;
    if (!this.held) this.value = value;
    // beside the drawing, not in it: one that is drawn anew must not take the focus away
    const card = figure.svg.closest(".card");
    if (this.element.parentElement !== card) card.append(this.element);
    this.put();
  }
  scale() {
    const svg = this.figure.svg;
    return svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
  }
  put() {
    if (!this.figure || !this.figure.svg.isConnected) return;
    const axes = this.figure.panels[0], [x, y, w, h] = axes.box, [x0, , x1] = axes.view, scale = this.scale();
    const part = (axes.x.unit(this.value - this.shift) - x0) / (x1 - x0);
    const svg = this.figure.svg.getBoundingClientRect(), card = this.element.parentElement.getBoundingClientRect();
    const style = this.element.style, left = svg.left - card.left - 1, top = svg.top - card.top - 1;
    this.element.hidden = !(part >= -0.01 && part <= 1.01);
    style.left = `${left + scale * (x + w * part)}px`;
    style.top = `${top + scale * y}px`;
    style.height = `${scale * h}px`;
    this.element.classList.toggle("left-of", part > 0.8 || this.label === "contact");
    this.element.classList.toggle("right", !(part > 0.8 || this.label === "contact"));
    this.element.setAttribute("aria-valuemin", String(this.clock.first));
    this.element.setAttribute("aria-valuemax", String(this.clock.last));
    this.element.setAttribute("aria-valuenow", String(+this.value.toFixed(6)));
    this.element.setAttribute("aria-valuetext", `${this.label} ${+this.value.toFixed(4)} s`);
  }
  under(/** @type {number} */ clientX) {
    const axes = this.figure.panels[0], [x, , w] = axes.box, [x0, , x1] = axes.view;
    const px = (clientX - this.figure.svg.getBoundingClientRect().left) / this.scale();
    return axes.x.value(x0 + (Math.min(Math.max(px, x), x + w) - x) / w * (x1 - x0)) + this.shift;
  }
  to(/** @type {number} */ value, /** @type {boolean} */ held) {
    const { first, last, step } = this.clock;
    const snapped = first + Math.round((Math.min(Math.max(value, first), last) - first) / step) * step;
    this.value = +snapped.toPrecision(12);
    this.put();
    this.moved(this.value, held);
  }
  key(/** @type {KeyboardEvent} */ event) {
    const step = this.clock.step * (event.shiftKey ? 10 : 1);
    const by = { ArrowLeft: -step, ArrowDown: -step, ArrowRight: step, ArrowUp: step, PageDown: -100 * step, PageUp: 100 * step }[event.key];
    if (by !== undefined) { event.preventDefault(); event.stopPropagation(); this.to(this.value + by, true); }
    if (event.key === "Home") { event.preventDefault(); this.moved(null, false); }
  }
}
