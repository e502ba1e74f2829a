//! Times as ISO 8601 text.
//!
//! Read: `YYYY-MM-DDThh:mm:ss[.fraction]`, or `YYYY-DDDT...` by day of the year, then ` TDB`,
//! ` TAI`, ` TT`, ` UTC` or `Z`; letters in any case. Written: always nine decimals, `Z` after UTC,
//! no suffix after TDB.
//!
//! Method: decimals are read as digits, so that nine places are exact; more are rounded to the ns.

use super::calendar::{NS_PER_DAY, civil_from_day, day_from_civil};
use super::decimals::rounded_ns;
use super::scale::Scale;
use super::tdb::{TT_MINUS_TAI_NS, from_tdb_ns, tdb_ns};
use super::utc::{ends_with_leap_second, first_day, last_leap_second, utc_day, utc_midnight};
use onboard_core::time::{Duration, Instant, NS_PER_SECOND};
use thiserror::Error;

/// Why a text is not a time.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum TimeError {
    /// No time scale is named.
    #[error(
        "time '{0}' names no time scale: write one after it, as in '2032-04-01T00:00:00 TDB' (TDB, TAI, TT or UTC), or end it with Z for UTC"
    )]
    NoScale(String),
    /// The time scale is not one of those known.
    #[error("time '{text}' has the unknown time scale '{scale}': legal are TDB, TAI, TT, UTC")]
    UnknownScale {
        /// The whole text.
        text: String,
        /// The scale in it.
        scale: String,
    },
    /// Not of the form of a date and time.
    #[error(
        "time '{0}' is not of the form YYYY-MM-DDThh:mm:ss with or without decimals (or YYYY-DDDThh:mm:ss)"
    )]
    Form(String),
    /// Hours and minutes alone.
    #[error("time '{0}' has no seconds: hh:mm:ss is needed")]
    NoSeconds(String),
    /// A field lies outside its range.
    #[error("time '{text}' has {field} {value}: legal is {first} to {last}")]
    Field {
        /// The whole text.
        text: String,
        /// Which field.
        field: &'static str,
        /// Its value.
        value: i64,
        /// Smallest legal value.
        first: i64,
        /// Largest legal value.
        last: i64,
    },
    /// A second 60 where no leap second is known.
    #[error(
        "time '{text}' has second 60, but no leap second is known there (the last ends {last})"
    )]
    NoLeapSecond {
        /// The whole text.
        text: String,
        /// Date that the last leap second ends.
        last: String,
    },
    /// UTC before its integer leap seconds.
    #[error("time '{0}' is UTC before 1972-01-01, where leap seconds are not defined")]
    BeforeUtc(String),
}

/// The instant that a text names; it must name its scale.
///
/// # Errors
/// [`TimeError`], quoting the text.
pub fn parse_time(text: &str) -> Result<Instant, TimeError> {
    let trimmed = text.trim();
    if let Some(bare) = trimmed.strip_suffix(['Z', 'z']) {
        return parse_in_scale(bare, Scale::Utc);
    }
    let Some((bare, scale)) = trimmed.rsplit_once(char::is_whitespace) else {
        return Err(TimeError::NoScale(text.to_owned()));
    };
    let scale = Scale::from_name(scale).ok_or_else(|| TimeError::UnknownScale {
        text: text.to_owned(),
        scale: scale.to_owned(),
    })?;
    parse_in_scale(bare.trim_end(), scale)
}

/// A calendar time, read but not yet on a scale.
struct Civil {
    /// Day from 0 on 2000-01-01.
    day: i64,
    /// Whole seconds since midnight, up to 86400 in a leap second.
    second_of_day: i64,
    /// ns since then, up to a whole second where decimals are rounded up.
    nanosecond: i64,
    leap: bool,
}

/// The instant of a date and time without suffix, on a scale known from elsewhere.
///
/// # Errors
/// [`TimeError`], quoting the text.
pub fn parse_in_scale(text: &str, scale: Scale) -> Result<Instant, TimeError> {
    let civil = read_civil(text)?;
    let no_leap = || TimeError::NoLeapSecond { text: text.to_owned(), last: last_leap_second() };
    if civil.leap && scale != Scale::Utc {
        return Err(no_leap());
    }
    let within = civil.second_of_day * NS_PER_SECOND + civil.nanosecond;
    if scale == Scale::Utc {
        if civil.day < first_day() {
            return Err(TimeError::BeforeUtc(text.to_owned()));
        }
        if civil.leap && !ends_with_leap_second(civil.day) {
            return Err(no_leap());
        }
        return Ok(utc_midnight(civil.day).plus(Duration::from_ns(within)));
    }
    let ns = civil.day * NS_PER_DAY + within - NS_PER_DAY / 2;
    Ok(match scale {
        Scale::Tdb => from_tdb_ns(ns),
        Scale::Tt => Instant::from_tai_ns(ns - TT_MINUS_TAI_NS),
        Scale::Tai | Scale::Utc => Instant::from_tai_ns(ns),
    })
}

fn read_civil(text: &str) -> Result<Civil, TimeError> {
    let form = || TimeError::Form(text.to_owned());
    let check = |field, value: i64, first, last| {
        if (first..=last).contains(&value) {
            Ok(value)
        } else {
            Err(TimeError::Field { text: text.to_owned(), field, value, first, last })
        }
    };
    let (date, time) = text.split_once(['T', 't']).ok_or_else(form)?;
    let mut dates = date.split('-');
    let year = digits(dates.next(), 4).ok_or_else(form)?;
    let year = check("year", year, 1709, 2290)?;
    let (second_field, third_field) = (dates.next(), dates.next());
    if dates.next().is_some() {
        return Err(form());
    }
    let day = if third_field.is_some() {
        let month = check("month", digits(second_field, 2).ok_or_else(form)?, 1, 12)?;
        let day = digits(third_field, 2).ok_or_else(form)?;
        let first = day_from_civil(year, month, 1);
        let next = day_from_civil(year + month / 12, month % 12 + 1, 1);
        first + check("day", day, 1, next - first)? - 1
    } else {
        let of_year = digits(second_field, 3).ok_or_else(form)?;
        let first = day_from_civil(year, 1, 1);
        first + check("day of the year", of_year, 1, day_from_civil(year + 1, 1, 1) - first)? - 1
    };
    let mut times = time.split(':');
    let hour = check("hour", digits(times.next(), 2).ok_or_else(form)?, 0, 23)?;
    let minute = check("minute", digits(times.next(), 2).ok_or_else(form)?, 0, 59)?;
    let seconds = times.next().ok_or_else(|| TimeError::NoSeconds(text.to_owned()))?;
    if times.next().is_some() {
        return Err(form());
    }
    let (whole, fraction) = seconds.split_once('.').unwrap_or((seconds, "0"));
    let last = if (hour, minute) == (23, 59) { 60 } else { 59 };
    let second = check("second", digits(Some(whole), 2).ok_or_else(form)?, 0, last)?;
    Ok(Civil {
        day,
        second_of_day: (hour * 60 + minute) * 60 + second,
        nanosecond: rounded_ns(fraction).ok_or_else(form)?,
        leap: second == 60,
    })
}

/// Exactly `count` decimal digits as a number.
fn digits(field: Option<&str>, count: usize) -> Option<i64> {
    let field = field?;
    let legal = field.len() == count && field.bytes().all(|byte| byte.is_ascii_digit());
    if legal { field.parse().ok() } else { None }
}

/// The TDB of an instant, `YYYY-MM-DDThh:mm:ss.nnnnnnnnn`.
#[must_use]
pub fn format_tdb(at: Instant) -> String {
    let since_midnight = tdb_ns(at).saturating_add(NS_PER_DAY / 2);
    written(since_midnight.div_euclid(NS_PER_DAY), since_midnight.rem_euclid(NS_PER_DAY), "")
}

/// The UTC of an instant, `YYYY-MM-DDThh:mm:ss.nnnnnnnnnZ`; second 60 in a leap second.
#[must_use]
pub fn format_utc(at: Instant) -> String {
    let day = utc_day(at);
    written(day, at.since(utc_midnight(day)).ns(), "Z")
}

fn written(day: i64, ns: i64, suffix: &str) -> String {
    let (year, month, day) = civil_from_day(day);
    let (seconds, ns) = (ns / NS_PER_SECOND, ns % NS_PER_SECOND);
    // In a leap second the day's second 86400 is 23:59:60.
    let minutes = (seconds / 60).min(1439);
    let mut text = String::with_capacity(30);
    let fields = [
        (year, 4, '-'),
        (month, 2, '-'),
        (day, 2, 'T'),
        (minutes / 60, 2, ':'),
        (minutes % 60, 2, ':'),
        (seconds - minutes * 60, 2, '.'),
    ];
    for (value, width, end) in fields {
        push_digits(&mut text, value, width);
        text.push(end);
    }
    push_digits(&mut text, ns, 9);
    text.push_str(suffix);
    text
}

fn push_digits(text: &mut String, value: i64, width: u32) {
    let mut unit = 10_i64.pow(width - 1);
    while unit > 0 {
        let digit = u8::try_from(value / unit % 10).unwrap_or(0);
        text.push(char::from(b'0' + digit));
        unit /= 10;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ns(text: &str) -> i64 {
        parse_time(text).unwrap().tai_ns()
    }

    #[test]
    fn scales_differ_as_they_should() {
        assert_eq!(ns("2000-01-01T12:00:00 TAI"), 0);
        assert_eq!(ns("2000-01-01T12:00:32.184 TT"), 0);
        assert_eq!(ns("2000-01-01T11:59:28Z"), 0);
        assert_eq!(ns("2000-01-01T11:59:28.000000001 UTC"), 1);
        // TDB - TT stays below 1.7 ms.
        assert!(ns("2000-01-01T12:00:32.184 TDB").abs() < 1_700_000);
        assert_eq!(ns("2000-061T00:00:00 TAI"), ns("2000-03-01T00:00:00 TAI"));
    }

    #[test]
    fn leap_seconds_come_back() {
        for text in [
            "2016-12-31T23:59:59.999999999Z",
            "2016-12-31T23:59:60.000000000Z",
            "2016-12-31T23:59:60.999999999Z",
            "2017-01-01T00:00:00.000000000Z",
            "2017-01-01T00:00:36.500000000Z",
            "1972-06-30T23:59:60.000000000Z",
        ] {
            assert_eq!(format_utc(parse_time(text).unwrap()), text);
        }
        assert_eq!(ns("2016-12-31T23:59:60Z") + NS_PER_SECOND, ns("2017-01-01T00:00:00Z"));
        assert_eq!(ns("2016-12-31T23:59:59Z") + NS_PER_SECOND, ns("2016-12-31T23:59:60Z"));
    }

    #[test]
    fn refusals_say_why() {
        let said = |text: &str| parse_time(text).unwrap_err().to_string();
        assert!(said("2032-04-01T00:00:00").contains("names no time scale"));
        assert!(said("2032-04-01T00:00:00 GPS").contains("'GPS': legal are TDB, TAI, TT, UTC"));
        assert!(said("2032-04-31T00:00:00 TDB").contains("day 31: legal is 1 to 30"));
        assert!(said("2031-366T00:00:00 TDB").contains("day of the year 366"));
        assert!(said("2032-13-01T00:00:00 TDB").contains("month 13: legal is 1 to 12"));
        assert!(said("2032-12-01T24:00:00 TDB").contains("hour 24: legal is 0 to 23"));
        assert!(said("2032-12-01T12:00:60Z").contains("second 60: legal is 0 to 59"));
        assert!(said("2032-12-31T23:59:60Z").contains("the last ends 2016-12-31"));
        assert!(said("2016-12-31T23:59:60 TAI").contains("no leap second"));
        assert!(said("2032-04-01T00:00 TDB").contains("has no seconds: hh:mm:ss"));
        assert!(said("1960-01-01T00:00:00Z").contains("before 1972"));
        assert!(said("0001-01-01T00:00:00 TDB").contains("year 1: legal is 1709 to 2290"));
        for text in [
            "2032-4-1T00:00:00 TDB",
            "2032-04-01 TDB",
            "2032-04-01T00:00:00. TDB",
            "2032-04-01T00:00:00.00000000o1 TDB",
            "2032-04-01T-1:00:00 TDB",
            "+032-04-01T00:00:00 TDB",
            "2032-04-01T00:00:00é TDB",
            "nan TDB",
            "Z",
        ] {
            assert!(said(text).contains("not of the form"), "{text}");
        }
        assert_eq!(ns("2032-04-01T00:00:00.0000000000 TAI"), ns("2032-04-01T00:00:00 TAI"));
    }

    #[test]
    fn decimals_beyond_the_ninth_are_rounded() {
        for (text, rounded) in [
            ("2032-04-01T00:01:09.1856655959 TDB", "2032-04-01T00:01:09.185665596 TDB"),
            ("2032-092T00:01:09.18566559549 TAI", "2032-04-01T00:01:09.185665595 TAI"),
            ("2032-04-01T00:00:00.0000000005 TT", "2032-04-01T00:00:00.000000001 TT"),
            ("2031-12-31T23:59:59.9999999999 TDB", "2032-01-01T00:00:00 TDB"),
            ("2016-12-31T23:59:59.9999999999Z", "2016-12-31T23:59:60Z"),
            ("2016-12-31T23:59:60.9999999999Z", "2017-01-01T00:00:00Z"),
        ] {
            assert_eq!(ns(text), ns(rounded), "{text}");
        }
    }

    #[test]
    fn letters_may_be_small() {
        assert_eq!(ns("2032-04-01t00:00:00 tdb"), ns("2032-04-01T00:00:00 TDB"));
        assert_eq!(ns("2032-092t00:00:00z"), ns("2032-04-01T00:00:00 UTC"));
    }

    proptest! {
        #[test]
        fn text_comes_back(ns in -880_000_000_000_000_000..9_000_000_000_000_000_000_i64) {
            let at = Instant::from_tai_ns(ns);
            prop_assert_eq!(parse_time(&format_utc(at)).unwrap(), at);
            let tdb = format!("{} TDB", format_tdb(at));
            prop_assert_eq!(parse_time(&tdb).unwrap(), at);
        }
    }
}
