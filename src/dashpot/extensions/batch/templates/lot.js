// pages, filter and drill-down of the tests; without it the gravest stand in the page
const PAGE = 50;
/** @typedef {{ heads: string[], rows: string[][] }} Every */
const every =
  /** @type {Every} */ (JSON.parse(document.getElementById("every")?.textContent || "{}"));
const body = document.querySelector("#rows tbody");
const bar = /** @type {HTMLElement | null} */ (document.querySelector(".filter"));
const at = (/** @type {string} */ name) => every.heads.indexOf(name);
const box = (
  /** @type {string} */ id,
) => /** @type {HTMLSelectElement & HTMLInputElement} */ (document.getElementById(id));
const filters = {
  lot: box("of-lot"),
  date: box("of-date"),
  verdict: box("of-verdict"),
  decision: box("of-decision"),
};
let from = 0;

function fitting() {
  const words = box("find").value.trim().toLowerCase();
  const seal = words.startsWith("seal ") && at("seal") >= 0 ? words.slice(5) : null;
  const chosen = Object.entries(filters).filter(([, select]) => select.value !== "");
  return every.rows.filter(
    (row) =>
      chosen.every(([name, select]) => row[at(name)] === select.value) &&
      (seal !== null
        ? row[at("seal")].toLowerCase() === seal
        : !words || row.some((cell) => cell.toLowerCase().includes(words))),
  );
}

function draw() {
  const rows = fitting();
  from = Math.min(from, Math.max(rows.length - 1, 0));
  from -= from % PAGE;
  const shown = every.heads.map((_, i) => i).filter((i) =>
    every.heads[i] !== "mark" && every.heads[i] !== "decision"
  );
  body?.replaceChildren(
    ...rows.slice(from, from + PAGE).map((row) => {
      const line = document.createElement("tr");
      for (const i of shown) {
        const cell = line.insertCell();
        cell.textContent = row[i];
        if (every.heads[i] === "file") cell.className = "file";
        else if (every.heads[i] === "value") cell.className = "n";
        else if (every.heads[i] === "verdict") cell.className = row[at("mark")];
        else if (every.heads[i] === "why") cell.className = "why";
      }
      return line;
    }),
  );
  const last = Math.min(from + PAGE, rows.length);
  box("shown-rows").textContent = rows.length ? `${from + 1} to ${last} of ${rows.length}` : "none";
  box("before").disabled = from === 0;
  box("after").disabled = last >= rows.length;
}

function find(/** @type {string} */ lot, /** @type {string} */ words) {
  for (const select of Object.values(filters)) select.value = "";
  filters.lot.value = lot;
  box("find").value = words;
  from = 0;
  draw();
  const fold = /** @type {HTMLDetailsElement} */ (document.getElementById("tests"));
  fold.open = true;
  fold.scrollIntoView({ block: "start" });
}

if (bar && body && every.rows?.length) {
  bar.hidden = false;
  document.querySelector("#tests .cut")?.remove();
  for (const [name, select] of Object.entries(filters)) {
    const values = at(name) < 0
      ? []
      : [...new Set(every.rows.map((row) => row[at(name)]))].filter(Boolean);
    values.sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
    select.append(new Option("all", ""), ...values.map((value) => new Option(value, value)));
    if (values.length < 2) /** @type {HTMLElement} */ (select.parentElement).hidden = true;
    select.addEventListener("change", () => ((from = 0), draw()));
  }
  box("find").addEventListener("input", () => ((from = 0), draw()));
  box("before").addEventListener("click", () => ((from -= PAGE), draw()));
  box("after").addEventListener("click", () => ((from += PAGE), draw()));
  for (
    const element
      of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-find]"))
  ) {
    element.addEventListener("click", () => find("", element.dataset.find || ""));
  }
  const chart = /** @type {HTMLElement | null} */ (document.querySelector("[data-points]"));
  const points = /** @type {[string, string][]} */ (JSON.parse(chart?.dataset.points || "[]"));
  for (const svg of chart?.querySelectorAll("svg[viewBox]") || []) {
    const panel = /** @type {SVGGElement | null} */ (svg.querySelector(".panel"));
    if (!panel) continue;
    svg.classList.add("drill");
    svg.addEventListener("click", (event) => {
      const area = panel.querySelector(".plot")?.getBoundingClientRect();
      const [, low, high] = (panel.dataset.x || "").split(" ").map(Number);
      if (!area) return;
      const share = (/** @type {MouseEvent} */ (event).clientX - area.left) / area.width;
      const place = Math.round(low + share * (high - low)) - 1;
      if (place in points) find(...points[place]);
    });
  }
  draw();
}
