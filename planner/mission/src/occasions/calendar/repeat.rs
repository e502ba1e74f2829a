//! When does an event that repeats take place.
//!
//! Method: rules are followed by the crate `rrule` on the clock of the event's zone; each time is then
//! taken to UTC by itself, so that a rule keeps its hour across a change of the clocks.
//!
//! Limits: 200,000 times; RSCALE and SKIP (RFC 7529) are refused by the crate.

use super::error::{EventError, MOST};
use chrono::{NaiveDateTime, TimeZone};
use rrule::{RRule, RRuleSet, Tz, Unvalidated};

/// The times of a rule from its start to `end`, on the zone's clock; `local` takes UTC there.
pub(super) fn instances(
    start: NaiveDateTime,
    rule: &str,
    end: NaiveDateTime,
    local: impl Fn(NaiveDateTime) -> NaiveDateTime,
) -> Result<Vec<NaiveDateTime>, EventError> {
    let refuse = |reason: String| EventError::Rule { key: "RRULE", rule: rule.to_owned(), reason };
    let rule_on_clock = until_on_clock(rule, local);
    let on_clock = Tz::UTC.from_utc_datetime(&start);
    let parsed: RRule<Unvalidated> =
        rule_on_clock.parse().map_err(|error: rrule::RRuleError| refuse(error.to_string()))?;
    let valid = parsed.validate(on_clock).map_err(|error| refuse(error.to_string()))?;
    let mut times = Vec::new();
    for time in &RRuleSet::new(on_clock).rrule(valid).limit() {
        let time = time.naive_utc();
        if time > end {
            break;
        }
        if times.len() == MOST {
            return Err(EventError::TooOften);
        }
        times.push(time);
    }
    Ok(times)
}

/// The rule with its last time on the zone's clock; a date there is its whole day.
fn until_on_clock(rule: &str, local: impl Fn(NaiveDateTime) -> NaiveDateTime) -> String {
    let part = |part: &str| {
        let Some((key, value)) = part.split_once('=') else { return part.to_owned() };
        let key = key.trim().to_ascii_uppercase();
        let value = value.trim().to_ascii_uppercase();
        if key != "UNTIL" {
            return format!("{key}={value}");
        }
        let until = match value.strip_suffix('Z') {
            Some(clock) => NaiveDateTime::parse_from_str(clock, "%Y%m%dT%H%M%S").map(&local),
            None if value.len() == 8 => {
                NaiveDateTime::parse_from_str(&format!("{value}T235959"), "%Y%m%dT%H%M%S")
            }
            None => NaiveDateTime::parse_from_str(&value, "%Y%m%dT%H%M%S"),
        };
        match until {
            Ok(until) => format!("{key}={}", until.format("%Y%m%dT%H%M%SZ")),
            Err(_) => format!("{key}={value}"),
        }
    };
    let parts = rule.trim().split(';').filter(|it| !it.trim().is_empty());
    parts.map(part).collect::<Vec<_>>().join(";")
}
