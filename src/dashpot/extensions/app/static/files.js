// Files in and out: opened, asked about, shown, taken away.
import { $, all, atWork, field, made, status, words } from "./dom.js";
import {
  hammers,
  isBench,
  isBeside,
  isHammer,
  isHitsAlone,
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
import { ask, call, cancelled, send, watched } from "./wire.js";

/** @typedef {import("./job.js").OpenFile} OpenFile */

const LINGER = 10_000;
/** Of the identity of a file; what follows says which specimen of it is read. */
const DIGITS = 16;
/** After which a reading can be cancelled, ms: before, it is done sooner. */
const PATIENCE = 300;

async function look(/** @type {OpenFile} */ one) {
  const { head } = await send("inspect", { file: one.id, options: one.options });
  const specimens = head.specimens?.length ? head.specimens : one.specimens || [];
  Object.assign(one, head, { asked: head.asked || "", specimens });
  if (isTest(one) || isHammer(one) || (isBench(one) && one.page !== "part")) one.asked = "";
}

/** Of which contents a file is: known no later than what is judged of them. */
async function stamp(/** @type {OpenFile} */ one) {
  const at = (await watched([one.id]).catch(() => ({})))[one.id];
  if (at) Object.assign(one, { hash: at.sha256, when: at.when });
}

/** Read a file; what it is refused for stands at its name. */
export async function read(/** @type {OpenFile} */ one) {
  const stamped = stamp(one);
  try {
    await look(one);
    return "";
  } catch (error) {
    const said = words(error);
    const why = said.startsWith(`${one.name}: `) ? said.slice(one.name.length + 2) : said;
    Object.assign(one, {
      mark: "bad",
      page: "",
      asked: "",
      line: said === cancelled ? "not read" : why,
    });
    return said;
  } finally {
    await stamped;
  }
}

/** What the user chose in the browser, by identity: the browser tells of each whether it changed. */
/** @type {Map<string, File>} */
export const picked = new Map();

/** Give a file another identity: what was chosen of it goes on. */
function rename(/** @type {OpenFile} */ one, /** @type {string} */ id) {
  const was = one.id;
  Object.assign(one, { id, mark: "", line: "", hash: "", watch: "" });
  if (state.current === was) state.current = id;
  for (const side of /** @type {("a" | "b")[]} */ (["a", "b"])) {
    state.ab[side] = state.ab[side].replace(was, id);
  }
}

/** Read a file again: from now on it is another one, of the same name and choices. */
export async function readAgain(
  /** @type {OpenFile} */ one,
  /** @type {{id: string, name: string}} */ found,
) {
  const was = one.id, at = new Date().toLocaleTimeString();
  status(`${one.name} changed, it is read again`);
  const [file, part] = [was.slice(0, DIGITS), was.slice(DIGITS)];
  rename(one, found.id + part);
  for (const other of one.specimens || []) other.id = other.id.replace(file, found.id);
  picked.delete(was);
  fileList();
  await read(one);
  one.again = at;
  fileList();
  status(`${one.name} changed, read again at ${at}`);
}

/** Read files that the server has, and show the first that asks something. */
export async function opened(
  /** @type {{id: string, name: string}[]} */ found,
  /** @type {(id: string) => Partial<OpenFile>} */ known = () => ({}),
) {
  const already = new Set(state.files.map((one) => one.id));
  /** @type {OpenFile[]} */
  const added = found.filter((one) => !already.has(one.id))
    .map((one) => ({ ...one, options: {}, ...known(one.id) }));
  state.files.push(...added);
  fileList();
  const at = state.current;
  let offered = false;
  const slow = setTimeout(() => {
    offered = true;
    atWork(1);
  }, PATIENCE);
  for (const one of added) {
    status(`reading ${one.name}`);
    const said = await read(one);
    if (!said || said === cancelled) continue;
    const about = said.startsWith(one.name) ? said : `${one.name}: ${said}`;
    refuse(about, "file", { words: `Remove ${one.name}`, remove: one.id });
  }
  clearTimeout(slow);
  if (offered) atWork(-1);
  const asks = added.find((one) => one.asked);
  const first = added.find((one) => one.page === "test") || added.find(isHitsAlone) ||
    added.find((one) => isBench(one) && !(isModes(one) && test()));
  const record = [...added, ...state.files].find((one) => !isBeside(one));
  const next = (asks || first || shown() || record || added[0] || state.files[0])?.id || "";
  // what the user chose while they were read is kept: what is typed then is of that file
  if (state.current === at || !shown()) state.current = next;
  fileList();
  settle();
}

/** Send files to the server, and read them. */
export async function take(/** @type {Iterable<File>} */ list) {
  refuse("", "file");
  const found = [];
  for (const file of list) {
    status(`opening ${file.name}`);
    try {
      const asked = new URLSearchParams({ name: file.name, modified: String(file.lastModified) });
      const sent = await call("POST", `/api/files?${asked}`, file);
      picked.set(sent.id, file);
      const old = state.files.filter((one) =>
        one.name === file.name && one.watch === "stale" && !one.id.startsWith(sent.id)
      );
      for (const one of old) {
        await readAgain(one, sent);
        picked.set(one.id, file);
      }
      if (old.length) settle();
      else found.push(sent);
    } catch (error) {
      refuse(words(error), "file");
    }
  }
  await opened(found);
}

export async function example() {
  status("making the example");
  refuse("", "file");
  const example = await call("POST", "/api/example");
  state.job.mass = example.mass;
  state.job.seals = example.seals;
  await opened(example.files);
}

export function show(/** @type {string} */ id) {
  const before = test();
  // what goes with a record has no page of its own
  if (state.files.some((one) => one.id === id && isBeside(one)) && shown()) return;
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
  const i = files.findIndex((one) => one.id === current);
  if (n) show(files[(i + by + n) % n].id);
}

export function remove(/** @type {string} */ id) {
  if (id === LOT) state.lot = "";
  refuse("", "file");
  refuse("");
  state.files = state.files.filter((one) => one.id !== id);
  state.current = (state.files.find((one) => !isBeside(one)) || state.files[0])?.id ||
    (state.lot && LOT);
  if (!hammers().length) state.joint = false;
  state.job.time_limits = {};
  fileList();
  views();
  settle();
}

/** Take a record for a blank test of the machine, or for that of a seal. */
export async function takeAsBlank(/** @type {string} */ id, /** @type {boolean} */ yes) {
  const one = state.files.find((file) => file.id === id);
  if (!one) return;
  const { kind: _, ...options } = one.options;
  one.options = yes ? { ...options, kind: "blank" } : options;
  refuse("", "file");
  await read(one);
  fileList();
  settle();
}

export function join(/** @type {string} */ id, /** @type {boolean} */ yes) {
  const one = state.files.find((file) => file.id === id), of = test();
  if (one) one.together = yes;
  if (yes && of) of.together = true;
  fileList();
  settle();
}

// -- what is asked of a file ----------------------------------------------------------------------

function answers() {
  const one = shown();
  if (!one) return null;
  // another specimen may have other columns: of these only what is not as it was found is said
  const changed = specimensChosen(one).length > 0;
  /** @type {import("./job.js").Options} */
  const options = { ...one.options, units: { ...one.options.units } };
  // what was answered before and is not chosen now is taken back
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
  return { one, options };
}

/** The specimens that are chosen where a file asks for one, or all that it has. */
function specimensChosen(/** @type {OpenFile} */ one) {
  /** @type {HTMLSelectElement | null} */
  const select = document.querySelector("[data-specimen]");
  const every = one.specimens || [];
  return select?.value === "all" ? every : every.filter(({ id }) => id === select?.value);
}

/** Read specimens of a file, each as a file by itself, in its place. */
async function readSpecimens(
  /** @type {OpenFile} */ one,
  /** @type {import("./job.js").Specimen[]} */ specimens,
) {
  const file = picked.get(one.id), anew = { mark: "", line: "", hash: "", watch: "", asked: "" };
  if (file) { for (const { id } of specimens) picked.set(id, file); }
  state.files = state.files.filter((each) => each !== one);
  state.current = specimens[0].id;
  await opened(specimens.map(({ id }) => ({ id, name: one.name })), (id) => {
    const { label, options } = specimens.find((each) => each.id === id) || specimens[0];
    return { ...one, ...anew, id, specimen: label, options: { ...one.options, ...options } };
  });
}

/** Read another specimen of an open file. */
export async function chooseSpecimen(/** @type {string} */ id, /** @type {string} */ to) {
  const one = state.files.find((file) => file.id === id);
  const chosen = one?.specimens?.filter((specimen) => specimen.id === to) || [];
  if (one && chosen.length) await readSpecimens(one, chosen);
}

export async function answer() {
  const given = answers();
  if (!given) return;
  given.one.options = given.options;
  const chosen = specimensChosen(given.one);
  if (chosen.length) return readSpecimens(given.one, chosen);
  try {
    await look(given.one);
    refuse("", "file");
  } catch (error) {
    refuse(words(error), "file");
  }
  fileList();
  settle();
}

export async function profile() {
  const given = answers();
  if (given) save((await send("profile", { options: given.options })).head);
}

// -- what is taken away ---------------------------------------------------------------------------

/** Save a file: its text, or the bytes of an archive in base 64. */
function save(/** @type {{name: string, kind: string, text?: string, base64?: string}} */ file) {
  const { text, base64 = "" } = file;
  const content = text ?? Uint8Array.from(atob(base64), (one) => one.charCodeAt(0));
  const href = URL.createObjectURL(new Blob([content], { type: file.kind }));
  const link = made("a", { href, download: file.name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(href), LINGER);
  return `saved ${file.name}`;
}

/** Ask for what is taken away, and say what `done` makes of the answer; it can be cancelled. */
function make(
  /** @type {string} */ verb,
  /** @type {any} */ request,
  /** @type {string} */ what,
  /** @type {(head: any) => string} */ done,
) {
  status(`making ${what}`);
  atWork(1);
  const over = (/** @type {string} */ said) => {
    atWork(-1);
    status(said);
  };
  // beside the page's own questions: what is shown is wanted, too
  ask("take", verb, request, ({ head }) => {
    notTaken("", verb);
    over(done(head));
  }, (said) => {
    if (said !== cancelled) notTaken(said, verb);
    over(said === cancelled ? said : "not made");
  }, () => atWork(-1));
}

/** Say in the menu why there is nothing to export, where its choices are. */
function notTaken(/** @type {string} */ said, /** @type {string} */ verb) {
  if (verb.startsWith("take-")) return refuse(said, "fit");
  $("not-taken").textContent = said;
  $("not-taken").hidden = !said;
  if (!said) return;
  $("menu").hidden = false;
  $("anyway").focus();
}

/** The fit of what the page fits by itself. */
export function takeBench() {
  const of = bench();
  if (of) make(`take-${of.verb}`, of.request, "fit", save);
}

/** The machine of blank tests, opened as the machine of the tests. */
export function useMachine() {
  const of = bench();
  if (!of) return;
  make(`take-${of.verb}`, of.request, "the machine file", (/** @type {any} */ file) => {
    take([new File([file.text], file.name, { type: file.kind })]);
    return `${file.name} is open`;
  });
}

/** The solid that stands on the page: nothing else is taken away as "the model". */
const solidShown = () => document.querySelector("[data-solid]")?.getAttribute("data-solid");

export function away(/** @type {Record<string, any>} */ what) {
  // what is about to change is of no solid that stands on the page
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
