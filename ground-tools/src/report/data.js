"use strict";
// The plan out of the page's data; opportunity_data.rs says what the stream holds.
const plan = (() => {
  const source = JSON.parse(document.getElementById("data").textContent);
  let text = atob(source.stream);
  const count = source.count;
  const first = new Float64Array(count), end = new Float64Array(count);
  const dwell = new Float64Array(count), turn = new Float64Array(count);
  const kind = new Uint32Array(count), template = new Uint32Array(count);
  const timesAt = new Uint32Array(count + 1), holesAt = new Uint32Array(count + 1);
  const times = [], holes = [], sessions = [];
  const ofOpportunity = new Int32Array(count).fill(-1);
  const last = source.templates.map(() => []);
  let at = 0;

  function number() {
    let value = 0, scale = 1;
    for (;;) {
      const byte = text.charCodeAt(at++);
      value += (byte & 127) * scale;
      if (byte < 128) return value;
      scale *= 128;
    }
  }
  function signed() {
    const value = number();
    return value % 2 ? -(value + 1) / 2 : value / 2;
  }
  function holeCount(parts) {
    let holes = 0;
    for (const part of parts) if (typeof part === "number") holes += part === -3 ? 2 : 1;
    return holes;
  }
  const holeCounts = source.templates.map(holeCount);

  let second = 0, turns = 0;
  for (let i = 0; i < count; i++) {
    second += number();
    const taken = number();
    turns += signed();
    const parts = number();
    timesAt[i] = times.length;
    let from = second, lengths = 0, until = second;
    for (let j = 0; j < parts; j++) {
      if (j) from += source.spin_s + signed();
      const length = number();
      times.push(from, from + length);
      lengths += length;
      until = from + length;
    }
    first[i] = second;
    end[i] = until;
    turn[i] = turns;
    kind[i] = taken >> 1;
    dwell[i] = lengths + signed() / 10;
    if (taken & 1) {
      const entry = 1000 * second + signed(), setup = number();
      const exit = 1000 * until + signed(), cooldown = number();
      const tdb = [signed(), signed()];
      ofOpportunity[i] = sessions.length;
      sessions.push({
        opportunity: i, start: (entry - setup) / 1000, end: (exit + cooldown) / 1000, tdb,
        passes: number(), psi: [signed() / 10, signed() / 10],
      });
    }
  }
  timesAt[count] = times.length;
  sessions.sort((a, b) => a.start - b.start || a.opportunity - b.opportunity);
  sessions.forEach((it, index) => { ofOpportunity[it.opportunity] = index; });

  // The reasons, all at once when the first is asked for.
  let read = false;
  function readReasons() {
    if (read) return;
    read = true;
    text = atob(source.reasons);
    at = 0;
    for (let i = 0; i < count; i++) {
      template[i] = number();
      holesAt[i] = holes.length;
      const before = last[template[i]];
      for (let j = 0; j < holeCounts[template[i]]; j++) {
        before[j] = (before[j] || 0) + signed();
        holes.push(before[j]);
      }
    }
  }

  const targets = source.targets.length;
  const pad = (value, width) => String(value).padStart(width, "0");
  const id = (kind, turn) =>
    `${source.telescopes[Math.floor(kind / targets)]}-${source.targets[kind % targets]}-${pad(turn, 6)}`;
  const iso = ms => new Date(ms).toISOString();

  return {
    telescopes: source.telescopes, targets: source.targets, span: source.span_s, count, sessions,
    first, end, dwell, kind, times, timesAt, marks: source.marks, templates: source.templates,
    // The session of an opportunity, or -1.
    session: ofOpportunity,
    target: i => kind[i] % targets,
    telescope: i => Math.floor(kind[i] / targets),
    id: i => id(kind[i], turn[i]),
    // Milliseconds since 1970 in UTC of a second of the mission, and back.
    utc(seconds) {
      let step = source.utc[0];
      for (const it of source.utc) if (it[0] <= seconds) step = it;
      return Math.floor(source.start_tai_ms + 1000 * seconds + 1e-4) + step[1];
    },
    second: utc => (utc - source.utc[0][1] - source.start_tai_ms) / 1000,
    // TDB of a session's start (0) or end (1), as text.
    tdb: (session, which) => {
      const ms = source.start_tai_ms + 1000 * (which ? session.end : session.start);
      // TAI since 2000-01-01T12:00:00 TAI to days of 86,400 s since 1970.
      return iso(Math.round(ms) + 946728000000 + 32184 + session.tdb[which]).slice(0, 19).replace("T", " ");
    },
    template(i) {
      readReasons();
      return template[i];
    },
    // The sentence of an opportunity.
    reason(i) {
      readReasons();
      let at = holesAt[i], words = "";
      for (const part of source.templates[template[i]]) {
        if (typeof part === "string") words += part;
        else if (part === -3) { words += id(holes[at], holes[at + 1]); at += 2; }
        else if (part === -2) words += iso(1000 * holes[at++]).slice(0, 19);
        else if (part === -1) words += iso(86400000 * holes[at++]).slice(0, 10);
        else words += pad(holes[at++], part);
      }
      return words;
    },
  };
})();
