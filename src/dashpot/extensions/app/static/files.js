// Files in and out: open, ask about their columns, show, export.
import { $, all, countWorking, createElement, field, status, words } from "./dom.js";
import {
  hammers,
  isAccessory,
  isBench,
  isHammer,
  isHammerOnly,
  isModes,
  isTest,
  job,
  limits,
  LOT,
  shown,
  state,
  test,
} from "./job.js";
import { bench, settle, study } from "./questions.js";
import { fileList, views } from "./shown.js";
import { refuse, settled } from "./verdict.js";
import { askQueued, call, cancelled, fetchFileStates, send } from "./wire.js";

/** @typedef {import("./job.js").OpenFile} OpenFile */

const LINGER = 10_000;
/** Digits of the identity of a file; the rest is the specimen that is read. */
const DIGITS = 16;
/** Time after which reading can be cancelled, ms. */
const PATIENCE = 300;

async function inspect(/** @type {OpenFile} */ openFile) {
  const { head } = await send("inspect", { file: openFile.id, options: openFile.options });
  const specimens = head.specimens?.length ? head.specimens : openFile.specimens || [];
  Object.assign(openFile, head, { question: head.question || "", specimens });
  if (isTest(openFile) || isHammer(openFile) || (isBench(openFile) && openFile.page !== "part")) {
    openFile.question = "";
  }
}

/** Set hash and time of the contents of a file. */
async function readStamp(/** @type {OpenFile} */ openFile) {
  const at = (await fetchFileStates([openFile.id]).catch(() => ({})))[openFile.id];
  if (at) Object.assign(openFile, { hash: at.sha256, when: at.when });
}

/** Read a file; return the refusal, which is also shown at its name. */
export async function read(/** @type {OpenFile} */ openFile) {
  const stamped = readStamp(openFile);
  try {
    await inspect(openFile);
    return "";
  } catch (error) {
    const message = words(error);
    const why = message.startsWith(`${openFile.name}: `)
      ? message.slice(openFile.name.length + 2)
      : message;
    Object.assign(openFile, {
      mark: "bad",
      page: "",
      question: "",
      line: message === cancelled ? "not read" : why,
    });
    return message;
  } finally {
    await stamped;
  }
}

/** Files chosen in the browser, by identity: the browser knows whether each changed. */
/** @type {Map<string, File>} */
export const picked = new Map();

/** Give a file another identity; its options stay. */
function rename(/** @type {OpenFile} */ openFile, /** @type {string} */ id) {
  const was = openFile.id;
  Object.assign(openFile, { id, mark: "", line: "", hash: "", watch: "" });
  if (state.current === was) state.current = id;
  for (const side of /** @type {("a" | "b")[]} */ (["a", "b"])) {
    state.ab[side] = state.ab[side].replace(was, id);
  }
}

/** Read a changed file again, with the same name and options. */
export async function readAgain(
  /** @type {OpenFile} */ openFile,
  /** @type {{id: string, name: string}} */ newFile,
) {
  const was = openFile.id, at = new Date().toLocaleTimeString();
  status(`${openFile.name} changed, it is read again`);
  const [file, part] = [was.slice(0, DIGITS), was.slice(DIGITS)];
  rename(openFile, newFile.id + part);
  for (const other of openFile.specimens || []) other.id = other.id.replace(file, newFile.id);
  picked.delete(was);
  fileList();
  await read(openFile);
  openFile.again = at;
  fileList();
  status(`${openFile.name} changed, read again at ${at}`);
}

/** Read files of the server, and show the first with a question. */
export async function openFiles(
  /** @type {{id: string, name: string}[]} */ files,
  /** @type {(id: string) => Partial<OpenFile>} */ getDefaults = () => ({}),
) {
  const openIds = new Set(state.files.map((openFile) => openFile.id));
  /** @type {OpenFile[]} */
  const added = files.filter((openFile) => !openIds.has(openFile.id))
    .map((openFile) => ({ ...openFile, options: {}, ...getDefaults(openFile.id) }));
  state.files.push(...added);
  fileList();
  const at = state.current;
  let canCancel = false;
  const slow = setTimeout(() => {
    canCancel = true;
    countWorking(1);
  }, PATIENCE);
  for (const openFile of added) {
    status(`reading ${openFile.name}`);
    const message = await read(openFile);
    if (!message || message === cancelled) continue;
    const about = message.startsWith(openFile.name) ? message : `${openFile.name}: ${message}`;
    refuse(about, "file", { words: `Remove ${openFile.name}`, remove: openFile.id });
  }
  clearTimeout(slow);
  if (canCancel) countWorking(-1);
  const asking = added.find((openFile) => openFile.question);
  const first = added.find((openFile) => openFile.page === "test") || added.find(isHammerOnly) ||
    added.find((openFile) => isBench(openFile) && !(isModes(openFile) && test()));
  const record = [...added, ...state.files].find((openFile) => !isAccessory(openFile));
  const next = (asking || first || shown() || record || added[0] || state.files[0])?.id || "";
  // a file that the user chose meanwhile stays shown
  if (state.current === at || !shown()) state.current = next;
  fileList();
  settle();
}

/** Send files to the server, and read them. */
export async function uploadFiles(/** @type {Iterable<File>} */ list) {
  refuse("", "file");
  const sentFiles = [];
  for (const file of list) {
    status(`opening ${file.name}`);
    try {
      const query = new URLSearchParams({
        name: file.name,
        modified: String(file.lastModified),
      });
      const sent = await call("POST", `/api/files?${query}`, file);
      picked.set(sent.id, file);
      const old = state.files.filter((openFile) =>
        openFile.name === file.name && openFile.watch === "stale" &&
        !openFile.id.startsWith(sent.id)
      );
      for (const openFile of old) {
        await readAgain(openFile, sent);
        picked.set(openFile.id, file);
      }
      if (old.length) settle();
      else sentFiles.push(sent);
    } catch (error) {
      refuse(words(error), "file");
    }
  }
  await openFiles(sentFiles);
}

export async function example() {
  status("making the example");
  refuse("", "file");
  const example = await call("POST", "/api/example");
  state.job.mass = example.mass;
  state.job.seals = example.seals;
  await openFiles(example.files);
}

export function show(/** @type {string} */ id) {
  const before = test();
  // limits and machine files have no page
  if (state.files.some((openFile) => openFile.id === id && isAccessory(openFile)) && shown()) {
    return;
  }
  if (state.against === "all") state.against = "";
  state.current = id;
  fileList();
  views();
  // what was hidden had no width to be drawn at
  if (bench() || test() !== before || $("hits-page").hidden) settle();
  else study();
}

/** Show the file so many places further on. */
export function step(/** @type {number} */ by) {
  const { files, current } = state, n = files.length;
  const i = files.findIndex((openFile) => openFile.id === current);
  if (n) show(files[(i + by + n) % n].id);
}

export function remove(/** @type {string} */ id) {
  if (id === LOT) state.lot = "";
  refuse("", "file");
  refuse("");
  state.files = state.files.filter((openFile) => openFile.id !== id);
  state.current = (state.files.find((openFile) => !isAccessory(openFile)) || state.files[0])?.id ||
    (state.lot && LOT);
  if (!hammers().length) state.joint = false;
  state.job.time_limits = {};
  fileList();
  views();
  settle();
}

/** Set whether a record is a blank test of the machine. */
export async function setBlank(/** @type {string} */ id, /** @type {boolean} */ yes) {
  const openFile = state.files.find((file) => file.id === id);
  if (!openFile) return;
  const { kind: _, ...options } = openFile.options;
  openFile.options = yes ? { ...options, kind: "blank" } : options;
  refuse("", "file");
  await read(openFile);
  fileList();
  settle();
}

export function join(/** @type {string} */ id, /** @type {boolean} */ yes) {
  const openFile = state.files.find((file) => file.id === id), of = test();
  if (openFile) openFile.together = yes;
  if (yes && of) of.together = true;
  fileList();
  settle();
}

// -- columns of a file --------------------------------------------------------------------------------

function readAnswers() {
  const openFile = shown();
  if (!openFile) return null;
  // another specimen may have other columns: send only roles that differ from the recognised ones
  const changed = getChosenSpecimens(openFile).length > 0;
  /** @type {import("./job.js").Options} */
  const options = { ...openFile.options, units: { ...openFile.options.units } };
  // an earlier answer that is not chosen now is removed
  const roles = [...(document.querySelector("[data-role-of]")?.querySelectorAll("option") || [])]
    .map((role) => role.value).filter((role) => role);
  for (const role of roles) if (!changed) delete options[role];
  for (const select of all("[data-role-of]")) {
    const number = select.dataset.roleOf;
    const role = /** @type {HTMLSelectElement} */ (select).value;
    /** @type {HTMLSelectElement | null} */
    const unit = document.querySelector(`[data-unit-of="${number}"]`);
    if (!role) continue;
    if (unit?.value) options.units[role] = unit.value;
    if (changed && select.querySelector("option[selected]")?.textContent === role) continue;
    if (role === "acceleration") {
      options.acceleration = [...new Set([...(options.acceleration || []), number])];
    } else options[role] = number;
  }
  for (const role of roles) if (!changed && !options[role]) delete options.units[role];
  /** @type {HTMLInputElement | null} */
  const rate = document.querySelector("[data-rate]");
  if (rate) options.rate = rate.value.trim() ? Number(rate.value.replace(",", ".")) : null;
  if (Number.isNaN(options.rate)) {
    refuse(`'${rate?.value}' is no sampling rate; expected a number, for example 1000`, "file");
    return null;
  }
  return { openFile, options };
}

/** The specimens that are chosen where a file asks for one, or all that it has. */
function getChosenSpecimens(/** @type {OpenFile} */ openFile) {
  /** @type {HTMLSelectElement | null} */
  const select = document.querySelector("[data-specimen]");
  const every = openFile.specimens || [];
  return select?.value === "all" ? every : every.filter(({ id }) => id === select?.value);
}

/** Read specimens of a file, each as a file by itself, in its place. */
async function readSpecimens(
  /** @type {OpenFile} */ openFile,
  /** @type {import("./job.js").Specimen[]} */ specimens,
) {
  const file = picked.get(openFile.id),
    reset = { mark: "", line: "", hash: "", watch: "", question: "" };
  if (file) { for (const { id } of specimens) picked.set(id, file); }
  state.files = state.files.filter((each) => each !== openFile);
  state.current = specimens[0].id;
  await openFiles(specimens.map(({ id }) => ({ id, name: openFile.name })), (id) => {
    const { label, options } = specimens.find((each) => each.id === id) || specimens[0];
    return {
      ...openFile,
      ...reset,
      id,
      specimen: label,
      options: { ...openFile.options, ...options },
    };
  });
}

/** Read another specimen of an open file. */
export async function chooseSpecimen(/** @type {string} */ id, /** @type {string} */ to) {
  const openFile = state.files.find((file) => file.id === id);
  const chosen = openFile?.specimens?.filter((specimen) => specimen.id === to) || [];
  if (openFile && chosen.length) await readSpecimens(openFile, chosen);
}

export async function answer() {
  const reading = readAnswers();
  if (!reading) return;
  reading.openFile.options = reading.options;
  const chosen = getChosenSpecimens(reading.openFile);
  if (chosen.length) return readSpecimens(reading.openFile, chosen);
  try {
    await inspect(reading.openFile);
    refuse("", "file");
  } catch (error) {
    refuse(words(error), "file");
  }
  fileList();
  settle();
}

export async function profile() {
  const reading = readAnswers();
  if (reading) save((await send("profile", { options: reading.options })).head);
}

// -- export ---------------------------------------------------------------------------------------

/** Save a file: its text, or the bytes of an archive in base 64. */
function save(/** @type {{name: string, kind: string, text?: string, base64?: string}} */ file) {
  const { text, base64 = "" } = file;
  const content = text ?? Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const href = URL.createObjectURL(new Blob([content], { type: file.kind }));
  const link = createElement("a", { href, download: file.name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(href), LINGER);
  return `saved ${file.name}`;
}

/** Request a download and show the text that `done` returns; it can be cancelled. */
function make(
  /** @type {string} */ verb,
  /** @type {any} */ request,
  /** @type {string} */ what,
  /** @type {(head: any) => string} */ done,
) {
  status(`making ${what}`);
  countWorking(1);
  const finish = (/** @type {string} */ message) => {
    countWorking(-1);
    status(message);
  };
  // in its own queue: the requests of the page go on
  askQueued("take", verb, request, ({ head }) => {
    showNotMade("", verb);
    finish(done(head));
  }, (message) => {
    if (message !== cancelled) showNotMade(message, verb);
    finish(message === cancelled ? message : "not made");
  }, () => countWorking(-1));
}

/** Show in the menu why the export failed. */
function showNotMade(/** @type {string} */ message, /** @type {string} */ verb) {
  if (verb.startsWith("take-")) return refuse(message, "fit");
  $("not-taken").textContent = message;
  $("not-taken").hidden = !message;
  if (!message) return;
  $("menu").hidden = false;
  $("anyway").focus();
}

/** Download the fit of the shown file. */
export function downloadBench() {
  const of = bench();
  if (of) make(`take-${of.verb}`, of.request, "fit", save);
}

/** Open the machine file of blank tests as the machine of the tests. */
export function useMachine() {
  const of = bench();
  if (!of) return;
  make(`take-${of.verb}`, of.request, "the machine file", (/** @type {any} */ file) => {
    uploadFiles([new File([file.text], file.name, { type: file.kind })]);
    return `${file.name} is open`;
  });
}

/** Identity of the model shown on the page: only this one is exported. */
const solidShown = () => document.querySelector("[data-solid]")?.getAttribute("data-solid");

export function download(/** @type {Record<string, any>} */ what) {
  // a pending change is not in the shown model
  if (!settled()) return status("not checked yet: nothing to export");
  const { joint } = state, solid = solidShown(), model = ["fit", "deck"].includes(what.what);
  const request = { job: job(), limits: limits(), ...what, ...(model && { joint, solid }) };
  make("take", request, what.target || what.what, save);
}

export function project() {
  if (!settled()) return status("not checked yet: nothing to save");
  const request = { job: job(), folder: field("folder").value };
  make("project", request, "the project", (head) => `kept in ${head.folder}`);
}
