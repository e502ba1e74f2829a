//! Gregorian dates as numbers of days.
//!
//! Days are counted from 0 on 2000-01-01, whatever the time scale.
//!
//! Method: eras of 400 years whose years begin in March, so that a leap day ends its year.

use onboard_core::time::NS_PER_SECOND;

/// ns of a day without a leap second.
pub(super) const NS_PER_DAY: i64 = 86_400 * NS_PER_SECOND;

/// Day, from 0 on 2000-01-01, of a Gregorian date.
pub(super) fn day_from_civil(year: i64, month: i64, day: i64) -> i64 {
    // Years from March, so that a leap day ends its year.
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let of_year = (153 * month + 2) / 5 + day - 1;
    let leap_days = year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    365 * year + leap_days + of_year - 730_425
}

/// Gregorian date (year, month, day) of a day counted from 0 on 2000-01-01.
#[must_use]
pub fn civil_from_day(day: i64) -> (i64, i64, i64) {
    let since_march_0 = day + 730_425;
    let era = since_march_0.div_euclid(146_097);
    let of_era = since_march_0.rem_euclid(146_097);
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * of_year + 2) / 153;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    let year = era * 400 + year_of_era + i64::from(month <= 2);
    (year, month, of_year - (153 * from_march + 2) / 5 + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn days_stand_at_known_dates() {
        assert_eq!((day_from_civil(2000, 1, 1), day_from_civil(2000, 3, 1)), (0, 60));
        assert_eq!(civil_from_day(-36_524), (1900, 1, 1));
        assert_eq!(civil_from_day(6209), (2016, 12, 31));
    }

    proptest! {
        #[test]
        fn days_and_dates_agree(day in -106_000..106_000_i64) {
            let (year, month, of_month) = civil_from_day(day);
            prop_assert_eq!(day_from_civil(year, month, of_month), day);
        }
    }
}
