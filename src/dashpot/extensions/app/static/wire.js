// Questions to the server: one in flight in each lane, the last one wins.

export const cancelled = "cancelled";

/** @typedef {{head: any, arrays: Record<string, Float32Array>}} Answer */

let awaited = 0;

/** Fetch; whoever looks at the page from outside sees whether an answer is awaited. */
async function fetched(/** @type {string} */ path, /** @type {RequestInit} */ how) {
  document.body.dataset.busy = String(++awaited > 0);
  try {
    const answer = await fetch(path, { credentials: "same-origin", ...how }).catch(() => {
      throw new Error("the server is gone: start 'dashpot app' again");
    });
    if (!answer.ok) throw await refused(answer);
    return await answer.arrayBuffer();
  } finally {
    document.body.dataset.busy = String(--awaited > 0);
  }
}

async function refused(/** @type {Response} */ answer) {
  const said = await answer.json().catch(() => ({}));
  return new Error(said.error || `the server answered ${answer.status}`);
}

/** What is no message: JSON in, JSON out. */
export async function call(
  /** @type {string} */ method,
  /** @type {string} */ path,
  /** @type {BodyInit | null} */ body = null,
) {
  const said = await fetched(path, { method, body });
  return JSON.parse(new TextDecoder().decode(said));
}

/** One question, one message. @returns {Promise<Answer>} */
export async function send(/** @type {string} */ verb, /** @type {any} */ request) {
  const buffer = await fetched(`/api/${verb}`, {
    method: "POST",
    body: JSON.stringify(request),
  });
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  /** @type {Record<string, Float32Array>} */
  const arrays = {};
  for (const [name, [at, count]] of Object.entries(head.arrays)) {
    arrays[name] = new Float32Array(buffer, 4 + length + 4 * at, count);
  }
  return { head, arrays };
}

/** What open files are on disk, without a sign that an answer is awaited; fails without a server. */
export async function watched(/** @type {string[]} */ files) {
  const how = { method: "POST", body: JSON.stringify({ files }) };
  const answer = await fetch("/api/watch", { credentials: "same-origin", ...how });
  return answer.ok ? await answer.json() : {};
}

/** @type {Record<string, {busy: boolean, next: (() => void) | null, replaced: () => void}>} */
const lanes = {};
// an answer that is no longer asked for would flicker; a curve that follows should move
const FOLLOWING = new Set(["live", "mass"]);

/** Ask in a lane; a later question of the lane replaces the one before, which is told at once. */
export function ask(
  /** @type {string} */ lane,
  /** @type {string} */ verb,
  /** @type {any} */ request,
  /** @type {(answer: Answer) => void} */ done,
  /** @type {(words: string) => void} */ failed,
  replaced = () => {},
) {
  const at = (lanes[lane] ||= { busy: false, next: null, replaced });
  const go = async () => {
    at.busy = true;
    try {
      const answer = await send(verb, request);
      if (!at.next || FOLLOWING.has(lane)) done(answer);
    } catch (error) {
      if (!at.next) failed(error instanceof Error ? error.message : String(error));
    } finally {
      at.busy = false;
      const next = at.next;
      at.next = null;
      next?.();
    }
  };
  if (at.busy) at.replaced();
  at.replaced = replaced;
  if (at.busy) at.next = go;
  else go();
}

/** Want no more what is asked in a lane. */
export function forget(/** @type {string} */ lane) {
  if (!lanes[lane]?.busy) return;
  lanes[lane].replaced();
  lanes[lane].replaced = lanes[lane].next = () => {};
}
