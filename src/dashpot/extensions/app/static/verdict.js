// The verdict on the current request and all open files; never better than what is known.
import { $, all, createElement, icon, panelCard, setText } from "./dom.js";
import { door, isBench, questionOf, shown, state, test } from "./job.js";

/** @typedef {{verdict: string, colour: string}} Answer As the server draws it */
/** @typedef {{words: string, act?: string, remove?: string}} Cure The one control that mends it */
/** @typedef {{name: string, mark: string, message: string}} Light */
/** @typedef {{word: string, message: string, colour: "open" | "bad", cure?: Cure, alert?: boolean, lights?: Light[]}} VerdictText */

const OPEN = "Not judged yet";
/** Current request; why it has no verdict, and whether one is being computed. */
let currentQuestion = "", why = "", working = false;
/** Headline while an answer is pending, and the residual of the force while a handle is dragged. */
let called = OPEN, residual = "";
const GONE = /server is gone/;
const JUDGE = { words: "Judge it", act: "again" };
/** Button shown while nothing is being computed. @type {Cure} */
let next = JUDGE;
/** Colour of the verdict of each answered request: an icon for each tab. */
const colours = new Map();
/** Last answer, its request, and whether it was complete. */
const answer = {
  of: "",
  whole: false,
  at: "before",
  head: /** @type {Answer | null} */ (null),
  word: "",
};
let typing = false;

/** @type {Record<string, {message: string, cure: Cure} | undefined>} */
const refusals = {};

/** Set the current request: until its answer arrives there is no verdict. */
export function askQuestion(
  /** @type {string} */ question,
  /** @type {string} */ because,
  word = OPEN,
) {
  // what moves says so until it is heard how far
  if (word === OPEN || word !== called) why = because;
  [currentQuestion, working, called] = [question, true, word];
  if (word === OPEN) residual = "";
  render();
}

/** Show a message and the residual while a handle is dragged; nothing once it is released. */
export function showProgress(/** @type {string} */ message, rest = "") {
  if (called === OPEN) return;
  [why, residual] = [message, rest];
  render();
}

/** Store an answer; if not `whole`, a part of it that arrives first. */
export function takeAnswer(
  /** @type {string} */ question,
  /** @type {Answer} */ head,
  /** @type {boolean} */ whole,
) {
  const at = new Date().toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
  Object.assign(answer, { of: question, head, whole, at });
  // what is known before the rest is no answer that one could go back to
  if (whole) answer.word = wordOf(head);
  if (whole) colours.set(question, head.colour);
  if (whole && question === currentQuestion) working = false;
  clearRefusal(question);
  render();
}

/** Clear a refusal, unless another request followed. */
export function clearRefusal(/** @type {string} */ question) {
  if (question === currentQuestion && refusals.fit) refuse("");
}

/** End the current request without an answer, with a reason. */
export function endQuestion(/** @type {string} */ because, /** @type {Cure} */ cure = JUDGE) {
  [why, working, next, called] = [because, false, cure, OPEN];
  render();
}

/** Whether a part of the answer is there: the fit, before the rest. */
export const hasPartialAnswer = () => answer.of === currentQuestion && !answer.whole;

let isElsewhere = false;

/** Set whether another page holds the session. */
export function setElsewhere(/** @type {boolean} */ yes) {
  isElsewhere = yes;
  render();
}

/** Set whether the user types into a field: it counts once the field is left. */
export function setTyping(/** @type {boolean} */ yes) {
  typing = yes;
  render();
}

/** Show a refusal; a fit that succeeds clears that of a fit, not that of a file. */
export function refuse(
  /** @type {string} */ message,
  of = "fit",
  /** @type {Cure} */ cure = of === "fit" ? findCure(message) : { words: "Close", act: "dismiss" },
) {
  refusals[of] = message ? { message, cure } : undefined;
  if (message && of === "fit") working = false;
  render();
  const busy = document.activeElement?.closest(".handle, [data-typed]");
  if (message && of === "fit" && !busy) document.getElementById("cure")?.focus();
}

/** Whether the shown file is fitted by itself: a solver input would be of another model. */
const isFittedAlone = () => {
  const openFile = shown();
  return !!openFile && isBench(openFile);
};

/** Whether what is shown may be exported: not while it is about to change. */
export const settled = () =>
  !!test() && !isFittedAlone() && !working && !typing && !refusals.fit && !isElsewhere &&
  !state.against &&
  !state.files.some((openFile) => openFile.watch) && !shown()?.question &&
  shown()?.mark !== "bad";

/** Button that undoes the cause of a refused fit, or else the last change. */
function findCure(/** @type {string} */ message) {
  const { time_limits, hammer } = state.job;
  if (GONE.test(message)) return { words: "Try again", act: "again" };
  if (hammer.reject.length && /no hit is left/.test(message)) {
    return { words: "Accept all that pass", act: "all-hits" };
  }
  if (Object.keys(time_limits).length) return { words: "Time limits as found", act: "reset" };
  return { words: "Take back the last change", act: "undo" };
}

/**
 * Open files that the verdict does not cover yet: not read, or with an open question. Refused files
 * never count, and a question does not concern a file that is fitted by itself.
 */
const getUnusedFiles = () =>
  state.files.filter((openFile) => {
    if (openFile.mark === "bad") return false;
    if (openFile.page === "part") return !door();
    return !openFile.mark ||
      (!isFittedAlone() && (!!openFile.question || openFile.mark !== "good"));
  });

/** Message and button for an open file that changed on disk. */
function describeFileChange(/** @type {import("./job.js").OpenFile} */ openFile) {
  /** @type {Record<string, [string, Cure?]>} */
  const texts = {
    writing: [`${openFile.name} is being written. It is read again once it rests.`],
    changed: [`${openFile.name} changed on disk. It is read again.`],
    gone: [
      `${openFile.name} is no longer where it was opened. These numbers are of what it held.`,
      { words: `Remove ${openFile.name}`, remove: openFile.id },
    ],
    stale: [
      `${openFile.name} changed on disk since it was opened, and a browser may not read it again by itself. Open it again.`,
      { words: "Open it again", act: "open" },
    ],
  };
  return texts[openFile.watch || ""];
}

/** A file that is being read. */
const reading = () => state.files.find((openFile) => !openFile.mark);

function last() {
  if (called !== OPEN) return "";
  return answer.word ? ` The last answer was: ${answer.word.toLowerCase()}.` : "";
}

/** The word of an answer. */
function wordOf(/** @type {Answer} */ head) {
  const holder = createElement("div");
  holder.innerHTML = head.verdict;
  return holder.querySelector(".word")?.textContent || "";
}

/** Text in place of the answer; null where the answer is complete and covers all files. */
function makeSubstitute() {
  /** @type {(message: string, cure?: Cure) => VerdictText} */
  const open = (message, cure) => ({
    word: called,
    message,
    colour: "open",
    cure,
    lights: lights(),
  });
  const { fit, file } = refusals, out = getUnusedFiles();
  if (isElsewhere) {
    const message = "This session is open in another tab, so this one is read only.";
    const cure = { words: "Take over", act: "take-over" };
    return { ...open(message, cure), word: "Open elsewhere", lights: [] };
  }
  if (fit && GONE.test(fit.message)) {
    const message =
      `The program that computes has ended. These numbers are of ${answer.at}, and may ` +
      "not be what the files say now. Start it again, and go on with the last session.";
    return makeRefusal("Connection lost", { ...fit, message });
  }
  if (fit?.cure.act === "all-hits") {
    const hits = state.job.hammer.reject.length;
    const message =
      `All ${hits} hits are rejected, so no response is measured. Accept three or more.`;
    return makeRefusal("Do not use: no hit is left", { ...fit, message });
  }
  if (fit) return makeRefusal("Do not use", fit);
  // the verdict does not depend on a refused file: the line above says so
  if (file && !currentQuestion) return makeRefusal("Not read", file);
  if (!currentQuestion && reading()) {
    const message = `${reading()?.name}: its columns, and what they hold. Esc ends it.`;
    return { ...open(message), word: "Reading" };
  }
  const off = state.files.find((openFile) => openFile.watch);
  if (off) return open(...describeFileChange(off));
  if (typing) return open("What is typed counts once you press Enter or leave the field.");
  if (answer.of === currentQuestion && answer.head?.colour === "bad") return null;
  if (answer.of !== currentQuestion || !answer.whole) {
    return open(why + last(), working ? undefined : next);
  }
  if (!out.length) return null;
  const [openFile] = out, read = openFile.mark;
  return open(
    read
      ? `${openFile.name} is open and not part of it: answer what it asks, or remove it.${last()}`
      : `${openFile.name} is being read.`,
    read ? { words: `Remove ${openFile.name}`, remove: openFile.id } : undefined,
  );
}

/** @returns {VerdictText} */
const makeRefusal = (
  /** @type {string} */ word,
  /** @type {{message: string, cure: Cure}} */ of,
) => ({
  word,
  // a word begins with a capital, the name of a file as it is
  message: of.message.replace(/^\p{Ll}(?=\p{L}*[ ,])/u, (first) => first.toUpperCase()),
  colour: "bad",
  cure: of.cure,
  alert: true,
});

/** @type {(of: VerdictText) => Node[]} */
function renderVerdict({ word, message, colour, cure, alert, lights = [] }) {
  const line = createElement("div", { class: "message" }),
    text = createElement("p", alert ? { role: "alert" } : {}, message);
  line.append(icon(colour, "icon big"), createElement("strong", { class: "word" }, word));
  const parts = [createElement("div", { class: "verdict-text" }, line, text)];
  // without any result the button stands without lights
  if (!cure || lights.some(({ mark }) => mark !== "open")) parts.push(renderLights(lights));
  if (!cure) return parts;
  const [name, does] = cure.remove ? ["data-remove", cure.remove] : ["data-act", cure.act || ""];
  parts.push(createElement("button", { id: "cure", class: "main", [name]: does }, cure.words));
  return parts;
}

/** Lights for test, stiffness and damping: of a partial answer, else not lit. */
function lights() {
  const box = answer.head && hasPartialAnswer() && !working ? createElement("div") : null;
  if (box) box.innerHTML = answer.head?.verdict || "";
  const lit = all(".lights dd", box || createElement("div"));
  return (test() ? ["Test", "Stiffness", "Damping"] : []).map((name, i) => {
    const mark = lit[i]?.querySelector("use")?.getAttribute("href")?.slice(3);
    const message = lit[i]?.textContent || (i ? "" : residual) || "not checked";
    return { name, mark: mark || "open", message };
  });
}

/** @type {(of: Light[]) => HTMLElement} */
function renderLights(of) {
  const list = createElement("dl", { class: "lights" });
  for (const { name, mark, message } of of) {
    list.append(createElement("dt", {}, name), createElement("dd", {}, icon(mark), message));
  }
  return list;
}

/** Update the headings of the folded sections on a narrow page. */
function updateFolds() {
  setText($("fold-checks"), document.querySelector("#checks .tally")?.textContent || "");
  setText($("fold-arms"), $("choice-line").textContent?.split(" \u00b7 ")[0] || "");
  setText($("file-count"), String(state.files.length || ""));
}

let shows = "";

/** Render the verdict. */
export function render() {
  const home = $("verdict"), bar = $("refusal"), refusal = refusals.fit || refusals.file;
  // without a verdict no panel would be moved by a line
  const hasOwnLine = !!refusals.file && !!currentQuestion && !refusals.fit;
  const text = refusal && (home.hidden || document.body.classList.contains("empty") || hasOwnLine)
    ? refusal.message
    : "";
  bar.textContent = text;
  if (text && hasOwnLine && refusal?.cure.remove) {
    const { words, remove } = refusal.cure;
    const has = { class: "link", "data-remove": remove, "aria-label": words };
    bar.append(createElement("button", has, "Remove it"));
  } else if (text && hasOwnLine) {
    bar.append(createElement("button", { class: "link", "data-act": "dismiss" }, "Close"));
  }
  // a refused file has its own page; an answer that was refused has this line alone
  bar.hidden = !text || (document.body.classList.contains("aside") && shown()?.mark === "bad");
  const other = currentQuestion || refusal || isElsewhere || reading() ? makeSubstitute() : null;
  const head = currentQuestion && !other ? answer.head : null;
  for (const button of all('[data-needs="test"]')) {
    button.toggleAttribute("disabled", !settled());
  }
  panelCard("frf")?.classList.toggle("stale", !!other);
  updateFolds();
  document.body.classList.toggle("unsettled", !!other);
  document.body.classList.toggle("standing", !!other && !working && hasPartialAnswer());
  document.body.classList.toggle("refused", !!refusals.fit);
  $("top").className = `top ${other?.colour || head?.colour || "open"}`;
  for (const tab of test() ? all("[data-which]") : []) {
    if (!["fit", "joint"].includes(tab.dataset.which || "")) continue;
    const joint = tab.dataset.which === "joint";
    const now = state.against ? colours.get(questionOf(joint)) : other?.colour || head?.colour;
    const colour = joint === state.joint ? now : colours.get(questionOf(joint));
    tab.querySelector("use")?.setAttribute("href", `#i-${colour || "open"}`);
  }
  const drawing = JSON.stringify([other, head?.verdict]);
  if (drawing === shows) return;
  shows = drawing;
  // what moves is not read out at every step
  home.setAttribute("aria-live", called === OPEN ? "polite" : "off");
  home.className = `verdict ${other?.colour || head?.colour || ""}`;
  if (other) home.replaceChildren(...renderVerdict(other));
  else home.innerHTML = head?.verdict || "";
}
