// What is asked: the open files and the choices, a job for the server, and the way back.
import { $, all } from "./dom.js";
import { call } from "./wire.js";

/** @typedef {Record<string, any>} Options Of reading a file: roles, units */
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
 * @property {boolean} [simulated]
 * @property {boolean} [long]
 * @property {boolean} [together]
 * @property {string} [temperature]
 * @property {string} [mass] On the seals in an FRF, where several differ in it
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
 * @property {Record<string, number>} cuts
 * @property {Record<string, string>} specimen
 * @property {{accept: string[], reject: string[]}} hammer
 */
/** @typedef {{at: string, law: string}} OfLevels Forces at which a resonance is asked for, and the law */
/** @typedef {{of: "points" | "masses" | "levels", band: string}} OfFRFs In what several FRFs differ, and where modes are sought */
/** @typedef {{files: OpenFile[], current: string, joint: boolean, base: boolean, phase: boolean, lot: string, levels: OfLevels, frfs: OfFRFs, job: Choices}} State */

/** What is shown where no file is. */
export const LOT = "lot";
const STEPS_BACK = 100;
const KEY = 18;

/** What a job is of which nothing was said: declared where commands have it from. */
const usual = JSON.parse($("usual").textContent || "");

/** @returns {State} */
const fresh = () => ({
  files: [],
  current: "",
  joint: false,
  base: false,
  phase: false,
  lot: "",
  levels: { at: "", law: "auto" },
  frfs: { of: "points", band: "" },
  job: { ...usual, cuts: {}, specimen: {}, hammer: { accept: [], reject: [] } },
});

export let state = fresh();

export function become(/** @type {Partial<State>} */ kept) {
  state = { ...fresh(), ...kept };
}

/** @returns {(one: OpenFile) => boolean} */
const isTaken = (/** @type {string[]} */ ...pages) => (one) =>
  pages.includes(one.page || "") && one.mark === "good";
export const isTest = isTaken("test");
export const isHits = isTaken("hammer");
/** An FRF of a level goes with those of other levels, and with no relaxation test. */
export const isHammer = (/** @type {OpenFile} */ one) =>
  isTaken("hammer", "response")(one) && !one.level;
export const isResponse = isTaken("response", "base");
/** A file, or one of several, in which amplitude was varied. */
export const isLevel = (/** @type {OpenFile} */ one) =>
  isTaken("level")(one) || (isResponse(one) && !!one.level);
/** An FRF whose modes are sought. */
export const isModes = (/** @type {OpenFile} */ one) =>
  isTaken("response")(one) && !one.level && state.frfs.of !== "levels";
/** What the page fits by itself. */
export const isBench = (/** @type {OpenFile} */ one) =>
  isTaken("bench")(one) || isLevel(one) || isModes(one);
/** The unit in which the level of an FRF is said. */
export const levelUnit = (/** @type {OpenFile | undefined} */ one) =>
  one?.page === "base" ? "m/s^2" : "N";
export const shown = () => state.files.find((one) => one.id === state.current);

/** The test that is fitted. */
export function test() {
  const one = shown();
  return one && isTest(one) ? one : state.files.find(isTest);
}

/** Tests of the same seal, at another temperature or depth, that are fitted with it. */
export const together = () =>
  state.files.filter((one) => one.together && test()?.together && isTest(one) && one !== test());
export const hammers = () => state.files.filter(isHammer);

/** The job of the server; its fields are those of the command line. */
export function job() {
  const of = test(), by = hammers(), also = together();
  const warmth = [of, ...also].map((one) => one?.temperature || "");
  const several = also.length > 0;
  return {
    ...state.job,
    relaxation: of ? of.id : "",
    reading: of ? of.options : {},
    joint: state.joint,
    further: also.map((one) => one.id),
    temperatures: warmth.some(Boolean) ? warmth : [],
    cuts: several ? {} : state.job.cuts,
    impact: by.map((one) => one.id),
    reading_impact: by.length ? by[0].options : {},
  };
}

/** What is asked of the test with one solid or the other. */
export const questionOf = (/** @type {boolean} */ joint) => JSON.stringify({ ...job(), joint });

/** What room each panel has for its drawing, px: what its place leaves beside key and border. */
export function sizes() {
  /** @type {Record<string, [number, number]>} */
  const found = {};
  // without the drawings of before, which would hold a place open
  document.body.classList.add("measuring");
  for (const card of all("[data-panel]")) {
    const body = card.querySelector(".body"), { clientWidth: width, clientHeight: height } = card;
    if (!width || !body) continue;
    const { paddingLeft, paddingTop } = getComputedStyle(card), key = body.clientHeight || KEY;
    const [x, y] = [2 * parseFloat(paddingLeft), 2 * parseFloat(paddingTop)];
    found[card.dataset.panel || ""] = [width - x, height - y - key];
  }
  document.body.classList.remove("measuring");
  return found;
}

// -- the way back ---------------------------------------------------------------------------------

/** @type {{key: string, kept: string}[]} */
const past = [];

/** What of the state the user chose; what a file was found to be is none of it. */
const key = () => {
  const { job, joint, base, levels, frfs, files } = state;
  return JSON.stringify([
    job,
    joint,
    base,
    levels,
    frfs,
    files.map((one) => [one.id, one.options, one.together, one.temperature, one.level, one.mass]),
  ]);
};

/** Keep the state: for a page that is loaded again, and for the way back. */
export function remember() {
  const kept = JSON.stringify(state);
  if (past.at(-1)?.key !== key()) past.push({ key: key(), kept });
  if (past.length > STEPS_BACK) past.shift();
  call("PUT", "/api/state", kept).catch(() => {});
}

/** Become what it was before the last choice; false where there is nothing before. */
export function undo() {
  if (past.at(-1)?.key === key()) past.pop();
  const last = past.at(-1);
  if (last) become(JSON.parse(last.kept));
  return !!last;
}
