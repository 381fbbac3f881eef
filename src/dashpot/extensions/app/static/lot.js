// A lot: the table of a folder that dashpot batch filled, to filter, to sort, to open a test from.
import { $, field, made, status, words } from "./dom.js";
import { state } from "./job.js";
import { refuse } from "./verdict.js";
import { send } from "./wire.js";

/** @typedef {(string | number | null)[]} Row */

const MOST = 300;
const SHOWN = [
  ["file", "test"],
  ["lot", "lot"],
  ["seal", "seal"],
  ["repeat", "repeat"],
  ["k_end_N_per_m", "N/mm at end of hold"],
  ["k_end_low_N_per_m", "from"],
  ["k_end_high_N_per_m", "to"],
  ["verdict", "verdict"],
  ["reason", "why"],
];
const MARKS = new Map([["use", "good"], ["use with care", "care"], ["do not use", "bad"], [
  "no test",
  "note",
]]);

/** @type {{columns: string[], rows: Row[]}} */
let table = { columns: [], rows: [] };
let by = "file", falling = false;

const at = (/** @type {Row} */ row, /** @type {string} */ name) => row[table.columns.indexOf(name)];

/** Read the table of the folder of the state. */
export async function showLot() {
  try {
    const { head } = await send("folder", { folder: state.lot });
    take(head);
  } catch (error) {
    refuse(words(error), "file");
  }
}

/** Take the table that the server sent. */
export function take(/** @type {any} */ head) {
  table = head;
  $("lot-name").textContent = head.name;
  $("lot-message").textContent = head.message;
  status(`a lot of ${head.message}`);
  draw();
}

function less(/** @type {Row} */ a, /** @type {Row} */ b) {
  const [x, y] = [at(a, by), at(b, by)], missing = (x === null ? 1 : 0) - (y === null ? 1 : 0);
  if (missing || x === null || y === null) return missing;
  const order = typeof x === "number" && typeof y === "number"
    ? x - y
    : String(x).localeCompare(String(y), undefined, { numeric: true });
  return falling ? -order : order;
}

const cell = (/** @type {Row} */ row, /** @type {string} */ name) => {
  const value = at(row, name);
  if (typeof value === "number") return (value / 1000).toPrecision(4);
  return String(value || "");
};

/** Draw the rows that pass the filter, in the order asked for. */
export function draw() {
  const wanted = field("lot-filter").value.trim().toLowerCase();
  const found = table.rows.filter((row) =>
    SHOWN.some(([name]) => String(at(row, name) ?? "").toLowerCase().includes(wanted))
  ).sort(less);
  const heads = SHOWN.map(([name, title]) => {
    const sort = name !== by ? "none" : falling ? "descending" : "ascending";
    const button = made("button", { class: "link", "data-sort": name }, title);
    return made("th", { scope: "col", "aria-sort": sort }, button);
  });
  $("lot-head").replaceChildren(made("tr", {}, ...heads));
  $("lot-rows").replaceChildren(
    ...found.slice(0, MOST).map((row) => {
      const verdict = String(at(row, "verdict") || at(row, "outcome") || "");
      const cells = SHOWN.slice(1).map(([name]) => {
        const number = typeof at(row, name) === "number";
        if (name === "verdict") return made("td", { class: MARKS.get(verdict) || "bad" }, verdict);
        return made("td", number ? { class: "number" } : {}, cell(row, name));
      });
      const fitted = at(row, "outcome") === "fitted";
      const which = `${at(row, "sha256")} ${at(row, "part") || ""}`, file = String(at(row, "file"));
      const name = fitted ? made("button", { class: "link", "data-row": which }, file) : file;
      return made("tr", {}, made("th", { scope: "row" }, name), ...cells);
    }),
  );
  const more = found.length > MOST ? `, the first ${MOST} shown` : "";
  $("lot-count").textContent = `${found.length} of ${table.rows.length} tests${more}`;
}

/** Order by a column; by the same once more, the other way. */
export function sort(/** @type {string} */ name) {
  falling = name === by && !falling;
  by = name;
  draw();
}
