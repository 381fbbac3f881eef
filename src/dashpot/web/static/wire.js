// @ts-check
// Questions to the server: one in flight in each lane, the last one wins.

export const cancelled = "cancelled";

/** @typedef {{head: any, arrays: Record<string, Float32Array>}} Answer */

/** What is no message: JSON in, JSON out. */
export async function call(/** @type {string} */ method, /** @type {string} */ path, /** @type {BodyInit | null} */ body = null) {
  const answer = await fetch(path, { method, body, credentials: "same-origin" });
  const said = await answer.json().catch(() => ({ error: `the server answered ${answer.status}` }));
  if (!answer.ok) throw new Error(said.error || `the server answered ${answer.status}`);
  return said;
}

/** One question, one message. @returns {Promise<Answer>} */
export async function send(/** @type {string} */ verb, /** @type {any} */ request) {
  let answer;
  try {
    answer = await fetch(`/api/${verb}`, { method: "POST", body: JSON.stringify(request), credentials: "same-origin" });
  } catch {
    throw new Error("the server is gone: start 'dashpot app' again");
  }
  if (!answer.ok) {
    const said = await answer.json().catch(() => ({}));
    throw new Error(said.error || `the server answered ${answer.status}`);
  }
  const buffer = await answer.arrayBuffer(), length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  /** @type {Record<string, Float32Array>} */
  const arrays = {};
  for (const [name, [at, count]] of Object.entries(head.arrays)) arrays[name] = new Float32Array(buffer, 4 + length + 4 * at, count);
  return { head, arrays };
}

/** @type {Record<string, {busy: boolean, next: (() => void) | null, dropped: (() => void) | null}>} */
const lanes = {};

/** Ask in a lane; a later question of the lane replaces one that waits. */
export function ask(
  /** @type {string} */ lane, /** @type {string} */ verb, /** @type {any} */ request,
  /** @type {(answer: Answer) => void} */ done, /** @type {(words: string) => void} */ failed,
  /** @type {() => void} */ replaced = () => {},
) {
  const at = (lanes[lane] ||= { busy: false, next: null, dropped: null });
  const go = async () => {
    at.busy = true;
    try {
      const answer = await send(verb, request);
      // an answer that is no longer asked for would flicker
      if (at.next && lane !== "live" && lane !== "mass") replaced();
      else done(answer);
    } catch (error) {
      if (at.next) replaced();
      else failed(error.message || String(error));
    } finally {
      at.busy = false;
      const next = at.next;
      at.next = at.dropped = null;
      if (next) next();
    }
  };
  if (!at.busy) void go();
  else {
    if (at.dropped) at.dropped();
    at.next = () => void go();
    at.dropped = replaced;
  }
}
