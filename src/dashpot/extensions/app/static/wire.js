// Requests to the server: one in flight per queue; a later one replaces the one that waits.

export const cancelled = "cancelled";

/** @typedef {{head: any, arrays: Record<string, Float32Array>}} Answer */

let pending = 0;

/** Fetch bytes; `data-busy` of the page shows whether a request is pending. */
async function fetchBytes(/** @type {string} */ path, /** @type {RequestInit} */ how) {
  document.body.dataset.busy = String(++pending > 0);
  try {
    const answer = await fetch(path, { credentials: "same-origin", ...how }).catch(() => {
      throw new Error("the server is gone: start 'dashpot app' again");
    });
    if (!answer.ok) throw await makeError(answer);
    return await answer.arrayBuffer();
  } finally {
    document.body.dataset.busy = String(--pending > 0);
  }
}

async function makeError(/** @type {Response} */ answer) {
  const body = await answer.json().catch(() => ({}));
  return new Error(body.error || `the server answered ${answer.status}`);
}

/** Request with JSON in and JSON out. */
export async function call(
  /** @type {string} */ method,
  /** @type {string} */ path,
  /** @type {BodyInit | null} */ body = null,
) {
  const buffer = await fetchBytes(path, { method, body });
  return JSON.parse(new TextDecoder().decode(buffer));
}

/** Request with a message of head and arrays as the answer. @returns {Promise<Answer>} */
export async function send(/** @type {string} */ verb, /** @type {any} */ request) {
  const buffer = await fetchBytes(`/api/${verb}`, {
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

/** State of open files on disk, without `data-busy`; fails without a server. */
export async function fetchFileStates(/** @type {string[]} */ files) {
  const how = { method: "POST", body: JSON.stringify({ files }) };
  const answer = await fetch("/api/watch", { credentials: "same-origin", ...how });
  return answer.ok ? await answer.json() : {};
}

/** @type {Record<string, {busy: boolean, next: (() => void) | null, replaced: () => void}>} */
const queues = {};
// an outdated answer would flicker; a curve that follows a handle should move
const FOLLOWING = new Set(["live", "mass"]);

/** Send a request in a queue; it replaces one that waits there, whose `replaced` is called. */
export function askQueued(
  /** @type {string} */ queue,
  /** @type {string} */ verb,
  /** @type {any} */ request,
  /** @type {(answer: Answer) => void} */ done,
  /** @type {(words: string) => void} */ failed,
  replaced = () => {},
) {
  const at = (queues[queue] ||= { busy: false, next: null, replaced });
  const go = async () => {
    at.busy = true;
    try {
      const answer = await send(verb, request);
      if (!at.next || FOLLOWING.has(queue)) done(answer);
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

/** Drop the answers of a queue. */
export function forget(/** @type {string} */ queue) {
  if (!queues[queue]?.busy) return;
  queues[queue].replaced();
  queues[queue].replaced = queues[queue].next = () => {};
}
