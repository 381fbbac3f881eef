// A handle on the time axis of a panel, for pointer, touch and keyboard; a slider to a screen reader.
// A move is an event "movelimit" of name, value (null: as found) and held.

/** @typedef {import("../../../plot/charts.js").Figure} Figure */
/** @typedef {import("./panels.js").Clock} Clock */
/** @typedef {import("../../../plot/charts.js").Panel} Axes */
/** @typedef {{figure: Figure, axes: Axes, on: DOMRect, about: DOMRect, scale: number}} Ground */

const EDGE = 0.01;
const RIGHT = 0.8;
const ENDS_STEP = /^(Arrow|Page)/;

export class Handle {
  constructor(
    /** @type {string} */ name,
    /** @type {string} */ panel,
    /** @type {string} */ label,
  ) {
    this.name = name;
    this.panel = panel;
    this.label = label;
    this.value = 0;
    this.shift = 0;
    this.held = false;
    this.begun = this.grip = 0;
    /** @type {Ground | null} */
    this.startGround = null;
    /** @type {Clock} */
    this.clock = { first: 0, last: 1, step: 0.001 };
    /** @type {Figure | null} */
    this.figure = null;
    this.element = this.build();
    document.addEventListener("zoomed", () => this.draw());
    addEventListener("resize", () => this.draw());
  }

  build() {
    const handle = document.createElement("button"), words = document.createElement("span");
    const both = document.createElement("i");
    handle.className = "handle";
    both.setAttribute("aria-hidden", "true");
    for (const sign of ["\u2039", "\u203a"]) {
      both.append(Object.assign(document.createElement("b"), { textContent: sign }));
    }
    handle.setAttribute("role", "slider");
    handle.setAttribute("aria-label", this.label);
    words.textContent = this.label;
    words.setAttribute("aria-hidden", "true");
    handle.append(words, both);
    handle.addEventListener("dblclick", () => this.askQueued());
    handle.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      handle.focus();
      handle.setPointerCapture(event.pointerId);
      this.startGround = this.ground();
      this.held = true;
      this.begun = this.value;
      const { left, width } = handle.getBoundingClientRect();
      this.grip = event.clientX - left - width / 2;
      handle.classList.add("held");
    });
    handle.addEventListener("pointermove", (event) => {
      if (this.held) this.to(this.under(event.clientX - this.grip));
    });
    const drop = () => {
      if (!this.held) return;
      this.held = false;
      handle.classList.remove("held");
      if (this.value !== this.begun) this.setText(this.value, false);
    };
    handle.addEventListener("pointerup", drop);
    handle.addEventListener("pointercancel", drop);
    handle.addEventListener("keydown", (event) => this.key(event));
    handle.addEventListener("keyup", (event) => {
      if (ENDS_STEP.test(event.key)) this.setText(this.value, false);
    });
    return handle;
  }

  setText(/** @type {number | null} */ value, /** @type {boolean} */ held) {
    const detail = { name: this.name, value, held };
    this.element.dispatchEvent(new CustomEvent("movelimit", { bubbles: true, detail }));
  }

  /** Ask for its number, to be typed. */
  askQueued() {
    this.element.dispatchEvent(new CustomEvent("number", { bubbles: true, detail: this.name }));
  }

  byHand(/** @type {boolean} */ yes) {
    this.element.classList.toggle("by-hand", yes);
  }

  /** Set the value, on the clock of the record (the axis begins at `shift`); true if it changed. */
  place(
    /** @type {Figure | null | undefined} */ figure,
    /** @type {number} */ value,
    /** @type {Clock | null} */ clock,
    /** @type {number} */ shift,
  ) {
    const card = figure?.svg.closest(".card");
    if (!figure || !card) {
      this.element.remove();
      return false;
    }
    const to = this.held ? this.value : value;
    const hasPartialAnswer = this.figure === figure && this.value === to && this.shift === shift &&
      !clock;
    this.figure = figure;
    this.clock = clock || this.clock;
    this.shift = shift;
    this.value = to;
    // beside the drawing, not in it: one that is drawn anew must not take the focus away
    if (this.element.parentElement !== card) card.append(this.element);
    return !hasPartialAnswer;
  }

  /**
   * The axes, how large a unit of the drawing is on the screen, and where: kept while held.
   * @returns {Ground | null}
   */
  ground() {
    const card = this.element.parentElement, figure = this.figure;
    if (this.held && figure && this.startGround?.figure === figure) return this.startGround;
    if (!figure?.svg.isConnected || !card) return null;
    const { svg, panels: [axes] } = figure, on = svg.getBoundingClientRect();
    const scale = on.width / svg.viewBox.baseVal.width;
    return { figure, axes, on, scale, about: card.getBoundingClientRect() };
  }

  /** Draw the handle at its value. */
  draw(ground = this.ground()) {
    if (!ground) return;
    const { axes, on, scale, about } = ground;
    const [x, y, w, h] = axes.box, [x0, , x1] = axes.view;
    const part = (axes.x.unit(this.value - this.shift) - x0) / (x1 - x0);
    const right = part <= RIGHT && this.label !== "contact", { element, clock } = this;
    // one that is moved out of sight waits at the edge: hidden, it could not be let go
    const held = this.held || document.activeElement === element;
    element.hidden = !held && !(part >= -EDGE && part <= 1 + EDGE);
    const seen = Math.min(Math.max(part || 0, -EDGE), 1 + EDGE);
    element.style.left = `${on.left - about.left - 1 + scale * (x + w * seen)}px`;
    element.style.top = `${on.top - about.top - 1 + scale * y}px`;
    element.style.height = `${scale * h}px`;
    element.classList.toggle("left-of", !right);
    element.classList.toggle("right-of", right);
    element.setAttribute("aria-valuemin", String(clock.first));
    element.setAttribute("aria-valuemax", String(clock.last));
    element.setAttribute("aria-valuenow", String(+this.value.toFixed(6)));
    element.setAttribute("aria-valuetext", `${this.label} ${+this.value.toFixed(4)} s`);
  }

  under(/** @type {number} */ clientX) {
    const ground = this.ground();
    if (!ground) return this.value;
    const { axes, on, scale } = ground;
    const [x, , w] = axes.box, [x0, , x1] = axes.view;
    const part = (Math.min(Math.max((clientX - on.left) / scale, x), x + w) - x) / w;
    return axes.x.value(x0 + part * (x1 - x0)) + this.shift;
  }

  to(/** @type {number} */ value) {
    const { first, last, step } = this.clock, within = Math.min(Math.max(value, first), last);
    const snapped = first + Math.round((within - first) / step) * step;
    this.value = +snapped.toPrecision(12);
    this.draw();
    this.setText(this.value, true);
  }

  key(/** @type {KeyboardEvent} */ event) {
    const step = this.clock.step * (event.shiftKey ? 10 : 1);
    /** @type {Record<string, number>} */
    const showProgress = {
      ArrowLeft: -step,
      ArrowDown: -step,
      ArrowRight: step,
      ArrowUp: step,
      PageDown: -100 * step,
      PageUp: 100 * step,
    };
    if (event.key in showProgress) {
      event.preventDefault();
      event.stopPropagation();
      this.to(this.value + showProgress[event.key]);
    }
    if (event.key === "Enter") {
      event.preventDefault();
      this.askQueued();
    }
    if (event.key === "Home") {
      event.preventDefault();
      this.setText(null, false);
    }
  }
}
