//! Which UTC day is it, and where do leap seconds lie.
//!
//! Days are numbered from 0 on 2000-01-01. A day's midnight in TAI is 86400 s times its number,
//! plus TAI - UTC of that day, less half a day for the zero at noon.

use super::calendar::{NS_PER_DAY, civil_from_day};
use crate::convert::i64_from_f64;
use hifitime::leap_seconds::LatestLeapSeconds;
use onboard_core::time::{Instant, NS_PER_SECOND};
use std::sync::LazyLock;

/// Days from 1900-01-01, hifitime's zero, to 2000-01-01.
const DAYS_1900_TO_2000: i64 = 36_524;

/// The first day of each value of TAI - UTC, and the value in seconds, by day.
static OFFSETS: LazyLock<Vec<(i64, i64)>> = LazyLock::new(|| {
    LatestLeapSeconds::default()
        .filter(|leap| leap.announced_by_iers)
        .map(|leap| {
            let day = i64_from_f64(leap.timestamp_tai_s / 86_400.0) - DAYS_1900_TO_2000;
            (day, i64_from_f64(leap.delta_at))
        })
        .collect()
});

/// TAI - UTC in seconds on a UTC day.
fn offset_s(day: i64) -> i64 {
    let after = OFFSETS.partition_point(|&(first, _)| first <= day);
    OFFSETS.get(after.saturating_sub(1)).map_or(10, |&(_, offset)| offset)
}

/// The first UTC day with integer leap seconds, 1972-01-01.
pub(super) fn first_day() -> i64 {
    OFFSETS.first().map_or(i64::MIN, |&(day, _)| day)
}

/// Whether a leap second ends this UTC day.
pub(super) fn ends_with_leap_second(day: i64) -> bool {
    offset_s(day) < offset_s(day.saturating_add(1)) && day >= first_day()
}

/// The start of UTC day `day`, counted from 0 on 2000-01-01; saturates beyond 292 years.
#[must_use]
pub fn utc_midnight(day: i64) -> Instant {
    Instant::from_tai_ns(
        day.saturating_mul(NS_PER_DAY)
            .saturating_add(offset_s(day) * NS_PER_SECOND)
            .saturating_sub(NS_PER_DAY / 2),
    )
}

/// The UTC day that holds an instant, counted from 0 on 2000-01-01; its leap second included.
#[must_use]
pub fn utc_day(at: Instant) -> i64 {
    // No offset is negative or reaches a day, so the day by TAI is right or one too late.
    let by_tai = at.tai_ns().saturating_add(NS_PER_DAY / 2).div_euclid(NS_PER_DAY);
    if utc_midnight(by_tai) <= at { by_tai } else { by_tai - 1 }
}

/// The date, `YYYY-MM-DD`, that the last leap second known ends.
#[must_use]
pub fn last_leap_second() -> String {
    let day = OFFSETS.last().map_or(0, |&(day, _)| day - 1);
    let (year, month, day) = civil_from_day(day);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leap_second_belongs_to_the_day_it_ends() {
        // 2016-12-31 is day 6209; it lasts 86401 s.
        let (start, end) = (utc_midnight(6209), utc_midnight(6210));
        assert_eq!(end.since(start).ns(), NS_PER_DAY + NS_PER_SECOND);
        assert!(ends_with_leap_second(6209) && !ends_with_leap_second(6210));
        assert_eq!(utc_day(start), 6209);
        assert_eq!(utc_day(Instant::from_tai_ns(start.tai_ns() - 1)), 6208);
        assert_eq!(utc_day(Instant::from_tai_ns(end.tai_ns() - 1)), 6209);
        assert_eq!(utc_day(end), 6210);
        assert_eq!(last_leap_second(), "2016-12-31");
    }

    #[test]
    fn offsets_stand_at_known_dates() {
        assert_eq!((offset_s(-10_227), offset_s(0), offset_s(6210)), (10, 32, 37));
        assert_eq!(first_day(), -10_227);
        assert_eq!(offset_s(-20_000), 10);
    }
}
