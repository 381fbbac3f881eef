// The verdict: of what is asked now and of all open files, and never calmer than what is known.
import { $, all, icon, made, panelCard, tell } from "./dom.js";
import { door, isBench, questionOf, shown, state, test } from "./job.js";

/** @typedef {{verdict: string, colour: string}} Judged As the server draws it */
/** @typedef {{words: string, act?: string, remove?: string}} Cure The one control that mends it */
/** @typedef {{name: string, mark: string, message: string}} Light */
/** @typedef {{word: string, message: string, colour: "open" | "bad", cure?: Cure, alert?: boolean, lights?: Light[]}} Said */

const OPEN = "Not judged yet";
/** What is asked now; why there is no verdict of it, and whether anything is at work on one. */
let asked = "", why = "", working = false;
/** What an answer that waits is called meanwhile, and what is left of the force while it moves. */
let called = OPEN, left = "";
const GONE = /server is gone/;
const JUDGE = { words: "Judge it", act: "again" };
/** What heals where nothing is at work. @type {Cure} */
let next = JUDGE;
/** Of every question that was answered, how it was judged: an icon for each tab. */
const colours = new Map();
/** What was answered last, of which question, and whether that was all of it. */
const known = {
  of: "",
  whole: false,
  at: "before",
  head: /** @type {Judged | null} */ (null),
  word: "",
};
let typing = false;

/** @type {Record<string, {said: string, cure: Cure} | undefined>} */
const refused = {};

/** Ask something: until its answer is there nothing is judged. */
export function asks(
  /** @type {string} */ question,
  /** @type {string} */ because,
  word = OPEN,
) {
  // what moves says so until it is heard how far
  if (word === OPEN || word !== called) why = because;
  [asked, working, called] = [question, true, word];
  if (word === OPEN) left = "";
  render();
}

/** Say how far what is asked has moved, and what is left of the force: unless it was let go. */
export function moves(/** @type {string} */ message, rest = "") {
  if (called === OPEN) return;
  [why, left] = [message, rest];
  render();
}

/** Take an answer, or, if not `whole`, what is known before it. */
export function knows(
  /** @type {string} */ question,
  /** @type {Judged} */ head,
  /** @type {boolean} */ whole,
) {
  const at = new Date().toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
  Object.assign(known, { of: question, head, whole, at });
  // what is known before the rest is no answer that one could go back to
  if (whole) known.word = wordOf(head);
  if (whole) colours.set(question, head.colour);
  if (whole && question === asked) working = false;
  heals(question);
  render();
}

/** An answer takes back what was refused, unless something else was asked since. */
export function heals(/** @type {string} */ question) {
  if (question === asked && refused.fit) refuse("");
}

/** Say that there will be no answer, and why. */
export function stops(/** @type {string} */ because, /** @type {Cure} */ cure = JUDGE) {
  [why, working, next, called] = [because, false, cure, OPEN];
  render();
}

/** Whether a part of what is asked is known: its fit, before the rest. */
export const stands = () => known.of === asked && !known.whole;

let away = false;

/** Another page holds the session. */
export function shut(/** @type {boolean} */ yes) {
  away = yes;
  render();
}

/** What is typed counts once the field is left. */
export function types(/** @type {boolean} */ yes) {
  typing = yes;
  render();
}

/** Say a refusal; a fit that succeeds takes back that of a fit, not that of a file. */
export function refuse(
  /** @type {string} */ said,
  of = "fit",
  /** @type {Cure} */ cure = of === "fit" ? mends(said) : { words: "Close", act: "dismiss" },
) {
  refused[of] = said ? { said, cure } : undefined;
  if (said && of === "fit") working = false;
  render();
  const busy = document.activeElement?.closest(".handle, [data-typed]");
  if (said && of === "fit" && !busy) document.getElementById("cure")?.focus();
}

/** Whether a file is shown that is judged by itself: a deck would be of another solid. */
const alone = () => {
  const one = shown();
  return !!one && isBench(one);
};

/** Whether what is shown may be taken away: not while it is about to change. */
export const settled = () =>
  !!test() && !alone() && !working && !typing && !refused.fit && !away && !state.against &&
  !state.files.some((one) => one.watch) && !shown()?.asked && shown()?.mark !== "bad";

/** The control that mends a refused fit: what was refused, or else what was changed last. */
function mends(/** @type {string} */ said) {
  const { time_limits, hammer } = state.job;
  if (GONE.test(said)) return { words: "Try again", act: "again" };
  if (hammer.reject.length && /no hit is left/.test(said)) {
    return { words: "Accept all that pass", act: "all-hits" };
  }
  if (Object.keys(time_limits).length) return { words: "Time limits as found", act: "reset" };
  return { words: "Take back the last change", act: "undo" };
}

/**
 * Files that could be part of what is judged and are not: asked about, or not read yet. What was
 * refused is part of nothing; what asks goes with no file that is judged by itself.
 */
const leftOut = () =>
  state.files.filter((one) => {
    if (one.mark === "bad") return false;
    if (one.page === "part") return !door();
    return !one.mark || (!alone() && (!!one.asked || one.mark !== "good"));
  });

/** Why an open file that is another one on disk now has no verdict, and what mends it. */
function unwatched(/** @type {import("./job.js").OpenFile} */ one) {
  /** @type {Record<string, [string, Cure?]>} */
  const told = {
    writing: [`${one.name} is being written. It is read again once it rests.`],
    changed: [`${one.name} changed on disk. It is read again.`],
    gone: [
      `${one.name} is no longer where it was opened. These numbers are of what it held.`,
      { words: `Remove ${one.name}`, remove: one.id },
    ],
    stale: [
      `${one.name} changed on disk since it was opened, and a browser may not read it again by itself. Open it again.`,
      { words: "Open it again", act: "open" },
    ],
  };
  return told[one.watch || ""];
}

/** A file that is being read. */
const reading = () => state.files.find((one) => !one.mark);

function last() {
  if (called !== OPEN) return "";
  return known.word ? ` The last answer was: ${known.word.toLowerCase()}.` : "";
}

/** The word of an answer. */
function wordOf(/** @type {Judged} */ head) {
  const holder = made("div");
  holder.innerHTML = head.verdict;
  return holder.querySelector(".word")?.textContent || "";
}

/** What is to be said in place of the answer; nothing where that is whole, and of all files. */
function instead() {
  /** @type {(message: string, cure?: Cure) => Said} */
  const open = (message, cure) => ({
    word: called,
    message,
    colour: "open",
    cure,
    lights: lights(),
  });
  const { fit, file } = refused, out = leftOut();
  if (away) {
    const message = "This session is open in another tab, so this one is read only.";
    const cure = { words: "Take over", act: "take-over" };
    return { ...open(message, cure), word: "Open elsewhere", lights: [] };
  }
  if (fit && GONE.test(fit.said)) {
    const message =
      `The program that computes has ended. These numbers are of ${known.at}, and may ` +
      "not be what the files say now. Start it again, and go on with the last session.";
    return said("Connection lost", { ...fit, said: message });
  }
  if (fit?.cure.act === "all-hits") {
    const hits = state.job.hammer.reject.length;
    const message =
      `All ${hits} hits are rejected, so no response is measured. Accept three or more.`;
    return said("Do not use: no hit is left", { ...fit, said: message });
  }
  if (fit) return said("Do not use", fit);
  // of what is judged nothing depends on a file that was refused: it says so above
  if (file && !asked) return said("Not read", file);
  if (!asked && reading()) {
    const message = `${reading()?.name}: its columns, and what they hold. Esc ends it.`;
    return { ...open(message), word: "Reading" };
  }
  const off = state.files.find((one) => one.watch);
  if (off) return open(...unwatched(off));
  if (typing) return open("What is typed counts once you press Enter or leave the field.");
  if (known.of === asked && known.head?.colour === "bad") return null;
  if (known.of !== asked || !known.whole) {
    return open(why + last(), working ? undefined : next);
  }
  if (!out.length) return null;
  const [one] = out, read = one.mark;
  return open(
    read
      ? `${one.name} is open and not part of it: answer what it asks, or remove it.${last()}`
      : `${one.name} is being read.`,
    read ? { words: `Remove ${one.name}`, remove: one.id } : undefined,
  );
}

/** @returns {Said} */
const said = (/** @type {string} */ word, /** @type {{said: string, cure: Cure}} */ of) => ({
  word,
  // a word begins with a capital, the name of a file as it is
  message: of.said.replace(/^\p{Ll}(?=\p{L}*[ ,])/u, (first) => first.toUpperCase()),
  colour: "bad",
  cure: of.cure,
  alert: true,
});

/** @type {(of: Said) => Node[]} */
function drawn({ word, message, colour, cure, alert, lights = [] }) {
  const line = made("div", { class: "message" }),
    text = made("p", alert ? { role: "alert" } : {}, message);
  line.append(icon(colour, "icon big"), made("strong", { class: "word" }, word));
  const parts = [made("div", { class: "said" }, line, text)];
  // where nothing is known what mends it stands there alone
  if (!cure || lights.some(({ mark }) => mark !== "open")) parts.push(lamps(lights));
  if (!cure) return parts;
  const [name, does] = cure.remove ? ["data-remove", cure.remove] : ["data-act", cure.act || ""];
  parts.push(made("button", { id: "cure", class: "main", [name]: does }, cure.words));
  return parts;
}

/** Three lights, none calmer than what is known: of what stands its own, else none is lit. */
function lights() {
  const own = known.head && stands() && !working ? made("div") : null;
  if (own) own.innerHTML = known.head?.verdict || "";
  const lit = all(".lights dd", own || made("div"));
  return (test() ? ["Test", "Stiffness", "Damping"] : []).map((name, i) => {
    const mark = lit[i]?.querySelector("use")?.getAttribute("href")?.slice(3);
    const message = lit[i]?.textContent || (i ? "" : left) || "not checked";
    return { name, mark: mark || "open", message };
  });
}

/** @type {(of: Light[]) => HTMLElement} */
function lamps(of) {
  const list = made("dl", { class: "lights" });
  for (const { name, mark, message } of of) {
    list.append(made("dt", {}, name), made("dd", {}, icon(mark), message));
  }
  return list;
}

/** What stands on the head of each fold of a narrow page: its marks are no calmer than the verdict. */
function folds() {
  tell($("fold-checks"), document.querySelector("#checks .tally")?.textContent || "");
  tell($("fold-arms"), $("choice-line").textContent?.split(" \u00b7 ")[0] || "");
  tell($("file-count"), String(state.files.length || ""));
}

let shows = "";

/** Let the verdict stand there as it is now. */
export function render() {
  const home = $("verdict"), bar = $("refusal"), refusal = refused.fit || refused.file;
  // where no verdict has a place there is no panel that a line would push
  const apart = !!refused.file && !!asked && !refused.fit;
  const told = refusal && (home.hidden || document.body.classList.contains("empty") || apart)
    ? refusal.said
    : "";
  bar.textContent = told;
  if (told && apart && refusal?.cure.remove) {
    const { words, remove } = refusal.cure;
    const has = { class: "link", "data-remove": remove, "aria-label": words };
    bar.append(made("button", has, "Remove it"));
  } else if (told && apart) {
    bar.append(made("button", { class: "link", "data-act": "dismiss" }, "Close"));
  }
  // a refused file has its own page; an answer that was refused has this line alone
  bar.hidden = !told || (document.body.classList.contains("aside") && shown()?.mark === "bad");
  const other = asked || refusal || away || reading() ? instead() : null;
  const head = asked && !other ? known.head : null;
  for (const one of all('[data-needs="test"]')) one.toggleAttribute("disabled", !settled());
  panelCard("frf")?.classList.toggle("stale", !!other);
  folds();
  document.body.classList.toggle("unsettled", !!other);
  document.body.classList.toggle("standing", !!other && !working && stands());
  document.body.classList.toggle("refused", !!refused.fit);
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
  if (other) home.replaceChildren(...drawn(other));
  else home.innerHTML = head?.verdict || "";
}
