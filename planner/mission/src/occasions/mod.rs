//! When may nothing be planned, and when is the ground in contact: the files that a mission's
//! schedule names.
//!
//! Contacts are a CSV with the header `start_utc, end_utc, bit_s`, blackouts one with `start_utc,
//! end_utc, reason` or an iCalendar file. Lines that begin with `#` are left out.
//!
//! Limits: of contacts that overlap the faster one counts. A blackout outside the mission is left out and counted, see
//! [`Blackouts`].
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

pub use calendar::{Calendar, CalendarError, EventError, Occasion, read as read_calendar};
pub use error::{OccasionError, OccasionFault};

use crate::file_path::FilePath;
use crate::mission::Mission;
use onboard_core::time::Instant;
use std::collections::BTreeMap;
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
/// Where contacts overlap, as when one station hands over to another, the faster one counts.
///
/// # Errors
/// [`OccasionError`] names the file, the line and what is wrong; one without a contact that takes data
/// is refused, since memory could never be emptied.
pub fn contacts(mission: &Mission, file: &FilePath) -> Result<Vec<Contact>, OccasionError> {
    let path = mission.path(file);
    let mut contacts: Vec<Contact> = Vec::new();
    for Row { from, until, third: rate, line } in rows(&path, "bit_s")? {
        let legal = rate.parse::<f64>().ok().filter(|it| (0.0..=1e18).contains(it));
        let Some(rate) = legal else {
            return Err(OccasionFault::Rate { value: rate }.of(path, Some(line)));
        };
        contacts.push(Contact { from, until, bit_s: whole(rate) });
    }
    if contacts.iter().all(|it| it.bit_s == 0) {
        return Err(OccasionFault::NoContact.of(path, None));
    }
    Ok(apart(&contacts))
}

/// The same without overlaps, by start.
fn apart(contacts: &[Contact]) -> Vec<Contact> {
    let overlap = contacts.windows(2).any(|pair| matches!(pair, [a, b] if b.from < a.until));
    if !overlap {
        return contacts.to_vec();
    }
    let mut edges: Vec<(Instant, bool, u64)> = contacts
        .iter()
        .flat_map(|it| [(it.from, true, it.bit_s), (it.until, false, it.bit_s)])
        .collect();
    edges.sort_unstable();
    let mut open: BTreeMap<u64, usize> = BTreeMap::new();
    let mut parts: Vec<Contact> = Vec::new();
    let mut from = None;
    for (at, begins, bit_s) in edges {
        let fastest = open.last_key_value().map(|it| *it.0);
        if let (Some(from), Some(fastest)) = (from, fastest)
            && from < at
        {
            match parts.last_mut() {
                Some(last) if last.until == from && last.bit_s == fastest => last.until = at,
                _ => parts.push(Contact { from, until: at, bit_s: fastest }),
            }
        }
        from = Some(at);
        let count = open.entry(bit_s).or_default();
        *count = if begins { *count + 1 } else { count.saturating_sub(1) };
        if *count == 0 {
            open.remove(&bit_s);
        }
    }
    parts
}

/// The blackouts of a mission, and what its file holds beside them.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Blackouts {
    /// Those that touch the mission, by start.
    pub within: Vec<Blackout>,
    /// How many lie outside the mission.
    pub outside: usize,
    /// What a calendar holds beside its events; these have moved to `within`.
    pub calendar: Calendar,
}

impl Blackouts {
    /// Those of a mission from `start` to `end`.
    ///
    /// # Errors
    /// [`OccasionError`] names the file, the line and what is wrong.
    pub fn read(
        mission: &Mission,
        (start, end): (Instant, Instant),
    ) -> Result<Self, OccasionError> {
        let Some(file) = &mission.calibration.schedule.blackouts else {
            return Ok(Self::default());
        };
        let path = mission.path(file);
        let is_calendar = path.extension().is_some_and(|it| it.eq_ignore_ascii_case("ics"));
        let mut calendar = Calendar::default();
        let mut within: Vec<Blackout> = if is_calendar {
            calendar = calendar::read_to(&table::bytes_of(&path)?, end)
                .map_err(|error| OccasionFault::Calendar(error).of(&path, None))?;
            let blackout =
                |it: Occasion| Blackout { from: it.from, until: it.until, reason: it.summary };
            calendar.occasions.drain(..).map(blackout).collect()
        } else {
            let blackout = |it: Row| Blackout { from: it.from, until: it.until, reason: it.third };
            rows(&path, "reason")?.into_iter().map(blackout).collect()
        };
        let all = within.len();
        within.retain(|it| it.until > start && it.from < end);
        within.sort_by(|a, b| (a.from, a.until, &a.reason).cmp(&(b.from, b.until, &b.reason)));
        Ok(Self { outside: all - within.len(), within, calendar })
    }

    /// What is left out, in a sentence each.
    #[must_use]
    pub fn left_out(&self) -> Vec<String> {
        let Calendar { cancelled, transparent, momentary, malformed, .. } = &self.calendar;
        let mut said: Vec<String> = [
            (self.outside, "lie outside the mission"),
            (*cancelled, "are cancelled"),
            (*transparent, "leave their time free (TRANSP:TRANSPARENT)"),
            (*momentary, "take no time"),
        ]
        .into_iter()
        .filter(|it| it.0 > 0)
        .map(|(count, why)| format!("blackouts left out because they {why}: {count}"))
        .collect();
        let lines: Vec<String> = malformed.iter().take(10).map(u64::to_string).collect();
        if !lines.is_empty() {
            let more = malformed.len() - lines.len();
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            said.push(format!(
                "malformed lines of the calendar left out: {}{more}",
                lines.join(", ")
            ));
        }
        said
    }
}

/// The blackouts of a mission from `start` to `end`, by start; what lies outside is left out.
///
/// # Errors
/// [`OccasionError`] names the file, the line and what is wrong.
pub fn blackouts(
    mission: &Mission,
    span: (Instant, Instant),
) -> Result<Vec<Blackout>, OccasionError> {
    Blackouts::read(mission, span).map(|it| it.within)
}
