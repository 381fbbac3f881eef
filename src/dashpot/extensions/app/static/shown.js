// What stands on the page beside the drawings: verdict, solid, choices, files, fields.
import { $, all, field, icon, made, put } from "./dom.js";
import {
  alike,
  door,
  goTogether,
  hammers,
  isBench,
  isHits,
  isHitsAlone,
  isJudged,
  isLevel,
  isModes,
  isResponse,
  isRod,
  isTest,
  kindOf,
  levelUnit,
  limited,
  LOT,
  machine,
  nameOf,
  shown,
  state,
  test,
  together,
} from "./job.js";
import { handles } from "./panels.js";
import { render } from "./verdict.js";

/** @typedef {import("./job.js").OpenFile} OpenFile */

/** A record without a seal, by which the machine is found. */
const isBlank = (/** @type {OpenFile} */ one) => one.options.kind === "blank";
/** Characters of a name in the list, and of its start where it is longer. */
const LONGEST = 48, START = 20;
/** What became of an open file on disk. @type {Record<string, string>} */
export const WATCHED = {
  writing: "being written",
  changed: "changed",
  gone: "no longer there",
  stale: "changed on disk",
};
/** Where no machine file is open. */
const MACHINE = "No machine file is open. Blank tests make one: open records on a rigid stop, on " +
  "a steel spring and empty, and tick \u201cblank test\u201d at each.";
/** A limit as it may be typed, by what it is of. @type {Record<string, string>} */
const LIMIT = { test: "damping >= 3%", csr: "life >= 10 years" };
const SPECIMEN = { name: "", lot: "", length: "mm" };

/** The table of a solid, and how many arms it has, each on its tab. */
export function solid(
  /** @type {string} */ html,
  /** @type {boolean} */ joint,
  /** @type {number | ""} */ arms,
) {
  const shown = joint === state.joint;
  if (shown) $("solid").innerHTML = html;
  const said = arms === "" ? "" : `, ${arms} arm${arms === 1 ? "" : "s"}`;
  $(joint ? "arms-joint" : "arms-fit").textContent = said;
  if (!shown) return;
  const auto = document.querySelector('[data-arms="auto"]');
  const chosen = state.job.arms === "auto" && arms !== "";
  if (auto) auto.textContent = chosen ? `auto: ${arms}` : "auto";
  choices();
}

export function choices() {
  const { arms, method, law, family, time_limits } = state.job;
  for (const [name, value] of Object.entries({ arms, method, law, family })) {
    for (const button of all(`[data-${name}]`)) {
      button.setAttribute("aria-pressed", String(String(value) === button.dataset[name]));
    }
  }
  for (const button of all("[data-frfs]")) {
    const of = shown()?.level && state.frfs.of !== "rod" ? "levels" : state.frfs.of;
    button.setAttribute("aria-pressed", String(of === button.dataset.frfs));
  }
  for (const button of all("[data-base]")) {
    button.setAttribute("aria-pressed", String(state.base === (button.dataset.base === "yes")));
  }
  $("reset").hidden = !Object.keys(time_limits).length;
  for (const [name, handle] of Object.entries(handles)) handle.byHand(name in time_limits);
  for (const button of all("[data-phase]")) {
    button.setAttribute("aria-pressed", String(state.phase));
    button.toggleAttribute("disabled", state.base);
  }
  const tabs = !!test() && !isBenchShown() && !isAside() && state.current !== LOT,
    two = tabs && hammers().length > 0;
  $("top").hidden = !tabs;
  $("tab-joint").hidden = !two;
  const many = state.files.filter(isTest).length;
  $("tab-all").hidden = many < 2;
  $("test-count").textContent = String(many);
  for (const button of all("[data-which]")) {
    const own = button.dataset.which === (state.against || (state.joint ? "joint" : "fit"));
    button.setAttribute("aria-selected", String(own));
    button.tabIndex = own ? 0 : -1;
  }
  $("choice-line").textContent = all("#choice-body .choice").filter((one) =>
    one.offsetParent || !one.closest(".of-test") || test()
  )
    .map((one) =>
      `${one.getAttribute("aria-label")} ${
        one.querySelector("[aria-pressed=true]")?.textContent || ""
      }`.toLowerCase()
    )
    .join(" \u00b7 ");
  $("taken").textContent = tabs && state.against
    ? ": choose a model"
    : two
    ? (state.joint ? ": joint model" : ": relaxation alone")
    : "";
}

/** Whether what is shown is a question or a refusal: no numbers are of it. */
const isAside = () => !!shown()?.asked || shown()?.mark === "bad";

const isBenchShown = () => state.files.some((one) => one.id === state.current && isBench(one));

export function fileList() {
  const of = test();
  $("files").replaceChildren(...state.files.map((one) => {
    const level = isLevel(one) && one.level ? `, at ${levelWords(one)}` : "";
    const unused = one.page === "machine" && one !== machine() ? ", not used" : "";
    const message = `${one.line || "reading"}${level}${unused}`;
    const words = made("span", {}, named(nameOf(one)), made("i", {}, message), ...stamped(one));
    const item = made(
      "li",
      {},
      made(
        "button",
        { class: "file", "data-show": one.id, "aria-current": String(one.id === state.current) },
        icon(one.mark || "open"),
        words,
      ),
    );
    if (of && isTest(one) && goTogether(one, of)) {
      const box = made("input", { type: "checkbox", "data-together": one.id });
      box.toggleAttribute("checked", together().includes(one));
      item.append(made("label", { class: "with" }, box, " fit together"));
    }
    if (one.id === state.current && one.specimen && one.specimens?.length) {
      const all = one.specimens.map(({ id, label }) => {
        const has = { value: id, ...(id === one.id && { selected: "" }) };
        return made("option", has, label);
      });
      const select = made("select", { "data-specimen-of": one.id }, ...all);
      item.append(made("label", { class: "with" }, "specimen ", select));
    }
    if (one.id === state.current && (one.kind === "relaxation" || isBlank(one))) {
      const box = made("input", { type: "checkbox", "data-blank": one.id });
      box.toggleAttribute("checked", isBlank(one));
      item.append(made("label", { class: "with" }, box, " blank test, no seal"));
    }
    const away = {
      class: "link away",
      "data-remove": one.id,
      "aria-label": `remove ${nameOf(one)}`,
    };
    item.append(made("button", away, "\u00d7"));
    return item;
  }));
  if (state.lot) {
    const name = state.lot.replace(/[\\/]+$/, "").split(/[\\/]/).at(-1) || state.lot;
    const message = made("span", {}, made("b", {}, name), made("i", {}, "a lot"));
    const current = String(state.current === LOT);
    const open = { class: "file", "data-show": LOT, "aria-current": current };
    const away = { class: "link away", "data-remove": LOT, "aria-label": `remove ${name}` };
    const button = made("button", open, icon("note"), message);
    $("files").prepend(made("li", {}, button, made("button", away, "\u00d7")));
  }
  document.body.classList.toggle("empty", !state.files.length && !state.lot);
  render();
}

/** A name of which start and end are seen, however long it is. */
function named(/** @type {string} */ name) {
  if (name.length <= LONGEST) return made("b", {}, name);
  const short = `${name.slice(0, START)}\u2026${name.slice(START + 1 - LONGEST)}`;
  return made("b", { title: name }, short);
}

/** Of which contents the numbers are: their hash, their time, and what became of the file since. */
function stamped(/** @type {OpenFile} */ one) {
  if (!one.hash) return [];
  const when = new Date(one.when || ""), today = when.toDateString() === new Date().toDateString();
  const at = today ? when.toLocaleTimeString() : when.toLocaleDateString();
  const text = one.again && !one.watch ? `changed, read again ${one.again}` : `of ${at}`;
  const title = `SHA-256 ${one.hash}, contents of ${when.toLocaleString()}`;
  const bits = [made("i", { class: "stamp", title }, `${one.hash.slice(0, 8)}, ${text}`)];
  if (one.watch) bits.push(made("i", { class: "watch" }, WATCHED[one.watch] || ""));
  return bits;
}

const unitWords = (/** @type {OpenFile | undefined} */ one) =>
  levelUnit(one).replace("^2", "\u00b2");
const levelNumber = (/** @type {OpenFile | undefined} */ one) =>
  (one?.level || "").slice(0, -levelUnit(one).length);
const levelWords = (/** @type {OpenFile} */ one) => `${levelNumber(one)} ${unitWords(one)}`;

/** Which page is shown: a question, the hits, the panels, or what is missing. */
export function views() {
  const one = shown(), asks = one ? one.asked || refusedPage(one) : "";
  const hits = !!one && isHits(one), hitsOnly = hits && isHitsAlone(one);
  const fitted = !!one && isBench(one), lot = state.current === LOT;
  document.body.classList.toggle("in-lot", lot);
  $("lot-page").hidden = !lot;
  const response = !!one && isResponse(one) && !isRod(one), level = !!one && isLevel(one);
  const modes = !!one && isModes(one), masses = modes && state.frfs.of === "masses";
  const judged = !!one && isJudged(one);
  const many = state.files.filter(isTest).length;
  if (state.against === "all" && many < 2) state.against = "";
  const against = !!state.against && !!test() && !fitted && !asks && !lot;
  document.body.classList.toggle("against", against);
  $("ab-page").hidden = !against || state.against !== "ab";
  $("seals-page").hidden = !against || state.against !== "all";
  const classes = {
    bench: fitted,
    level,
    swept: level && !response,
    response,
    modes: modes || hitsOnly,
    masses,
    "hits-only": hitsOnly,
    judged,
  };
  document.body.classList.toggle("aside", !!asks);
  document.body.classList.toggle("massed", !!state.job.mass || hammers().length > 0);
  for (const [name, yes] of Object.entries(classes)) document.body.classList.toggle(name, yes);
  $("bench-page").hidden = !fitted || hitsOnly;
  $("pole-hint").hidden = !hitsOnly || !!asks;
  $("machine-hint").hidden = !judged || !one || !isBlank(one) || !!asks;
  asked(one);
  document.body.classList.toggle("alone", response && !fitted && !test());
  $("question").hidden = !asks;
  $("question").innerHTML = asks;
  $("hits-page").hidden = !hits || !!asks || against;
  // a transmissibility goes with no relaxation test on this page
  const alone = response && !level && !modes;
  $("frfs").hidden = lot || !!asks || !one || !isResponse(one);
  $("alone").hidden = !!test() || judged || one?.page === "base";
  $("missing").hidden = lot || !!asks || (fitted && !hitsOnly) || response || !!test() ||
    !hammers().length;
  $("no-level").hidden = lot || !response || fitted || !(alone || !test());
  $("grid").hidden = lot || !!asks || hits || fitted || alone || against || !test();
  $("verdict").hidden = lot || !!asks || alone || !(test() || fitted);
  render();
}

/** What stands in place of the figures where a file was refused: nothing of another one. */
function refusedPage(/** @type {OpenFile} */ one) {
  if (one.mark !== "bad") return "";
  const away = made("button", { class: "main", "data-remove": one.id }, `Remove ${one.name}`);
  const home = made(
    "div",
    {},
    made("h1", {}, `${one.name} was not read`),
    made("p", { class: "question" }, one.line || ""),
    made("p", {}, "The other files are as they were: nothing of them depends on this one."),
    made("p", { class: "buttons" }, away),
  );
  return home.innerHTML;
}

/** The fields of a kind that stands alone, for each file where each is asked. */
function asked(/** @type {OpenFile | undefined} */ one) {
  const home = $("asks"),
    of = one && isJudged(one) ? (one.page === "part" ? door() : one) : undefined;
  const asks = of?.asks || [];
  home.hidden = !asks.length;
  if (!of || !asks.length || home.contains(document.activeElement)) return;
  const said = state.said[kindOf(of)] || {};
  const rows = asks.flatMap((ask) => {
    const every = ask.each
      ? alike(of).map((each, i) => ({ name: `${ask.name} ${i}`, label: each.name }))
      : [ask];
    return every.map(({ name, label }) => {
      const has = { "data-ask": name, spellcheck: "false" };
      const input =
        /** @type {HTMLInputElement} */ (made(ask.choices.length ? "select" : "input", has));
      for (const choice of ask.choices) input.append(made("option", {}, choice));
      if (!ask.choices.length) input.placeholder = ask.unit ? "none" : "with unit";
      input.value = said[name] || ask.choices[0] || "";
      const unit = ask.unit.replace("^3", "\u00b3");
      return made("label", { class: "field" }, label, made("span", {}, input, made("i", {}, unit)));
    });
  });
  home.replaceChildren(made("h2", {}, "Of this test"), ...rows);
}

/** The numbers of the choices in their fields. */
export function fields() {
  const { job } = state;
  put("mass", job.mass.replace(/g$/, ""));
  put("seals", String(job.seals));
  field("limit-lines").placeholder = LIMIT[limited()] || "NAME >= VALUE";
  put("limit-lines", state.limits[limited()] || "");
  const rig = machine();
  $("machine-line").textContent = rig ? `${rig.name}: ${rig.line}` : MACHINE;
  field("machine-compliance").disabled = !!rig;
  put("machine-compliance", rig ? "" : withoutUnit(job.machine?.compliance, "um/N"));
  put("compression", job.compression.replace(/mm$/, ""));
  put("level", levelNumber(shown()));
  $("level-unit").textContent = unitWords(shown());
  put("level-at", state.levels.at);
  put("frf-mass", (shown()?.mass || "").replace(/g$/, ""));
  put("modes-band", state.frfs.band.replace(/Hz$/, ""));
  put("amplitude-law", state.levels.law);
  put("specimen-temperature", (described()?.temperature || "").replace("degC", ""));
  for (const [name, unit] of Object.entries(SPECIMEN)) {
    put(`specimen-${name}`, withoutUnit(job.specimen[name], unit));
  }
}

/** A quantity as its field has it, whose unit stands behind it. */
function withoutUnit(/** @type {string | undefined} */ said, /** @type {string} */ unit) {
  return unit && said?.endsWith(unit) ? said.slice(0, -unit.length) : said || "";
}

/** The file whose temperature the field is. */
function described() {
  const one = shown();
  return one && isBench(one) ? one : test();
}

/** A number with its unit: that of the field, where none was typed. */
export function withUnit(/** @type {string} */ text, /** @type {string} */ unit) {
  return Number.isNaN(Number(text)) ? text : `${text}${unit}`;
}

/** Take a field of the specimen. */
export function describe(/** @type {string} */ name, /** @type {string} */ typed) {
  const number = typed.trim().replace(",", "."), of = described();
  if (name === "temperature") {
    if (of) of.temperature = number && withUnit(number, "degC");
  } else if (number) {
    state.job.specimen[name] = name === "length" ? withUnit(number, "mm") : typed.trim();
  } else delete state.job.specimen[name];
}
