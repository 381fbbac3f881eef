// Questions to the server, and where their answers stand. The page computes no number.
import { $, all, atWork, field, made, panelCard, put, stand, status } from "./dom.js";
import {
  alike,
  chosen,
  door,
  hammers,
  isBench,
  isHits,
  isHitsAlone,
  isJudged,
  isLevel,
  isModes,
  isResponse,
  isTest,
  job,
  jobOf,
  kindOf,
  limits,
  LOT,
  questionOf,
  readAlike,
  remember,
  shown,
  sizes,
  solids,
  state,
  test,
} from "./job.js";
import { curves, panel, placeHandles, since as counted, strips, unitOf } from "./panels.js";
import { choices, fields, fileList, solid, views } from "./shown.js";
import { asks, heals, knows, moves, refuse, stands, stops } from "./verdict.js";
import { ask, call, cancelled, forget } from "./wire.js";

const PATIENCE = 400;
const LATER = "It is judged once you let go.";
/** @type {Record<string, string>} */
const ENDS = { onset: "Contact", ramp_end: "Ramp end", hold_end: "Hold end" };
const seconds = (/** @type {number} */ since, digits = 1) =>
  `${((performance.now() - since) / 1000).toFixed(digits)} s`;

/** What decides the verdict: two questions alike have one. */
function question() {
  const of = bench();
  // limits are asked of the seal, and no verdict on its model depends on them
  if (of) return JSON.stringify([of.verb, { ...of.request, sizes: null, limits: null }]);
  if (test() && state.against) return JSON.stringify([state.against, against()]);
  return test() ? questionOf(state.joint) : "";
}

/** Say why what is asked now has no answer. */
function ends(/** @type {string} */ said) {
  $("right").classList.remove("moving");
  limitsFound({ html: "", refusal: "" });
  if (said !== cancelled) return refuse(said);
  if (state.joint) return stops("Cancelled. There is no joint model.");
  const skipped = hammers().length
    ? "The hammer test was not compared."
    : "Its limits were not computed.";
  const known = stands() && !bench() ? `The fit stands: ${found.end.join(" ")}. ${skipped}` : "";
  stops(`Cancelled. ${known || "What was asked last is not fitted."}`);
}

/** The limits as they were held against what was found, or why one is none. */
function limitsFound(/** @type {{html: string, refusal: string}} */ { html, refusal }) {
  const home = $("limits-found");
  home.classList.remove("past");
  home.hidden = !html;
  stand("limits-found", html);
  $("limits-refusal").textContent = refusal;
  $("limits-refusal").hidden = !refusal;
  const word = home.querySelector("h2")?.textContent || "";
  $("fold-limits").textContent = refusal ? "one is refused" : word || "none";
}

/** Hold other limits against what is found: no verdict on the model depends on them. */
export function limit() {
  remember();
  $("limits-found").classList.add("past");
  const alone = bench();
  if (alone) fitBench(alone);
  else study();
}

/** What the fit that was settled last chose by itself. */
let found = { arms: 0, law: "", time_limits: {}, end: ["", ""] };

/** While a handle is held: bare curves, and both fits' numbers. */
export function live(/** @type {string} */ end) {
  if (!test()) return;
  const now = question();
  asks(now, LATER, "While you drag");
  status("following");
  $("right").classList.add("moving");
  // what is chosen by trial is as it was found, until the handle is let go
  const { arms, law, time_limits } = found, own = job();
  const asked = {
    ...own,
    arms: own.arms === "auto" && arms ? arms : own.arms,
    law: own.law === "auto" && law ? law : own.law,
    time_limits: { ...time_limits, ...own.time_limits },
  };
  // what does not follow is of the cut before
  for (const name of ["frf", "spectrum"]) panelCard(name)?.classList.add("past");
  const request = { job: asked, unit: unitOf("hold"), since: counted };
  ask("live", "live", request, ({ head, arrays }) => {
    // a fit that was settled meanwhile is of what was asked later
    if (!$("right").classList.contains("moving")) return;
    curves(arrays);
    $("beside").innerHTML = head.beside;
    heals(now);
    placeHandles(head.time_limits);
    const [at, was] = [head.time_limits, found.time_limits].map((time_limits) =>
      `${time_limits[end].toFixed(3)} s`
    );
    const [name, k] = head.end, [before, k0] = found.end;
    const far = `${ENDS[end]} ${at}, was ${was}. ${name} ${k}, was ${
      name === before ? "" : `${before} `
    }${k0}.`;
    moves(`${far} ${LATER}`, head.left);
    const left = document.querySelector('[data-panel="hold"] .key li');
    if (left) left.textContent = head.left;
    performance.mark("dashpot-live");
  }, ends);
}

/** A key that takes two lines is known when it stands there: its drawing is then to be lower. */
const tooTall = () => all("[data-panel]").some((one) => one.scrollHeight > one.clientHeight + 1);

/** When it was said that nothing more is wanted. */
let stopped = 0;

/** End what is at work, and begin nothing that would have followed it. */
export function cancel() {
  stopped = performance.now();
  call("POST", "/api/cancel").catch(() => {});
}

/** The fit with its intervals and checks, and every panel of the test. */
export function settle(again = false) {
  const now = question();
  remember();
  asks(now, `${chosen()}The file is fitted.`);
  choices();
  fields();
  views();
  const of = test(), alone = bench(), lot = state.current === LOT;
  if (lot || alone || !of) ["settle", "slow"].forEach(forget);
  if (lot) return;
  if (alone) return fitBench(alone);
  if (!of) {
    nothing();
    const open = state.files.some((one) => one.asked);
    status(open ? "a question is open" : "no relaxation test is open");
    return;
  }
  if (state.against) return compare();
  // of a long record a part is drawn at once; the study fits all of it, in its own lane
  const quick = !!of.long, since = performance.now();
  status(quick ? "fitting a part of the samples" : "fitting");
  const asked = { job: job(), sizes: sizes(), quick, base: state.base, phase: state.phase };
  if (pictured !== of.id) look(of.id, asked);
  ask("settle", "settle", asked, ({ head }) => {
    knows(now, head, false);
    settled(head);
    if (stopped >= since) {
      ends(cancelled);
      return status(cancelled);
    }
    if (!again && tooTall()) return settle(true);
    status(`fitted in ${seconds(since, 2)}`);
    study();
  }, (said) => {
    ends(said);
    status("not fitted");
  });
}

/** The test whose record stands in its panels. */
let pictured = "";

/** The record alone, to look at until its fit is there: nothing of another test beside it. */
function look(/** @type {string} */ of, /** @type {any} */ asked) {
  ask("look", "look", asked, ({ head }) => {
    if (pictured === of || test()?.id !== of) return;
    for (const name of ["frf", "spectrum"]) panel(name, "");
    for (const [name, html] of Object.entries(head.panels)) panel(name, html);
  }, () => {});
}

/** Without a test nothing is known of a seal. */
function nothing() {
  drawnOf = pictured = "";
  $("right").classList.remove("moving");
  solid("", false, "");
  solid("", true, "");
  for (const name of ["checks", "beside", "answers", "command", "bench-page", "tells-more"]) {
    $(name).replaceChildren();
  }
  limitsFound({ html: "", refusal: "" });
  $("simulated").hidden = true;
  for (const end of all("[data-cut]")) put(end.id, "");
}

let drawnOf = "";

function settled(/** @type {any} */ head) {
  // what stands there of both tests is old, and looks so, until their solid is found anew
  const old = state.joint && drawnOf === test()?.id;
  pictured = test()?.id || "";
  if (!old) {
    for (const [name, html] of Object.entries(head.panels)) panel(name, html);
    $("answers").replaceChildren();
    $("solid").replaceChildren();
  }
  $("grid").classList.toggle("old", old);
  if (old) $("command").textContent = head.command;
  else told(head);
  solid(head.solid, false, head.arms);
  $("beside").innerHTML = head.beside;
  $("beside").hidden = !Object.keys(state.job.time_limits).length;
  $("pressed").textContent = head.pressed.message;
  field("compression").placeholder = head.pressed.value || "weight";
  field("specimen-temperature").placeholder = head.temperature || "not given";
  found = { arms: head.arms, law: head.law, time_limits: head.time_limits, end: head.end };
  const [first, last] = head.clock;
  placeHandles(head.time_limits, { first, last, step: head.step }, !old);
  $("right").classList.remove("moving");
  fit();
}

/** What every answer tells of the solid. */
function told(/** @type {any} */ head) {
  $("checks").innerHTML = head.checks;
  $("command").textContent = head.command;
  $("simulated").hidden = !head.simulated;
  $("tells-more").innerHTML = head.more || "";
}

/**
 * Where a column is too short for all of it the choices fold, then notes are counted alone, then
 * what helps is, then the last of what failed: one press shows them in place of the numbers.
 */
export function fit() {
  const right = $("right"), more = document.getElementById("more-checks");
  const rows = all("#checks li"), failed = rows.filter((row) => row.className !== "note");
  const full = () => right.scrollHeight > right.clientHeight + 1;
  right.classList.remove("short", "tight", "tighter", "checking");
  for (const row of rows) row.hidden = false;
  if (more) more.hidden = true;
  if (full()) right.classList.add("short");
  if (!more || !rows.length || !full()) return;
  right.classList.add("tight");
  if (full()) right.classList.add("tighter");
  let counted = 0;
  while (full() && counted + 1 < failed.length) failed[failed.length - ++counted].hidden = true;
  const unsaid = [
    counted && `${counted} more`,
    right.classList.contains("tighter") ? "what helps" : rows.length > failed.length && "notes",
  ];
  more.textContent = unsaid.filter(Boolean).join(", ");
  more.hidden = !more.textContent;
  more.setAttribute("aria-expanded", "false");
}

/** All checks in full, in place of the numbers, and back. */
export function moreChecks() {
  if ($("right").classList.contains("checking")) return fit();
  $("right").classList.add("checking");
  for (const row of all("#checks li")) row.hidden = false;
  $("more-checks").textContent = "numbers";
  $("more-checks").setAttribute("aria-expanded", "true");
}

/** A question that takes seconds, can be cancelled, and says meanwhile what is done. */
function slowly(
  /** @type {string} */ verb,
  /** @type {any} */ request,
  /** @type {(head: any) => unknown} */ done,
  without = () => {},
) {
  const since = performance.now();
  atWork(1);
  let over = false;
  const timer = setInterval(async () => {
    const at = await call("GET", "/api/working").catch(() => null);
    if (over) return;
    const doing = at && at.seconds !== null
      ? at.doing || "computing limits of the response"
      : "working";
    status(`${doing}, ${seconds(since)}`);
  }, PATIENCE);
  const end = () => {
    if (over) return;
    over = true;
    clearInterval(timer);
    atWork(-1);
  };
  ask("slow", verb, request, ({ head }) => {
    end();
    if (done(head) !== false) status(`done in ${seconds(since)}`);
  }, (said) => {
    end();
    without();
    ends(said);
    status(said === cancelled ? "cancelled" : "stopped");
  }, end);
}

/** Both sides that are held against each other, each the first that there is if it is not chosen. */
function ab() {
  const every = solids().map(([name]) => name), now = test()?.id;
  const usual = [`fit ${now}`, every.find((one) => one !== `fit ${now}`) || `fit ${now}`];
  const [a, b] = [state.ab.a, state.ab.b].map((one, i) => every.includes(one) ? one : usual[i]);
  return { a, b };
}

/** What is laid over each other or held against each other: two models, or all tests. */
const against = () => state.against === "all" ? overlaid() : ab();

/** Every test by itself, with the choices of the page. */
function overlaid() {
  return state.files.filter(isTest).map((one) => jobOf(`fit ${one.id}`)).map((one) => ({
    ...one,
    impact: [],
    reading_impact: {},
    time_limits: {},
  }));
}

/** All tests over each other. */
function overlay() {
  const now = question();
  asks(now, "All tests are fitted, each by itself.");
  slowly("overlay", { jobs: overlaid(), sizes: sizes() }, (head) => {
    for (const [name, html] of Object.entries(head.panels)) panel(name, html);
    stand("seals-table", head.table);
    $("simulated").hidden = !head.simulated;
    $("command").textContent = head.command;
    knows(now, head, true);
    return true;
  });
}

/** Two fits against each other. */
function compare() {
  if (state.against === "all") return overlay();
  const { a, b } = ab(), now = question();
  asks(now, "Both fits are compared.");
  for (const [side, chosen] of [["a", a], ["b", b]]) {
    const all = solids().map(([name, words]) => made("option", { value: name }, words));
    $(`ab-${side}`).replaceChildren(...all);
    field(`ab-${side}`).value = chosen;
  }
  const request = { a: { job: jobOf(a) }, b: { job: jobOf(b) }, sizes: sizes() };
  slowly("against", request, (head) => {
    for (const [name, html] of Object.entries(head.panels)) panel(name, html);
    $("ab-table").innerHTML = head.table;
    $("simulated").hidden = !head.simulated;
    $("command").textContent = "";
    knows(now, head, true);
    return true;
  });
}

/** The whole story: bound, hammer, joint fit. */
export function study(again = false) {
  if (!test()) return;
  if (state.against) return compare();
  const now = question();
  asks(
    now,
    `${chosen()}${hammers().length ? "The hammer is compared." : "Its limits are computed."}`,
  );
  const asked = { job: job(), sizes: sizes(), base: state.base, phase: state.phase };
  slowly("study", { ...asked, limits: limits() }, (head) => {
    studied(head);
    limitsFound(head.limits);
    knows(now, head, !head.hint);
    if (head.hint) stops(head.hint, { words: "Give the mass", act: "mass" });
    if (again || !tooTall()) return true;
    study(true);
    return false;
  });
}

/** What is asked of the file that is shown, if the page fits it by itself, and by which verb. */
export function bench() {
  const asked = benchAsked();
  return asked && { ...asked, request: { ...asked.request, limits: limits() } };
}

function benchAsked() {
  const one = shown();
  if (!one || !isBench(one)) return null;
  const { id: file, options, temperature } = one, { arms, mass, seals } = state.job;
  // in one column it is none itself
  const width = $("main").clientWidth || document.body.clientWidth;
  const room = { bench: [width - 16, 0] };
  if (isJudged(one)) return { verb: "judged", request: { ...judged(one), sizes: room } };
  if (isHitsAlone(one)) {
    const files = readAlike(state.files.filter(isHits)).map((each) => each.id);
    const { band } = state.frfs;
    const request = { files, options, hammer: state.job.hammer, band };
    return { verb: "hammer", request: { ...request, sizes: sizes() } };
  }
  if (isModes(one)) {
    const every = readAlike(state.files.filter(isModes)), { of, band } = state.frfs;
    const files = every.map((each) => each.id);
    const by = of === "masses" ? { masses: every.map((each) => each.mass || ""), seals } : {};
    return { verb: "modes", request: { files, ...by, options: one.options, band, sizes: room } };
  }
  if (!isLevel(one)) {
    return { verb: "bench", request: { file, options, temperature, arms, sizes: room } };
  }
  const { at, law } = state.levels;
  if (!isResponse(one)) {
    return { verb: "level", request: { files: [file], options, law, sizes: room } };
  }
  const all = readAlike(state.files.filter((each) => isResponse(each) && each.level));
  const files = all.map((each) => each.id), levels = all.map((each) => each.level);
  const wanted = at.split(/[\s;]+/).filter(Boolean).map((force) => `${force.replace(",", ".")}N`);
  const request = { files, levels, options: all[0].options, mass, seals, at: wanted, sizes: room };
  return { verb: "level", request };
}

/** What is asked of a kind that stands alone, and of which files. */
function judged(/** @type {import("./job.js").OpenFile} */ one) {
  const of = one.page === "part" ? door() || one : one, kind = kindOf(of);
  const { options } = of, said = state.said[kind] || {};
  if (kind === "door") {
    const others = state.files.filter((each) => each !== of).map((each) => each.id);
    return { kind, files: [of.id, ...others], said, options: {}, test: test()?.id || "" };
  }
  return { kind, files: alike(of).map((each) => each.id), said, options };
}

let benched = "";

function fitBench(/** @type {{verb: string, request: any}} */ { verb, request }) {
  const now = question();
  // what stands there may be another file's
  if (benched !== state.current) nothing();
  benched = state.current;
  slowly(verb, request, (head) => {
    knows(now, head, true);
    $("solid").innerHTML = head.solid;
    solid(head.solid, state.joint, head.arms);
    $("answers").innerHTML = head.answers || "";
    $("beside").hidden = true;
    told(head);
    limitsFound(head.limits);
    fit();
    if (verb === "hammer") return hitsAlone(head);
    strips($("bench-page"), head.figures, verb, head.facts);
    return true;
  }, nothing);
}

/** Poles of the stabilisation chart that stands there, each its frequency, Hz. */
export let poles = /** @type {number[]} */ ([]);

function hitsAlone(/** @type {any} */ head) {
  for (const [name, html] of Object.entries(head.hit_panels)) panel(name, html);
  stand("hit-table", head.hits);
  poles = head.poles.map((/** @type {number[]} */ pole) => pole[0]);
  return true;
}

function studied(/** @type {any} */ head) {
  drawnOf = test()?.id || "";
  $("grid").classList.remove("old");
  for (
    const [name, html] of Object.entries({ frf: head.frf, ...head.hit_panels, ...head.panels })
  ) {
    panel(name, html);
  }
  if (state.joint) $("beside").hidden = true; // it is of the relaxation test alone
  stand("hit-table", head.hits);
  for (const one of hammers()) one.line = head.hammer || one.line;
  fileList();
  $("answers").innerHTML = head.answers;
  solid(head.solid, state.joint, head.arms);
  told(head);
  fit();
  placeHandles(head.time_limits, null, true);
}

/** The response of the mass while it moves. */
export function predict() {
  if (!test() || !state.job.mass) return;
  const now = question();
  asks(now, LATER, "While the mass moves");
  status("following");
  ask(
    "mass",
    "predict",
    { job: job(), base: state.base, phase: state.phase },
    ({ head, arrays }) => {
      curves(arrays);
      moves(`Peak at ${head.peak}. ${LATER}`);
      $("command").textContent = head.command;
      performance.mark("dashpot-mass");
    },
    ends,
  );
}
