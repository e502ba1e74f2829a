//! The strategy that a survey follows, and how often it is sampled.
//!
//! Angles are those of the scan chain in the conventions. Periods and the sampling rate are exact
//! rationals and are rounded once, when the survey starts: sample j lies at exactly j / `f_s`,
//! whatever the rates are.
//!
//! Limits: [`SamplingError`].

use super::clock::SampleClock;
use super::rates::{ExactRotor, sampling_period};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};
use onboard_core::time::{Duration, Instant};
use thiserror::Error;

/// A scanning strategy sampled at a constant rate.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledScan {
    /// Instant of sample 0, where all rotations have their start phase.
    pub start: Instant,
    /// Samples per second.
    pub sampling_hz: BigRational,
    /// Angle from the anti-Sun axis to the spin axis in radians.
    pub alpha_rad: f64,
    /// Angle from the spin axis to the boresight in radians.
    pub beta_rad: f64,
    /// Precession.
    pub precession: ExactRotor,
    /// Spin.
    pub spin: ExactRotor,
}

/// Why a strategy cannot be sampled at its rate.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum SamplingError {
    /// A rate of zero or below.
    #[error("a sampling rate of {hz} Hz: a rate above 0 Hz is needed")]
    NotPositive {
        /// The rate.
        hz: f64,
    },
    /// Spin or precession turns by half a turn or more between samples.
    #[error(
        "a sampling rate of {hz} Hz: more than two samples per turn are needed, above {least_hz} Hz"
    )]
    TooSlow {
        /// The rate.
        hz: f64,
        /// Two samples per turn of the faster rotation.
        least_hz: f64,
    },
    /// Samples so far apart or so close that their time is not represented.
    #[error("a sampling rate of {hz} Hz: a rate from 1e-9 to 1e18 Hz is needed")]
    OutOfRange {
        /// The rate.
        hz: f64,
    },
}

impl SampledScan {
    /// Whether the strategy can be sampled at its rate.
    ///
    /// # Errors
    /// [`SamplingError`] with the rate, and the rate that is needed.
    pub fn check(&self) -> Result<(), SamplingError> {
        self.clock().map(drop)
    }

    /// Samples taken before `elapsed` after the start.
    #[must_use]
    pub fn samples_before(&self, elapsed: Duration) -> u64 {
        let seconds = BigRational::new(elapsed.ns().into(), 1_000_000_000.into());
        (seconds * &self.sampling_hz).ceil().to_integer().to_u64().unwrap_or(0)
    }

    /// The strategy on the clock of samples.
    pub(super) fn clock(&self) -> Result<SampleClock, SamplingError> {
        let exact_hz = &self.sampling_hz;
        let hz = exact_hz.to_f64().unwrap_or(f64::NAN);
        if !exact_hz.is_positive() {
            return Err(SamplingError::NotPositive { hz });
        }
        let turns = [&self.spin, &self.precession].map(|it| it.turns_per_s.abs());
        let [spin, precession] = turns;
        let fastest = if spin > precession { spin } else { precession };
        if &fastest * BigRational::from_integer(2.into()) >= *exact_hz {
            let least_hz = fastest.to_f64().unwrap_or(f64::NAN) * 2.0;
            return Err(SamplingError::TooSlow { hz, least_hz });
        }
        Ok(SampleClock {
            start: self.start,
            period: sampling_period(exact_hz).ok_or(SamplingError::OutOfRange { hz })?,
            alpha_rad: self.alpha_rad,
            beta_rad: self.beta_rad,
            precession: self.precession.sampled(exact_hz),
            spin: self.spin.sampled(exact_hz),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use onboard_core::phase::Phase;

    fn sampled(above: i64, below: i64) -> SampledScan {
        let period = |seconds: i64| {
            let period_s = BigRational::from_integer(seconds.into());
            ExactRotor::with_period(&period_s, Phase::ZERO).unwrap()
        };
        SampledScan {
            start: Instant::from_tai_ns(0),
            sampling_hz: BigRational::new(above.into(), below.into()),
            alpha_rad: 0.8,
            beta_rad: 0.9,
            precession: period(-10_000),
            spin: period(1000),
        }
    }

    #[test]
    fn rates_that_cannot_be_sampled_are_named() {
        let refused = |above, below| sampled(above, below).check().unwrap_err();
        assert_eq!(refused(0, 1), SamplingError::NotPositive { hz: 0.0 });
        assert_eq!(refused(-19, 2), SamplingError::NotPositive { hz: -9.5 });
        assert_eq!(refused(1, 500), SamplingError::TooSlow { hz: 0.002, least_hz: 0.002 });
        assert_eq!(sampled(21, 10_000).check(), Ok(()));
        let mut fast = sampled(1, 1);
        fast.sampling_hz = num_traits::Pow::pow(BigRational::from_integer(10.into()), 30_u32);
        assert!(matches!(fast.check(), Err(SamplingError::OutOfRange { .. })));
    }

    #[test]
    fn samples_are_counted_exactly() {
        let scan = sampled(20_000_000, 1_048_576);
        let day = Duration::from_ns(86_400_000_000_000);
        // 86400 * 20e6 / 2^20 = 1647949.2
        assert_eq!(scan.samples_before(day), 1_647_950);
        assert_eq!(sampled(19, 1).samples_before(Duration::from_ns(1_000_000_000)), 19);
        assert_eq!(sampled(19, 1).samples_before(Duration::from_ns(1_000_000_001)), 20);
    }
}
