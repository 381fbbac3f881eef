// Buttons, keys, fields, dropped files, and the start of the page.
import { $, all, createElement, field, status } from "./dom.js";
import * as files from "./files.js";
import * as folders from "./folders.js";
import {
  door,
  getLimitsKind,
  history,
  kindOf,
  levelUnit,
  remember,
  restore,
  setReadOnly,
  shown,
  state,
  test,
  undo,
} from "./job.js";
import * as lot from "./lot.js";
import { poleAt } from "./panels.js";
import {
  bench,
  cancel,
  fit,
  limit,
  live,
  moreChecks,
  poles,
  predict,
  settle,
  study,
} from "./questions.js";
import { choices, describe, fields, fileList, views, withUnit } from "./shown.js";
import { refuse, setElsewhere, setTyping } from "./verdict.js";
import * as watch from "./watch.js";
import { call } from "./wire.js";

const DECKS = {
  nastran: "Nastran bush, PBUSHT",
  abaqus: "Abaqus",
  ansys: "Ansys",
  lsdyna: "LS-DYNA",
  calculix: "CalculiX",
  opensees: "OpenSees",
  adams: "Adams",
  radioss: "Radioss",
  optistruct: "OptiStruct",
  comsol: "COMSOL",
  modelica: "Modelica",
  fmu: "FMU (FMI 2.0)",
  felupe: "FElupe",
  statespace: "State space",
  csv: "Table",
};
const NOTICED = 24;
const PAUSE = 250;
const STEP = 1.01;
/** Factor of the band about a clicked pole in which its mode is sought. */
const ABOUT = 1.3;

// -- buttons and keys -----------------------------------------------------------------------------

function menu(/** @type {boolean} */ open) {
  $("menu").hidden = !open;
  document.querySelector('[data-act="menu"]')?.setAttribute("aria-expanded", String(open));
  if (open) $("units").focus();
}

function copy() {
  navigator.clipboard?.writeText($("command").textContent || "").then(
    () => status("command copied"),
    () => status("the browser does not allow access to the clipboard"),
  );
}

/** Show the model of one tab: verdict, tables, figures and exports. */
function which(/** @type {string} */ name) {
  const joint = name === "joint", was = state.against;
  const against = name === "ab" || name === "all" ? name : "";
  if (against === was && (against || joint === state.joint)) return;
  state.against = against;
  if (!against) state.joint = joint;
  if (against || was) return settle();
  choices();
  // the page still shows the other model
  $("grid").classList.add("old");
  $("solid").replaceChildren();
  remember();
  study();
}

function swap() {
  const [a, b] = [field("ab-b").value, field("ab-a").value];
  state.ab = { a, b };
  settle();
}

function allHits() {
  state.job.hammer = { accept: [], reject: [] };
  settle();
}

function reset() {
  state.job.time_limits = {};
  settle();
}

function back(/** @type {number | undefined} */ to = undefined) {
  if (!undo(to)) return;
  fileList();
  settle();
}

/** Show the history, the last choice first; each can be restored. */
function steps(/** @type {boolean} */ open) {
  $("history").hidden = !open;
  $("undo").setAttribute("aria-expanded", String(open));
  const rows = history().map(({ words, i }, at) => {
    const has = { "data-back": String(i), ...(at ? {} : { "aria-current": "true" }) };
    return createElement(
      "li",
      {},
      createElement("button", has, words, createElement("span", {}, at ? "" : "now")),
    );
  });
  $("history-list").replaceChildren(...rows);
  if (open) $("history-list").querySelector("button")?.focus();
}

function choose(/** @type {Partial<import("./job.js").Choices>} */ changes) {
  Object.assign(state.job, changes);
  settle();
}

function arms(/** @type {string} */ value) {
  if (value === "auto") choose({ arms: value });
  else choose({ arms: +value, ...(state.job.family === "fractional" && { family: "maxwell" }) });
}

function deck(/** @type {string} */ target) {
  const { checked: anyway } = field("anyway");
  const getQuantity = (/** @type {string} */ name, /** @type {string} */ unit) => {
    const number = field(`deck-${name}`).value.trim().replace(",", ".");
    return number && number + unit;
  };
  files.download({
    what: "deck",
    target,
    units: field("units").value,
    form: field("form").value,
    seals: +field("deck-seals").value || state.job.seals,
    compression: getQuantity("compression", "mm"),
    modulus: getQuantity("modulus", "MPa"),
    anyway,
  });
}

/** Fold the choices, or unfold them. */
function unfold(yes = !$("choices").classList.contains("choosing")) {
  $("choices").classList.toggle("choosing", yes);
  document.querySelector('[data-act="choices"]')?.setAttribute("aria-expanded", String(yes));
  fit();
}

const keys = /** @type {HTMLDialogElement} */ ($("keys"));

/** @type {Record<string, () => unknown>} */
const acts = {
  open: () => $("pick").click(),
  example: files.example,
  answer: files.answer,
  profile: files.profile,
  project: files.project,
  cancel,
  "take-bench": files.downloadBench,
  "use-machine": files.useMachine,
  folders: () => {
    if (document.body.classList.toggle("folders")) field("folder-name").focus();
  },
  report: () => files.download({ what: "report" }),
  choices: () => unfold(),
  "more-checks": moreChecks,
  specimen: () => {
    document.querySelector(".specimen")?.classList.toggle("edit");
    $("specimen-name").focus();
  },
  menu: () => menu(!!$("menu").hidden),
  copy,
  swap,
  reset,
  undo: () => back(),
  history: () => steps(!!$("history").hidden),
  again: () => settle(),
  "all-hits": allHits,
  mass: () => $("mass").focus(),
  dismiss: () => refuse("", "file"),
  "close-keys": () => keys.close(),
  resume: async () => {
    await call("POST", "/api/session");
    location.reload();
  },
  forget: async () => {
    await call("DELETE", "/api/session");
    $("last-session").hidden = true;
  },
};

/** Actions of the data attributes of a button, each called with the value. */
/** @type {Record<string, (value: string) => unknown>} */
const buttons = {
  act: (name) => acts[name]?.(),
  take: (what) => files.download({ what }),
  deck,
  which,
  arms,
  back: (i) => back(+i),
  folder: folders.openFolder,
  row: folders.openRow,
  sort: lot.sort,
  show: files.show,
  remove: files.remove,
  base: (value) => {
    state.base = value === "yes";
    settle();
  },
  mass: (value) => {
    state.job.mass = value;
    fields();
    predict();
    settle();
  },
  phase: () => {
    state.phase = !state.phase;
    choices();
    remember();
    study();
  },
  keep: (names) => {
    const chosenHits = names.split(",");
    const every = all("#hit-table [data-hit]").map((box) => box.dataset.hit || "");
    const { accept } = state.job.hammer, reject = every.filter((hit) => !chosenHits.includes(hit));
    choose({ hammer: { accept: accept.filter((hit) => chosenHits.includes(hit)), reject } });
  },
  step: (value) => {
    const [name, by] = value.split(" ");
    step(name, +by);
  },
  fold: (name) => {
    const open = document.body.classList.toggle(`open-${name}`);
    document.querySelector(`[data-fold="${name}"]`)?.setAttribute("aria-expanded", String(open));
    // what was folded had no width to be drawn at
    if (open && test() && ["bench", "arms"].includes(name)) settle();
  },
  frfs: (of) => {
    const openFile = shown();
    if (of !== "levels" && openFile?.level) openFile.level = "";
    if (of === "points" || of === "masses" || of === "levels" || of === "rod") {
      state.frfs = { ...state.frfs, of };
    }
    fileList();
    settle();
  },
  method: (method) => choose({ method }),
  law: (law) => choose({ law }),
  // a fractional solid has no number of arms
  family: (family) => choose(family === "fractional" ? { family, arms: "auto" } : { family }),
};

document.addEventListener("click", (event) => {
  const at = /** @type {HTMLElement} */ (event.target), button = at.closest("button");
  if (!at.closest("#menu") && button?.dataset.act !== "menu") menu(false);
  if (button?.dataset.act !== "history") steps(false);
  if (!button) return;
  for (const [name, value] of Object.entries(button.dataset)) buttons[name]?.(value || "");
});

/** @type {Record<string, () => unknown>} */
const letters = {
  o: acts.open,
  f: acts.folders,
  e: () => !state.files.length && files.example(),
  j: () => !$("top").hidden && !$("tab-joint").hidden && which("joint"),
  b: () => !$("top").hidden && which("ab"),
  " ": () => state.against === "ab" && swap(),
  p: () => test() && !state.base && buttons.phase(""),
  r: () => test() && acts.report(),
  t: () => test() && acts.menu(),
  m: () => $("mass").focus(),
  s: () => $("seals").focus(),
  c: copy,
  "[": () => files.step(-1),
  "]": () => files.step(1),
  u: () => !$("undo").hidden && acts.history(),
  "?": () => keys.showModal(),
};

document.addEventListener("keydown", (event) => {
  const at = /** @type {HTMLElement} */ (event.target);
  if (event.key === "Escape") {
    menu(false);
    steps(false);
    if (!$("cancel").hidden) acts.cancel();
    return;
  }
  if (event.ctrlKey && event.key === "z" && !at.closest("input")) {
    // the browser's own would undo what was typed into a field, and go there
    event.preventDefault();
    back();
    return;
  }
  const typing = at.closest("input, select, textarea, [role=application]");
  if (event.ctrlKey || event.metaKey || event.altKey || typing) return;
  if (/^[0-6]$/.test(event.key) && test()) arms(event.key === "0" ? "auto" : event.key);
  else {
    const act = letters[event.key.toLowerCase()];
    if (!act || (event.key === " " && (state.against !== "ab" || at.closest("button")))) return;
    event.preventDefault();
    act();
  }
});

// while B is held down, A is hidden
document.addEventListener("keydown", (event) => {
  if (event.key === "b" && event.repeat) document.body.classList.add("blink");
});
document.addEventListener("keyup", () => document.body.classList.remove("blink"));

// -- fields ---------------------------------------------------------------------------------------

// a mass may be typed with its unit
function inGrams(/** @type {string} */ text) {
  const [, number, unit] = text.match(/^(.*?)\s*(k?g)?$/) || [];
  return unit === "kg" ? String(+(1000 * +number).toPrecision(12)) : number || "";
}

function cut(
  /** @type {string} */ name,
  /** @type {number | null} */ value,
  /** @type {boolean} */ held,
) {
  const wasSet = held && name in state.job.time_limits;
  if (value === null) delete state.job.time_limits[name];
  else state.job.time_limits[name] = value;
  if (!wasSet) choices();
  $("both-fits").hidden = false;
  if (value !== null) live(name);
  if (!held) settle();
}

function useHit(/** @type {string} */ name, /** @type {boolean} */ yes) {
  const { accept, reject } = state.job.hammer;
  const others = (/** @type {string[]} */ list) => list.filter((hit) => hit !== name);
  state.job.hammer = {
    accept: [...others(accept), ...(yes ? [name] : [])],
    reject: [...others(reject), ...(yes ? [] : [name])],
  };
  if (!test()) return settle();
  remember();
  study();
}

/** Seek modes in a band about the clicked pole of the chart. */
$("hits-page").addEventListener("click", (event) => {
  const at = poleAt(event, poles);
  if (test() || !at) return;
  const [low, high] = [at / ABOUT, at * ABOUT].map((hertz) => +hertz.toPrecision(3));
  state.frfs = { ...state.frfs, band: `${low}:${high}Hz` };
  settle();
});

/** @type {Record<string, (typed: string) => void>} */
const typed = {
  mass: (text) => {
    const grams = inGrams(text);
    state.job.mass = grams && `${grams}g`;
  },
  seals: (text) => {
    state.job.seals = text ? +text : 1;
  },
  compression: (text) => {
    state.job.compression = text && `${text}mm`;
  },
  "machine-compliance": (text) => {
    const { compliance: _, ...others } = state.job.machine || {};
    state.job.machine = text ? { ...others, compliance: withUnit(text, "um/N") } : others;
  },
  level: (text) => {
    const openFile = shown();
    if (openFile) openFile.level = text && text + levelUnit(openFile);
    fileList();
  },
  "frf-mass": (text) => {
    const openFile = shown(), grams = inGrams(text);
    if (openFile) openFile.mass = grams && `${grams}g`;
    fileList();
  },
  "modes-band": (text) => {
    state.frfs = { ...state.frfs, band: text && `${text.replace(/\s*(to|[-–;])\s*/, ":")}Hz` };
  },
  "amplitude-law": (law) => {
    state.levels = { ...state.levels, law };
  },
  "level-at": (text) => {
    state.levels = { ...state.levels, at: text };
  },
};

const COUNTS = ".field, .cuts";
document.addEventListener("input", (event) => {
  const at = /** @type {HTMLElement} */ (event.target);
  if (at.closest(COUNTS)) setTyping(true);
});
// behind the change, which asks for what was typed
document.addEventListener("focusout", () => setTyping(false));

let pause = 0;
document.addEventListener("change", (event) => {
  const at = /** @type {HTMLInputElement} */ (event.target), { hit, cut: end } = at.dataset;
  const text = at.value.trim().replace(",", ".");
  setTyping(false);
  if (at.id === "pick") {
    files.uploadFiles([...(at.files || [])]);
    at.value = "";
  } else if (hit) useHit(hit, at.checked);
  else if (at.dataset.specimenOf) files.chooseSpecimen(at.dataset.specimenOf, at.value);
  else if (at.dataset.blank) files.setBlank(at.dataset.blank, at.checked);
  else if (at.dataset.together) files.join(at.dataset.together, at.checked);
  else if (at.dataset.side) {
    state.ab = { ...state.ab, [at.dataset.side]: at.value };
    settle();
  } else if (at.dataset.ask) {
    const openFile = shown(), of = openFile?.page === "part" ? door() : openFile;
    if (!of) return;
    const kind = kindOf(of), name = at.dataset.ask;
    state.formValues = {
      ...state.formValues,
      [kind]: { ...state.formValues[kind], [name]: at.value.trim() },
    };
    settle();
  } else if (end) cut(end, Number.isFinite(parseFloat(text)) ? parseFloat(text) : null, false);
  else if (at.id === "limit-lines") {
    state.limits = { ...state.limits, [getLimitsKind()]: at.value.trim() };
    limit();
  } else if (at.id.startsWith("specimen-")) {
    describe(at.id.slice("specimen-".length), at.value);
    settle();
  } else if (typed[at.id]) {
    typed[at.id](text);
    settle();
  }
});

document.addEventListener("movelimit", (event) => {
  const { name, value, held } = /** @type {CustomEvent} */ (event).detail;
  cut(name, value, held);
});

/** Change a number by so many steps: curves follow at once, the verdict after a pause. */
function step(/** @type {string} */ name, /** @type {number} */ by) {
  if (name === "seals") state.job.seals = Math.max(1, Math.round(state.job.seals) + by);
  else {
    const grams = parseFloat(state.job.mass);
    if (!grams) return $("mass").focus();
    state.job.mass = `${+(grams * STEP ** by).toPrecision(4)}g`;
  }
  field("mass").value = state.job.mass.replace(/g$/, "");
  field("seals").value = String(state.job.seals);
  delete field("mass").dataset.typed;
  predict();
  clearTimeout(pause);
  // each press is a change: what takes seconds waits for the last of them
  pause = setTimeout(settle, PAUSE);
}

// each line is a limit: it counts when it is written
$("limit-lines").addEventListener("keydown", (event) => {
  if (event.key !== "Enter" || !field("limit-lines").value.trim()) return;
  setTimeout(() => $("limit-lines").dispatchEvent(new Event("change", { bubbles: true })));
});

$("mass").addEventListener("keydown", (event) => {
  const by = { ArrowUp: 1, ArrowDown: -1 }[event.key];
  if (!by || field("mass").dataset.typed) return;
  event.preventDefault();
  step("mass", by);
});
$("mass").addEventListener("wheel", (event) => {
  if (document.activeElement !== $("mass") || field("mass").dataset.typed) return;
  event.preventDefault();
  step("mass", event.deltaY < 0 ? 1 : -1);
}, { passive: false });

document.addEventListener("number", (event) => {
  unfold(true);
  field(`cut-${/** @type {CustomEvent} */ (event).detail}`).select();
});

// -- files that are dropped, and a window of another size ----------------------------------------

$("open-folder").addEventListener("submit", (event) => {
  event.preventDefault();
  folders.openFolder(field("folder-name").value);
});
$("lot-filter").addEventListener("input", lot.draw);

let depth = 0;
addEventListener("dragenter", (event) => {
  event.preventDefault();
  depth += 1;
  $("dropping").hidden = false;
});
addEventListener("dragleave", () => {
  depth -= 1;
  $("dropping").hidden = depth > 0;
});
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => {
  event.preventDefault();
  depth = 0;
  $("dropping").hidden = true;
  if (event.dataTransfer) files.uploadFiles([...event.dataTransfer.files]);
});

let [wide, tall] = [innerWidth, innerHeight];
addEventListener("resize", () => {
  const changed = Math.max(Math.abs(innerWidth - wide), Math.abs(innerHeight - tall));
  if (changed < NOTICED || !(test() || bench())) return;
  [wide, tall] = [innerWidth, innerHeight];
  settle();
});

// -- the beginning --------------------------------------------------------------------------------

for (const [name, words] of Object.entries(DECKS)) {
  $("decks").append(createElement("button", { "data-deck": name }, words));
}

/** Take the lock of the session: one page holds it, the others only show it. */
function hold(/** @type {LockOptions} */ how) {
  return new Promise((resolve) => {
    const request = navigator.locks.request("session", how, (lock) => {
      showReadOnly(!lock);
      resolve(!!lock);
      return lock && new Promise(() => {});
    });
    // another page took it over
    request.catch(() => showReadOnly(true));
  });
}

function showReadOnly(/** @type {boolean} */ yes) {
  setReadOnly(yes);
  setElsewhere(yes);
  document.body.classList.toggle("read-only", yes);
  for (const element of all(".bar, .left, .right, .menu, #grid, .top, #drop, .recent")) {
    element.inert = yes;
  }
}

acts["take-over"] = async () => {
  await hold({ steal: true });
  // with the choices of the other page
  location.reload();
};

await hold({ ifAvailable: true });
const session = await call("GET", "/api/state").catch(() => ({}));
if (session.last_session) {
  $("last-session").hidden = false;
  $("last-session-files").textContent = session.last_session.files.join(", ");
  const when = new Date(session.last_session.when);
  $("last-session-when").textContent = when.toLocaleString(undefined, {
    dateStyle: "medium",
    timeStyle: "short",
  });
}
if (session.files) {
  restore(session);
  fileList();
  fields();
  views();
  if (state.lot) await lot.showLot();
  if (state.files.length && !session.open?.length) settle();
} else if (!session.open?.length) fileList();
// of the command line, or recorded meanwhile
if (session.open?.length) await files.openFiles(session.open);
for (const folder of session.folders || []) await folders.openFolder(folder);
await folders.list();
watch.begin();
document.body.dataset.ready = "true";
