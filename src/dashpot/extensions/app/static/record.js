// Recording from an instrument: its settings, force and displacement as they arrive, and the fit.
import { $, all, createElement, field, status, words } from "./dom.js";
import { call } from "./wire.js";

/** @typedef {{name: string, now: string, svg: string}} Drawn */
/** @typedef {{running: boolean, rows: number, message: string, failed: string, drawn: Drawn[], saved_file: {id: string, name: string} | null}} Seen */

const BEAT = 500;
const TALL = 210, TALL_NARROW = 180, NARROW = 900;
const FIELDS = ["driver", "port", "baud", "columns", "file", "speed", "folder"];

let running = false;

const button = (/** @type {string} */ id) => /** @type {HTMLButtonElement} */ ($(id));

function refuse(/** @type {string} */ message) {
  $("refusal").textContent = message;
  $("refusal").hidden = !message;
}

function choices() {
  const driver = field("driver").value;
  for (const entry of all("[data-of]")) {
    entry.hidden = !entry.dataset.of?.split(" ").includes(driver);
  }
}

function show(/** @type {Seen} */ seen) {
  running = seen.running;
  button("start").disabled = running;
  button("stop").disabled = !running;
  button("fit").disabled = !seen.saved_file;
  $("simulated").hidden = !seen.message.includes("simulated");
  const over = seen.rows ? "recorded" : "nothing is recorded";
  status(running ? `recording, ${seen.rows} samples` : over);
  $("message").textContent = seen.message;
  if (seen.failed) refuse(seen.failed);
  $("panels").replaceChildren(...seen.drawn.map(({ name, now, svg }) => {
    const [, what, unit] = name.match(/(.*) \[(.*)\]/) || ["", name, ""];
    const figure = createElement("figure", { class: "card", "data-channel": what });
    const body = createElement("div", { class: "body" });
    body.innerHTML = svg;
    figure.append(createElement("figcaption", {}, `${what}, now ${now} ${unit}`), body);
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
  const settings = Object.fromEntries(FIELDS.map((name) => [name, field(name).value]));
  act(async () => {
    await call("POST", "/api/record", JSON.stringify(settings));
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
for (const entry of [...(state.files || []), ...(state.open || [])]) {
  $("file").append(createElement("option", { value: entry.id }, entry.name));
}
choices();
await follow();
document.body.dataset.ready = "true";
