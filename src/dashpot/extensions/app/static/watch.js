// The open files on disk: hash and time of each, and what changed since it was read.
import { field } from "./dom.js";
import { picked, readAgain } from "./files.js";
import { isReadOnly, state } from "./job.js";
import { settle } from "./questions.js";
import { fileList } from "./shown.js";
import { refuse, render } from "./verdict.js";
import { fetchFileStates } from "./wire.js";

/** Interval between two checks, ms. */
const PERIOD = 1000;
/** Checks without an answer after which the server is taken for gone. */
const MISSED = 2;

/** Whether a file that was chosen can no longer be read: it changed, or it is gone. */
async function isStale(/** @type {string} */ id) {
  const file = picked.get(id);
  return !!file && !await file.slice(0, 1).arrayBuffer().then(() => true, () => false);
}

let missed = 0;

/** Return the state of all open files on disk, or null without an answer. */
async function fetchStates() {
  try {
    const seen = await fetchFileStates(state.files.map((openFile) => openFile.id));
    missed = 0;
    return seen;
  } catch {
    missed += 1;
    return null;
  }
}

/** Check once: read again what changed, and show what is being written or gone. */
async function checkFiles() {
  const seen = await fetchStates();
  if (!seen) {
    if (missed === MISSED) refuse("the server is gone: start 'dashpot app' again");
    return;
  }
  let drawn = false, changed = false;
  for (const openFile of [...state.files]) {
    const at = seen[openFile.id];
    if (!at) continue;
    const before = JSON.stringify([openFile.hash, openFile.when, openFile.watch]);
    openFile.hash = at.sha256;
    openFile.when = at.when;
    openFile.watch = at.state || (await isStale(openFile.id) ? "stale" : "");
    drawn ||= before !== JSON.stringify([openFile.hash, openFile.when, openFile.watch]);
    if (at.state !== "changed" || isReadOnly() || field("mass").dataset.typed) continue;
    changed = true;
    await readAgain(openFile, at.new);
  }
  for (const id of picked.keys()) {
    if (!state.files.some((openFile) => openFile.id === id)) picked.delete(id);
  }
  if (drawn || changed) fileList();
  if (changed) settle();
  render();
}

/** Check periodically; at once when the page becomes visible. */
export function begin() {
  let looking = false;
  const once = async () => {
    if (looking || !state.files.length) return;
    looking = true;
    await checkFiles().finally(() => {
      looking = false;
    });
  };
  setInterval(once, PERIOD);
  document.addEventListener("visibilitychange", once);
}
