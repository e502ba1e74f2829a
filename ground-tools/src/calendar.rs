//! Which events does an iCalendar file hold, and how do sessions become one (RFC 5545).
//!
//! Times are UTC. A session's event begins at the whole second before it and ends at the whole
//! second after it; its UID is the session's id, so a calendar that takes a new plan moves the
//! events it already has.
//!
//! Method: the crate `icalendar` folds, unfolds, escapes and reads; what it means is decided here.
//! Events that are cancelled are left out.
//!
//! Limits: events that repeat, have a duration instead of an end, or stand in local time are refused.

use crate::failure::Failure;
use crate::provenance::PROGRAM;
use crate::timeline::Timeline;
use ephem::time::{format_utc, parse_time};
use icalendar::parser::{Component as Parsed, Property, read_calendar, unfold};
use icalendar::{Calendar, Component, Event};
use onboard_core::time::{Duration, Instant};

const SECOND_NS: i64 = 1_000_000_000;

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
pub fn read(text: &str) -> Result<Vec<Occasion>, String> {
    let no_calendar = || {
        "it is no iCalendar file: BEGIN:VCALENDAR, events and END:VCALENDAR are needed".to_owned()
    };
    let begins = text.trim_start_matches('\u{feff}').trim_start();
    if !begins.get(..15).is_some_and(|it| it.eq_ignore_ascii_case("BEGIN:VCALENDAR")) {
        return Err(no_calendar());
    }
    let unfolded = unfold(begins);
    // The parser's own message quotes whole lines; the counts tell what is wrong.
    let calendar = read_calendar(&unfolded).map_err(|_| {
        let count = |what: &str| unfolded.lines().filter(|it| it.starts_with(what)).count();
        let (begun, ended) = (count("BEGIN:"), count("END:"));
        if begun == ended {
            no_calendar()
        } else {
            format!("it is cut short: {begun} components begin and {ended} end")
        }
    })?;
    let mut events = Vec::new();
    collect(&calendar.components, &mut events);
    let occasions: Result<Vec<_>, String> = events.into_iter().map(occasion).collect();
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
fn occasion(event: &Parsed<'_>) -> Result<Option<Occasion>, String> {
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
    if let Some(key) =
        ["RRULE", "RDATE", "RECURRENCE-ID", "DURATION"].iter().find(|key| value(key).is_some())
    {
        return Err(format!(
            "{name} has {key}, which is not taken: one event each with DTSTART and \
                            DTEND is needed"
        ));
    }
    let time = |key: &str| {
        let property = event.find_prop(key);
        let property = property.ok_or_else(|| format!("{name} has no {key}: it is needed"))?;
        moment(property).map_err(|reason| format!("{name}, {key}: {reason}"))
    };
    let (from, until) = (time("DTSTART")?, time("DTEND")?);
    if until <= from {
        return Err(format!("{name} from {} does not end after its start", format_utc(from)));
    }
    Ok(Some(Occasion { from, until, summary }))
}

/// `YYYYMMDDTHHMMSSZ`, or a date, which begins at midnight UTC.
fn moment(property: &Property<'_>) -> Result<Instant, String> {
    let text = property.val.as_str();
    let zone = property.params.iter().find(|it| it.key.as_str().eq_ignore_ascii_case("TZID"));
    let zone = zone.and_then(|it| it.val.as_ref()).map(|it| it.as_str().trim_matches('"'));
    let utc = zone.is_some_and(|it| ["UTC", "Etc/UTC", "GMT", "Etc/GMT"].contains(&it));
    let need = || {
        let place = zone.map_or_else(String::new, |zone| format!(" in {zone}"));
        format!("{text}{place} is not a time in UTC: YYYYMMDDTHHMMSSZ or YYYYMMDD is needed")
    };
    if zone.is_some() && !utc {
        return Err(need());
    }
    let digits = |from: usize, until: usize| {
        let part = text.get(from..until).filter(|it| it.bytes().all(|b| b.is_ascii_digit()));
        part.ok_or_else(need)
    };
    let date = format!("{}-{}-{}", digits(0, 4)?, digits(4, 6)?, digits(6, 8)?);
    let time = match text.get(8..).map(|rest| (rest.strip_suffix('Z'), rest)) {
        Some((None, "")) => "00:00:00".to_owned(),
        Some((Some(rest), _)) if rest.len() == 7 && rest.starts_with('T') => clock(&digits)?,
        Some((None, rest)) if utc && rest.len() == 7 && rest.starts_with('T') => clock(&digits)?,
        _ => return Err(need()),
    };
    parse_time(&format!("{date}T{time}Z")).map_err(|error| error.to_string())
}

/// The time of day in `YYYYMMDDTHHMMSS`.
fn clock<'t>(digits: &impl Fn(usize, usize) -> Result<&'t str, String>) -> Result<String, String> {
    Ok(format!("{}:{}:{}", digits(9, 11)?, digits(11, 13)?, digits(13, 15)?))
}

/// The sessions of a timeline as a calendar.
///
/// # Errors
/// [`Failure::Internal`] where it cannot be written.
pub fn write(timeline: &Timeline, stamp: Instant) -> Result<Vec<u8>, Failure> {
    let mission = &timeline.provenance.mission;
    let mut calendar = Calendar::empty();
    for (key, value) in [
        ("VERSION", "2.0".to_owned()),
        ("PRODID", format!("-//Gyrfalcon//{PROGRAM}//EN")),
        ("CALSCALE", "GREGORIAN".to_owned()),
        ("X-WR-CALNAME", format!("{mission} calibration")),
    ] {
        calendar.append_property(icalendar::Property::new(key, value));
    }
    for session in &timeline.sessions {
        let description = format!(
            "{} to {}\n{} passes, {} s with {} in view of {}\n{}\nmission {}",
            session.start_utc,
            session.end_utc,
            session.transits.len(),
            session.dwell_s,
            session.target,
            session.telescope,
            session.reason,
            timeline.provenance.mission_sha256
        );
        let mut event = Event::new();
        event
            .uid(&format!("{}@{}.gyrfalcon", session.id, mission.to_lowercase().replace(' ', "-")))
            .summary(&format!("{}: {}", session.telescope, session.target))
            .description(&description)
            .add_property("CATEGORIES", "CALIBRATION")
            .add_property("DTSTAMP", basic(stamp))
            .add_property("DTSTART", basic(Instant::from_tai_ns(session.start_tai_ns)))
            .add_property("DTEND", basic(up(Instant::from_tai_ns(session.end_tai_ns))));
        calendar.push(event.done());
    }
    let text: String = (&calendar).try_into().map_err(Failure::internal)?;
    Ok(text.into_bytes())
}

/// `YYYYMMDDTHHMMSSZ`, the whole second before.
fn basic(at: Instant) -> String {
    let text = format_utc(at);
    let mut text: String =
        text.chars().take(19).filter(|letter| !matches!(letter, '-' | ':')).collect();
    text.push('Z');
    text
}

/// The whole second of TAI, and so of UTC, at or after.
fn up(at: Instant) -> Instant {
    at.plus(Duration::from_ns((-at.tai_ns()).rem_euclid(SECOND_NS)))
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
        assert_eq!(days.until.since(days.from).ns(), 2 * 86_400 * SECOND_NS);
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
            let error = read(&calendar(lines)).unwrap_err();
            assert!(error.contains(sentence), "{error}");
        }
        for text in ["", "start_utc,end_utc,reason\n", "BEGIN:VEVENT\nEND:VEVENT\n"] {
            assert!(read(text).unwrap_err().contains("no iCalendar file"), "{text}");
        }
        let cut = calendar(&[start, end]).replace("END:VEVENT\r\nEND:VCALENDAR\r\n", "");
        assert!(read(&cut).unwrap_err().contains("cut short"), "{}", read(&cut).unwrap_err());
    }

    #[test]
    fn times_are_written_to_whole_seconds_outward() {
        let inside = at("2032-04-01T06:30:00.25Z");
        assert_eq!(basic(inside), "20320401T063000Z");
        assert_eq!(basic(up(inside)), "20320401T063001Z");
        assert_eq!(basic(up(at("2032-04-01T06:30:00Z"))), "20320401T063000Z");
    }
}
