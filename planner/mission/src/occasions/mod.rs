//! When may nothing be planned, and when is the ground in contact: the files that a mission's
//! schedule names.
//!
//! Contacts are a CSV with the header `start_utc, end_utc, bit_s`, blackouts one with `start_utc,
//! end_utc, reason` or an iCalendar file. Lines that begin with `#` are left out.
//!
//! Limits: contacts must not overlap; a blackout must touch the mission.
//!
//! # Example
//! A blackout as a calendar holds it:
//! ```
//! use mission::occasions::read_calendar;
//!
//! let text = "BEGIN:VCALENDAR\r\nBEGIN:VEVENT\r\nUID:1\r\nSUMMARY:Orbit correction\r\n\
//!     DTSTART:20320402T060000Z\r\nDTEND:20320402T080000Z\r\nEND:VEVENT\r\nEND:VCALENDAR\r\n";
//! let found = read_calendar(text)?;
//! assert_eq!(found[0].summary, "Orbit correction");
//! assert_eq!(found[0].until.since(found[0].from).seconds(), 7200.0);
//! # Ok::<(), mission::occasions::CalendarError>(())
//! ```

mod calendar;
mod error;
mod table;

pub use calendar::{CalendarError, EventError, Occasion, read as read_calendar};
pub use error::{OccasionError, OccasionFault};

use crate::file_path::FilePath;
use crate::mission::Mission;
use onboard_core::time::Instant;
use std::path::Path;
use table::{Row, rows, whole};

/// A time when nothing is allowed, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Blackout {
    /// Its start.
    pub from: Instant,
    /// Its end.
    pub until: Instant,
    /// Why.
    pub reason: String,
}

/// A time when data go to the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Contact {
    /// Its start.
    pub from: Instant,
    /// Its end.
    pub until: Instant,
    /// The rate, whole bits per second.
    pub bit_s: u64,
}

/// The ground contacts of a file that a mission names, by start.
///
/// # Errors
/// [`OccasionError`] names the file, the line and what is wrong.
pub fn contacts(mission: &Mission, file: &FilePath) -> Result<Vec<Contact>, OccasionError> {
    let path = mission.path(file);
    let mut contacts: Vec<Contact> = Vec::new();
    for Row { from, until, third: rate, line } in rows(&path, "bit_s")? {
        let legal = rate.parse::<f64>().ok().filter(|it| (0.0..=1e18).contains(it));
        let Some(rate) = legal else {
            return Err(OccasionFault::Rate { value: rate }.of(path, Some(line)));
        };
        if contacts.last().is_some_and(|last| from < last.until) {
            return Err(OccasionFault::Overlap { from }.of(path, Some(line)));
        }
        contacts.push(Contact { from, until, bit_s: whole(rate) });
    }
    Ok(contacts)
}

/// The blackouts of a mission from `start` to `end`, by start.
///
/// # Errors
/// [`OccasionError`] names the file, the line and what is wrong.
pub fn blackouts(
    mission: &Mission,
    (start, end): (Instant, Instant),
) -> Result<Vec<Blackout>, OccasionError> {
    let Some(file) = &mission.calibration.schedule.blackouts else { return Ok(Vec::new()) };
    let path = mission.path(file);
    let is_calendar = path.extension().is_some_and(|it| it.eq_ignore_ascii_case("ics"));
    // A calendar's events have no line of their own.
    let placed: Vec<(Blackout, Option<u64>)> = if is_calendar {
        events(&path)?.into_iter().map(|it| (it, None)).collect()
    } else {
        let blackout = |it: Row| {
            (Blackout { from: it.from, until: it.until, reason: it.third }, Some(it.line))
        };
        rows(&path, "reason")?.into_iter().map(blackout).collect()
    };
    let is_outside = |it: &Blackout| it.until <= start || it.from >= end;
    if let Some((outside, line)) = placed.iter().find(|it| is_outside(&it.0)) {
        let blackout = (outside.from, outside.until);
        let fault = OccasionFault::Outside { blackout, mission: (start, end) };
        return Err(fault.of(path, *line));
    }
    let mut all: Vec<Blackout> = placed.into_iter().map(|it| it.0).collect();
    all.sort_by(|a, b| (a.from, a.until, &a.reason).cmp(&(b.from, b.until, &b.reason)));
    Ok(all)
}

/// The events of an iCalendar file.
fn events(path: &Path) -> Result<Vec<Blackout>, OccasionError> {
    let events = calendar::read(&table::text_of(path)?)
        .map_err(|error| OccasionFault::Calendar(error).of(path, None))?;
    let blackout = |it: Occasion| Blackout { from: it.from, until: it.until, reason: it.summary };
    Ok(events.into_iter().map(blackout).collect())
}
