// Parts of the page other than drawings: table of the model, options, files, fields.
import { $, all, createElement, field, icon, setField } from "./dom.js";
import {
  canFitTogether,
  door,
  getFilesOfKind,
  getLimitsKind,
  hammers,
  isBench,
  isHammerOnly,
  isHits,
  isLevel,
  isModes,
  isResponse,
  isRod,
  isStandalone,
  isTest,
  kindOf,
  levelUnit,
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
const isBlank = (/** @type {OpenFile} */ openFile) => openFile.options.kind === "blank";
/** Longest name in the list, and characters of the start of a shortened one. */
const LONGEST = 48, START = 20;
/** State of an open file on disk. @type {Record<string, string>} */
export const WATCHED = {
  writing: "being written",
  changed: "changed",
  gone: "no longer there",
  stale: "changed on disk",
};
/** Text without a machine file. */
const MACHINE = "No machine file is open. Blank tests make one: open records on a rigid stop, on " +
  "a steel spring and empty, and tick \u201cblank test\u201d at each.";
/** Example of a limit, by kind. @type {Record<string, string>} */
const LIMIT = { test: "damping >= 3%", csr: "life >= 10 years" };
const SPECIMEN = { name: "", lot: "", length: "mm" };

/** Show the table of a model, and its number of arms on the tab. */
export function solid(
  /** @type {string} */ html,
  /** @type {boolean} */ joint,
  /** @type {number | ""} */ arms,
) {
  const shown = joint === state.joint;
  if (shown) $("solid").innerHTML = html;
  const text = arms === "" ? "" : `, ${arms} arm${arms === 1 ? "" : "s"}`;
  $(joint ? "arms-joint" : "arms-fit").textContent = text;
  if (!shown) return;
  const auto = document.querySelector('[data-arms="auto"]');
  const isAutomatic = state.job.arms === "auto" && arms !== "";
  if (auto) auto.textContent = isAutomatic ? `auto: ${arms}` : "auto";
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
  const tabs = !!test() && !isBenchShown() && !hasNoNumbers() && state.current !== LOT,
    two = tabs && hammers().length > 0;
  $("top").hidden = !tabs;
  $("tab-joint").hidden = !two;
  const many = state.files.filter(isTest).length;
  $("tab-all").hidden = many < 2;
  $("test-count").textContent = String(many);
  for (const button of all("[data-which]")) {
    const isOwn = button.dataset.which === (state.against || (state.joint ? "joint" : "fit"));
    button.setAttribute("aria-selected", String(isOwn));
    button.tabIndex = isOwn ? 0 : -1;
  }
  $("choice-line").textContent = all("#choice-body .choice").filter((group) =>
    group.offsetParent || !group.closest(".of-test") || test()
  )
    .map((group) =>
      `${group.getAttribute("aria-label")} ${
        group.querySelector("[aria-pressed=true]")?.textContent || ""
      }`.toLowerCase()
    )
    .join(" \u00b7 ");
  $("taken").textContent = tabs && state.against
    ? ": choose a model"
    : two
    ? (state.joint ? ": joint model" : ": relaxation alone")
    : "";
}

/** Whether the shown file is a question or a refusal, without numbers. */
const hasNoNumbers = () => !!shown()?.question || shown()?.mark === "bad";

const isBenchShown = () =>
  state.files.some((openFile) => openFile.id === state.current && isBench(openFile));

export function fileList() {
  const of = test();
  $("files").replaceChildren(...state.files.map((openFile) => {
    const level = isLevel(openFile) && openFile.level ? `, at ${levelWords(openFile)}` : "";
    const unused = openFile.page === "machine" && openFile !== machine() ? ", not used" : "";
    const message = `${openFile.line || "reading"}${level}${unused}`;
    const words = createElement(
      "span",
      {},
      makeName(nameOf(openFile)),
      createElement("i", {}, message),
      ...makeStamp(openFile),
    );
    const item = createElement(
      "li",
      {},
      createElement(
        "button",
        {
          class: "file",
          "data-show": openFile.id,
          "aria-current": String(openFile.id === state.current),
        },
        icon(openFile.mark || "open"),
        words,
      ),
    );
    if (of && isTest(openFile) && canFitTogether(openFile, of)) {
      const box = createElement("input", { type: "checkbox", "data-together": openFile.id });
      box.toggleAttribute("checked", together().includes(openFile));
      item.append(createElement("label", { class: "with" }, box, " fit together"));
    }
    if (openFile.id === state.current && openFile.specimen && openFile.specimens?.length) {
      const all = openFile.specimens.map(({ id, label }) => {
        const has = { value: id, ...(id === openFile.id && { selected: "" }) };
        return createElement("option", has, label);
      });
      const select = createElement("select", { "data-specimen-of": openFile.id }, ...all);
      item.append(createElement("label", { class: "with" }, "specimen ", select));
    }
    if (openFile.id === state.current && (openFile.kind === "relaxation" || isBlank(openFile))) {
      const box = createElement("input", { type: "checkbox", "data-blank": openFile.id });
      box.toggleAttribute("checked", isBlank(openFile));
      item.append(createElement("label", { class: "with" }, box, " blank test, no seal"));
    }
    const removal = {
      class: "link away",
      "data-remove": openFile.id,
      "aria-label": `remove ${nameOf(openFile)}`,
    };
    item.append(createElement("button", removal, "\u00d7"));
    return item;
  }));
  if (state.lot) {
    const name = state.lot.replace(/[\\/]+$/, "").split(/[\\/]/).at(-1) || state.lot;
    const message = createElement(
      "span",
      {},
      createElement("b", {}, name),
      createElement("i", {}, "a lot"),
    );
    const current = String(state.current === LOT);
    const open = { class: "file", "data-show": LOT, "aria-current": current };
    const removal = { class: "link away", "data-remove": LOT, "aria-label": `remove ${name}` };
    const button = createElement("button", open, icon("note"), message);
    $("files").prepend(
      createElement("li", {}, button, createElement("button", removal, "\u00d7")),
    );
  }
  document.body.classList.toggle("empty", !state.files.length && !state.lot);
  render();
}

/** Name of a file, shortened in the middle. */
function makeName(/** @type {string} */ name) {
  if (name.length <= LONGEST) return createElement("b", {}, name);
  const short = `${name.slice(0, START)}\u2026${name.slice(START + 1 - LONGEST)}`;
  return createElement("b", { title: name }, short);
}

/** Hash and time of the contents that were read, and what happened to the file since. */
function makeStamp(/** @type {OpenFile} */ openFile) {
  if (!openFile.hash) return [];
  const when = new Date(openFile.when || ""),
    today = when.toDateString() === new Date().toDateString();
  const at = today ? when.toLocaleTimeString() : when.toLocaleDateString();
  const text = openFile.again && !openFile.watch
    ? `changed, read again ${openFile.again}`
    : `of ${at}`;
  const title = `SHA-256 ${openFile.hash}, contents of ${when.toLocaleString()}`;
  const bits = [
    createElement("i", { class: "stamp", title }, `${openFile.hash.slice(0, 8)}, ${text}`),
  ];
  if (openFile.watch) {
    bits.push(createElement("i", { class: "watch" }, WATCHED[openFile.watch] || ""));
  }
  return bits;
}

const unitWords = (/** @type {OpenFile | undefined} */ openFile) =>
  levelUnit(openFile).replace("^2", "\u00b2");
const levelNumber = (/** @type {OpenFile | undefined} */ openFile) =>
  (openFile?.level || "").slice(0, -levelUnit(openFile).length);
const levelWords = (/** @type {OpenFile} */ openFile) =>
  `${levelNumber(openFile)} ${unitWords(openFile)}`;

/** Which page is shown: a question, the hits, the panels, or what is missing. */
export function views() {
  const openFile = shown(),
    question = openFile ? openFile.question || refusedPage(openFile) : "";
  const hits = !!openFile && isHits(openFile), hitsOnly = hits && isHammerOnly(openFile);
  const fitted = !!openFile && isBench(openFile), lot = state.current === LOT;
  document.body.classList.toggle("in-lot", lot);
  $("lot-page").hidden = !lot;
  const response = !!openFile && isResponse(openFile) && !isRod(openFile),
    level = !!openFile && isLevel(openFile);
  const modes = !!openFile && isModes(openFile), masses = modes && state.frfs.of === "masses";
  const standalone = !!openFile && isStandalone(openFile);
  const many = state.files.filter(isTest).length;
  if (state.against === "all" && many < 2) state.against = "";
  const against = !!state.against && !!test() && !fitted && !question && !lot;
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
    standalone,
  };
  document.body.classList.toggle("aside", !!question);
  document.body.classList.toggle("massed", !!state.job.mass || hammers().length > 0);
  for (const [name, yes] of Object.entries(classes)) document.body.classList.toggle(name, yes);
  $("bench-page").hidden = !fitted || hitsOnly;
  $("pole-hint").hidden = !hitsOnly || !!question;
  $("machine-hint").hidden = !standalone || !openFile || !isBlank(openFile) || !!question;
  showForm(openFile);
  document.body.classList.toggle("frf-only", response && !fitted && !test());
  $("question").hidden = !question;
  $("question").innerHTML = question;
  $("hits-page").hidden = !hits || !!question || against;
  // a transmissibility goes with no relaxation test on this page
  const frfOnly = response && !level && !modes;
  $("frfs").hidden = lot || !!question || !openFile || !isResponse(openFile);
  $("joint-hint").hidden = !!test() || standalone || openFile?.page === "base";
  $("missing").hidden = lot || !!question || (fitted && !hitsOnly) || response || !!test() ||
    !hammers().length;
  $("no-level").hidden = lot || !response || fitted || !(frfOnly || !test());
  $("grid").hidden = lot || !!question || hits || fitted || frfOnly || against || !test();
  $("verdict").hidden = lot || !!question || frfOnly || !(test() || fitted);
  render();
}

/** Page of a refused file, in place of the figures. */
function refusedPage(/** @type {OpenFile} */ openFile) {
  if (openFile.mark !== "bad") return "";
  const button = createElement(
    "button",
    { class: "main", "data-remove": openFile.id },
    `Remove ${openFile.name}`,
  );
  const home = createElement(
    "div",
    {},
    createElement("h1", {}, `${openFile.name} was not read`),
    createElement("p", { class: "question" }, openFile.line || ""),
    createElement(
      "p",
      {},
      "The other files are as they were: nothing of them depends on this one.",
    ),
    createElement("p", { class: "buttons" }, button),
  );
  return home.innerHTML;
}

/** Show the form of a kind, with fields for each file where they differ. */
function showForm(/** @type {OpenFile | undefined} */ openFile) {
  const home = $("form-fields"),
    of = openFile && isStandalone(openFile)
      ? (openFile.page === "part" ? door() : openFile)
      : undefined;
  const formFields = of?.form_fields || [];
  home.hidden = !formFields.length;
  if (!of || !formFields.length || home.contains(document.activeElement)) return;
  const values = state.formValues[kindOf(of)] || {};
  const rows = formFields.flatMap((formField) => {
    const every = formField.each
      ? getFilesOfKind(of).map((each, i) => ({ name: `${formField.name} ${i}`, label: each.name }))
      : [formField];
    return every.map(({ name, label }) => {
      const has = { "data-ask": name, spellcheck: "false" };
      const input = /** @type {HTMLInputElement} */ (createElement(
        formField.choices.length ? "select" : "input",
        has,
      ));
      for (const choice of formField.choices) input.append(createElement("option", {}, choice));
      if (!formField.choices.length) input.placeholder = formField.unit ? "none" : "with unit";
      input.value = values[name] || formField.choices[0] || "";
      const unit = formField.unit.replace("^3", "\u00b3");
      return createElement(
        "label",
        { class: "field" },
        label,
        createElement("span", {}, input, createElement("i", {}, unit)),
      );
    });
  });
  home.replaceChildren(createElement("h2", {}, "This test"), ...rows);
}

/** Show the options in their fields. */
export function fields() {
  const { job } = state;
  setField("mass", job.mass.replace(/g$/, ""));
  setField("seals", String(job.seals));
  field("limit-lines").placeholder = LIMIT[getLimitsKind()] || "NAME >= VALUE";
  setField("limit-lines", state.limits[getLimitsKind()] || "");
  const rig = machine();
  $("machine-line").textContent = rig ? `${rig.name}: ${rig.line}` : MACHINE;
  field("machine-compliance").disabled = !!rig;
  setField("machine-compliance", rig ? "" : withoutUnit(job.machine?.compliance, "um/N"));
  setField("compression", job.compression.replace(/mm$/, ""));
  setField("level", levelNumber(shown()));
  $("level-unit").textContent = unitWords(shown());
  setField("level-at", state.levels.at);
  setField("frf-mass", (shown()?.mass || "").replace(/g$/, ""));
  setField("modes-band", state.frfs.band.replace(/Hz$/, ""));
  setField("amplitude-law", state.levels.law);
  setField("specimen-temperature", (getTemperatureFile()?.temperature || "").replace("degC", ""));
  for (const [name, unit] of Object.entries(SPECIMEN)) {
    setField(`specimen-${name}`, withoutUnit(job.specimen[name], unit));
  }
}

/** A quantity without the unit that its field shows. */
function withoutUnit(/** @type {string | undefined} */ text, /** @type {string} */ unit) {
  return unit && text?.endsWith(unit) ? text.slice(0, -unit.length) : text || "";
}

/** The file whose temperature the field is. */
function getTemperatureFile() {
  const openFile = shown();
  return openFile && isBench(openFile) ? openFile : test();
}

/** A number with its unit: that of the field, where none was typed. */
export function withUnit(/** @type {string} */ text, /** @type {string} */ unit) {
  return Number.isNaN(Number(text)) ? text : `${text}${unit}`;
}

/** Take a field of the specimen. */
export function describe(/** @type {string} */ name, /** @type {string} */ typed) {
  const number = typed.trim().replace(",", "."), of = getTemperatureFile();
  if (name === "temperature") {
    if (of) of.temperature = number && withUnit(number, "degC");
  } else if (number) {
    state.job.specimen[name] = name === "length" ? withUnit(number, "mm") : typed.trim();
  } else delete state.job.specimen[name];
}
