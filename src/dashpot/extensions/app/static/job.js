// What is asked: the open files and the choices, a job for the server, and the way back.
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
 * @property {string} [asked]
 * @property {Specimen[]} [specimens] Of which the file asked one
 * @property {string} [specimen] The one that is read, if there are several
 * @property {boolean} [simulated]
 * @property {boolean} [long]
 * @property {boolean} [together]
 * @property {string} [temperature]
 * @property {string} [mass] On the seals in an FRF, where several differ in it
 * @property {{name: string, label: string, unit: string, choices: string[], each: boolean}[]} [asks] Fields of its kind
 * @property {boolean} [alone] Whether it is judged by itself
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
/** @typedef {{key: string, words: string, kept: string}} Step A choice, and the state after it */
/** @typedef {{at: string, law: string}} OfLevels Forces at which a resonance is asked for, and the law */
/** @typedef {{of: "points" | "masses" | "levels" | "rod", band: string}} OfFRFs In what several FRFs differ, and where modes are sought */
/** @typedef {{files: OpenFile[], current: string, joint: boolean, base: boolean, against: "" | "ab" | "all", ab: {a: string, b: string}, phase: boolean, lot: string, levels: OfLevels, frfs: OfFRFs, said: Record<string, Record<string, string>>, limits: Record<string, string>, past: Step[], job: Choices}} State */

/** What is shown where no file is. */
export const LOT = "lot";
const STEPS_BACK = 30;
const KEY = 18;

/** What a job is of which nothing was said: declared where commands have it from. */
const usual = JSON.parse($("usual").textContent || "");

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
  said: {},
  limits: {},
  past: [],
  job: { ...usual, time_limits: {}, specimen: {}, machine: {}, hammer: { accept: [], reject: [] } },
});

export let state = fresh();

export function become(/** @type {Partial<State>} */ kept) {
  state = { ...fresh(), ...kept };
  if (!["ab", "all"].includes(state.against)) state.against = "";
}

/** @returns {(one: OpenFile) => boolean} */
const isTaken = (/** @type {string[]} */ ...pages) => (one) =>
  pages.includes(one.page || "") && one.mark === "good";
export const isTest = isTaken("test");
export const isHits = isTaken("hammer");
export const isResponse = isTaken("response", "base");
/** An FRF that is taken for that of a mass on a rod. */
export const isRod = (/** @type {OpenFile} */ one) => isResponse(one) && state.frfs.of === "rod";
/** A door, among the files that are its parts. */
export const door = () => state.files.find((one) => one.kind === "door");
/** A kind that stands alone, or part of a door that is open. */
export const isJudged = (/** @type {OpenFile} */ one) =>
  isTaken("judged")(one) || isRod(one) || (one.page === "part" && !!door());
export const kindOf = (/** @type {OpenFile} */ one) => isRod(one) ? "rod" : one.kind || "";
/** The files that are judged together with one: all of its kind, but for what is one hit or rod. */
export const alike = (/** @type {OpenFile} */ one) =>
  one.alone || one.specimen
    ? [one]
    : state.files.filter((each) =>
      isTaken("judged")(each) && each.kind === one.kind && !each.specimen
    );
/** An FRF of a level goes with those of other levels, and with no relaxation test. */
export const isHammer = (/** @type {OpenFile} */ one) =>
  isTaken("hammer", "response")(one) && !one.level && !isRod(one);
/** A file, or one of several, in which amplitude was varied. */
export const isLevel = (/** @type {OpenFile} */ one) =>
  isTaken("level")(one) || (isResponse(one) && !!one.level);
/** An FRF whose modes are sought. */
export const isModes = (/** @type {OpenFile} */ one) =>
  isResponse(one) && !one.level && ["points", "masses"].includes(state.frfs.of);
/** Hits that no relaxation test goes with. */
export const isHitsAlone = (/** @type {OpenFile} */ one) =>
  isHits(one) && !state.files.some(isTest);
/** What the page fits by itself. */
export const isBench = (/** @type {OpenFile} */ one) =>
  isTaken("bench")(one) || isHitsAlone(one) || isLevel(one) || isModes(one) || isJudged(one);
/** The unit in which the level of an FRF is said. */
export const levelUnit = (/** @type {OpenFile | undefined} */ one) =>
  one?.page === "base" ? "m/s^2" : "N";
export const shown = () => state.files.find((one) => one.id === state.current);
/** A file that is no record, and is asked nothing by itself: limits, a machine. */
export const isBeside = isTaken("limits", "machine");
const isMachine = isTaken("machine");
/** The machine file of the tests: the last that was opened. */
export const machine = () => state.files.filter(isMachine).at(-1);
/** Of what the limits are that are typed: of the seal under test, or of the kind that is shown. */
export const limited = () => {
  const one = shown();
  return one && isBench(one) ? kindOf(one) : "test";
};
/** Limits of what is shown: typed, one on a line, and in files. */
export const limits = () => ({
  typed: (state.limits[limited()] || "").split("\n").filter((text) => text.trim()),
  files: state.files.filter(isTaken("limits")).map((one) => one.id),
});

/** The test that is fitted. */
export function test() {
  const one = shown();
  return one && isTest(one) ? one : state.files.find(isTest);
}

/** Whether two tests can be read by the same options: of specimens each has its own. */
export const goTogether = (/** @type {OpenFile} */ one, /** @type {OpenFile} */ other) =>
  one !== other && !one.specimen && !other.specimen;
/** Tests of the same seal, at another temperature or depth, that are fitted with it. */
export const together = () => {
  const of = test();
  if (!of?.together) return [];
  return state.files.filter((one) => one.together && isTest(one) && goTogether(one, of));
};
/** Files that are read by the options of the first; of specimens the one that is shown. */
export const readAlike = (/** @type {OpenFile[]} */ files) =>
  files.some((one) => one.specimen) ? [files.find((one) => one === shown()) || files[0]] : files;
export const hammers = () => readAlike(state.files.filter(isHammer));
/** What a file is called: by its name, and which of its specimens is read. */
export const nameOf = (/** @type {OpenFile} */ one) =>
  one.specimen ? `${one.name} [${one.specimen}]` : one.name;

/** The job of the server; its fields are those of the command line. */
export function job() {
  const of = test(), by = hammers(), also = together();
  const warmth = [of, ...also].map((one) => one?.temperature || "");
  const several = also.length > 0, rig = machine();
  return {
    ...state.job,
    ...(rig && { machine: rig.id }),
    relaxation: of ? of.id : "",
    reading: of ? of.options : {},
    joint: state.joint,
    other_tests: also.map((one) => one.id),
    temperatures: warmth.some(Boolean) ? warmth : [],
    time_limits: several ? {} : state.job.time_limits,
    impact: by.map((one) => one.id),
    reading_impact: by.length ? by[0].options : {},
  };
}

/** The solids that can be held against each other, each by what it is of. */
export function solids() {
  const many = state.files.filter(isTest).length > 1,
    cut = Object.keys(state.job.time_limits).length > 0;
  return state.files.filter(isTest).flatMap((one) => {
    const own = (/** @type {string} */ words) => many ? `${nameOf(one)}, ${words}` : words;
    const found = [[`fit ${one.id}`, own("relaxation alone")]];
    if (hammers().length) found.push([`joint ${one.id}`, own("joint model")]);
    if (one === test() && cut) found.push([`found ${one.id}`, own("time limits as found")]);
    return found;
  });
}

/** The job of one of them. */
export function jobOf(/** @type {string} */ solid) {
  const [how, id] = solid.split(" "), of = state.files.find((one) => one.id === id);
  const own = of === test() && how !== "found";
  return {
    ...job(),
    relaxation: id,
    reading: of ? of.options : {},
    joint: how === "joint",
    other_tests: [],
    temperatures: of?.temperature ? [of.temperature] : [],
    time_limits: own ? state.job.time_limits : {},
  };
}

/** What is asked of the test with one solid or the other. */
export const questionOf = (/** @type {boolean} */ joint) => JSON.stringify({ ...job(), joint });

/** What room each panel had when it was seen last. @type {Record<string, [number, number]>} */
const rooms = {};

/**
 * What room each panel has for its drawing, px: what its place leaves beside key and border. One
 * that is not shown now is drawn for where it stood.
 */
export function sizes() {
  // without the drawings of before, which would hold a place open
  document.body.classList.add("measuring");
  for (const card of all("[data-panel]")) {
    const body = card.querySelector(".body"), { clientWidth: width, clientHeight: height } = card;
    if (!width || !body) continue;
    const { paddingLeft, paddingTop } = getComputedStyle(card), key = body.clientHeight || KEY;
    const [x, y] = [2 * parseFloat(paddingLeft), 2 * parseFloat(paddingTop)];
    rooms[card.dataset.panel || ""] = [width - x, height - y - key];
  }
  document.body.classList.remove("measuring");
  return rooms;
}

// -- the way back ---------------------------------------------------------------------------------

/** What of the state the user chose; what a file was found to be is none of it. */
const key = () => {
  const { job, joint, base, levels, frfs, said, limits, files } = state;
  return JSON.stringify([
    job,
    joint,
    base,
    levels,
    frfs,
    said,
    limits,
    files.map((one) => [one.id, one.options, one.together, one.temperature, one.level, one.mass]),
  ]);
};

/** What was chosen, in a few words: how one state differs from the one before. */
function changed(/** @type {string} */ before, /** @type {string} */ after) {
  const [was, now] = [before, after].map((one) => JSON.parse(one));
  const [a, b] = [was[0], now[0]];
  /** @type {string[]} */
  const words = [];
  for (const name of Object.keys(b)) {
    if (JSON.stringify(a[name]) === JSON.stringify(b[name])) continue;
    if (name === "time_limits") {
      const moved = Object.keys({ ...a.time_limits, ...b.time_limits }).filter((one) =>
        a.time_limits[one] !== b.time_limits[one]
      );
      for (const one of moved) {
        const at = b.time_limits[one] === undefined
          ? "as found"
          : `${+b.time_limits[one].toFixed(4)} s`;
        words.push(`${one === "onset" ? "contact" : one.replace("_", " ")} ${at}`);
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
  const ids = [was, now].map((one) =>
    one.at(-1).map((/** @type {any[]} */ file) => file[0]).join()
  );
  if (!more && ids[0] !== ids[1]) words.push("a file that changed");
  return words.join(", ") || "reading of a file";
}

let readOnly = false;

export const readsOnly = () => readOnly;

/** Keep nothing of a page that is open elsewhere. */
export function onlyRead(/** @type {boolean} */ yes) {
  readOnly = yes;
}

/** Keep the state: for a page that is loaded again, and for the way back. */
export function remember() {
  if (readOnly) return;
  const { past, ...own } = state, now = key(), last = past.at(-1);
  // what a file asks is asked again where one goes back to it
  const files = own.files.map((one) => one.asked ? { ...one, asked: "" } : one);
  const kept = JSON.stringify({ ...own, files });
  // one goes back to the file that was shown when the next choice was made
  if (last?.key === now) last.kept = kept;
  else past.push({ key: now, words: last ? changed(last.key, now) : "opened", kept });
  if (past.length > STEPS_BACK) past.shift();
  $("undo").hidden = past.length < 2;
  call("PUT", "/api/state", JSON.stringify(state)).then(
    () => unkept(""),
    (error) => unkept(error instanceof Error ? error.message : String(error)),
  );
}

/** Say that a page that is loaded again would not find this session, and why. */
function unkept(/** @type {string} */ said) {
  $("unkept").textContent = said && `This session is not kept for a reload: ${said}.`;
  $("unkept").hidden = !said;
}

/** What was chosen last, as a sentence; nothing of what was only opened. */
export function chosen() {
  const said = state.past.length > 1 ? state.past.at(-1)?.words || "" : "";
  return said && `${said[0].toUpperCase()}${said.slice(1)}. `;
}

/** What was chosen so far, the last first. */
export const history = () => state.past.map(({ words }, i) => ({ words, i })).reverse();

/** Become what it was before the last choice, or after the choice `i`; false if there is none. */
export function undo(i = state.past.length - (state.past.at(-1)?.key === key() ? 2 : 1)) {
  const past = state.past.slice(0, i + 1), to = past.at(-1);
  if (!to || i < 0) return false;
  become({ ...JSON.parse(to.kept), past });
  return true;
}
