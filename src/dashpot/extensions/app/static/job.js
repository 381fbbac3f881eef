// The state of the page: open files and options, the job for the server, and the history.
import { $, all } from "./dom.js";
import { call } from "./wire.js";

/** @typedef {Record<string, any>} Options Of reading a file: roles, units */
/** @typedef {{id: string, label: string, options: Options}} Specimen One of several in a file */
/**
 * @typedef {object} OpenFile
 * @property {string} id
 * @property {string} name
 * @property {Options} options
 * @property {string} [kind]
 * @property {string} [page] Where it is taken, as the register of kinds says: "test", "hammer", ...
 * @property {string} [line]
 * @property {string} [mark]
 * @property {string} [question]
 * @property {Specimen[]} [specimens] Of which the file asked one
 * @property {string} [specimen] The one that is read, if there are several
 * @property {boolean} [simulated]
 * @property {boolean} [long]
 * @property {boolean} [together]
 * @property {string} [temperature]
 * @property {string} [mass] On the seals in an FRF, where several differ in it
 * @property {{name: string, label: string, unit: string, choices: string[], each: boolean}[]} [form_fields] Fields of its kind
 * @property {boolean} [takes_one_file] Whether it is judged by itself
 * @property {string} [hash] Of its contents, SHA-256
 * @property {string} [when] Time of its contents
 * @property {string} [watch] What became of it on disk: "", "writing", "gone", "changed", "stale"
 * @property {string} [again] When it was read again
 * @property {string} [level] Amplitude of the force, or of the base's acceleration, of an FRF
 */
/**
 * @typedef {object} Choices
 * @property {string} mass
 * @property {number} seals
 * @property {string} compression
 * @property {"auto" | number} arms
 * @property {string} method
 * @property {string} law
 * @property {string} family
 * @property {Record<string, number>} time_limits
 * @property {Record<string, string>} specimen
 * @property {Record<string, string>} machine What is known of it where no machine file is open
 * @property {{accept: string[], reject: string[]}} hammer
 */
/** @typedef {{key: string, words: string, saved: string}} Step A choice, and the state after it */
/** @typedef {{at: string, law: string}} OfLevels Forces at which a resonance is asked for, and the law */
/** @typedef {{of: "points" | "masses" | "levels" | "rod", band: string}} OfFRFs In what several FRFs differ, and where modes are sought */
/** @typedef {{files: OpenFile[], current: string, joint: boolean, base: boolean, against: "" | "ab" | "all", ab: {a: string, b: string}, phase: boolean, lot: string, levels: OfLevels, frfs: OfFRFs, formValues: Record<string, Record<string, string>>, limits: Record<string, string>, past: Step[], job: Choices}} State */

/** Value of `current` while a lot is shown. */
export const LOT = "lot";
const STEPS_BACK = 30;
const KEY = 18;

/** Default options of a job, from the declaration of the commands. */
const defaults = JSON.parse($("defaults").textContent || "");

/** @returns {State} */
const fresh = () => ({
  files: [],
  current: "",
  joint: false,
  base: false,
  against: "",
  ab: { a: "", b: "" },
  phase: false,
  lot: "",
  levels: { at: "", law: "auto" },
  frfs: { of: "points", band: "" },
  formValues: {},
  limits: {},
  past: [],
  job: {
    ...defaults,
    time_limits: {},
    specimen: {},
    machine: {},
    hammer: { accept: [], reject: [] },
  },
});

export let state = fresh();

export function restore(/** @type {Partial<State>} */ saved) {
  state = { ...fresh(), ...saved };
  if (!["ab", "all"].includes(state.against)) state.against = "";
  // a session of another version may hold steps that nothing can go back to
  state.past = state.past.filter((step) => step.saved);
}

/** @returns {(openFile: OpenFile) => boolean} */
const isReadAs = (/** @type {string[]} */ ...pages) => (openFile) =>
  pages.includes(openFile.page || "") && openFile.mark === "good";
export const isTest = isReadAs("test");
export const isHits = isReadAs("hammer");
export const isResponse = isReadAs("response", "base");
/** An FRF that is taken for that of a mass on a rod. */
export const isRod = (/** @type {OpenFile} */ openFile) =>
  isResponse(openFile) && state.frfs.of === "rod";
/** A door, among the files that are its parts. */
export const door = () => state.files.find((openFile) => openFile.kind === "door");
/** A kind that is fitted by itself, or part of an open door. */
export const isStandalone = (/** @type {OpenFile} */ openFile) =>
  isReadAs("standalone")(openFile) || isRod(openFile) || (openFile.page === "part" && !!door());
export const kindOf = (/** @type {OpenFile} */ openFile) =>
  isRod(openFile) ? "rod" : openFile.kind || "";
/** Files that are fitted together: all of the kind, unless the kind takes one file. */
export const getFilesOfKind = (/** @type {OpenFile} */ openFile) =>
  openFile.takes_one_file || openFile.specimen
    ? [openFile]
    : state.files.filter((each) =>
      isReadAs("standalone")(each) && each.kind === openFile.kind && !each.specimen
    );
/** Hits or an FRF to be fitted with a relaxation test: not an FRF at one of several amplitudes. */
export const isHammer = (/** @type {OpenFile} */ openFile) =>
  isReadAs("hammer", "response")(openFile) && !openFile.level && !isRod(openFile);
/** A file, or one of several, in which amplitude was varied. */
export const isLevel = (/** @type {OpenFile} */ openFile) =>
  isReadAs("level")(openFile) || (isResponse(openFile) && !!openFile.level);
/** An FRF whose modes are sought. */
export const isModes = (/** @type {OpenFile} */ openFile) =>
  isResponse(openFile) && !openFile.level && ["points", "masses"].includes(state.frfs.of);
/** Hits that no relaxation test goes with. */
export const isHammerOnly = (/** @type {OpenFile} */ openFile) =>
  isHits(openFile) && !state.files.some(isTest);
/** What the page fits by itself. */
export const isBench = (/** @type {OpenFile} */ openFile) =>
  isReadAs("bench")(openFile) || isHammerOnly(openFile) || isLevel(openFile) || isModes(openFile) ||
  isStandalone(openFile);
/** Unit of the amplitude of an FRF. */
export const levelUnit = (/** @type {OpenFile | undefined} */ openFile) =>
  openFile?.page === "base" ? "m/s^2" : "N";
export const shown = () => state.files.find((openFile) => openFile.id === state.current);
/** A file that is no record and has no questions: limits, a machine. */
export const isAccessory = isReadAs("limits", "machine");
const isMachine = isReadAs("machine");
/** The machine file of the tests: the last that was opened. */
export const machine = () => state.files.filter(isMachine).at(-1);
/** Kind that the typed limits apply to: the seal under test, or the shown kind. */
export const getLimitsKind = () => {
  const openFile = shown();
  return openFile && isBench(openFile) ? kindOf(openFile) : "test";
};
/** Limits of what is shown: typed, one on a line, and in files. */
export const limits = () => ({
  typed: (state.limits[getLimitsKind()] || "").split("\n").filter((text) => text.trim()),
  files: state.files.filter(isReadAs("limits")).map((openFile) => openFile.id),
});

/** The test that is fitted. */
export function test() {
  const openFile = shown();
  return openFile && isTest(openFile) ? openFile : state.files.find(isTest);
}

/** Whether two tests can be read by the same options: of specimens each has its own. */
export const canFitTogether = (/** @type {OpenFile} */ openFile, /** @type {OpenFile} */ other) =>
  openFile !== other && !openFile.specimen && !other.specimen;
/** Tests of the same seal, at another temperature or depth, that are fitted with it. */
export const together = () => {
  const of = test();
  if (!of?.together) return [];
  return state.files.filter((openFile) =>
    openFile.together && isTest(openFile) && canFitTogether(openFile, of)
  );
};
/** Files that are read by the options of the first; of specimens the one that is shown. */
export const selectSpecimen = (/** @type {OpenFile[]} */ files) =>
  files.some((openFile) => openFile.specimen)
    ? [files.find((openFile) => openFile === shown()) || files[0]]
    : files;
export const hammers = () => selectSpecimen(state.files.filter(isHammer));
/** Name of a file, with the specimen that is read. */
export const nameOf = (/** @type {OpenFile} */ openFile) =>
  openFile.specimen ? `${openFile.name} [${openFile.specimen}]` : openFile.name;

/** The job of the server; its fields are those of the command line. */
export function job() {
  const of = test(), by = hammers(), also = together();
  const temperatures = [of, ...also].map((openFile) => openFile?.temperature || "");
  const several = also.length > 0, rig = machine();
  return {
    ...state.job,
    ...(rig && { machine: rig.id }),
    relaxation: of ? of.id : "",
    reading: of ? of.options : {},
    joint: state.joint,
    other_tests: also.map((openFile) => openFile.id),
    temperatures: temperatures.some(Boolean) ? temperatures : [],
    time_limits: several ? {} : state.job.time_limits,
    impact: by.map((openFile) => openFile.id),
    reading_impact: by.length ? by[0].options : {},
  };
}

/** Models that can be compared: identity and label. */
export function solids() {
  const many = state.files.filter(isTest).length > 1,
    cut = Object.keys(state.job.time_limits).length > 0;
  return state.files.filter(isTest).flatMap((openFile) => {
    const label = (/** @type {string} */ words) => many ? `${nameOf(openFile)}, ${words}` : words;
    const models = [[`fit ${openFile.id}`, label("relaxation alone")]];
    if (hammers().length) models.push([`joint ${openFile.id}`, label("joint model")]);
    if (openFile === test() && cut) {
      models.push([`auto ${openFile.id}`, label("time limits as found")]);
    }
    return models;
  });
}

/** The job of one of them. */
export function jobOf(/** @type {string} */ solid) {
  const [how, id] = solid.split(" "), of = state.files.find((openFile) => openFile.id === id);
  const hasLimits = of === test() && how !== "auto";
  return {
    ...job(),
    relaxation: id,
    reading: of ? of.options : {},
    joint: how === "joint",
    other_tests: [],
    temperatures: of?.temperature ? [of.temperature] : [],
    time_limits: hasLimits ? state.job.time_limits : {},
  };
}

/** Job as text, alone or combined with the hammer test. */
export const questionOf = (/** @type {boolean} */ joint) => JSON.stringify({ ...job(), joint });

/** Size of each panel when it was last visible, px. @type {Record<string, [number, number]>} */
const panelSizes = {};

/**
 * Size available for the drawing in each panel, px, without legend and border; a hidden panel keeps
 * its last size.
 */
export function sizes() {
  // without the drawings of before, which would hold a place open
  document.body.classList.add("measuring");
  for (const card of all("[data-panel]")) {
    const body = card.querySelector(".body"), { clientWidth: width, clientHeight: height } = card;
    if (!width || !body) continue;
    const { paddingLeft, paddingTop } = getComputedStyle(card), key = body.clientHeight || KEY;
    const [x, y] = [2 * parseFloat(paddingLeft), 2 * parseFloat(paddingTop)];
    panelSizes[card.dataset.panel || ""] = [width - x, height - y - key];
  }
  document.body.classList.remove("measuring");
  return panelSizes;
}

// -- history --------------------------------------------------------------------------------------

/** The choices of the user in the state, as text; not what was recognised in the files. */
const key = () => {
  const { job, joint, base, levels, frfs, formValues, limits, files } = state;
  return JSON.stringify([
    job,
    joint,
    base,
    levels,
    frfs,
    formValues,
    limits,
    files.map((
      openFile,
    ) => [
      openFile.id,
      openFile.options,
      openFile.together,
      openFile.temperature,
      openFile.level,
      openFile.mass,
    ]),
  ]);
};

/** Difference between two states in a few words. */
function describeChange(/** @type {string} */ before, /** @type {string} */ after) {
  const [was, now] = [before, after].map((text) => JSON.parse(text));
  const [a, b] = [was[0], now[0]];
  /** @type {string[]} */
  const words = [];
  for (const name of Object.keys(b)) {
    if (JSON.stringify(a[name]) === JSON.stringify(b[name])) continue;
    if (name === "time_limits") {
      const names = Object.keys({ ...a.time_limits, ...b.time_limits }).filter((limit) =>
        a.time_limits[limit] !== b.time_limits[limit]
      );
      for (const limit of names) {
        const at = b.time_limits[limit] === undefined
          ? "as found"
          : `${+b.time_limits[limit].toFixed(4)} s`;
        words.push(`${limit === "onset" ? "contact" : limit.replace("_", " ")} ${at}`);
      }
    } else if (name === "hammer") {
      words.push(`hits rejected: ${b.hammer.reject.join(", ") || "none"}`);
    } else if (name === "specimen" || name === "machine") words.push(name);
    else words.push(`${name} ${String(b[name] || "not given").replace(/(\d)(?=[a-z])/, "$1 ")}`);
  }
  if (was[1] !== now[1]) words.push(now[1] ? "joint model" : "relaxation alone");
  if (was[2] !== now[2]) words.push(now[2] ? "its base moves" : "a force on it");
  if (JSON.stringify(was[6]) !== JSON.stringify(now[6])) words.push("limits");
  const more = now.at(-1).length - was.at(-1).length;
  if (more > 0) words.push(`${more === 1 ? "a file" : `${more} files`} opened`);
  if (more < 0) words.push("a file removed");
  const ids = [was, now].map((choice) =>
    choice.at(-1).map((/** @type {any[]} */ file) => file[0]).join()
  );
  if (!more && ids[0] !== ids[1]) words.push("a file that changed");
  return words.join(", ") || "reading of a file";
}

let readOnly = false;

export const isReadOnly = () => readOnly;

/** Set whether this page only shows a session that another page holds. */
export function setReadOnly(/** @type {boolean} */ yes) {
  readOnly = yes;
}

/** Save the state, for a reload and for the history. */
export function remember() {
  if (readOnly) return;
  const { past, ...current } = state, now = key(), last = past.at(-1);
  // the questions of a file are asked again when one goes back to it
  const files = current.files.map((openFile) =>
    openFile.question ? { ...openFile, question: "" } : openFile
  );
  const saved = JSON.stringify({ ...current, files });
  // going back shows the file that was shown at the next choice
  if (last?.key === now) last.saved = saved;
  else past.push({ key: now, words: last ? describeChange(last.key, now) : "opened", saved });
  if (past.length > STEPS_BACK) past.shift();
  $("undo").hidden = past.length < 2;
  call("PUT", "/api/state", JSON.stringify(state)).then(
    () => showSaveError(""),
    (error) => showSaveError(error instanceof Error ? error.message : String(error)),
  );
}

/** Show why this session would be lost on a reload. */
function showSaveError(/** @type {string} */ message) {
  $("save-error").textContent = message && `This session is not kept for a reload: ${message}.`;
  $("save-error").hidden = !message;
}

/** The last choice as a sentence; empty if files were only opened. */
export function describeLastChoice() {
  const text = state.past.length > 1 ? state.past.at(-1)?.words || "" : "";
  return text && `${text[0].toUpperCase()}${text.slice(1)}. `;
}

/** All choices, the last first. */
export const history = () => state.past.map(({ words }, i) => ({ words, i })).reverse();

/** Restore the state before the last choice, or after the choice `i`; false if there is none. */
export function undo(i = state.past.length - (state.past.at(-1)?.key === key() ? 2 : 1)) {
  const past = state.past.slice(0, i + 1), to = past.at(-1);
  if (!to || i < 0) return false;
  restore({ ...JSON.parse(to.saved), past });
  return true;
}
