//! Which part of the mission is looked at: `--from`, `--until`, and `--duration` after `--from`.
//!
//! A time without a scale is UTC, a date is its midnight; both are said. `+30d` counts from the mission's
//! start for `--from`, from there for `--until`. The clock of the mission's rotations is not moved.

use super::shared::SharedArgs;
use crate::failure::Failure;
use ephem::time::{TimeError, format_tdb, parse_time};
use mission::{quantity, rounding};
use onboard_core::time::Instant;

/// A part of the mission.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Window {
    /// Its first instant.
    pub from: Instant,
    /// Its last instant.
    pub until: Instant,
    /// How times were read that left something open.
    pub said: Vec<String>,
}

/// The window of the command line, where it names one, in a mission with this span.
///
/// # Errors
/// [`Failure::Input`] names the option, and what a time looks like.
pub fn window(
    shared: &SharedArgs,
    (start, end): (Instant, Instant),
) -> Result<Option<Window>, Failure> {
    if shared.from.is_none() && shared.until.is_none() {
        return Ok(None);
    }
    let mut said = Vec::new();
    let mut read = |option: &str, text: &Option<String>, zero, otherwise| match text {
        Some(text) => instant((option, text), zero, &mut said),
        None => Ok(otherwise),
    };
    let from = read("--from", &shared.from, start, start)?;
    let until = match &shared.duration {
        Some(duration) => after(("--duration", duration, duration), from)?,
        None => read("--until", &shared.until, from, end)?,
    };
    Ok(Some(Window { from, until, said }))
}

/// What a time looks like.
const NEED: &str = "a date such as 2033-05-01, a time such as 2033-05-01T12:00:00Z or \"2033-05-01T12:00:00 \
                    TDB\", or +30d is needed";

fn instant(
    (option, text): (&str, &str),
    zero: Instant,
    said: &mut Vec<String>,
) -> Result<Instant, Failure> {
    let trimmed = text.trim();
    if let Some(span) = trimmed.strip_prefix('+') {
        return after((option, text, span), zero);
    }
    let refused = |error: TimeError| Failure::Input(format!("{option}: {error}; {NEED}"));
    let is_date = !trimmed.contains(['T', 't', ' ']);
    let read = match parse_time(trimmed) {
        Err(_) if is_date => parse_time(&format!("{trimmed}T00:00:00Z")),
        Err(TimeError::NoScale(_)) => parse_time(&format!("{trimmed}Z")),
        other => return other.map_err(refused),
    };
    let at = read.map_err(refused)?;
    let tdb = format_tdb(at);
    said.push(format!("{option} {trimmed} names no time scale: read as UTC, {tdb} TDB"));
    Ok(at)
}

/// So long after an instant.
fn after((option, text, span): (&str, &str, &str), zero: Instant) -> Result<Instant, Failure> {
    let wrong = |what: String| Failure::Input(format!("{option} {text}: {what}"));
    let exact = quantity::seconds(span).map_err(|error| wrong(error.to_string()))?;
    let span = rounding::duration(&exact).ok_or_else(|| wrong(NEED.to_owned()))?;
    Ok(zero.plus(span))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Cli;
    use clap::Parser;
    use onboard_core::time::Duration;

    fn read(arguments: &str) -> Result<Option<Window>, String> {
        let words = std::iter::once("gyrfalcon").chain(arguments.split_whitespace());
        let cli = Cli::try_parse_from(words).map_err(|error| error.to_string())?;
        let start = parse_time("2032-04-01T00:00:00Z").map_err(|error| error.to_string())?;
        window(&cli.shared, (start, start.plus(days(100)))).map_err(|error| error.to_string())
    }

    fn days(count: i64) -> Duration {
        Duration::from_ns(count * 86_400_000_000_000)
    }

    #[test]
    fn windows_are_read_in_all_their_forms() {
        let start = parse_time("2032-04-01T00:00:00Z").unwrap();
        for arguments in [
            "plan --from 2032-04-11 --until 2032-04-21T00:00:00Z",
            "plan --from +10d --until +10d",
            "plan --from +10d --duration 10d",
            "plan --from 2032-04-11T00:00:00 --until 2032-04-21",
        ] {
            let found = read(arguments).unwrap().unwrap();
            let wanted = (start.plus(days(10)), start.plus(days(20)));
            assert_eq!((found.from, found.until), wanted, "{arguments}");
        }
        let rest = read("plan --from +40d").unwrap().unwrap();
        assert_eq!((rest.from, rest.until), (start.plus(days(40)), start.plus(days(100))));
        assert_eq!(read("plan --duration 10d"), Ok(None));
    }

    #[test]
    fn what_is_left_open_is_said() {
        let said = |arguments| read(arguments).unwrap().unwrap().said;
        assert_eq!(said("plan --from 2032-04-11T00:00:00Z"), [""; 0]);
        let sentence = &said("plan --from 2032-04-11")[0];
        assert!(sentence.contains("names no time scale: read as UTC, 2032-04-11T00:01:09"));
    }

    #[test]
    fn other_times_are_refused() {
        for (arguments, sentence) in [
            ("plan --from 2032-02-30", "day 30"),
            ("plan --from yesterday", "is needed"),
            ("plan --from +10", "has no unit"),
            ("plan --until 2032-04-11T25:00:00", "hour 25"),
            ("plan --from +1d --until +2d --duration 1d", "cannot be used with"),
        ] {
            let error = read(arguments).unwrap_err();
            assert!(error.contains(sentence), "{arguments}: {error}");
        }
    }
}
