//! Which events does an iCalendar file hold (RFC 5545).
//!
//! Times are taken to UTC; a whole day is one of UTC. Events (`VEVENT`) and busy times (`VFREEBUSY`)
//! of all calendars of the file are read; what is cancelled, transparent or takes no time is counted
//! and left out.
//!
//! Method: [`lines`] unfolds; the crate `icalendar` reads components and unescapes; `rrule` follows
//! rules; zones are those of the file, of the tz database, or of Windows. What it means is decided
//! here.
//!
//! Limits: a time without a zone is refused, unless the calendar names one (`X-WR-TIMEZONE`); so is a
//! changed instance that stands for all later ones too (`RANGE`).

mod error;
mod lines;
mod moment;
mod repeat;
mod zone;
mod placed;
mod event;

pub use error::{CalendarError, EventError};
pub use event::Occasion;

use chrono::{NaiveDate, NaiveDateTime, NaiveTime};
use event::{Event, Seen, busy};
use icalendar::parser::{Component, read_components};
use lines::Lines;
use onboard_core::time::Instant;
use zone::{Zone, Zones};

/// What a calendar holds.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Calendar {
    /// Its events, in the order of the file; one that repeats stands there each time.
    pub occasions: Vec<Occasion>,
    /// Events that are cancelled.
    pub cancelled: usize,
    /// Events that leave their time free.
    pub transparent: usize,
    /// Events that take no time.
    pub momentary: usize,
    /// Numbers of malformed lines that are left out.
    pub malformed: Vec<u64>,
}

/// The events of a file's text, in its order.
///
/// # Errors
/// A sentence that says which event cannot be used and what would be legal; one that repeats without
/// an end is refused.
pub fn read(text: impl AsRef<[u8]>) -> Result<Vec<Occasion>, CalendarError> {
    read_until(text.as_ref(), end_of_time()).map(|it| it.occasions)
}

/// What a file holds, rules followed up to an instant.
///
/// # Errors
/// As [`read`].
pub(super) fn read_to(bytes: &[u8], end: Instant) -> Result<Calendar, CalendarError> {
    let text = ephem::time::format_utc(end);
    let end =
        NaiveDateTime::parse_from_str(text.get(..19).unwrap_or_default(), "%Y-%m-%dT%H:%M:%S");
    read_until(bytes, end.unwrap_or_else(|_| end_of_time()))
}

fn end_of_time() -> NaiveDateTime {
    NaiveDate::from_ymd_opt(2290, 1, 1).unwrap_or(NaiveDate::MAX).and_time(NaiveTime::MIN)
}

fn read_until(bytes: &[u8], end: NaiveDateTime) -> Result<Calendar, CalendarError> {
    let lines = Lines::of(bytes)?;
    let mut roots = Vec::new();
    for text in &lines.texts {
        roots.extend(read_components(text).map_err(|_| CalendarError::NotACalendar)?);
    }
    // Clocks differ from UTC by less than two days.
    let end = end + chrono::Duration::days(2);
    let mut zones = Zones::default();
    each(&roots, &mut |it| {
        if it.name.as_str() == "VTIMEZONE" {
            zones.take(it, end);
        }
    });
    let mut found = Calendar { malformed: lines.malformed, ..Calendar::default() };
    for root in &roots {
        let own = root.find_prop("X-WR-TIMEZONE").and_then(|it| zones.find(it.val.as_str()));
        read_calendar(root, (&zones, own.as_ref()), end, &mut found)?;
    }
    Ok(found)
}

/// One calendar's events, in order.
fn read_calendar(
    root: &Component<'_>,
    zones: (&Zones, Option<&Zone>),
    end: NaiveDateTime,
    found: &mut Calendar,
) -> Result<(), CalendarError> {
    let mut components = Vec::new();
    each(&root.components, &mut |it| components.push(it));
    let events: Vec<Event<'_>> = components
        .iter()
        .copied()
        .filter(|it| it.name.as_str() == "VEVENT")
        .map(|it| Event::of(it, zones))
        .collect::<Result<_, _>>()?;
    // An instance that is changed takes the place of the one that the rule gives.
    let replaced: Vec<(&str, NaiveDateTime)> =
        events.iter().filter_map(|it| Some((it.uid?, it.replaces?))).collect();
    let mut events = events.iter();
    for component in components {
        match component.name.as_str() {
            "VFREEBUSY" => found.occasions.extend(busy(component)?),
            "VEVENT" => {
                let Some(event) = events.next() else { continue };
                match event.seen(end, &replaced)? {
                    Seen::Cancelled => found.cancelled += 1,
                    Seen::Transparent => found.transparent += 1,
                    Seen::Momentary => found.momentary += 1,
                    Seen::At(occasions) => found.occasions.extend(occasions),
                }
            }
            _ => {}
        }
    }
    Ok(())
}

/// Components, also those of calendars within.
fn each<'c>(components: &'c [Component<'c>], see: &mut impl FnMut(&'c Component<'c>)) {
    for component in components {
        see(component);
        if component.name.as_str() == "VCALENDAR" {
            each(&component.components, see);
        }
    }
}

#[cfg(test)]
mod tests;
