//! Where is local time in UTC.
//!
//! A zone is UTC, one that the file defines (`VTIMEZONE`), one of the tz database, or one by its name in
//! Windows; asked in this order.
//!
//! Method: [RFC 5545, section 3.3.5]: a time that occurs twice is the first of the two, one that is
//! skipped is taken with the offset before the gap.
//!
//! Limits: the tz database's rules as the crate `chrono-tz` has them, to 2100.

use super::moment::{Moment, civil};
use super::repeat::instances;
use chrono::{Duration, MappedLocalTime, NaiveDateTime, Offset, TimeZone};
use chrono_tz::Tz;
use icalendar::parser::Component;
use std::collections::BTreeMap;
use windows_timezones::WindowsTimezone;

/// Names of UTC.
const UTC: [&str; 8] = [
    "UTC",
    "Etc/UTC",
    "GMT",
    "Etc/GMT",
    "Z",
    "Zulu",
    "Coordinated Universal Time",
    "tzone://Microsoft/Utc",
];

/// Local time.
#[derive(Debug, Clone)]
pub(super) enum Zone {
    Utc,
    Named(Tz),
    Own(Vec<Onset>),
}

/// When a zone's clocks change, in the time that they show before, and the offsets before and after.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Onset {
    at: NaiveDateTime,
    before: Duration,
    after: Duration,
}

impl Zone {
    /// UTC of a local time.
    pub(super) fn utc(&self, local: NaiveDateTime) -> NaiveDateTime {
        local - self.offset(local)
    }

    /// Local time of UTC.
    pub(super) fn local(&self, utc: NaiveDateTime) -> NaiveDateTime {
        match self {
            Self::Utc => utc,
            Self::Named(zone) => zone.from_utc_datetime(&utc).naive_local(),
            Self::Own(onsets) => {
                let after = onsets.partition_point(|it| it.at - it.before <= utc);
                utc + offset_of(onsets, after)
            }
        }
    }

    fn offset(&self, local: NaiveDateTime) -> Duration {
        match self {
            Self::Utc => Duration::zero(),
            Self::Named(zone) => {
                let seconds = |local: NaiveDateTime| match zone.offset_from_local_datetime(&local) {
                    MappedLocalTime::Single(it) | MappedLocalTime::Ambiguous(it, _) => {
                        Some(it.fix().local_minus_utc())
                    }
                    MappedLocalTime::None => None,
                };
                // No gap but that of a date line is longer than some hours.
                let before = || seconds(local - Duration::hours(3));
                let earlier = || seconds(local - Duration::hours(25));
                let seconds = seconds(local).or_else(before).or_else(earlier);
                Duration::seconds(seconds.unwrap_or_default().into())
            }
            Self::Own(onsets) => {
                let after = onsets.partition_point(|it| it.at <= local);
                match after.checked_sub(1).and_then(|last| onsets.get(last)) {
                    Some(gap) if local < gap.at + (gap.after - gap.before) => gap.before,
                    _ => offset_of(onsets, after),
                }
            }
        }
    }
}

/// The offset after so many onsets.
fn offset_of(onsets: &[Onset], passed: usize) -> Duration {
    match passed.checked_sub(1).and_then(|last| onsets.get(last)) {
        Some(last) => last.after,
        None => onsets.first().map_or(Duration::zero(), |it| it.before),
    }
}

/// The zones that a file defines.
#[derive(Debug, Default)]
pub(super) struct Zones(BTreeMap<String, Zone>);

impl Zones {
    /// Takes a `VTIMEZONE`; its rules are followed to `end`. One that defines nothing is passed over.
    pub(super) fn take(&mut self, component: &Component<'_>, end: NaiveDateTime) {
        let Some(name) = component.find_prop("TZID") else { return };
        let mut onsets = Vec::new();
        for observance in &component.components {
            onsets.extend(onsets_of(observance, end).unwrap_or_default());
        }
        onsets.sort_unstable();
        if !onsets.is_empty() {
            self.0.insert(name.val.as_str().trim().to_owned(), Zone::Own(onsets));
        }
    }

    /// The zone of a name.
    pub(super) fn find(&self, name: &str) -> Option<Zone> {
        let name = name.trim().trim_matches('"').trim();
        if let Some(own) = self.0.get(name) {
            return Some(own.clone());
        }
        if UTC.iter().any(|it| it.eq_ignore_ascii_case(name)) {
            return Some(Zone::Utc);
        }
        let windows = name.parse::<WindowsTimezone>().ok().map(WindowsTimezone::tzdb_id);
        // Names that are unique the world over end in the tz database's: /example.org/Europe/Paris.
        let mut tails = std::iter::successors(Some(name.trim_start_matches('/')), |name| {
            name.split_once('/').map(|it| it.1).filter(|it| it.contains('/'))
        });
        let known = |name: &str| Tz::from_str_insensitive(name).ok();
        windows.and_then(known).or_else(|| tails.find_map(known)).map(Zone::Named)
    }
}

/// When one observance of a zone begins, again and again.
fn onsets_of(observance: &Component<'_>, end: NaiveDateTime) -> Option<Vec<Onset>> {
    let offset = |key: &str| offset_in(observance.find_prop(key)?.val.as_str());
    let (before, after) = (offset("TZOFFSETFROM")?, offset("TZOFFSETTO")?);
    let start = civil(observance.find_prop("DTSTART")?.val.as_str().trim()).ok()?;
    let Moment::Local(start) = start else { return None };
    let mut at = vec![start];
    for property in &observance.properties {
        let value = property.val.as_str();
        match property.name.as_str() {
            "RRULE" => {
                // UNTIL is in UTC.
                let local = |utc: NaiveDateTime| utc + before;
                at.extend(instances(start, value, end, local).ok()?);
            }
            "RDATE" => {
                for text in value.split(',') {
                    if let Ok(Moment::Local(local)) = civil(text.trim()) {
                        at.push(local);
                    }
                }
            }
            _ => {}
        }
    }
    at.sort_unstable();
    at.dedup();
    Some(at.into_iter().map(|at| Onset { at, before, after }).collect())
}

/// An offset such as +0200 or -033045.
fn offset_in(text: &str) -> Option<Duration> {
    let text = text.trim();
    let (sign, digits) = match text.strip_prefix('-') {
        Some(digits) => (-1, digits),
        None => (1, text.strip_prefix('+').unwrap_or(text)),
    };
    let part = |from: usize| digits.get(from..from + 2)?.parse::<i64>().ok();
    let seconds = if digits.len() > 4 { part(4)? } else { 0 };
    Some(Duration::seconds(sign * ((part(0)? * 60 + part(2)?) * 60 + seconds)))
}
