//! The sessions of a timeline as an iCalendar file (RFC 5545).
//!
//! Times are UTC. A session's event begins at the whole second before it and ends at the whole
//! second after it; its UID is the session's id, so a calendar that takes a new plan moves the
//! events it already has.
//!
//! Method: the crate `icalendar` folds and escapes.
//!
//! # Example
//! The plan of a day as a calendar, which the reader of blackouts takes back:
//! ```
//! use formats::{calendar, timeline::timeline};
//! use mission::{Mission, Override, occasions::read_calendar};
//! use planner::plan::{Revision, plan};
//! use planner::{progress::Quietly, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=1")?])?;
//! let world = World::open(mission, None)?;
//! let timeline = timeline(&world, &plan(&world, &Revision::default(), &Quietly)?, None)?;
//! let text = String::from_utf8(calendar::write(&timeline, world.start)?)?;
//! assert!(text.contains("UID:MFT-jupiter-000003@litebird.gyrfalcon\r\n"));
//! let events = read_calendar(&text)?;
//! assert_eq!(events.len(), timeline.sessions.len());
//! assert_eq!(events[0].summary, "MFT: jupiter");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::WriteError;
use crate::timeline::Timeline;
use ephem::time::format_utc;
use icalendar::{Calendar, Component, Event};
use onboard_core::time::{Duration, Instant};
use planner::provenance::PROGRAM;

const SECOND_NS: i64 = 1_000_000_000;

/// The sessions of a timeline as a calendar.
///
/// # Errors
/// [`WriteError::Refused`] where it cannot be written.
pub fn write(timeline: &Timeline, stamp: Instant) -> Result<Vec<u8>, WriteError> {
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
    let text: String = (&calendar).try_into().map_err(WriteError::refused)?;
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
    use ephem::time::parse_time;

    fn at(text: &str) -> Instant {
        parse_time(text).unwrap()
    }

    #[test]
    fn times_are_written_to_whole_seconds_outward() {
        let inside = at("2032-04-01T06:30:00.25Z");
        assert_eq!(basic(inside), "20320401T063000Z");
        assert_eq!(basic(up(inside)), "20320401T063001Z");
        assert_eq!(basic(up(at("2032-04-01T06:30:00Z"))), "20320401T063000Z");
    }
}
