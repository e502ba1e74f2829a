//! The opportunities, their times in view, sessions and reasons, as the page's script reads them.
//!
//! A JSON object: names, the span, UTC less TAI, templates of sentences, and two streams, base64 of the
//! numbers of [`encoding`](super::encoding). `reasons` has the sentence of each opportunity, read when
//! the first is asked for. `stream` has for each opportunity by first entry, seconds from the
//! mission's start: first entry less the last one's; 2 class + (1 if taken); turn less the last one's;
//! number of times in view, each its length, from the second on after its start less the start before
//! and a spin period; dwell in tenths of a second less the sum of lengths. If taken: first entry in ms
//! less the whole seconds, setup and cooldown in ms, last exit in ms less the whole seconds, TDB less TAI
//! at start and at end in ms beyond 32184, number of passes, least and largest psi in tenths of a degree.

use super::encoding::{Part, Sentences, push, push_signed};
use super::names::Names;
use super::source::Source;
use crate::failure::Failure;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use ephem::time::{tdb_ns, utc_day, utc_midnight};
use formats::timeline::Difference;
use onboard_core::time::Instant;
use planner::opportunities::Opportunity;
use serde_json::{Value, json};

/// Days from 1970 to 2000.
const DAYS_TO_2000: i64 = 10_957;
const NS_PER_DAY: i64 = 86_400_000_000_000;

/// What the script reads, and the template of each opportunity's reason.
pub(super) struct Data {
    value: Value,
    /// Number of the template of each reason, by opportunity.
    pub(super) template: Vec<usize>,
    /// The templates of reasons.
    pub(super) templates: Vec<Vec<Part>>,
}

impl Data {
    pub(super) fn new(source: &Source, names: &Names) -> Result<Self, Failure> {
        let prefixes = (0..names.telescopes.len())
            .flat_map(|telescope| (0..names.targets.len()).map(move |target| (telescope, target)))
            .map(|(telescope, target)| names.prefix(telescope, target))
            .collect();
        let mut writer = Writer {
            source,
            names,
            sentences: Sentences::new(prefixes),
            bytes: Vec::new(),
            reasons: Vec::new(),
            last: (0, 0),
        };
        let list = source.offers.opportunities.list();
        let template = list
            .iter()
            .enumerate()
            .map(|(index, it)| writer.opportunity(index, it))
            .collect::<Result<_, _>>()?;
        let world = source.world;
        let marks = difference_marks(source);
        let value = json!({
            "telescopes": names.telescopes,
            "targets": names.targets,
            "count": list.len(),
            "start_tai_ms": milliseconds(world.start.tai_ns()),
            "span_s": world.end.since(world.start).seconds(),
            "utc": utc_steps(source),
            "spin_s": writer.spin_s(),
            "templates": writer.sentences.templates().map(written).collect::<Vec<_>>(),
            "marks": marks,
            "stream": STANDARD.encode(&writer.bytes),
            "reasons": STANDARD.encode(&writer.reasons),
        });
        let templates = writer.sentences.templates().map(<[Part]>::to_vec).collect();
        Ok(Self { value, template, templates })
    }

    /// As it stands in the page: no `<`, so that nothing in it ends the element.
    pub(super) fn json(&self) -> String {
        self.value.to_string().replace('<', "\\u003c")
    }
}

/// Ids that an earlier plan did not have or had at another time.
fn difference_marks(source: &Source) -> Value {
    let ids = |of: fn(&Difference) -> Vec<&str>| source.difference.map_or(Vec::new(), of);
    json!({
        "added": ids(|it| it.added.iter().map(|entry| &*entry.id).collect()),
        "moved": ids(|it| it.moved.iter().map(|entry| &*entry.now.id).collect()),
    })
}

/// From each of these seconds of the mission on, ms from TAI since 2000-01-01T12:00:00 TAI to UTC since
/// 1970-01-01 read as days of 86,400 s.
fn utc_steps(source: &Source) -> Vec<(f64, i64)> {
    let world = source.world;
    let mut steps: Vec<(f64, i64)> = Vec::new();
    for day in utc_day(world.start)..=utc_day(world.end) {
        let midnight = utc_midnight(day);
        let offset = milliseconds((day + DAYS_TO_2000) * NS_PER_DAY - midnight.tai_ns());
        if steps.last().is_none_or(|last| last.1 != offset) {
            steps.push((midnight.since(world.start).seconds(), offset));
        }
    }
    steps
}

fn milliseconds(ns: i64) -> i64 {
    ns.div_euclid(1_000_000)
}

/// A template for the script: words, or a number for a hole.
fn written(parts: &[Part]) -> Value {
    let part = |part: &Part| match part {
        Part::Text(words) => json!(words),
        Part::Id => json!(-3),
        Part::Time => json!(-2),
        Part::Date => json!(-1),
        Part::Digits(width) => json!(width),
    };
    parts.iter().map(part).collect()
}

struct Writer<'w, 'r> {
    source: &'w Source<'r>,
    names: &'w Names<'r>,
    sentences: Sentences,
    bytes: Vec<u8>,
    reasons: Vec<u8>,
    /// Second and turn of the opportunity before.
    last: (i64, i64),
}

impl Writer<'_, '_> {
    fn spin_s(&self) -> i64 {
        nearest(self.source.world.mission.scan.spin_period_min.to_f64() * 60.0)
    }

    /// Whole seconds since the mission's start.
    fn second(&self, at: Instant) -> i64 {
        (at.since(self.source.world.start).ns() + 500_000_000).div_euclid(1_000_000_000)
    }

    /// Milliseconds since the mission's start, with both ends' digits cut as the texts cut them.
    fn ms(&self, at: Instant) -> i64 {
        milliseconds(at.tai_ns()) - milliseconds(self.source.world.start.tai_ns())
    }

    fn push(&mut self, number: i64) -> Result<(), Failure> {
        let number = u64::try_from(number).map_err(|_| {
            Failure::internal(format!("{number} stands for a length in the report"))
        })?;
        push(&mut self.bytes, number);
        Ok(())
    }

    fn push_signed(&mut self, number: i64) {
        push_signed(&mut self.bytes, number);
    }

    fn opportunity(&mut self, index: usize, it: &Opportunity) -> Result<usize, Failure> {
        let session = self.names.taken[index];
        let times = self.times(it);
        let (start, end) = (times[0].0, times[times.len() - 1].1);
        self.push(start - self.last.0)?;
        let class = 2 * self.names.class(it) + usize::from(session.is_some());
        self.push(i64::try_from(class).unwrap_or(i64::MAX))?;
        let turn = i64::try_from(it.number).unwrap_or(i64::MAX);
        self.push_signed(turn - self.last.1);
        self.last = (start, turn);
        self.push(i64::try_from(times.len()).unwrap_or(i64::MAX))?;
        let (mut before, mut lengths) = (None, 0);
        for &(from, until) in &times {
            if let Some(before) = before {
                self.push_signed(from - before - self.spin_s());
            }
            before = Some(from);
            self.push(until - from)?;
            lengths += until - from;
        }
        self.push_signed(nearest(it.dwell.seconds() * 10.0) - 10 * lengths);
        let Some(session) = session else {
            return Ok(self.sentences.push(&mut self.reasons, self.names.because[index]));
        };
        let ends = [session.start_tai_ns, session.end_tai_ns].map(Instant::from_tai_ns);
        let first = self.ms(it.first_entry);
        let last = self.ms(it.last_exit);
        self.push_signed(first - 1000 * start);
        self.push(first - self.ms(ends[0]))?;
        self.push_signed(last - 1000 * end);
        self.push(self.ms(ends[1]) - last)?;
        for at in ends {
            self.push_signed(milliseconds(tdb_ns(at)) - milliseconds(at.tai_ns()) - 32_184);
        }
        self.push(i64::try_from(session.transits.len()).unwrap_or(i64::MAX))?;
        let (low, high) = psi_range(session);
        self.push_signed(nearest(10.0 * low));
        self.push_signed(nearest(10.0 * high));
        Ok(self.sentences.push(&mut self.reasons, &session.reason))
    }

    /// The seconds in view: passes that touch or overlap as one.
    fn times(&self, it: &Opportunity) -> Vec<(i64, i64)> {
        let mut times: Vec<(i64, i64)> = Vec::new();
        for &pass in self.source.offers.opportunities.passes(it) {
            let transit = &self.source.offers.found[pass].transit;
            let (from, until) = (self.second(transit.entry), self.second(transit.exit));
            match times.last_mut() {
                Some(last) if from <= last.1 => last.1 = last.1.max(until),
                _ => times.push((from, until)),
            }
        }
        times
    }
}

/// Least and largest crossing angle of a session's passes in degrees.
pub(super) fn psi_range(session: &formats::timeline::Session) -> (f64, f64) {
    let angles = session.transits.iter().map(|it| it.psi_deg);
    angles.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| (low.min(it), high.max(it)))
}

#[expect(clippy::cast_possible_truncation, reason = "seconds and angles far below 2^53")]
fn nearest(number: f64) -> i64 {
    number.round() as i64
}
