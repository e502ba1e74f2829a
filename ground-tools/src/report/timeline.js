"use strict";
// The timeline that zooms: what is in view is drawn on a canvas, a row for each telescope and target.
const timeline = (() => {
  const chart = document.getElementById("chart");
  const canvas = chart.querySelector("canvas"), tip = document.getElementById("tip");
  const details = document.getElementById("details"), view = document.getElementById("view");
  const overview = document.getElementById("overview"), day = document.getElementById("day");
  const pen = canvas.getContext("2d");
  const SHORTEST = 60, ABOVE = 26;
  const rows = [], rowOf = new Map();
  let from = 0, until = plan.span, chosen = -1, waiting = false;
  let width = 0, height = 0, left = 0, row = 24, colours = {};

  for (let i = 0; i < plan.count; i++) {
    if (!rowOf.has(plan.kind[i])) rowOf.set(plan.kind[i], null);
  }
  [...rowOf.keys()].sort((a, b) => a - b).forEach((kind, index) => {
    rowOf.set(kind, index);
    rows.push({
      kind, opportunities: [], longest: 0,
      name: `${plan.telescopes[Math.floor(kind / plan.targets.length)]} ${plan.targets[kind % plan.targets.length]}`,
    });
  });
  let longestSession = 0;
  for (let i = 0; i < plan.count; i++) {
    const it = rows[rowOf.get(plan.kind[i])];
    it.opportunities.push(i);
    it.longest = Math.max(it.longest, plan.end[i] - plan.first[i]);
  }
  for (const it of plan.sessions) longestSession = Math.max(longestSession, it.end - it.start);
  const margin = it => it.longest + longestSession;
  const marks = new Map();
  for (const id of plan.marks.added) marks.set(id, "+");
  for (const id of plan.marks.moved) marks.set(id, "~");

  // First index from `low` on for which `beyond` holds in an ascending list.
  function search(count, beyond) {
    let low = 0, high = count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (beyond(middle)) high = middle; else low = middle + 1;
    }
    return low;
  }
  const x = seconds => left + (width - left) * (seconds - from) / (until - from);
  const secondAt = px => from + (until - from) * (px - left) / (width - left);

  function look() {
    const style = getComputedStyle(document.documentElement);
    const of = name => style.getPropertyValue(name).trim();
    colours = { ink: of("--ink"), faint: of("--faint"), line: of("--line"), paper: of("--paper"), stripe: of("--stripe"), accent: of("--accent") };
    colours.series = plan.targets.map((_, index) => of(`--c${index % 8}`));
    colours.font = `${getComputedStyle(chart).fontSize} ${getComputedStyle(document.body).fontFamily}`;
    pen.font = colours.font;
    const size = parseFloat(getComputedStyle(chart).fontSize);
    row = Math.round(size * 1.9);
    left = Math.ceil(Math.max(0, ...rows.map(it => pen.measureText(it.name).width), pen.measureText("2032-04-01").width)) + 14;
  }

  function resize() {
    look();
    const scale = window.devicePixelRatio || 1;
    width = chart.clientWidth;
    height = ABOVE + row * Math.max(1, rows.length) + 2;
    canvas.style.height = `${height}px`;
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    draw();
  }

  function draw() {
    waiting = false;
    pen.font = colours.font;
    pen.textBaseline = "middle";
    pen.clearRect(0, 0, width, height);
    rows.forEach((_, index) => {
      if (index % 2 === 0) { pen.fillStyle = colours.stripe; pen.fillRect(0, ABOVE + index * row, width, row); }
    });
    const most = Math.max(3, Math.floor((width - left) / (pen.measureText("2032-04-01").width + 16)));
    let free = 0;
    pen.textAlign = "left";
    for (const tick of clock.ticks(from, until, most)) {
      const at = Math.round(x(tick.at)) + 0.5;
      if (at < left) continue;
      pen.strokeStyle = tick.strong ? colours.faint : colours.line;
      pen.beginPath(); pen.moveTo(at, ABOVE - 5); pen.lineTo(at, height); pen.stroke();
      const wide = pen.measureText(tick.words).width;
      if (at > free && at + wide < width) {
        pen.fillStyle = tick.strong ? colours.ink : colours.faint;
        pen.fillText(tick.words, at + 3, ABOVE / 2);
        free = at + wide + 12;
      }
    }
    const second = (width - left) / (until - from);
    pen.save();
    pen.beginPath(); pen.rect(left, 0, width - left, height); pen.clip();
    rows.forEach((it, index) => drawRow(it, ABOVE + index * row, second));
    pen.restore();
    pen.fillStyle = colours.ink;
    if (until - from < 2 * 86400) pen.fillText(clock.utc(from).slice(0, 10), 4, ABOVE / 2);
    rows.forEach((it, index) => pen.fillText(it.name, 4, ABOVE + (index + 0.5) * row));
    pen.strokeStyle = colours.faint;
    pen.strokeRect(left + 0.5, ABOVE + 0.5, width - left - 1, height - ABOVE - 1);
    view.textContent = `${clock.utc(from).slice(0, 16)} to ${clock.utc(until).slice(0, 16)} UTC (${clock.span(until - from)})`;
    if (document.activeElement !== day) day.value = clock.date(plan.utc(from));
    overview.querySelectorAll(".window").forEach(box => {
      box.style.left = `${100 * from / plan.span}%`;
      box.style.width = `${Math.max(0.3, 100 * (until - from) / plan.span)}%`;
      box.hidden = until - from >= plan.span;
    });
  }

  function drawRow(it, top, second) {
    const list = it.opportunities, reach = margin(it);
    const begin = search(list.length, k => plan.first[list[k]] >= from - reach);
    const colour = colours.series[it.kind % plan.targets.length];
    const fine = second > 0.02;
    const drawnTo = [-1e9, -1e9];
    pen.fillStyle = colour;
    for (let k = begin; k < list.length; k++) {
      const i = list[k], index = plan.session[i];
      if (plan.first[i] > until + reach) break;
      const session = index >= 0 ? plan.sessions[index] : null;
      if (session && second > 0.004) {
        const a = x(session.start), b = x(session.end);
        pen.globalAlpha = 1;
        pen.strokeStyle = index === chosen ? colours.accent : colours.ink;
        pen.lineWidth = index === chosen ? 3 : 1;
        pen.strokeRect(a, top + 3, Math.max(1, b - a), row - 6);
        pen.lineWidth = 1;
        const mark = marks.size && marks.get(plan.id(i));
        if (mark && b - a > 12) { pen.fillStyle = colours.ink; pen.fillText(mark, a + 3, top + 9); pen.fillStyle = colour; }
      }
      const used = session ? 1 : 0;
      const tall = used ? row - 8 : Math.round(row * 0.4);
      const y = top + (row - tall) / 2;
      pen.globalAlpha = used ? 1 : 0.45;
      if (fine) {
        for (let j = plan.timesAt[i]; j < plan.timesAt[i + 1]; j += 2) {
          const a = x(plan.times[j]), b = x(plan.times[j + 1]);
          pen.fillRect(a, y, Math.max(1, b - a), tall);
        }
      } else {
        const a = Math.max(Math.floor(x(plan.first[i])), drawnTo[used]), b = Math.ceil(x(plan.end[i]));
        if (b > a) {
          pen.fillRect(a, y, b - a, tall);
          drawnTo[used] = b;
        }
      }
    }
    pen.globalAlpha = 1;
    if (chosen >= 0 && second <= 0.004) {
      const session = plan.sessions[chosen];
      if (plan.kind[session.opportunity] === it.kind) {
        pen.strokeStyle = colours.accent;
        pen.lineWidth = 3;
        pen.strokeRect(x(session.start) - 2, top + 2, Math.max(4, x(session.end) - x(session.start) + 4), row - 4);
        pen.lineWidth = 1;
      }
    }
  }

  function later() {
    if (!waiting) { waiting = true; requestAnimationFrame(draw); }
  }

  // Shows from `a` to `b`, kept within the mission and above the shortest span.
  function show(a, b) {
    const length = Math.min(plan.span, Math.max(SHORTEST, b - a));
    const middle = (a + b) / 2;
    from = Math.min(Math.max(0, middle - length / 2), plan.span - length);
    until = from + length;
    later();
  }
  function zoom(factor, about = (from + until) / 2) {
    const length = Math.min(plan.span, Math.max(SHORTEST, (until - from) * factor));
    const share = (about - from) / (until - from);
    show(about - share * length, about + (1 - share) * length);
  }
  function move(share) {
    const step = share * (until - from);
    show(from + step, until + step);
  }

  function choose(index, follow) {
    chosen = index;
    if (index < 0) { details.innerHTML = "<p>No session chosen.</p>"; later(); return; }
    const it = plan.sessions[index], i = it.opportunity;
    const psi = it.psi[0] === it.psi[1] ? `${it.psi[0]} deg` : `${it.psi[0]} to ${it.psi[1]} deg`;
    const told = [
      ["target", plan.targets[plan.target(i)]], ["telescope", plan.telescopes[plan.telescope(i)]],
      ["start", `${clock.utc(it.start)} UTC, ${plan.tdb(it, 0)} TDB`],
      ["end", `${clock.utc(it.end)} UTC, ${plan.tdb(it, 1)} TDB`],
      ["first entry", `${clock.utc(plan.first[i])} UTC`], ["last exit", `${clock.utc(plan.end[i])} UTC`],
      ["passes", String(it.passes)], ["in view", `${plan.dwell[i].toFixed(1)} s`], ["psi", psi],
      ["why", plan.reason(i)],
    ];
    const title = document.createElement("h3"), list = document.createElement("dl");
    title.textContent = plan.id(i);
    for (const [key, value] of told) {
      const group = document.createElement("div");
      group.append(Object.assign(document.createElement("dt"), { textContent: key }),
        Object.assign(document.createElement("dd"), { textContent: value }));
      list.append(group);
    }
    details.replaceChildren(title, list);
    if (follow && (it.start < from || it.end > until)) {
      const length = Math.min(until - from, 86400);
      show((it.start + it.end - length) / 2, (it.start + it.end + length) / 2);
    }
    later();
  }

  // The next (+1) or previous (-1) session from the chosen one, or from the middle of what is shown.
  function step(direction) {
    if (!plan.sessions.length) return;
    let index = chosen + direction;
    if (chosen < 0) {
      const after = search(plan.sessions.length, k => plan.sessions[k].start >= (from + until) / 2);
      index = direction > 0 ? after : after - 1;
    }
    choose(Math.min(plan.sessions.length - 1, Math.max(0, index)), true);
  }

  // The opportunity or session under a point of the chart; sessions first.
  function under(event) {
    const box = canvas.getBoundingClientRect();
    const px = event.clientX - box.left, it = rows[Math.floor((event.clientY - box.top - ABOVE) / row)];
    if (!it || px < left || event.clientY - box.top < ABOVE) return null;
    const at = secondAt(px), slack = 4 * (until - from) / (width - left), list = it.opportunities;
    let best = null, nearest = slack, bestSession = false;
    for (let k = search(list.length, k => plan.first[list[k]] >= at - margin(it) - slack); k < list.length; k++) {
      const i = list[k], session = plan.session[i] >= 0 ? plan.sessions[plan.session[i]] : null;
      if (plan.first[i] > at + margin(it) + slack) break;
      const a = session ? session.start : plan.first[i], b = session ? session.end : plan.end[i];
      const away = at < a ? a - at : at > b ? at - b : 0;
      if (away <= slack && (best === null || (session && !bestSession) || (away < nearest && !!session === bestSession))) {
        best = i; nearest = away; bestSession = !!session;
      }
    }
    return best;
  }

  const actions = {
    in: () => zoom(0.5), out: () => zoom(2), left: () => move(-0.25), right: () => move(0.25),
    before: () => step(-1), next: () => step(1), mission: () => show(0, plan.span), none: () => choose(-1),
  };
  const keys = {
    "+": "in", "=": "in", "-": "out", "_": "out", ArrowLeft: "left", ArrowRight: "right", ArrowUp: "in",
    ArrowDown: "out", Home: "mission", n: "next", N: "next", p: "before", P: "before", Escape: "none",
  };
  chart.addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
    event.preventDefault();
    actions[keys[event.key]]();
  });
  document.querySelectorAll("#zoom [data-do]").forEach(button =>
    button.addEventListener("click", () => actions[button.dataset.do]()));
  document.querySelectorAll("#zoom [data-span]").forEach(button => button.addEventListener("click", () => {
    const length = Number(button.dataset.span) || plan.span;
    const middle = chosen >= 0 ? plan.sessions[chosen].start : (from + until) / 2;
    show(middle - length / 2, middle + length / 2);
  }));
  day.addEventListener("change", () => {
    const at = plan.second(Date.parse(`${day.value}T00:00:00Z`));
    if (Number.isFinite(at)) show(at, at + 86400);
  });
  chart.addEventListener("wheel", event => {
    if (!event.ctrlKey && document.activeElement !== chart) return;
    event.preventDefault();
    const sideways = Math.abs(event.deltaX) > Math.abs(event.deltaY);
    if (sideways) move(event.deltaX / width);
    else zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY / 300))), secondAt(event.clientX - canvas.getBoundingClientRect().left));
  }, { passive: false });

  let drag = null;
  chart.addEventListener("pointerdown", event => {
    if (event.button !== 0) return;
    drag = { x: event.clientX, from, until, moved: false };
    chart.setPointerCapture(event.pointerId);
  });
  chart.addEventListener("pointermove", event => {
    if (drag) {
      const change = event.clientX - drag.x;
      drag.moved = drag.moved || Math.abs(change) > 4;
      if (drag.moved) {
        const seconds = change * (drag.until - drag.from) / (width - left);
        show(drag.from - seconds, drag.until - seconds);
      }
      return;
    }
    const i = under(event);
    tip.hidden = i === null;
    if (i === null) return;
    const session = plan.session[i] >= 0;
    tip.textContent = `${plan.id(i)}: ${clock.utc(plan.first[i])} UTC, ${clock.span(plan.dwell[i])} in view; ${session ? "used" : plan.reason(i)}`;
    const box = chart.getBoundingClientRect();
    tip.style.top = `${event.clientY - box.top + 18}px`;
    tip.style.left = `${Math.max(0, Math.min(event.clientX - box.left - 40, box.width - tip.offsetWidth))}px`;
  });
  chart.addEventListener("pointerup", event => {
    const click = drag && !drag.moved;
    drag = null;
    if (!click) return;
    const i = under(event);
    choose(i !== null && plan.session[i] >= 0 ? plan.session[i] : -1, false);
  });
  chart.addEventListener("pointercancel", () => { drag = null; });
  chart.addEventListener("pointerleave", () => { tip.hidden = true; });

  overview.querySelectorAll(".strip svg").forEach(strip => {
    const holder = document.createElement("span");
    holder.className = "holder";
    strip.replaceWith(holder);
    const box = document.createElement("span");
    box.className = "window";
    holder.append(strip, box);
    holder.addEventListener("click", event => {
      const place = holder.getBoundingClientRect();
      const at = plan.span * (event.clientX - place.left) / place.width;
      const length = until - from >= plan.span ? 30 * 86400 : until - from;
      show(at - length / 2, at + length / 2);
    });
  });
  new ResizeObserver(resize).observe(chart);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", resize);
  resize();
  return { show, choose, range: () => [from, until], chosen: () => chosen };
})();
