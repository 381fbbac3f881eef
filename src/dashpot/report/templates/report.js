(() => {
  "use strict";
  for (const figure of document.querySelectorAll("figure")) {
    const out = document.createElement("p");
    out.className = "read";
    out.setAttribute("aria-live", "polite");
    // said once, where there is room: every figure works alike
    if (figure.id === "figure-lead" && matchMedia("(min-width:901px)").matches)
      out.textContent = "Point or use the arrow keys to read values; drag, + or \u2212 to zoom, double click or 0 for all.";
    const strips = figure.querySelector(".strips"), label = figure.querySelector("figcaption").textContent.trim();
    strips.after(out);
    strips.removeAttribute("role");
    for (const svg of strips.querySelectorAll("svg[viewBox]"))
      if (svg.querySelector(":scope > .panel")) new charts.Figure(svg, out, label);
  }

  // what is folded is printed
  const opened = [];
  addEventListener("beforeprint", () => {
    for (const one of document.querySelectorAll("details:not([open])")) { one.open = true; opened.push(one); }
  });
  addEventListener("afterprint", () => { for (const one of opened.splice(0)) one.open = false; });
})();
