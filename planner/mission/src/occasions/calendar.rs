//! Which events does an iCalendar file hold (RFC 5545).
//!
//! Times are UTC. Events that are cancelled are left out.
//!
//! Method: the crate `icalendar` unfolds, unescapes and reads; what it means is decided here.
//!
//! Limits: events that repeat, have a duration instead of an end, or stand in local time are refused.

use ephem::time::{TimeError, format_utc, parse_time};
use icalendar::parser::{Component as Parsed, Property, read_calendar, unfold};
use onboard_core::time::Instant;
use std::fmt;
use thiserror::Error;

/// Why a calendar is refused.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CalendarError {
    /// It has no calendar, or lines that are none of iCalendar.
    #[error("it is no iCalendar file: BEGIN:VCALENDAR, events and END:VCALENDAR are needed")]
    NotACalendar,
    /// It ends within a component.
    #[error("it is cut short: {begun} components begin and {ended} end")]
    CutShort {
        /// Components that begin.
        begun: usize,
        /// Components that end.
        ended: usize,
    },
    /// One of its events cannot be used.
    #[error("{event}{reason}")]
    Event {
        /// What the event is called.
        event: String,
        /// Why.
        reason: EventError,
    },
}

/// Why an event cannot be used.
#[derive(Debug, Clone, PartialEq)]
pub enum EventError {
    /// It has a property that is not taken.
    NotTaken {
        /// The property.
        key: &'static str,
    },
    /// It lacks a property.
    Missing {
        /// The property.
        key: &'static str,
    },
    /// It does not end after its start.
    Reversed {
        /// Its start.
        from: Instant,
    },
    /// A time that is not in UTC, or no time.
    NotUtc {
        /// The property.
        key: &'static str,
        /// The time as written.
        text: String,
        /// Its zone, where one is named.
        zone: Option<String>,
    },
    /// A date or time of day that does not exist.
    Time {
        /// The property.
        key: &'static str,
        /// What is wrong with it.
        error: TimeError,
    },
}

impl fmt::Display for EventError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotTaken { key } => write!(
                f,
                " has {key}, which is not taken: one event each with DTSTART and DTEND is needed"
            ),
            Self::Missing { key } => write!(f, " has no {key}: it is needed"),
            Self::Reversed { from } => {
                write!(f, " from {} does not end after its start", format_utc(*from))
            }
            Self::NotUtc { key, text, zone } => {
                write!(f, ", {key}: {text}")?;
                if let Some(zone) = zone {
                    write!(f, " in {zone}")?;
                }
                f.write_str(" is not a time in UTC: YYYYMMDDTHHMMSSZ or YYYYMMDD is needed")
            }
            Self::Time { key, error } => write!(f, ", {key}: {error}"),
        }
    }
}

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

/// The events of a file's text, in its order.
///
/// # Errors
/// A sentence that says which event cannot be used and what would be legal.
pub fn read(text: &str) -> Result<Vec<Occasion>, CalendarError> {
    let begins = text.trim_start_matches('\u{feff}').trim_start();
    if !begins.get(..15).is_some_and(|it| it.eq_ignore_ascii_case("BEGIN:VCALENDAR")) {
        return Err(CalendarError::NotACalendar);
    }
    let unfolded = unfold(begins);
    // The parser's own message quotes whole lines; the counts tell what is wrong.
    let calendar = read_calendar(&unfolded).map_err(|_| {
        let count = |what: &str| unfolded.lines().filter(|it| it.starts_with(what)).count();
        let (begun, ended) = (count("BEGIN:"), count("END:"));
        if begun == ended {
            CalendarError::NotACalendar
        } else {
            CalendarError::CutShort { begun, ended }
        }
    })?;
    let mut events = Vec::new();
    collect(&calendar.components, &mut events);
    let occasions: Result<Vec<_>, CalendarError> = events.into_iter().map(occasion).collect();
    Ok(occasions?.into_iter().flatten().collect())
}

/// Events, also of calendars within.
fn collect<'c>(components: &'c [Parsed<'c>], events: &mut Vec<&'c Parsed<'c>>) {
    for component in components {
        match component.name.as_str() {
            "VEVENT" => events.push(component),
            "VCALENDAR" => collect(&component.components, events),
            _ => {}
        }
    }
}

/// An event; none where it is cancelled.
fn occasion(event: &Parsed<'_>) -> Result<Option<Occasion>, CalendarError> {
    let value = |key: &str| event.find_prop(key).map(|it| it.val.as_str().to_owned());
    if value("STATUS").is_some_and(|it| it.eq_ignore_ascii_case("CANCELLED")) {
        return Ok(None);
    }
    let summary = value("SUMMARY").unwrap_or_default();
    let name = match (&*summary, value("UID")) {
        ("", None) => "an event".to_owned(),
        ("", Some(uid)) => format!("event {uid}"),
        (summary, _) => format!("event '{summary}'"),
    };
    let refuse = |reason: EventError| CalendarError::Event { event: name.clone(), reason };
    for key in ["RRULE", "RDATE", "RECURRENCE-ID", "DURATION"] {
        if value(key).is_some() {
            return Err(refuse(EventError::NotTaken { key }));
        }
    }
    let time = |key: &'static str| {
        let property = event.find_prop(key).ok_or(EventError::Missing { key })?;
        moment(key, property)
    };
    let (from, until) = (time("DTSTART").map_err(refuse)?, time("DTEND").map_err(refuse)?);
    if until <= from {
        return Err(refuse(EventError::Reversed { from }));
    }
    Ok(Some(Occasion { from, until, summary }))
}

/// `YYYYMMDDTHHMMSSZ`, or a date, which begins at midnight UTC.
fn moment(key: &'static str, property: &Property<'_>) -> Result<Instant, EventError> {
    let text = property.val.as_str();
    let zone = property.params.iter().find(|it| it.key.as_str().eq_ignore_ascii_case("TZID"));
    let zone = zone.and_then(|it| it.val.as_ref()).map(|it| it.as_str().trim_matches('"'));
    let utc = zone.is_some_and(|it| ["UTC", "Etc/UTC", "GMT", "Etc/GMT"].contains(&it));
    let not_utc =
        || EventError::NotUtc { key, text: text.to_owned(), zone: zone.map(str::to_owned) };
    if zone.is_some() && !utc {
        return Err(not_utc());
    }
    let digits = |from: usize, until: usize| {
        let part = text.get(from..until).filter(|it| it.bytes().all(|b| b.is_ascii_digit()));
        part.ok_or_else(not_utc)
    };
    let date = format!("{}-{}-{}", digits(0, 4)?, digits(4, 6)?, digits(6, 8)?);
    let clock = || Ok(format!("{}:{}:{}", digits(9, 11)?, digits(11, 13)?, digits(13, 15)?));
    let time = match text.get(8..).map(|rest| (rest.strip_suffix('Z'), rest)) {
        Some((None, "")) => "00:00:00".to_owned(),
        Some((Some(rest), _)) if rest.len() == 7 && rest.starts_with('T') => clock()?,
        Some((None, rest)) if utc && rest.len() == 7 && rest.starts_with('T') => clock()?,
        _ => return Err(not_utc()),
    };
    parse_time(&format!("{date}T{time}Z")).map_err(|error| EventError::Time { key, error })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn calendar(lines: &[&str]) -> String {
        let event = lines.join("\r\n");
        format!(
            "BEGIN:VCALENDAR\r\nVERSION:2.0\r\nPRODID:x\r\nBEGIN:VEVENT\r\nUID:7\r\n{event}\r\n\
             END:VEVENT\r\nEND:VCALENDAR\r\n"
        )
    }

    fn at(text: &str) -> Instant {
        parse_time(text).unwrap()
    }

    #[test]
    fn events_are_read_in_utc_unfolded_and_unescaped() {
        let text = calendar(&[
            "DTSTART:20320401T063000Z",
            "DTEND;TZID=UTC:20320401T073000",
            "SUMMARY:Wheel unloading\\, orbit\\; man",
            " oeuvre: all \\\\ telescopes",
            "BEGIN:VALARM",
            "TRIGGER;RELATED=END:-PT5M",
            "END:VALARM",
        ]);
        let expected = Occasion {
            from: at("2032-04-01T06:30:00Z"),
            until: at("2032-04-01T07:30:00Z"),
            summary: "Wheel unloading, orbit; manoeuvre: all \\ telescopes".to_owned(),
        };
        assert_eq!(read(&text).unwrap(), read(&text.replace("\r\n", "\n")).unwrap());
        assert_eq!(read(&text).unwrap(), [expected]);
        let days = calendar(&["DTSTART;VALUE=DATE:20320401", "DTEND;VALUE=DATE:20320403"]);
        let [days] = &read(&days).unwrap()[..] else { panic!() };
        assert_eq!(days.until.since(days.from).ns(), 2 * 86_400 * 1_000_000_000);
        let cancelled =
            calendar(&["DTSTART:20320401T063000Z", "DTEND:20320401T073000Z", "STATUS:CANCELLED"]);
        assert_eq!(read(&cancelled).unwrap(), []);
        assert_eq!(read("BEGIN:VCALENDAR\nEND:VCALENDAR\n").unwrap(), []);
    }

    #[test]
    fn what_is_not_taken_is_named() {
        let start = "DTSTART:20320401T063000Z";
        let end = "DTEND:20320401T073000Z";
        for (lines, sentence) in [
            (&[start, end, "RRULE:FREQ=DAILY"][..], "has RRULE"),
            (&[start, end, "RDATE:20320402T063000Z"], "has RDATE"),
            (&[start, "DURATION:PT1H"], "has DURATION"),
            (&[start], "event 7 has no DTEND"),
            (&[start, "SUMMARY:Wheel"], "event 'Wheel' has no DTEND"),
            (&[end], "has no DTSTART"),
            (&[start, "DTEND:20320401T073000"], "20320401T073000 is not a time in UTC"),
            (&[start, "DTEND;TZID=Europe/Paris:20320401T073000"], "in Europe/Paris is not a time"),
            (&[start, "DTEND:2032-04-01"], "is not a time in UTC"),
            (&[start, "DTEND:20321301"], "month 13"),
            (&[start, "DTEND:20320401T063000Z"], "does not end after its start"),
        ] {
            let error = read(&calendar(lines)).unwrap_err().to_string();
            assert!(error.contains(sentence), "{error}");
        }
        for text in ["", "start_utc,end_utc,reason\n", "BEGIN:VEVENT\nEND:VEVENT\n"] {
            assert!(read(text).unwrap_err().to_string().contains("no iCalendar file"), "{text}");
        }
        let cut = calendar(&[start, end]).replace("END:VEVENT\r\nEND:VCALENDAR\r\n", "");
        assert_eq!(read(&cut).unwrap_err(), CalendarError::CutShort { begun: 2, ended: 0 });
    }
}
