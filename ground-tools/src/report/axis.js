"use strict";
// Words of times, and round steps of an axis of time.
const clock = (() => {
  const MINUTE = 60, HOUR = 3600, DAY = 86400;
  const steps = [1, 5, 15, 30, MINUTE, 5 * MINUTE, 10 * MINUTE, 30 * MINUTE, HOUR, 3 * HOUR, 6 * HOUR,
    12 * HOUR, DAY, 2 * DAY, 7 * DAY];
  const months = [1, 2, 3, 6, 12, 24, 60, 120];
  const date = ms => new Date(ms).toISOString().slice(0, 10);
  const text = ms => new Date(ms).toISOString().slice(0, 19).replace("T", " ");

  // Ticks between two seconds of the mission, at most `most`: seconds and words.
  function ticks(from, until, most) {
    const a = plan.utc(from), b = plan.utc(until), found = [];
    const step = steps.find(it => (b - a) / 1000 / it <= most);
    if (step) {
      const ms = 1000 * step;
      for (let at = Math.ceil(a / ms) * ms; at <= b; at += ms) {
        const day = at % (1000 * DAY) === 0;
        const words = day ? date(at) : new Date(at).toISOString().slice(11, step < MINUTE ? 19 : 16);
        found.push({ at: plan.second(at), words, strong: day && step < DAY });
      }
      return found;
    }
    const every = months.find(it => (b - a) / (30.4 * DAY * 1000) / it <= most) || 120;
    const start = new Date(a);
    let month = 12 * start.getUTCFullYear() + start.getUTCMonth();
    for (month = Math.ceil(month / every) * every; ; month += every) {
      const at = Date.UTC(Math.floor(month / 12), month % 12, 1);
      if (at > b) return found;
      if (at >= a) found.push({ at: plan.second(at), words: date(at).slice(0, 7), strong: month % 12 === 0 });
    }
  }

  function span(seconds) {
    if (seconds < 120) return `${seconds.toFixed(1)} s`;
    if (seconds < 7200) return `${(seconds / MINUTE).toFixed(1)} min`;
    if (seconds < 2 * DAY) return `${(seconds / HOUR).toFixed(1)} h`;
    return `${(seconds / DAY).toFixed(1)} d`;
  }
  return { ticks, span, date, text, utc: seconds => text(plan.utc(seconds)) };
})();
