// Requests to the server, and where their answers are shown. The page computes no number.
import {
  $,
  all,
  countWorking,
  createElement,
  field,
  panelCard,
  setField,
  setHtml,
  status,
} from "./dom.js";
import {
  describeLastChoice,
  door,
  getFilesOfKind,
  hammers,
  isBench,
  isHammerOnly,
  isHits,
  isLevel,
  isModes,
  isResponse,
  isStandalone,
  isTest,
  job,
  jobOf,
  kindOf,
  limits,
  LOT,
  questionOf,
  remember,
  selectSpecimen,
  shown,
  sizes,
  solids,
  state,
  test,
} from "./job.js";
import { curves, panel, placeHandles, since as counted, strips, unitOf } from "./panels.js";
import { choices, fields, fileList, solid, views } from "./shown.js";
import {
  askQuestion,
  clearRefusal,
  endQuestion,
  hasPartialAnswer,
  refuse,
  showProgress,
  takeAnswer,
} from "./verdict.js";
import { askQueued, call, cancelled, forget } from "./wire.js";

const PATIENCE = 400;
const LATER = "It is judged once you let go.";
/** @type {Record<string, string>} */
const ENDS = { onset: "Contact", ramp_end: "Ramp end", hold_end: "Hold end" };
const seconds = (/** @type {number} */ since, digits = 1) =>
  `${((performance.now() - since) / 1000).toFixed(digits)} s`;

/** Everything that the verdict depends on, as text. */
function question() {
  const of = bench();
  // the verdict on a model does not depend on limits
  if (of) return JSON.stringify([of.verb, { ...of.request, sizes: null, limits: null }]);
  if (test() && state.against) return JSON.stringify([state.against, against()]);
  return test() ? questionOf(state.joint) : "";
}

/** Show why the current request has no answer. */
function showFailure(/** @type {string} */ message) {
  $("right").classList.remove("moving");
  showLimits({ html: "", refusal: "" });
  if (message !== cancelled) return refuse(message);
  if (state.joint) return endQuestion("Cancelled. There is no joint model.");
  const skipped = hammers().length
    ? "The hammer test was not compared."
    : "Its limits were not computed.";
  const note = hasPartialAnswer() && !bench()
    ? `The fit stands: ${automatic.end.join(" ")}. ${skipped}`
    : "";
  endQuestion(`Cancelled. ${note || "What was asked last is not fitted."}`);
}

/** Show the result compared with the limits, or why a limit was refused. */
function showLimits(/** @type {{html: string, refusal: string}} */ { html, refusal }) {
  const home = $("limits-result");
  home.classList.remove("past");
  home.hidden = !html;
  setHtml("limits-result", html);
  $("limits-refusal").textContent = refusal;
  $("limits-refusal").hidden = !refusal;
  const word = home.querySelector("h2")?.textContent || "";
  $("fold-limits").textContent = refusal ? "one is refused" : word || "none";
}

/** Compare the result with other limits; the verdict on the model does not depend on them. */
export function limit() {
  remember();
  $("limits-result").classList.add("past");
  const benchRequest = bench();
  if (benchRequest) fitBench(benchRequest);
  else study();
}

/** Choices that the last complete fit made automatically. */
let automatic = { arms: 0, law: "", time_limits: {}, end: ["", ""] };

/** While a handle is dragged: curves and the numbers of both fits. */
export function live(/** @type {string} */ end) {
  if (!test()) return;
  const now = question();
  askQuestion(now, LATER, "While you drag");
  status("following");
  $("right").classList.add("moving");
  // automatic choices are kept until the handle is released
  const { arms, law, time_limits } = automatic, current = job();
  const draggedJob = {
    ...current,
    arms: current.arms === "auto" && arms ? arms : current.arms,
    law: current.law === "auto" && law ? law : current.law,
    time_limits: { ...time_limits, ...current.time_limits },
  };
  // these panels still show the time limits before
  for (const name of ["frf", "spectrum"]) panelCard(name)?.classList.add("past");
  const request = { job: draggedJob, unit: unitOf("hold"), since: counted };
  askQueued("live", "live", request, ({ head, arrays }) => {
    // a complete fit that arrived meanwhile is newer
    if (!$("right").classList.contains("moving")) return;
    curves(arrays);
    $("both-fits").innerHTML = head.both_fits;
    clearRefusal(now);
    placeHandles(head.time_limits);
    const [at, was] = [head.time_limits, automatic.time_limits].map((time_limits) =>
      `${time_limits[end].toFixed(3)} s`
    );
    const [name, k] = head.end, [before, k0] = automatic.end;
    const far = `${ENDS[end]} ${at}, was ${was}. ${name} ${k}, was ${
      name === before ? "" : `${before} `
    }${k0}.`;
    showProgress(`${far} ${LATER}`, head.residual_note);
    const residualKey = document.querySelector('[data-panel="hold"] .key li');
    if (residualKey) residualKey.textContent = head.residual_note;
    performance.mark("dashpot-live");
  }, showFailure);
}

/** Whether a legend takes two lines, so that its drawing must be lower. */
const tooTall = () => all("[data-panel]").some((card) => card.scrollHeight > card.clientHeight + 1);

/** Time of the last cancellation. */
let stopped = 0;

/** Cancel what is being computed, and what would follow it. */
export function cancel() {
  stopped = performance.now();
  call("POST", "/api/cancel").catch(() => {});
}

/** Request the fit with its intervals and checks, and every panel of the test. */
export function settle(again = false) {
  const now = question();
  remember();
  askQuestion(now, `${describeLastChoice()}The file is fitted.`);
  choices();
  fields();
  views();
  const of = test(), benchRequest = bench(), lot = state.current === LOT;
  if (lot || benchRequest || !of) ["settle", "slow"].forEach(forget);
  if (lot) return;
  if (benchRequest) return fitBench(benchRequest);
  if (!of) {
    clearPage();
    const open = state.files.some((openFile) => openFile.question);
    status(open ? "a question is open" : "no relaxation test is open");
    return;
  }
  if (state.against) return compare();
  // of a long record a part is drawn at once; the study fits all of it, in its own queue
  const quick = !!of.long, since = performance.now();
  status(quick ? "fitting a part of the samples" : "fitting");
  const request = { job: job(), sizes: sizes(), quick, base: state.base, phase: state.phase };
  if (shownRecord !== of.id) showRecord(of.id, request);
  askQueued("settle", "settle", request, ({ head }) => {
    takeAnswer(now, head, false);
    showFit(head);
    if (stopped >= since) {
      showFailure(cancelled);
      return status(cancelled);
    }
    if (!again && tooTall()) return settle(true);
    status(`fitted in ${seconds(since, 2)}`);
    study();
  }, (message) => {
    showFailure(message);
    status("not fitted");
  });
}

/** Test whose record is shown in the panels. */
let shownRecord = "";

/** Show the record until its fit arrives, and nothing of another test. */
function showRecord(/** @type {string} */ of, /** @type {any} */ request) {
  askQueued("look", "look", request, ({ head }) => {
    if (shownRecord === of || test()?.id !== of) return;
    for (const name of ["frf", "spectrum"]) panel(name, "");
    for (const [name, html] of Object.entries(head.panels)) panel(name, html);
  }, () => {});
}

/** Clear the page: there is no test. */
function clearPage() {
  shownStudy = shownRecord = "";
  $("right").classList.remove("moving");
  solid("", false, "");
  solid("", true, "");
  for (const name of ["checks", "both-fits", "answers", "command", "bench-page", "tells-more"]) {
    $(name).replaceChildren();
  }
  showLimits({ html: "", refusal: "" });
  $("simulated").hidden = true;
  for (const end of all("[data-cut]")) setField(end.id, "");
}

let shownStudy = "";

function showFit(/** @type {any} */ head) {
  // the combined fit of before is shown as outdated until the new one arrives
  const old = state.joint && shownStudy === test()?.id;
  shownRecord = test()?.id || "";
  if (!old) {
    for (const [name, html] of Object.entries(head.panels)) panel(name, html);
    $("answers").replaceChildren();
    $("solid").replaceChildren();
  }
  $("grid").classList.toggle("old", old);
  if (old) $("command").textContent = head.command;
  else showChecks(head);
  solid(head.solid, false, head.arms);
  $("both-fits").innerHTML = head.both_fits;
  $("both-fits").hidden = !Object.keys(state.job.time_limits).length;
  $("pressed").textContent = head.pressed.message;
  field("compression").placeholder = head.pressed.value || "weight";
  field("specimen-temperature").placeholder = head.temperature || "not given";
  automatic = { arms: head.arms, law: head.law, time_limits: head.time_limits, end: head.end };
  const [first, last] = head.clock;
  placeHandles(head.time_limits, { first, last, step: head.step }, !old);
  $("right").classList.remove("moving");
  fit();
}

/** Show what every answer has: checks, command, simulated data. */
function showChecks(/** @type {any} */ head) {
  $("checks").innerHTML = head.checks;
  $("command").textContent = head.command;
  $("simulated").hidden = !head.simulated;
  $("tells-more").innerHTML = head.more || "";
}

/**
 * Fit the column to its height: fold the choices, then hide the notes, then the remedies, then the
 * last failed checks. One button shows them in place of the numbers.
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

/** Show all checks in place of the numbers, or the numbers again. */
export function moreChecks() {
  if ($("right").classList.contains("checking")) return fit();
  $("right").classList.add("checking");
  for (const row of all("#checks li")) row.hidden = false;
  $("more-checks").textContent = "numbers";
  $("more-checks").setAttribute("aria-expanded", "true");
}

/** Send a request that takes seconds: it can be cancelled and shows its progress. */
function slowly(
  /** @type {string} */ verb,
  /** @type {any} */ request,
  /** @type {(head: any) => unknown} */ done,
  without = () => {},
) {
  const since = performance.now();
  countWorking(1);
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
    countWorking(-1);
  };
  askQueued("slow", verb, request, ({ head }) => {
    end();
    if (done(head) !== false) status(`done in ${seconds(since)}`);
  }, (message) => {
    end();
    without();
    showFailure(message);
    status(message === cancelled ? "cancelled" : "stopped");
  }, end);
}

/** The two models that are compared; the first ones by default. */
function ab() {
  const every = solids().map(([name]) => name), now = test()?.id;
  const defaults = [
    `fit ${now}`,
    every.find((name) => name !== `fit ${now}`) || `fit ${now}`,
  ];
  const [a, b] = [state.ab.a, state.ab.b].map((name, i) =>
    every.includes(name) ? name : defaults[i]
  );
  return { a, b };
}

/** What is compared: two models, or all tests. */
const against = () => state.against === "all" ? overlaid() : ab();

/** Jobs of all tests, each by itself, with the options of the page. */
function overlaid() {
  return state.files.filter(isTest).map((openFile) => jobOf(`fit ${openFile.id}`)).map((
    testJob,
  ) => ({
    ...testJob,
    impact: [],
    reading_impact: {},
    time_limits: {},
  }));
}

/** Request all tests in one figure. */
function overlay() {
  const now = question();
  askQuestion(now, "All tests are fitted, each by itself.");
  slowly("overlay", { jobs: overlaid(), sizes: sizes() }, (head) => {
    for (const [name, html] of Object.entries(head.panels)) panel(name, html);
    setHtml("seals-table", head.table);
    $("simulated").hidden = !head.simulated;
    $("command").textContent = head.command;
    takeAnswer(now, head, true);
    return true;
  });
}

/** Request the comparison of two fits. */
function compare() {
  if (state.against === "all") return overlay();
  const { a, b } = ab(), now = question();
  askQuestion(now, "Both fits are compared.");
  for (const [side, name] of [["a", a], ["b", b]]) {
    const all = solids().map(([name, words]) => createElement("option", { value: name }, words));
    $(`ab-${side}`).replaceChildren(...all);
    field(`ab-${side}`).value = name;
  }
  const request = { a: { job: jobOf(a) }, b: { job: jobOf(b) }, sizes: sizes() };
  slowly("against", request, (head) => {
    for (const [name, html] of Object.entries(head.panels)) panel(name, html);
    $("ab-table").innerHTML = head.table;
    $("simulated").hidden = !head.simulated;
    $("command").textContent = "";
    takeAnswer(now, head, true);
    return true;
  });
}

/** Request limits, comparison with the hammer test, and the combined fit. */
export function study(again = false) {
  if (!test()) return;
  if (state.against) return compare();
  const now = question();
  askQuestion(
    now,
    `${describeLastChoice()}${
      hammers().length ? "The hammer is compared." : "Its limits are computed."
    }`,
  );
  const request = { job: job(), sizes: sizes(), base: state.base, phase: state.phase };
  slowly("study", { ...request, limits: limits() }, (head) => {
    showStudy(head);
    showLimits(head.limits);
    takeAnswer(now, head, !head.hint);
    if (head.hint) endQuestion(head.hint, { words: "Give the mass", act: "mass" });
    if (again || !tooTall()) return true;
    study(true);
    return false;
  });
}

/** Request for the shown file, if it is fitted by itself; null otherwise. */
export function bench() {
  const request = makeBenchRequest();
  return request && { ...request, request: { ...request.request, limits: limits() } };
}

function makeBenchRequest() {
  const openFile = shown();
  if (!openFile || !isBench(openFile)) return null;
  const { id: file, options, temperature } = openFile, { arms, mass, seals } = state.job;
  // in one column it is none itself
  const width = $("main").clientWidth || document.body.clientWidth;
  const pageSize = { bench: [width - 16, 0] };
  if (isStandalone(openFile)) {
    return { verb: "standalone", request: { ...makeKindRequest(openFile), sizes: pageSize } };
  }
  if (isHammerOnly(openFile)) {
    const files = selectSpecimen(state.files.filter(isHits)).map((each) => each.id);
    const { band } = state.frfs;
    const request = { files, options, hammer: state.job.hammer, band };
    return { verb: "hammer", request: { ...request, sizes: sizes() } };
  }
  if (isModes(openFile)) {
    const every = selectSpecimen(state.files.filter(isModes)), { of, band } = state.frfs;
    const files = every.map((each) => each.id);
    const by = of === "masses" ? { masses: every.map((each) => each.mass || ""), seals } : {};
    return {
      verb: "modes",
      request: { files, ...by, options: openFile.options, band, sizes: pageSize },
    };
  }
  if (!isLevel(openFile)) {
    return { verb: "bench", request: { file, options, temperature, arms, sizes: pageSize } };
  }
  const { at, law } = state.levels;
  if (!isResponse(openFile)) {
    return { verb: "level", request: { files: [file], options, law, sizes: pageSize } };
  }
  const all = selectSpecimen(state.files.filter((each) => isResponse(each) && each.level));
  const files = all.map((each) => each.id), levels = all.map((each) => each.level);
  const wanted = at.split(/[\s;]+/).filter(Boolean).map((force) => `${force.replace(",", ".")}N`);
  const request = {
    files,
    levels,
    options: all[0].options,
    mass,
    seals,
    at: wanted,
    sizes: pageSize,
  };
  return { verb: "level", request };
}

/** Request for a kind that is fitted by itself, and its files. */
function makeKindRequest(/** @type {import("./job.js").OpenFile} */ openFile) {
  const of = openFile.page === "part" ? door() || openFile : openFile, kind = kindOf(of);
  const { options } = of, form_values = state.formValues[kind] || {};
  if (kind === "door") {
    const others = state.files.filter((each) => each !== of).map((each) => each.id);
    return { kind, files: [of.id, ...others], form_values, options: {}, test: test()?.id || "" };
  }
  return { kind, files: getFilesOfKind(of).map((each) => each.id), form_values, options };
}

let shownBench = "";

function fitBench(/** @type {{verb: string, request: any}} */ { verb, request }) {
  const now = question();
  // the page may show another file
  if (shownBench !== state.current) clearPage();
  shownBench = state.current;
  slowly(verb, request, (head) => {
    takeAnswer(now, head, true);
    $("solid").innerHTML = head.solid;
    solid(head.solid, state.joint, head.arms);
    $("answers").innerHTML = head.answers || "";
    $("both-fits").hidden = true;
    showChecks(head);
    showLimits(head.limits);
    fit();
    if (verb === "hammer") return showHammerOnly(head);
    strips($("bench-page"), head.figures, verb, head.facts);
    return true;
  }, clearPage);
}

/** Frequencies of the poles in the stabilisation chart, Hz. */
export let poles = /** @type {number[]} */ ([]);

function showHammerOnly(/** @type {any} */ head) {
  for (const [name, html] of Object.entries(head.hit_panels)) panel(name, html);
  setHtml("hit-table", head.hits);
  poles = head.poles.map((/** @type {number[]} */ pole) => pole[0]);
  return true;
}

function showStudy(/** @type {any} */ head) {
  shownStudy = test()?.id || "";
  $("grid").classList.remove("old");
  for (
    const [name, html] of Object.entries({ frf: head.frf, ...head.hit_panels, ...head.panels })
  ) {
    panel(name, html);
  }
  if (state.joint) $("both-fits").hidden = true; // it is of the relaxation test alone
  setHtml("hit-table", head.hits);
  for (const openFile of hammers()) openFile.line = head.hammer || openFile.line;
  fileList();
  $("answers").innerHTML = head.answers;
  solid(head.solid, state.joint, head.arms);
  showChecks(head);
  fit();
  placeHandles(head.time_limits, null, true);
}

/** Request the response while the mass is changed. */
export function predict() {
  if (!test() || !state.job.mass) return;
  const now = question();
  askQuestion(now, LATER, "While the mass moves");
  status("following");
  askQueued(
    "mass",
    "predict",
    { job: job(), base: state.base, phase: state.phase },
    ({ head, arrays }) => {
      curves(arrays);
      showProgress(`Peak at ${head.peak}. ${LATER}`);
      $("command").textContent = head.command;
      performance.mark("dashpot-mass");
    },
    showFailure,
  );
}
