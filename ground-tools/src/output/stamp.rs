//! When do the files of a plan say that they were made.
//!
//! What was asked for, else `SOURCE_DATE_EPOCH` (seconds of Unix time, as reproducible builds set
//! it), else the mission's start: never the clock, so that equal inputs give equal bytes.

use crate::cli::quantities::instant;
use crate::failure::Failure;
use ephem::time::utc_midnight;
use onboard_core::time::{Duration, Instant};

/// Days from 1970-01-01 to 2000-01-01.
const DAYS_TO_2000: i64 = 10_957;
const DAY_S: i64 = 86_400;
/// 2290-01-01, as Unix time.
const LAST_S: i64 = 10_098_086_400;

/// The instant, out of `--stamp`, the environment and the mission's start.
///
/// # Errors
/// [`Failure::Input`] names the option or the variable and what is needed.
pub fn stamp(asked: Option<&str>, start: Instant) -> Result<Instant, Failure> {
    chosen(asked, std::env::var("SOURCE_DATE_EPOCH").ok().as_deref(), start)
}

/// The same with the variable's value.
fn chosen(asked: Option<&str>, variable: Option<&str>, start: Instant) -> Result<Instant, Failure> {
    if let Some(text) = asked {
        return instant("--stamp", text);
    }
    let Some(text) = variable else { return Ok(start) };
    let seconds = text.parse::<i64>().ok().filter(|it| (0..LAST_S).contains(it));
    let seconds = seconds.ok_or_else(|| {
        Failure::Input(format!(
            "SOURCE_DATE_EPOCH is '{text}': whole seconds since 1970-01-01 from 0 to {LAST_S} are \
             needed (or --stamp, which goes first)"
        ))
    })?;
    let within = Duration::from_ns(seconds % DAY_S * 1_000_000_000);
    Ok(utc_midnight(seconds / DAY_S - DAYS_TO_2000).plus(within))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ephem::time::format_utc;

    #[test]
    fn the_option_goes_first_then_the_variable_then_the_start() {
        let start = Instant::from_tai_ns(1_000_000_000_000_000_000);
        let text = |asked, variable| chosen(asked, variable, start).map(format_utc);
        // date -u -d @1798761600
        assert_eq!(text(None, Some("1798761600")).unwrap(), "2027-01-01T00:00:00.000000000Z");
        assert_eq!(
            text(Some("2031-01-01T00:00:00Z"), Some("x")).unwrap(),
            "2031-01-01T00:00:00.000000000Z"
        );
        assert_eq!(chosen(None, None, start).unwrap(), start);
        for bad in ["", "x", "-1", "1e9", "99999999999"] {
            assert!(text(None, Some(bad)).unwrap_err().to_string().contains("SOURCE_DATE_EPOCH"));
        }
        let error = text(Some("2031-01-01"), None).unwrap_err().to_string();
        assert!(error.starts_with("--stamp: ") && error.contains("time scale"), "{error}");
    }
}
