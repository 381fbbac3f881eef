// @ts-check
// The page: what is asked of the server, and where its answers stand. It computes no number.
import { ask, call, cancelled, send } from "/static/wire.js";
import { Handle } from "/static/handles.js";

/** @typedef {{id: string, name: string, kind?: string, line?: string, mark?: string, asked?: string, simulated?: boolean, together?: boolean, temperature?: string, options: Record<string, any>}} OpenFile */

const $ = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));
const all = (/** @type {string} */ query, /** @type {ParentNode} */ root = document) => /** @type {any[]} */ ([...root.querySelectorAll(query)]);

const DECKS = {
  nastran: "Nastran bush, PBUSHT", abaqus: "Abaqus", ansys: "Ansys", lsdyna: "LS-DYNA", calculix: "CalculiX",
  opensees: "OpenSees", adams: "Adams", radioss: "Radioss", statespace: "State space", csv: "Table",
};
const KINDS = { relaxation: "test", impact: "hammer", frf: "hammer" };
const SPECIMEN = { name: "", lot: "", length: "mm" };

/** @type {{files: OpenFile[], current: string, job: Record<string, any>, joint: boolean, mass: number}} */
const fresh = () => ({
  files: [], current: "", joint: false, mass: 0,
  job: { mass: "", seals: 1, compression: "", arms: "auto", method: "full", law: "auto", family: "maxwell", cuts: {}, specimen: {}, hammer: { accept: [], reject: [] } },
});
let state = fresh();
/** @type {string[]} */
const past = [];
let clock = { first: 0, last: 1, step: 0.001 };
/** @type {Record<string, any>} */
const figures = {};
/** @type {Record<string, string>} */
const tables = { fit: "", joint: "" };
let settled = {};

// -- the job ------------------------------------------------------------------------------------

const test = () => state.files.find((one) => one.id === state.current && one.kind === "relaxation" && one.mark === "good")
  || state.files.find((one) => one.kind === "relaxation" && one.mark === "good");
// tests of the same seal, at another temperature or depth, that are fitted with the one shown
const together = () => state.files.filter((one) => one.together && test()?.together && one.kind === "relaxation" && one.mark === "good" && one !== test());
const hammers = () => state.files.filter((one) => KINDS[one.kind || ""] === "hammer" && one.mark === "good");

function job() {
  const of = test(), by = hammers(), also = together();
  const warmth = [of, ...also].map((one) => one?.temperature || "");
  const several = also.length > 0;
  return {
    ...state.job, relaxation: of ? of.id : "", reading: of ? of.options : {}, joint: state.joint,
    specimen: several ? state.job.specimen : { ...state.job.specimen, temperature: warmth[0] },
    further: also.map((one) => one.id), temperatures: several && warmth.some(Boolean) ? warmth : [],
    cuts: several ? {} : state.job.cuts,
    impact: by.map((one) => one.id), reading_impact: by.length ? by[0].options : {},
  };
}
function widths() {
  const found = {};
  for (const card of all("[data-panel]")) if (card.clientWidth) found[card.dataset.panel] = card.clientWidth - 18;
  return found;
}
const remember = () => void call("PUT", "/api/state", JSON.stringify(state)).catch(() => {});

// -- what stands on the page ----------------------------------------------------------------------

function status(/** @type {string} */ words) { $("status").textContent = words; }
function refuse(/** @type {string} */ words) {
  $("refusal").textContent = words;
  $("refusal").hidden = !words;
}
function verdict(/** @type {any} */ head) {
  $("verdict").innerHTML = head.verdict;
  $("verdict").className = `verdict ${head.colour}`;
}
function panel(/** @type {string} */ name, /** @type {string} */ html) {
  const card = document.querySelector(`[data-panel="${name}"]`);
  if (!card || !html) return;
  const body = card.querySelector(".body"), out = card.querySelector(".read");
  // @ts-ignore
  body.innerHTML = html;
  card.classList.remove("stale");
  // @ts-ignore
  const svg = body.querySelector("svg.figure"), label = card.querySelector("figcaption").textContent;
  // @ts-ignore
  figures[name] = svg ? new charts.Figure(svg, out, label) : null;
}
function stale(/** @type {boolean} */ yes) {
  $("verdict").classList.toggle("stale", yes);
  document.querySelector('[data-panel="frf"]')?.classList.toggle("stale", yes);
}
function solid() {
  const which = tables.joint && state.joint ? "joint" : "fit";
  for (const button of all("[data-which]")) {
    button.setAttribute("aria-pressed", String(button.dataset.which === which));
    if (button.dataset.which === "joint") button.disabled = !tables.joint;
  }
  $("solid").innerHTML = tables[which];
}
function choices() {
  for (const name of ["arms", "method", "law", "family"])
    for (const button of all(`[data-${name}]`)) {
      const value = button.dataset[name];
      button.setAttribute("aria-pressed", String(String(state.job[name]) === value));
    }
  $("reset").hidden = !Object.keys(state.job.cuts).length;
  for (const [name, handle] of Object.entries(handles)) handle.byHand(name in state.job.cuts);
  $("both").hidden = !hammers().length || state.joint || !test();
}
function fileList() {
  $("files").innerHTML = "";
  for (const one of state.files) {
    const item = document.createElement("li"), button = document.createElement("button");
    const shown = one.id === state.current;
    button.className = "file";
    button.setAttribute("aria-current", String(shown));
    button.innerHTML = `<svg class="icon" role="img"><use href="#i-${one.mark || "note"}"/></svg><span><b></b><i></i></span>`;
    // @ts-ignore
    button.querySelector("b").textContent = one.name;
    // @ts-ignore
    button.querySelector("i").textContent = one.line || "reading";
    button.onclick = () => show(one.id);
    const away = document.createElement("button");
    away.className = "link away";
    away.textContent = "\u00d7";
    away.setAttribute("aria-label", `remove ${one.name}`);
    away.onclick = () => remove(one.id);
    item.append(button);
    if (one.kind === "relaxation" && one.mark === "good" && one !== test() && test()) {
      const label = document.createElement("label"), box = document.createElement("input");
      box.type = "checkbox";
      box.checked = together().includes(one);
      box.onchange = () => {
        one.together = box.checked;
        const shown = test();
        if (box.checked && shown) shown.together = true;
        fileList();
        settle();
      };
      label.className = "with";
      label.append(box, " fit together");
      item.append(label);
    }
    item.append(away);
    $("files").append(item);
  }
  document.body.classList.toggle("empty", !state.files.length);
  for (const button of all('[data-needs="test"]')) button.disabled = !test();
}
// a mass may be typed with its unit
function inGrams(/** @type {string} */ text) {
  const [, number, unit] = text.match(/^(.*?)\s*(k?g)?$/) || [];
  return unit === "kg" ? String(+(1000 * +number).toPrecision(12)) : number;
}
function views() {
  const one = state.files.find((file) => file.id === state.current);
  const asks = one && one.asked, hits = one && one.kind === "impact" && one.mark === "good" && test();
  $("question").hidden = !asks;
  $("question").innerHTML = asks ? one.asked : "";
  $("hits-page").hidden = !hits || !!asks;
  $("missing").hidden = !!asks || !!test() || !hammers().length;
  $("grid").hidden = !!asks || !!hits || !test();
  $("verdict").hidden = !!asks || !test();
}
function fields() {
  $("mass").value = state.job.mass.replace(/g$/, "");
  $("seals").value = state.job.seals;
  $("compression").value = state.job.compression.replace(/mm$/, "");
  $("mass-slider").disabled = !state.job.mass;
  $("specimen-temperature").value = (test()?.temperature || "").replace("degC", "");
  for (const [name, unit] of Object.entries(SPECIMEN))
    $(`specimen-${name}`).value = String(state.job.specimen[name] || "").slice(0, unit ? -unit.length : undefined);
}
function show(/** @type {string} */ id) {
  const before = test();
  state.current = id;
  fileList();
  views();
  if (test() !== before || !settled.fit) settle();
  else if (!$("hits-page").hidden) study();
}
function remove(/** @type {string} */ id) {
  state.files = state.files.filter((one) => one.id !== id);
  state.current = state.files[0]?.id || "";
  if (!hammers().length) state.joint = false;
  state.job.cuts = {};
  fileList();
  views();
  settle();
}

// -- handles ----------------------------------------------------------------------------------------

const cut = (/** @type {string} */ name, /** @type {number | null} */ value, /** @type {boolean} */ held) => {
  if (value === null) delete state.job.cuts[name];
  else state.job.cuts[name] = value;
  choices();
  $("beside").hidden = false;
  if (held) live(); else { live(); settle(); }
};
const handles = {
  onset: new Handle("ramp", "contact", (v, held) => cut("onset", v, held)),
  ramp_end: new Handle("ramp", "ramp end", (v, held) => cut("ramp_end", v, held)),
  hold_end: new Handle("hold", "hold end", (v, held) => cut("hold_end", v, held)),
};
function placeHandles(/** @type {any} */ cuts) {
  const at = { ...cuts, ...state.job.cuts };
  for (const [name, handle] of Object.entries(handles)) {
    // what is cut by hand is one test
    const figure = together().length ? null : figures[handle.panel];
    handle.place(figure, at[name], clock, handle.panel === "hold" ? at.onset : 0);
    handle.byHand(name in state.job.cuts);
    const field = document.querySelector(`[data-cut="${name}"]`);
    // @ts-ignore
    if (field && document.activeElement !== field) field.value = at[name].toFixed(4).replace(/0+$/, "").replace(/\.$/, "");
  }
}

// -- questions ----------------------------------------------------------------------------------------

function curves(/** @type {Record<string, Float32Array>} */ arrays) {
  for (const key of Object.keys(arrays).filter((one) => one.endsWith("/x"))) {
    const [name, curve] = key.split("/"), figure = figures[name];
    if (!figure) continue;
    const axes = figure.panels[0], y = arrays[`${name}/${curve}/y`];
    const path = all(".plot path[data-name]", figure.svg).find((one) => one.dataset.name.startsWith(curve));
    if (!path) continue;
    let d = "";
    arrays[key].forEach((x, i) => {
      const px = Math.round(axes.x.unit(x)), py = Math.round(axes.y.unit(y[i]));
      if (Number.isFinite(px) && Number.isFinite(py)) d += `${d ? "L" : "M"}${px} ${py}`;
    });
    path.setAttribute("d", d);
  }
}
function live() {
  if (!test()) return;
  ask("live", "live", { job: job() }, ({ head, arrays }) => {
    curves(arrays);
    $("beside").innerHTML = head.beside;
    refuse("");
    placeHandles(head.cuts);
    performance.mark("dashpot-live");
  }, refuse);
}
function settle() {
  choices();
  fields();
  views();
  remember();
  if (!test()) { status(state.files.some((one) => one.asked) ? "a question is open" : "no relaxation test is open"); return; }
  stale(true);
  status("fitting");
  const since = performance.now(), asked = job();
  ask("settle", "settle", { job: asked, widths: widths() }, ({ head }) => {
    settled = head;
    refuse("");
    tables.fit = head.solid;
    if (!state.joint) tables.joint = "";
    verdict(head);
    for (const [name, html] of Object.entries(head.panels)) panel(name, html);
    $("checks").innerHTML = head.checks;
    $("beside").innerHTML = head.beside;
    $("beside").hidden = !Object.keys(state.job.cuts).length;
    $("command").textContent = head.command;
    $("simulated").hidden = !head.simulated;
    $("answers").innerHTML = "";
    const [first, last] = head.clock;
    clock = { first, last, step: head.step };
    const auto = document.querySelector('[data-arms="auto"]');
    if (auto) auto.textContent = state.job.arms === "auto" && head.arms !== "" ? `auto: ${head.arms}` : "auto";
    solid();
    placeHandles(head.cuts);
    status(`settled in ${((performance.now() - since) / 1000).toFixed(2)} s`);
    past.push(JSON.stringify(state));
    study();
  }, (words) => { refuse(words); status("not fitted"); });
}
function study() {
  if (!test()) return;
  const since = Date.now();
  $("cancel").hidden = false;
  let over = false;
  const timer = setInterval(async () => {
    const at = await call("GET", "/api/working").catch(() => null);
    if (over) return;
    const words = at && at.seconds !== null ? at.doing || "bounding the response" : "working";
    status(`${words}, ${((Date.now() - since) / 1000).toFixed(1)} s`);
  }, 400);
  const end = () => { over = true; clearInterval(timer); $("cancel").hidden = true; };
  ask("slow", "study", { job: job(), widths: widths() }, ({ head }) => {
    end();
    verdict(head);
    stale(false);
    $("hint").textContent = head.hint;
    $("hint").hidden = !head.hint;
    panel("frf", head.frf);
    for (const [name, html] of Object.entries(head.hit_panels)) panel(name, html);
    $("hit-table").innerHTML = head.hits;
    for (const one of hammers()) one.line = head.hammer || one.line;
    fileList();
    $("answers").innerHTML = head.answers;
    $("checks").innerHTML = head.checks;
    $("command").textContent = head.command;
    $("simulated").hidden = !head.simulated;
    tables.joint = head.joint || "";
    solid();
    choices();
    status(`done in ${((Date.now() - since) / 1000).toFixed(1)} s`);
  }, (words) => { end(); stale(false); if (words !== cancelled) refuse(words); status(words === cancelled ? "cancelled" : "stopped"); }, end);
}
function predict() {
  if (!test() || !state.job.mass) return;
  ask("mass", "predict", { job: job() }, ({ head, arrays }) => {
    curves(arrays);
    document.querySelector('[data-panel="frf"]')?.classList.add("stale");
    status(`${head.peak}; limits: working`);
    $("command").textContent = head.command;
    performance.mark("dashpot-mass");
  }, refuse);
}

// -- files -----------------------------------------------------------------------------------------------

async function look(/** @type {OpenFile} */ one) {
  const { head } = await send("inspect", { file: one.id, options: one.options });
  Object.assign(one, head, { asked: head.asked || "" });
  if (KINDS[one.kind || ""] !== undefined && one.mark === "good") one.asked = "";
}
async function opened(/** @type {{id: string, name: string}[]} */ found) {
  const already = new Set(state.files.map((one) => one.id));
  const added = found.filter((one) => !already.has(one.id)).map((one) => ({ ...one, options: {} }));
  state.files.push(...added);
  fileList();
  for (const one of added) {
    status(`reading ${one.name}`);
    try { await look(one); } catch (error) {
      const words = String(error.message || error);
      Object.assign(one, { mark: "bad", line: words });
      refuse(words.startsWith(one.name) ? words : `${one.name}: ${words}`);
    }
  }
  const asks = added.find((one) => one.asked), first = added.find((one) => one.kind === "relaxation");
  state.current = (asks || first || state.files.find((one) => one.id === state.current) || added[0] || state.files[0])?.id || "";
  fileList();
  settle();
}
async function take(/** @type {FileList | File[]} */ list) {
  refuse("");
  const found = [];
  for (const file of list) {
    status(`opening ${file.name}`);
    try { found.push(await call("POST", `/api/files?name=${encodeURIComponent(file.name)}`, file)); } catch (error) { refuse(error.message); }
  }
  await opened(found);
}
async function example() {
  status("making the example");
  const made = await call("POST", "/api/example");
  state.job.mass = made.mass;
  state.job.seals = made.seals;
  await opened(made.files);
}
function answers() {
  const one = state.files.find((file) => file.id === state.current);
  if (!one) return null;
  const options = { ...one.options, units: { ...one.options.units } };
  for (const select of all("[data-role-of]")) {
    const number = select.dataset.roleOf, role = select.value;
    const unit = /** @type {any} */ (document.querySelector(`[data-unit-of="${number}"]`)).value;
    if (!role) continue;
    if (role === "acceleration") options.acceleration = [...new Set([...(options.acceleration || []), number])];
    else options[role] = number;
    if (unit) options.units[role] = unit;
  }
  return { one, options };
}
async function answer() {
  const given = answers();
  if (!given) return;
  given.one.options = given.options;
  try { await look(given.one); refuse(""); } catch (error) { refuse(error.message); }
  fileList();
  settle();
}
function save(/** @type {{name: string, kind: string, text: string}} */ file) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([file.text], { type: file.kind }));
  link.download = file.name;
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
function away(/** @type {Record<string, any>} */ what) {
  status(`making ${what.target || what.what}`);
  $("cancel").hidden = false;
  ask("slow", "take", { job: job(), ...what }, ({ head }) => { $("cancel").hidden = true; save(head); refuse(""); status(`saved ${head.name}`); },
    (words) => { $("cancel").hidden = true; refuse(words); status("not made"); });
}

// -- what the user does ------------------------------------------------------------------------------------

const acts = {
  open: () => $("pick").click(), hammer: () => $("pick").click(), example, answer,
  cancel: () => call("POST", "/api/cancel"),
  report: () => away({ what: "report" }),
  menu: () => {
    $("menu").hidden = !$("menu").hidden;
    document.querySelector('[data-act="menu"]')?.setAttribute("aria-expanded", String(!$("menu").hidden));
    if (!$("menu").hidden) $("units").focus();
  },
  copy: () => navigator.clipboard?.writeText($("command").textContent).then(() => status("command copied"), () => status("the browser keeps its clipboard to itself")),
  joint: () => { state.joint = true; choices(); remember(); study(); },
  reset: () => { state.job.cuts = {}; settle(); },
  profile: async () => {
    const given = answers();
    if (given) save((await send("profile", { options: given.options })).head);
  },
  project: () => ask("slow", "project", { job: job(), folder: $("folder").value }, ({ head }) => { refuse(""); status(`kept in ${head.folder}`); }, refuse),
  "close-keys": () => $("keys").close(),
};
document.addEventListener("click", (event) => {
  const at = /** @type {HTMLElement} */ (event.target);
  const button = /** @type {any} */ (at.closest("button"));
  if (!at.closest("#menu") && !(button && button.dataset.act === "menu")) $("menu").hidden = true;
  if (!button) return;
  const said = button.dataset;
  if (said.act) acts[said.act]?.();
  else if (said.take) away({ what: said.take });
  else if (said.deck) away({ what: "deck", target: said.deck, units: $("units").value, joint: $("of-joint").checked, anyway: $("anyway").checked });
  else if (said.which) { const to = said.which === "joint"; if (to !== state.joint) { state.joint = to; study(); } solid(); }
  else if (said.arms) { state.job.arms = said.arms === "auto" ? "auto" : +said.arms; settle(); }
  else if (said.method) { state.job.method = said.method; settle(); }
  else if (said.law) { state.job.law = said.law; settle(); }
  else if (said.family) { state.job.family = said.family; settle(); }
});
document.addEventListener("change", (event) => {
  const at = /** @type {any} */ (event.target);
  if (at.id === "pick") { void take([...at.files]); at.value = ""; return; }
  if (at.dataset.hit) {
    const { accept, reject } = state.job.hammer, name = at.dataset.hit;
    state.job.hammer = {
      accept: [...accept.filter((/** @type {string} */ one) => one !== name), ...(at.checked ? [name] : [])],
      reject: [...reject.filter((/** @type {string} */ one) => one !== name), ...(at.checked ? [] : [name])],
    };
    remember();
    study();
    return;
  }
  if (at.dataset.cut) { const value = parseFloat(at.value.replace(",", ".")); cut(at.dataset.cut, Number.isFinite(value) ? value : null, false); return; }
  const text = String(at.value || "").trim().replace(",", ".");
  if (at.id === "mass") { const said = inGrams(text); state.job.mass = said && `${said}g`; $("mass-slider").value = 0; state.mass = +said; settle(); }
  else if (at.id === "mass-slider") settle();
  else if (at.id === "seals") { state.job.seals = text ? +text : 1; settle(); }
  else if (at.id === "compression") { state.job.compression = text && `${text}mm`; settle(); }
  else if (at.id.startsWith("specimen-")) {
    const name = at.id.slice(9), unit = SPECIMEN[name], of = test();
    if (name === "temperature") { if (of) of.temperature = text && `${text}degC`; } else if (text) state.job.specimen[name] = unit ? text + unit : String(at.value).trim();
    else delete state.job.specimen[name];
    settle();
  }
});
$("mass-slider").addEventListener("input", () => {
  if (!state.mass) state.mass = parseFloat(state.job.mass);
  const grams = +(state.mass * 10 ** +$("mass-slider").value).toPrecision(4);
  state.job.mass = `${grams}g`;
  $("mass").value = grams;
  predict();
});
document.addEventListener("keydown", (event) => {
  const at = /** @type {HTMLElement} */ (event.target);
  if (event.key === "Escape") {
    $("menu").hidden = true;
    if (!$("cancel").hidden) acts.cancel();
    return;
  }
  if (event.ctrlKey && event.key === "z" && !at.closest("input")) {
    past.pop();
    const last = past.pop();
    if (last) { state = JSON.parse(last); fileList(); settle(); }
    return;
  }
  if (event.ctrlKey || event.metaKey || event.altKey || at.closest("input, select, textarea, [role=application]")) return;
  const step = (/** @type {number} */ by) => {
    const i = state.files.findIndex((one) => one.id === state.current), n = state.files.length;
    if (n) show(state.files[(i + by + n) % n].id);
  };
  const keys = {
    o: acts.open, h: acts.hammer, e: () => !state.files.length && example(), j: () => !$("both").hidden && acts.joint(),
    r: () => test() && acts.report(), t: () => test() && acts.menu(), m: () => $("mass").focus(), s: () => $("seals").focus(),
    c: acts.copy, "[": () => step(-1), "]": () => step(1), "?": () => $("keys").showModal(),
  };
  if (/^[0-6]$/.test(event.key) && test()) { state.job.arms = event.key === "0" ? "auto" : +event.key; settle(); } else {
    const act = keys[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act();
  }
});
for (const [name, words] of Object.entries(DECKS)) {
  const button = document.createElement("button");
  button.dataset.deck = name;
  button.textContent = words;
  $("decks").append(button);
}
let depth = 0;
addEventListener("dragenter", (event) => { event.preventDefault(); depth += 1; $("dropping").hidden = false; });
addEventListener("dragleave", () => { depth -= 1; if (depth <= 0) $("dropping").hidden = true; });
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => {
  event.preventDefault();
  depth = 0;
  $("dropping").hidden = true;
  if (event.dataTransfer) void take(event.dataTransfer.files);
});
let wide = 0;
new ResizeObserver(() => {
  const now = document.body.clientWidth;
  if (wide && Math.abs(now - wide) > 40 && test()) settle();
  wide = now;
}).observe(document.body);

const kept = await call("GET", "/api/state").catch(() => ({}));
if (kept.files) {
  state = { ...fresh(), ...kept };
  fileList();
  fields();
  views();
  if (state.files.length) settle();
} else if (kept.open?.length) await opened(kept.open);
else fileList();
document.body.dataset.ready = "true";
