// The open files on disk: hash and time of each, and what changed since it was read.
import { field } from "./dom.js";
import { picked, readAgain } from "./files.js";
import { readsOnly, state } from "./job.js";
import { settle } from "./questions.js";
import { fileList } from "./shown.js";
import { refuse, render } from "./verdict.js";
import { watched } from "./wire.js";

/** Between two looks, ms. */
const PERIOD = 1000;
/** Looks that get no answer before the server is taken for gone. */
const MISSED = 2;

/** Whether a file that was chosen can no longer be read: it changed, or it is gone. */
async function isStale(/** @type {string} */ id) {
  const file = picked.get(id);
  return !!file && !await file.slice(0, 1).arrayBuffer().then(() => true, () => false);
}

let missed = 0;

/** Ask of all open files. */
async function asked() {
  try {
    const seen = await watched(state.files.map((one) => one.id));
    missed = 0;
    return seen;
  } catch {
    missed += 1;
    return null;
  }
}

/** Look once: what changed is read again, what is written or gone is said. */
async function look() {
  const seen = await asked();
  if (!seen) {
    if (missed === MISSED) refuse("the server is gone: start 'dashpot app' again");
    return;
  }
  let drawn = false, changed = false;
  for (const one of [...state.files]) {
    const at = seen[one.id];
    if (!at) continue;
    const before = JSON.stringify([one.hash, one.when, one.watch]);
    one.hash = at.sha256;
    one.when = at.when;
    one.watch = at.state || (await isStale(one.id) ? "stale" : "");
    drawn ||= before !== JSON.stringify([one.hash, one.when, one.watch]);
    if (at.state !== "changed" || readsOnly() || field("mass").dataset.typed) continue;
    changed = true;
    await readAgain(one, at.new);
  }
  for (const id of picked.keys()) {
    if (!state.files.some((one) => one.id === id)) picked.delete(id);
  }
  if (drawn || changed) fileList();
  if (changed) settle();
  render();
}

/** Look again and again; at once when the page is seen again. */
export function begin() {
  let looking = false;
  const once = async () => {
    if (looking || !state.files.length) return;
    looking = true;
    await look().finally(() => {
      looking = false;
    });
  };
  setInterval(once, PERIOD);
  document.addEventListener("visibilitychange", once);
}
