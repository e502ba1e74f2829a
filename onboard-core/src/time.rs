//! What time is it, exactly.
//!
//! An [`Instant`] counts nanoseconds of TAI since 2000-01-01T12:00:00 TAI in an i64: good for
//! plus and minus 292 years, no rounding, no leap seconds. The ground converts UTC, TT and TDB.
//!
//! Method: integers only; differences saturate rather than wrap.
//!
//! Limits: text and other time scales do not exist here.

use crate::convert::{f64_from_i64, i64_from_f64};
use serde::{Deserialize, Serialize};

/// Nanoseconds in a second.
pub const NS_PER_SECOND: i64 = 1_000_000_000;

/// An instant on the TAI scale, in nanoseconds since 2000-01-01T12:00:00 TAI.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Instant(i64);

/// A signed span of TAI time in nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Duration(i64);

impl Instant {
    /// The instant at `tai_ns` nanoseconds of TAI after 2000-01-01T12:00:00 TAI.
    #[must_use]
    pub const fn from_tai_ns(tai_ns: i64) -> Self {
        Self(tai_ns)
    }

    /// Nanoseconds of TAI since 2000-01-01T12:00:00 TAI.
    #[must_use]
    pub const fn tai_ns(self) -> i64 {
        self.0
    }

    /// Time from `earlier` to this instant; saturates beyond 292 years.
    #[must_use]
    // REQ-TIME-1.
    pub const fn since(self, earlier: Self) -> Duration {
        Duration(self.0.saturating_sub(earlier.0))
    }

    /// This instant moved by `span`; saturates at the ends of the scale.
    #[must_use]
    // REQ-TIME-1.
    pub const fn plus(self, span: Duration) -> Self {
        Self(self.0.saturating_add(span.0))
    }
}

impl Duration {
    /// No time at all.
    pub const ZERO: Self = Self(0);

    /// A span of `ns` nanoseconds.
    #[must_use]
    pub const fn from_ns(ns: i64) -> Self {
        Self(ns)
    }

    /// The span in nanoseconds.
    #[must_use]
    pub const fn ns(self) -> i64 {
        self.0
    }

    /// The span nearest to `seconds`; saturates, and NaN gives zero.
    #[must_use]
    #[cfg_attr(target_os = "none", inline(never))] // Rounding is long in software.
    pub fn from_seconds(seconds: f64) -> Self {
        Self(i64_from_f64(libm::round(seconds * 1e9)))
    }

    /// The whole nanoseconds in `seconds`, towards zero; saturates, and NaN gives zero.
    #[must_use]
    pub const fn from_seconds_floor(seconds: f64) -> Self {
        Self(i64_from_f64(seconds * 1e9))
    }

    /// The span in seconds, correct to half a unit in the last place.
    #[must_use]
    pub const fn seconds(self) -> f64 {
        f64_from_i64(self.0) / 1e9
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    // REQ-TIME-1.
    fn differences_are_exact_and_saturate() {
        let a = Instant::from_tai_ns(1_017_921_637_000_000_001);
        let b = a.plus(Duration::from_ns(94_672_799_947_000_000));
        assert_eq!(b.since(a).ns(), 94_672_799_947_000_000);
        assert_eq!(
            Instant::from_tai_ns(i64::MAX).since(Instant::from_tai_ns(i64::MIN)).ns(),
            i64::MAX
        );
        assert_eq!(Duration::from_seconds(f64::NAN), Duration::ZERO);
        assert_eq!(Duration::from_seconds(1.000_000_000_6).ns(), 1_000_000_001);
        assert_eq!(Duration::from_seconds_floor(1.000_000_000_6).ns(), 1_000_000_000);
    }
}
