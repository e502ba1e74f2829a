"use strict";
// Sessions of the tables lead to the timeline; everything is ready.
(() => {
  const byId = new Map();
  plan.sessions.forEach((it, index) => byId.set(plan.id(it.opportunity), index));
  document.querySelectorAll("table.sessions").forEach(table => table.addEventListener("click", event => {
    const row = event.target.closest("tbody tr");
    const index = row && byId.get(row.cells[0].textContent);
    if (index === undefined || index === null || getSelection().toString()) return;
    timeline.choose(index, true);
    document.getElementById("timeline").scrollIntoView();
  }));
  document.documentElement.dataset.ready = "yes";
  performance.mark("ready");
})();
