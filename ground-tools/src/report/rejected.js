"use strict";
// The rejected opportunities, a page at a time, as the filters say.
const rejected = (() => {
  const PAGE = 50;
  const form = document.querySelector("#filters form"), body = document.querySelector("#rejected-list tbody");
  const matches = document.getElementById("matches");
  const target = document.getElementById("by-target"), telescope = document.getElementById("by-telescope");
  const reason = document.getElementById("by-reason"), text = document.getElementById("by-text");
  const all = [];
  for (let i = 0; i < plan.count; i++) if (plan.session[i] < 0) all.push(i);
  let found = all, page = 0, sentences = null;

  // A template as the table of reasons names it; encoding.rs makes the same.
  const labels = plan.templates.map(parts => {
    let words = "";
    for (const part of parts) {
      const hole = words.endsWith("\u2026");
      if (typeof part !== "string") words += hole ? "" : "\u2026";
      else if (hole) words += [".", ":", "-", "Z"].includes(part) ? "" : part.replace(/^Z/, "");
      else words += part;
    }
    return words;
  });

  function filter() {
    const words = text.value.trim().toLowerCase();
    if (words && !sentences) {
      sentences = all.map(i => `${plan.id(i)} ${clock.utc(plan.first[i])} ${plan.reason(i)}`.toLowerCase());
    }
    found = all.filter((i, k) =>
      (target.value === "" || plan.target(i) === Number(target.value)) &&
      (telescope.value === "" || plan.telescope(i) === Number(telescope.value)) &&
      (reason.value === "" || labels[plan.template(i)] === reason.value) &&
      (!words || sentences[k].includes(words)));
    page = 0;
    show();
  }

  function show() {
    const pages = Math.max(1, Math.ceil(found.length / PAGE));
    page = Math.min(Math.max(0, page), pages - 1);
    const rows = found.slice(page * PAGE, (page + 1) * PAGE).map(i => {
      const row = document.createElement("tr");
      const cells = [plan.id(i), clock.utc(plan.first[i]), plan.dwell[i].toFixed(1), plan.reason(i)];
      cells.forEach((words, index) => {
        const cell = document.createElement("td");
        if (index === 2) cell.className = "num";
        cell.textContent = words;
        row.append(cell);
      });
      return row;
    });
    body.replaceChildren(...rows);
    const shown = found.length ? `, ${page * PAGE + 1} to ${Math.min(found.length, (page + 1) * PAGE)} shown` : "";
    matches.textContent = `${found.length} of ${all.length} rejected opportunities match${shown}.`;
  }

  let waiting = 0;
  form.addEventListener("input", () => { clearTimeout(waiting); waiting = setTimeout(filter, 120); });
  form.addEventListener("submit", event => { event.preventDefault(); filter(); });
  form.addEventListener("reset", () => { setTimeout(filter, 0); });
  document.querySelectorAll("#filters [data-page]").forEach(button => button.addEventListener("click", () => {
    page = { first: 0, before: page - 1, next: page + 1, last: Infinity }[button.dataset.page];
    show();
  }));
  const soon = window.requestIdleCallback || (done => setTimeout(done, 50));
  soon(show);
  return { count: () => found.length };
})();
