// How the search weighs what it finds: who types plain words wants a page, not an attribute of a class.
const typed = new URLSearchParams(location.search).get("q") ?? "";
const isCode = /[._()]|[a-z][A-Z]/.test(typed);
var Scorer = {
  score: ([docname, , , , score, , kind]) => {
    if (isCode) return score;
    return score - (kind === "object" ? 30 : docname.startsWith("api") ? 10 : 0);
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
