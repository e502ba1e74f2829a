//! Dates, times and durations as iCalendar writes them [RFC 5545, section 3.3].

use chrono::{Datelike, Duration, NaiveDate, NaiveDateTime, NaiveTime};
use ephem::time::{Scale, TimeError, parse_in_scale, parse_time};
use onboard_core::time::Instant;

/// A time as written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Moment {
    /// A day.
    Day(NaiveDate),
    /// A time without scale.
    Local(NaiveDateTime),
    /// A time in UTC.
    Utc(NaiveDateTime),
}

/// A time as written; a date that does not exist is told as ephemerides tell it.
pub(super) fn civil(text: &str) -> Result<Moment, Option<TimeError>> {
    let digits = |from: usize, until: usize| {
        text.get(from..until).filter(|it| it.bytes().all(|b| b.is_ascii_digit())).ok_or(None)
    };
    let (year, month, day) = (digits(0, 4)?, digits(4, 6)?, digits(6, 8)?);
    let rest = text.get(8..).unwrap_or_default();
    let (clock, utc) = match rest.strip_suffix(['Z', 'z']) {
        Some(clock) => (clock, true),
        None => (rest, false),
    };
    let is_day = rest.is_empty();
    let is_time = clock.len() == 7 && clock.starts_with(['T', 't']);
    if !(is_day || is_time) {
        return Err(None);
    }
    let (hour, minute, second) = if is_day {
        ("00", "00", "00")
    } else {
        (digits(9, 11)?, digits(11, 13)?, digits(13, 15)?)
    };
    let number = |text: &str| text.parse::<u32>().unwrap_or(u32::MAX);
    let date = year
        .parse()
        .ok()
        .and_then(|year| NaiveDate::from_ymd_opt(year, number(month), number(day)));
    // A leap second is read as the second after it.
    let leap = second == "60";
    let time = NaiveTime::from_hms_opt(
        number(hour),
        number(minute),
        if leap { 59 } else { number(second) },
    );
    let (Some(date), Some(time)) = (date, time) else {
        let written = format!("{year}-{month}-{day}T{hour}:{minute}:{second} TAI");
        return Err(parse_time(&written).err());
    };
    if is_day {
        return Ok(Moment::Day(date));
    }
    let local = date.and_time(time) + Duration::seconds(leap.into());
    Ok(if utc { Moment::Utc(local) } else { Moment::Local(local) })
}

/// The instant of a time in UTC; years before 1972 without leap seconds, none after 2290.
pub(super) fn instant(utc: NaiveDateTime) -> Instant {
    let utc = if utc.year() < 2290 {
        utc
    } else {
        NaiveDate::from_ymd_opt(2290, 1, 1).map_or(utc, |it| it.and_time(NaiveTime::MIN))
    };
    let text = utc.format("%Y-%m-%dT%H:%M:%S").to_string();
    let scale = if utc.year() < 1972 { Scale::Tai } else { Scale::Utc };
    parse_in_scale(&text, scale).unwrap_or(Instant::from_tai_ns(i64::MIN / 2))
}

/// A duration: whole days by the calendar, and seconds.
pub(super) fn duration(text: &str) -> Option<(Duration, Duration)> {
    let text = text.trim().to_ascii_uppercase();
    let text = text.strip_prefix('+').unwrap_or(&text).strip_prefix('P')?;
    let (days, clock) = text.split_once('T').map_or((text, None), |it| (it.0, Some(it.1)));
    let days = sum(days, &[('W', 7 * 86_400), ('D', 86_400)])?;
    let clock = clock.map_or(Some(0), |it| sum(it, &[('H', 3600), ('M', 60), ('S', 1)]))?;
    let seconds = |count| Duration::try_seconds(count).filter(|it| it.num_days() < 100_000);
    Some((seconds(days)?, seconds(clock)?)).filter(|_| text.len() > 1)
}

/// The sum of counts with units behind them, in this order.
fn sum(text: &str, units: &[(char, i64)]) -> Option<i64> {
    let (mut rest, mut sum) = (text, 0_i64);
    for &(unit, seconds) in units {
        if let Some((count, after)) = rest.split_once(unit) {
            let digits = count.bytes().all(|it| it.is_ascii_digit());
            let count = count.parse::<i64>().ok().filter(|_| digits)?;
            sum = sum.checked_add(count.checked_mul(seconds)?)?;
            rest = after;
        }
    }
    rest.is_empty().then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_days_and_seconds() {
        let of = |text| duration(text).map(|(a, b)| (a.num_days(), b.num_seconds()));
        for (text, expected) in [
            ("P7W", Some((49, 0))),
            ("p15dt5h0m20s", Some((15, 18_020))),
            ("+PT1H30M", Some((0, 5400))),
            ("P1D", Some((1, 0))),
            ("PT", None),
            ("P", None),
            ("-PT1H", None),
            ("PT1X", None),
            ("PT1.5H", None),
            ("1H", None),
            ("P99999999999999999D", None),
        ] {
            assert_eq!(of(text), expected, "{text}");
        }
    }
}
