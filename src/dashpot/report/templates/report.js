import { Figure } from "../../plot/charts.js";

const HOW =
  "Point or use the arrow keys to read values; drag, + or \u2212 to zoom, double click or 0 for all.";

for (const figure of document.querySelectorAll("figure")) {
  const strips = figure.querySelector(".strips");
  const label = figure.querySelector("figcaption")?.textContent?.trim() || "";
  if (!strips) continue;
  const out = document.createElement("p");
  out.className = "read";
  out.setAttribute("aria-live", "polite");
  // said once, where there is room: every figure works alike
  const lead = figure.id === "figure-lead" && matchMedia("(min-width:901px)").matches;
  if (lead) out.textContent = HOW;
  strips.after(out);
  strips.removeAttribute("role");
  /** @type {NodeListOf<SVGSVGElement>} */
  const drawn = strips.querySelectorAll("svg[viewBox]");
  for (const svg of drawn) if (svg.querySelector(":scope > .panel")) new Figure(svg, out, label);
}

// what is folded is printed
/** @type {HTMLDetailsElement[]} */
const opened = [];
addEventListener("beforeprint", () => {
  /** @type {NodeListOf<HTMLDetailsElement>} */
  const folds = document.querySelectorAll("details:not([open])");
  for (const fold of folds) {
    fold.open = true;
    opened.push(fold);
  }
});
addEventListener("afterprint", () => {
  for (const fold of opened.splice(0)) fold.open = false;
});
