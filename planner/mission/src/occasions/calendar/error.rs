//! Why a calendar cannot be used, in sentences.

use ephem::time::{TimeError, format_utc};
use onboard_core::time::Instant;
use std::fmt;
use thiserror::Error;

/// Deepest nesting of components; calendars need three.
pub(super) const DEEPEST: usize = 16;
/// Most times that an event may take place.
pub(super) const MOST: usize = 200_000;

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
    /// A line that is no property.
    #[error("line {number}: '{text}' is not of the form NAME:VALUE")]
    Line {
        /// Its number.
        number: u64,
        /// The line.
        text: String,
    },
    /// The end of what did not begin.
    #[error("line {number}: END:{name} ends a component that is not open there")]
    End {
        /// Its number.
        number: u64,
        /// The component's name.
        name: String,
    },
    /// Components within components.
    #[error("line {number}: components are nested more than {DEEPEST} deep")]
    Nested {
        /// The line at which it is too deep.
        number: u64,
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
    /// No time, or one that belongs to no zone.
    NotUtc {
        /// The property.
        key: &'static str,
        /// The time as written.
        text: String,
    },
    /// A zone that is not known.
    Zone {
        /// The property.
        key: &'static str,
        /// The zone as written.
        zone: String,
    },
    /// A date or time of day that does not exist.
    Time {
        /// The property.
        key: &'static str,
        /// What is wrong with it.
        error: TimeError,
    },
    /// A duration that is none.
    Duration {
        /// The property.
        key: &'static str,
        /// The duration as written.
        text: String,
    },
    /// A rule that cannot be followed.
    Rule {
        /// The property.
        key: &'static str,
        /// The rule as written.
        rule: String,
        /// What the reader of rules said.
        reason: String,
    },
    /// It repeats too often.
    TooOften,
}

impl fmt::Display for EventError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotTaken { key } => write!(f, " has {key}, which is not taken"),
            Self::Missing { key } => write!(f, " has no {key}: it is needed"),
            Self::Reversed { from } => {
                write!(f, " from {} does not end after its start", format_utc(*from))
            }
            Self::NotUtc { key, text } => write!(
                f,
                ", {key}: {text} is not a time in UTC or a zone: YYYYMMDDTHHMMSSZ, YYYYMMDD, or TZID \
                 before YYYYMMDDTHHMMSS is needed"
            ),
            Self::Zone { key, zone } => write!(
                f,
                ", {key}: the zone {zone} is not known: a VTIMEZONE of that name, or a name such as \
                 Europe/Paris is needed"
            ),
            Self::Time { key, error } => write!(f, ", {key}: {error}"),
            Self::Duration { key, text } => {
                write!(f, ", {key}: {text} is not a duration such as PT1H30M, P2D or P1W")
            }
            Self::Rule { key, rule, reason } => write!(f, ", {key}:{rule}: {reason}"),
            Self::TooOften => {
                write!(f, " repeats more than {MOST} times: COUNT or UNTIL is needed")
            }
        }
    }
}
