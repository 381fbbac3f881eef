// A lot: the table that dashpot batch wrote, to filter, to sort, and to open a test from.
import { $, createElement, field, status, words } from "./dom.js";
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
let by = "file", descending = false;

const at = (/** @type {Row} */ row, /** @type {string} */ name) => row[table.columns.indexOf(name)];

/** Read the table of the folder of the state. */
export async function showLot() {
  try {
    const { head } = await send("folder", { folder: state.lot });
    uploadFiles(head);
  } catch (error) {
    refuse(words(error), "file");
  }
}

/** Take the table that the server sent. */
export function uploadFiles(/** @type {any} */ head) {
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
  return descending ? -order : order;
}

const cell = (/** @type {Row} */ row, /** @type {string} */ name) => {
  const value = at(row, name);
  if (typeof value === "number") return (value / 1000).toPrecision(4);
  return String(value || "");
};

/** Draw the rows that pass the filter, in the order asked for. */
export function draw() {
  const wanted = field("lot-filter").value.trim().toLowerCase();
  const rows = table.rows.filter((row) =>
    SHOWN.some(([name]) => String(at(row, name) ?? "").toLowerCase().includes(wanted))
  ).sort(less);
  const heads = SHOWN.map(([name, title]) => {
    const sort = name !== by ? "none" : descending ? "descending" : "ascending";
    const button = createElement("button", { class: "link", "data-sort": name }, title);
    return createElement("th", { scope: "col", "aria-sort": sort }, button);
  });
  $("lot-head").replaceChildren(createElement("tr", {}, ...heads));
  $("lot-rows").replaceChildren(
    ...rows.slice(0, MOST).map((row) => {
      const verdict = String(at(row, "verdict") || at(row, "outcome") || "");
      const cells = SHOWN.slice(1).map(([name]) => {
        const number = typeof at(row, name) === "number";
        if (name === "verdict") {
          return createElement("td", { class: MARKS.get(verdict) || "bad" }, verdict);
        }
        return createElement("td", number ? { class: "number" } : {}, cell(row, name));
      });
      const fitted = at(row, "outcome") === "fitted";
      const which = `${at(row, "sha256")} ${at(row, "part") || ""}`, file = String(at(row, "file"));
      const name = fitted
        ? createElement("button", { class: "link", "data-row": which }, file)
        : file;
      return createElement("tr", {}, createElement("th", { scope: "row" }, name), ...cells);
    }),
  );
  const more = rows.length > MOST ? `, the first ${MOST} shown` : "";
  $("lot-count").textContent = `${rows.length} of ${table.rows.length} tests${more}`;
}

/** Order by a column; by the same once more, the other way. */
export function sort(/** @type {string} */ name) {
  descending = name === by && !descending;
  by = name;
  draw();
}
