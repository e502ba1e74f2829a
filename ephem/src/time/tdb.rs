//! TDB, TT and TAI of an instant, as whole ns.
//!
//! Method: TDB is SPICE's ephemeris time, TDB - TAI = 32.184 s + K sin E with hifitime's NAIF
//! constants, rounded once to the ns.
//!
//! Limits: within 35 us of the full theory, 17 us rms (`tests/time.rs`). Years 1708 to 2291.

use crate::convert::{f64_from_i64, i64_from_f64};
use hifitime::{Duration, Epoch, NAIF_EB, NAIF_K, NAIF_M0, NAIF_M1};
use onboard_core::time::{Instant, NS_PER_SECOND};

/// TT - TAI in ns.
pub(super) const TT_MINUS_TAI_NS: i64 = 32_184_000_000;

/// 2000-01-01T12:00:00 TAI as ns from hifitime's TAI zero, 1900-01-01T00:00:00.
const J2000_IN_HIFITIME_NS: i128 = 3_155_716_800 * 1_000_000_000;

/// The same instant as a hifitime epoch on TAI, exactly.
#[must_use]
pub fn to_epoch(at: Instant) -> Epoch {
    Epoch::from_tai_duration(Duration::from_total_nanoseconds(
        i128::from(at.tai_ns()) + J2000_IN_HIFITIME_NS,
    ))
}

/// The same instant as an [`Instant`], exactly for an epoch on TAI; `None` beyond 292 years.
#[must_use]
pub fn from_epoch(epoch: Epoch) -> Option<Instant> {
    let ns = epoch.to_tai_duration().total_nanoseconds() - J2000_IN_HIFITIME_NS;
    i64::try_from(ns).ok().map(Instant::from_tai_ns)
}

/// ns of TDB since 2000-01-01T12:00:00 TDB; saturates at the ends of the scale.
#[must_use]
pub fn tdb_ns(at: Instant) -> i64 {
    let tt = at.tai_ns().saturating_add(TT_MINUS_TAI_NS);
    // The periodic term moves by 3e-10 of its argument: two rounds settle it to the ns.
    let first = tt.saturating_add(periodic_ns(tt));
    tt.saturating_add(periodic_ns(first))
}

/// The instant at `tdb_ns` ns of TDB since 2000-01-01T12:00:00 TDB.
#[must_use]
pub fn from_tdb_ns(tdb_ns: i64) -> Instant {
    Instant::from_tai_ns(tdb_ns.saturating_sub(periodic_ns(tdb_ns)).saturating_sub(TT_MINUS_TAI_NS))
}

/// Seconds of TDB since 2000-01-01T12:00:00 TDB, rounded once (to 0.06 us in this century).
#[must_use]
pub fn tdb_seconds(at: Instant) -> f64 {
    seconds_from_ns(tdb_ns(at))
}

/// The instant nearest to `tdb_s` seconds of TDB since 2000-01-01T12:00:00 TDB; saturates.
pub(crate) fn from_tdb_seconds(tdb_s: f64) -> Instant {
    let whole = libm::floor(tdb_s);
    let ns = i64_from_f64(whole)
        .saturating_mul(NS_PER_SECOND)
        .saturating_add(i64_from_f64((tdb_s - whole) * 1e9));
    from_tdb_ns(ns)
}

fn seconds_from_ns(ns: i64) -> f64 {
    f64_from_i64(ns.div_euclid(NS_PER_SECOND)) + f64_from_i64(ns.rem_euclid(NS_PER_SECOND)) * 1e-9
}

/// TDB - TT in ns at a TDB time: K sin E, E = M + e sin M, M = M0 + M1 t.
fn periodic_ns(tdb_ns: i64) -> i64 {
    let mean = NAIF_M0 + NAIF_M1 * seconds_from_ns(tdb_ns);
    let eccentric = mean + NAIF_EB * libm::sin(mean);
    i64_from_f64(1e9 * NAIF_K * libm::sin(eccentric))
}

#[cfg(test)]
mod tests {
    use super::*;
    use hifitime::TimeScale;
    use proptest::prelude::*;

    #[test]
    fn the_zero_is_noon_of_tai() {
        let noon = Epoch::from_gregorian_tai_hms(2000, 1, 1, 12, 0, 0);
        assert_eq!(from_epoch(noon), Some(Instant::from_tai_ns(0)));
        assert_eq!(to_epoch(Instant::from_tai_ns(0)), noon);
    }

    proptest! {
        #[test]
        fn epochs_come_back_exactly(ns in any::<i64>()) {
            let at = Instant::from_tai_ns(ns);
            prop_assert_eq!(from_epoch(to_epoch(at)), Some(at));
        }

        #[test]
        fn tdb_comes_back_exactly(ns in -9_000_000_000_000_000_000..9_000_000_000_000_000_000_i64) {
            prop_assert_eq!(tdb_ns(from_tdb_ns(ns)), ns);
            let at = Instant::from_tai_ns(ns);
            prop_assert_eq!(from_tdb_ns(tdb_ns(at)), at);
        }

        #[test]
        fn tdb_is_hifitimes_ephemeris_time(ns in 0..1_500_000_000_000_000_000_i64) {
            let at = Instant::from_tai_ns(ns);
            let theirs = to_epoch(at).to_time_scale(TimeScale::ET).duration.total_nanoseconds();
            prop_assert!((i128::from(tdb_ns(at)) - theirs).abs() <= 2);
        }
    }
}
