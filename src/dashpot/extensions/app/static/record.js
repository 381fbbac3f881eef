// An instrument that is read: what it is, its force and displacement as they come, and the way on.
import { $, all, field, made, status, words } from "./dom.js";
import { call } from "./wire.js";

/** @typedef {{name: string, now: string, svg: string}} Drawn */
/** @typedef {{running: boolean, rows: number, message: string, failed: string, drawn: Drawn[], kept: {id: string, name: string} | null}} Seen */

const BEAT = 500;
const TALL = 210, TALL_NARROW = 180, NARROW = 900;
const FIELDS = ["driver", "port", "baud", "columns", "file", "speed", "folder"];

let running = false;

const button = (/** @type {string} */ id) => /** @type {HTMLButtonElement} */ ($(id));

function refuse(/** @type {string} */ said) {
  $("refusal").textContent = said;
  $("refusal").hidden = !said;
}

function choices() {
  const driver = field("driver").value;
  for (const one of all("[data-of]")) one.hidden = !one.dataset.of?.split(" ").includes(driver);
}

function show(/** @type {Seen} */ seen) {
  running = seen.running;
  button("start").disabled = running;
  button("stop").disabled = !running;
  button("fit").disabled = !seen.kept;
  $("simulated").hidden = !seen.message.includes("simulated");
  const over = seen.rows ? "recorded" : "nothing is recorded";
  status(running ? `recording, ${seen.rows} samples` : over);
  $("message").textContent = seen.message;
  if (seen.failed) refuse(seen.failed);
  $("panels").replaceChildren(...seen.drawn.map(({ name, now, svg }) => {
    const [, what, unit] = name.match(/(.*) \[(.*)\]/) || ["", name, ""];
    const figure = made("figure", { class: "card", "data-channel": what });
    const body = made("div", { class: "body" });
    body.innerHTML = svg;
    figure.append(made("figcaption", {}, `${what}, now ${now} ${unit}`), body);
    return figure;
  }));
}

async function look() {
  const width = $("panels").clientWidth - 18;
  const height = innerWidth < NARROW ? TALL_NARROW : TALL;
  show(await call("GET", `/api/record?width=${width}&height=${height}`));
}

async function follow() {
  try {
    await look();
    if (running) setTimeout(follow, BEAT);
  } catch (error) {
    refuse(words(error));
  }
}

async function act(/** @type {() => Promise<unknown>} */ what) {
  refuse("");
  try {
    await what();
  } catch (error) {
    refuse(words(error));
  }
}

$("driver").addEventListener("change", choices);
$("device").addEventListener("submit", (event) => {
  event.preventDefault();
  const asked = Object.fromEntries(FIELDS.map((name) => [name, field(name).value]));
  act(async () => {
    await call("POST", "/api/record", JSON.stringify(asked));
    await follow();
  });
});
$("stop").addEventListener("click", () =>
  act(async () => {
    await call("DELETE", "/api/record");
    await look();
  }));
$("fit").addEventListener("click", () =>
  act(async () => {
    await call("POST", "/api/record/fit");
    location.href = "/";
  }));
addEventListener("resize", () => $("panels").childElementCount && !running && act(look));

const state = await call("GET", "/api/state").catch(() => ({}));
for (const one of [...(state.files || []), ...(state.open || [])]) {
  $("file").append(made("option", { value: one.id }, one.name));
}
choices();
await follow();
document.body.dataset.ready = "true";
