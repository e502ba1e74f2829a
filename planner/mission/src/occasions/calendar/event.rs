//! What one event means: when it takes place, and whether it counts.

use super::error::{CalendarError, EventError};
use super::moment::{duration, instant};
use super::placed::{Placed, placed, zone_of};
use super::repeat::instances;
use super::zone::{Zone, Zones};
use chrono::{Duration, NaiveDateTime};
use icalendar::parser::{Component, Property};
use onboard_core::time::Instant;

/// A time with a reason.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Occasion {
    /// Its start.
    pub from: Instant,
    /// Its end.
    pub until: Instant,
    /// Its summary.
    pub summary: String,
}

/// Whether and when an event takes place.
pub(super) enum Seen {
    Cancelled,
    Transparent,
    Momentary,
    At(Vec<Occasion>),
}

/// How long an event lasts.
#[derive(Clone, Copy)]
enum Lasting {
    /// So long, exactly.
    Exactly(Duration),
    /// Days by its zone's clock, and then a time.
    Days(Duration, Duration),
}

/// An event.
pub(super) struct Event<'c> {
    component: &'c Component<'c>,
    zones: (&'c Zones, Option<&'c Zone>),
    name: String,
    summary: String,
    pub(super) uid: Option<&'c str>,
    /// The start, in UTC, of the instance whose place it takes.
    pub(super) replaces: Option<NaiveDateTime>,
}

fn value<'c>(component: &'c Component<'c>, key: &str) -> Option<&'c str> {
    component.find_prop(key).map(|it| it.val.as_str().trim())
}

impl<'c> Event<'c> {
    /// Reads what tells events apart.
    pub(super) fn of(
        component: &'c Component<'c>,
        zones: (&'c Zones, Option<&'c Zone>),
    ) -> Result<Self, CalendarError> {
        let summary = value(component, "SUMMARY").unwrap_or_default().to_owned();
        let uid = value(component, "UID");
        let name = match (&*summary, uid) {
            ("", None) => "an event".to_owned(),
            ("", Some(uid)) => format!("event {uid}"),
            (summary, _) => format!("event '{summary}'"),
        };
        let mut event = Self { component, zones, name, summary, uid, replaces: None };
        event.replaces = event.replaced().map_err(|reason| event.refused(reason))?;
        Ok(event)
    }

    fn refused(&self, reason: EventError) -> CalendarError {
        CalendarError::Event { event: self.name.clone(), reason }
    }

    fn replaced(&self) -> Result<Option<NaiveDateTime>, EventError> {
        const KEY: &str = "RECURRENCE-ID";
        let Some(property) = self.component.find_prop(KEY) else { return Ok(None) };
        if property.params.iter().any(|it| it.key.as_str().eq_ignore_ascii_case("RANGE")) {
            return Err(EventError::NotTaken { key: "RECURRENCE-ID with RANGE" });
        }
        let zone = zone_of(KEY, property, self.zones)?;
        placed(KEY, property.val.as_str(), zone.as_ref()).map(|it| Some(it.utc()))
    }

    /// When it takes place up to `end`, without the instances whose place others take.
    pub(super) fn seen(
        &self,
        end: NaiveDateTime,
        replaced: &[(&str, NaiveDateTime)],
    ) -> Result<Seen, CalendarError> {
        let says = |key: &str, word: &str| {
            value(self.component, key).is_some_and(|it| it.eq_ignore_ascii_case(word))
        };
        if says("STATUS", "CANCELLED") {
            return Ok(Seen::Cancelled);
        }
        if says("TRANSP", "TRANSPARENT") {
            return Ok(Seen::Transparent);
        }
        self.occasions(end, replaced).map_err(|reason| self.refused(reason))
    }

    fn occasions(
        &self,
        end: NaiveDateTime,
        replaced: &[(&str, NaiveDateTime)],
    ) -> Result<Seen, EventError> {
        let start = self.time("DTSTART")?.ok_or(EventError::Missing { key: "DTSTART" })?;
        let Some(lasting) = self.lasting(&start)? else { return Ok(Seen::Momentary) };
        let mut spans = Vec::new();
        for local in self.starts(&start, end)? {
            let from = start.zone.utc(local);
            spans.push((from, lasting.after(local, &start.zone)));
        }
        self.periods(lasting, &mut spans)?;
        let left_out = self.left_out(&start, end)?;
        let taken = |from: &NaiveDateTime| {
            self.replaces.is_none() && self.uid.is_some_and(|uid| replaced.contains(&(uid, *from)))
        };
        spans.retain(|(from, _)| !left_out.contains(from) && !taken(from));
        spans.sort_unstable();
        spans.dedup();
        let occasion = |(from, until)| Occasion {
            from: instant(from),
            until: instant(until),
            summary: self.summary.clone(),
        };
        Ok(Seen::At(spans.into_iter().map(occasion).collect()))
    }

    /// The time of a property that stands there once.
    fn time(&self, key: &'static str) -> Result<Option<Placed>, EventError> {
        let Some(property) = self.component.find_prop(key) else { return Ok(None) };
        let zone = zone_of(key, property, self.zones)?;
        placed(key, property.val.as_str(), zone.as_ref()).map(Some)
    }

    /// How long it lasts; `None` for no time at all.
    fn lasting(&self, start: &Placed) -> Result<Option<Lasting>, EventError> {
        const KEY: &str = "DURATION";
        if let Some(end) = self.time("DTEND")? {
            let exactly = end.utc() - start.utc();
            if exactly <= Duration::zero() {
                return Err(EventError::Reversed { from: instant(start.utc()) });
            }
            return Ok(Some(Lasting::Exactly(exactly)));
        }
        let Some(text) = value(self.component, KEY) else {
            let day = Lasting::Days(Duration::days(1), Duration::zero());
            return Ok(start.is_day.then_some(day));
        };
        let (days, time) = duration(text)
            .ok_or_else(|| EventError::Duration { key: KEY, text: text.to_owned() })?;
        let none = days + time <= Duration::zero();
        Ok(if none { None } else { Some(Lasting::Days(days, time)) })
    }

    /// Its first start and those of its rules, on its zone's clock.
    fn starts(&self, start: &Placed, end: NaiveDateTime) -> Result<Vec<NaiveDateTime>, EventError> {
        let rules: Vec<&Property<'_>> = self.all("RRULE").collect();
        if rules.is_empty() {
            return Ok(vec![start.local]);
        }
        let mut starts = Vec::new();
        for rule in rules {
            let local = |utc| start.zone.local(utc);
            starts.extend(instances(start.local, rule.val.as_str(), end, local)?);
        }
        Ok(starts)
    }

    /// The starts, in UTC, that EXDATE and EXRULE leave out.
    fn left_out(
        &self,
        start: &Placed,
        end: NaiveDateTime,
    ) -> Result<Vec<NaiveDateTime>, EventError> {
        let mut left_out = Vec::new();
        for rule in self.all("EXRULE") {
            let local = |utc| start.zone.local(utc);
            let starts = instances(start.local, rule.val.as_str(), end, local)?;
            left_out.extend(starts.into_iter().map(|it| start.zone.utc(it)));
        }
        for property in self.all("EXDATE") {
            let zone = zone_of("EXDATE", property, self.zones)?;
            for text in property.val.as_str().split(',') {
                let mut date = placed("EXDATE", text, zone.as_ref())?;
                if date.is_day && !start.is_day {
                    // A day among times: that day's, at the event's own time.
                    date.local = date.local.date().and_time(start.local.time());
                    date.zone = start.zone.clone();
                }
                left_out.push(date.utc());
            }
        }
        left_out.sort_unstable();
        Ok(left_out)
    }

    /// Adds what RDATE names: starts, or periods with ends of their own.
    fn periods(
        &self,
        lasting: Lasting,
        spans: &mut Vec<(NaiveDateTime, NaiveDateTime)>,
    ) -> Result<(), EventError> {
        for property in self.all("RDATE") {
            let zone = zone_of("RDATE", property, self.zones)?;
            for text in property.val.as_str().split(',') {
                if text.contains('/') {
                    spans.push(period("RDATE", text, zone.as_ref())?);
                } else {
                    let start = placed("RDATE", text, zone.as_ref())?;
                    spans.push((start.utc(), lasting.after(start.local, &start.zone)));
                }
            }
        }
        Ok(())
    }

    fn all(&self, key: &'c str) -> impl Iterator<Item = &'c Property<'c>> {
        self.component.properties.iter().filter(move |it| it.name.as_str() == key)
    }
}

impl Lasting {
    /// The end, in UTC, of what starts then on the zone's clock.
    fn after(self, local: NaiveDateTime, zone: &Zone) -> NaiveDateTime {
        match self {
            Self::Exactly(time) => zone.utc(local) + time,
            Self::Days(days, time) => zone.utc(local + days) + time,
        }
    }
}

/// `start/end` or `start/duration`, in UTC.
fn period(
    key: &'static str,
    text: &str,
    zone: Option<&Zone>,
) -> Result<(NaiveDateTime, NaiveDateTime), EventError> {
    let missing = || EventError::NotUtc { key, text: text.to_owned() };
    let (from, until) = text.split_once('/').ok_or_else(missing)?;
    let start = placed(key, from, zone)?;
    let end = match duration(until) {
        Some((days, time)) => Lasting::Days(days, time).after(start.local, &start.zone),
        None => placed(key, until, zone)?.utc(),
    };
    let from = start.utc();
    if end <= from {
        return Err(EventError::Reversed { from: instant(from) });
    }
    Ok((from, end))
}

/// The busy times of a `VFREEBUSY`.
pub(super) fn busy(component: &Component<'_>) -> Result<Vec<Occasion>, CalendarError> {
    const KEY: &str = "FREEBUSY";
    let name = value(component, "UID").unwrap_or_default();
    let refuse = |reason| CalendarError::Event { event: format!("VFREEBUSY {name}"), reason };
    let mut occasions = Vec::new();
    for property in component.properties.iter().filter(|it| it.name.as_str() == KEY) {
        let kind = property.params.iter().find(|it| it.key.as_str().eq_ignore_ascii_case("FBTYPE"));
        let kind = kind.and_then(|it| it.val.as_ref()).map_or("BUSY", |it| it.as_str());
        if kind.eq_ignore_ascii_case("FREE") {
            continue;
        }
        for text in property.val.as_str().split(',').filter(|it| !it.trim().is_empty()) {
            let (from, until) = period(KEY, text, None).map_err(refuse)?;
            let summary = value(component, "SUMMARY").unwrap_or("busy").to_owned();
            occasions.push(Occasion { from: instant(from), until: instant(until), summary });
        }
    }
    Ok(occasions)
}
