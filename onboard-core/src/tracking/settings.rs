//! What the tracker is told: how much is known beforehand, and what it must refuse.
//!
//! Angles stand in the order of [`ScanCovariance`](crate::uncertainty::ScanCovariance): precession
//! phase, alpha, spin phase; rates: precession, spin.
//!
//! Limits: the legal ranges below; within them the filter's arithmetic keeps its digits.

use super::filter::Walks;
use crate::time::Duration;
use core::f64::consts::FRAC_PI_2;
use serde::{Deserialize, Serialize};

/// Largest legal prior standard deviation of an angle, rad.
pub const MAX_ANGLE_SIGMA_RAD: f64 = 0.5;
/// Largest legal prior standard deviation of a rate, relative to the rate.
pub const MAX_RATE_SIGMA: f64 = 0.01;
/// Largest legal random walk of an angle, rad/s^(1/2).
pub const MAX_ANGLE_WALK: f64 = 1e-3;
/// Largest legal random walk of a rate, rad/s^(3/2).
pub const MAX_RATE_WALK: f64 = 1e-6;
/// Legal gates on chi^2 of three degrees of freedom.
pub const GATES: core::ops::RangeInclusive<f64> = 1.0..=1e4;

/// The least number above zero: any positive limit of a correction is legal.
const LEAST_LIMIT_RAD: f64 = f64::from_bits(1);

/// One of the angles that an attitude shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScanAngle {
    /// The precession phase.
    Precession,
    /// The angle from the anti-Sun axis to the spin axis.
    Alpha,
    /// The spin phase.
    Spin,
}

/// The angles in their order.
pub(super) const ANGLES: [ScanAngle; 3] =
    [ScanAngle::Precession, ScanAngle::Alpha, ScanAngle::Spin];

/// What the tracker is told.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TrackerSettings {
    /// Standard deviations of the angles' errors before any measurement, rad; in [0, 0.5].
    pub angle_sigmas_rad: [f64; 3],
    /// Standard deviations of the rates' errors before any measurement, relative to the rate; in
    /// [0, 0.01].
    pub rate_sigmas: [f64; 2],
    /// Random walks of the angles, rad/s^(1/2); in [0, 1e-3], zero for none.
    pub angle_walks: [f64; 3],
    /// Random walks of the rates, rad/s^(3/2); in [0, 1e-6], zero for none.
    pub rate_walks: [f64; 2],
    /// Oldest measurement that is used; positive.
    pub max_age: Duration,
    /// How far a measurement may lie ahead of now, for clocks that differ; not negative.
    pub max_lead: Duration,
    /// Largest chi^2 (three degrees of freedom) that is not an outlier; in [1, 1e4].
    pub gate: f64,
    /// Largest correction of each angle by one measurement, rad; in (0, pi/2].
    pub limits_rad: [f64; 3],
}

/// Why settings are illegal.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TrackerSettingsError {
    /// An angle's prior standard deviation (rad).
    AngleSigma(ScanAngle, f64),
    /// The precession rate's prior standard deviation (relative).
    PrecessionRateSigma(f64),
    /// The spin rate's prior standard deviation (relative).
    SpinRateSigma(f64),
    /// An angle's random walk (rad/s^(1/2)).
    AngleWalk(ScanAngle, f64),
    /// The precession rate's random walk (rad/s^(3/2)).
    PrecessionRateWalk(f64),
    /// The spin rate's random walk (rad/s^(3/2)).
    SpinRateWalk(f64),
    /// The greatest age is not positive.
    MaxAge(Duration),
    /// The greatest lead is negative.
    MaxLead(Duration),
    /// The gate on chi^2.
    Gate(f64),
    /// The limit of an angle's correction (rad).
    Limit(ScanAngle, f64),
}

/// The first of the values, in the order of the angles, that is not from `least` to `most`.
#[inline(never)]
fn outside(values: &[f64], least: f64, most: f64) -> Option<(ScanAngle, f64)> {
    let pairs = ANGLES.into_iter().zip(values);
    let mut bad = pairs.filter(|(_, value)| !(least..=most).contains(*value));
    bad.next().map(|(angle, value)| (angle, *value))
}

impl TrackerSettings {
    /// Checks every range.
    ///
    /// # Errors
    /// [`TrackerSettingsError`] names the first setting out of its range, with its value.
    #[inline(never)]
    pub fn check(&self) -> Result<(), TrackerSettingsError> {
        if let Some((angle, sigma)) = outside(&self.angle_sigmas_rad, 0.0, MAX_ANGLE_SIGMA_RAD) {
            return Err(TrackerSettingsError::AngleSigma(angle, sigma));
        }
        if let Some((angle, walk)) = outside(&self.angle_walks, 0.0, MAX_ANGLE_WALK) {
            return Err(TrackerSettingsError::AngleWalk(angle, walk));
        }
        if let Some((angle, limit)) = outside(&self.limits_rad, LEAST_LIMIT_RAD, FRAC_PI_2) {
            return Err(TrackerSettingsError::Limit(angle, limit));
        }
        // Of two rates the second stands where alpha would.
        match outside(&self.rate_sigmas, 0.0, MAX_RATE_SIGMA) {
            Some((ScanAngle::Precession, rate)) => {
                return Err(TrackerSettingsError::PrecessionRateSigma(rate));
            }
            Some((_, rate)) => return Err(TrackerSettingsError::SpinRateSigma(rate)),
            None => {}
        }
        match outside(&self.rate_walks, 0.0, MAX_RATE_WALK) {
            Some((ScanAngle::Precession, walk)) => {
                return Err(TrackerSettingsError::PrecessionRateWalk(walk));
            }
            Some((_, walk)) => return Err(TrackerSettingsError::SpinRateWalk(walk)),
            None => {}
        }
        if self.max_age <= Duration::ZERO {
            return Err(TrackerSettingsError::MaxAge(self.max_age));
        }
        if self.max_lead < Duration::ZERO {
            return Err(TrackerSettingsError::MaxLead(self.max_lead));
        }
        if !GATES.contains(&self.gate) {
            return Err(TrackerSettingsError::Gate(self.gate));
        }
        Ok(())
    }

    pub(super) const fn walks(&self) -> Walks {
        Walks { angles: self.angle_walks, rates: self.rate_walks }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEGAL: TrackerSettings = TrackerSettings {
        angle_sigmas_rad: [0.01; 3],
        rate_sigmas: [1e-5; 2],
        angle_walks: [0.0; 3],
        rate_walks: [0.0; 2],
        max_age: Duration::from_ns(1),
        max_lead: Duration::ZERO,
        gate: 21.1,
        limits_rad: [0.1; 3],
    };

    #[test]
    fn every_setting_has_a_range() {
        use TrackerSettingsError as E;
        assert_eq!(LEGAL.check(), Ok(()));
        let with = |change: fn(&mut TrackerSettings)| {
            let mut settings = LEGAL;
            change(&mut settings);
            settings.check().unwrap_err()
        };
        let (none, past) = (Duration::ZERO, Duration::from_ns(-1));
        assert_eq!(with(|s| s.angle_sigmas_rad[1] = -1.0), E::AngleSigma(ScanAngle::Alpha, -1.0));
        assert_eq!(with(|s| s.rate_sigmas[0] = 0.02), E::PrecessionRateSigma(0.02));
        assert_eq!(with(|s| s.rate_sigmas[1] = 0.02), E::SpinRateSigma(0.02));
        assert_eq!(with(|s| s.angle_walks[2] = 1.0), E::AngleWalk(ScanAngle::Spin, 1.0));
        assert_eq!(with(|s| s.rate_walks[0] = 1.0), E::PrecessionRateWalk(1.0));
        assert_eq!(with(|s| s.rate_walks[1] = -1.0), E::SpinRateWalk(-1.0));
        assert_eq!(with(|s| s.max_age = Duration::ZERO), E::MaxAge(none));
        assert_eq!(with(|s| s.max_lead = Duration::from_ns(-1)), E::MaxLead(past));
        assert_eq!(with(|s| s.gate = 0.5), E::Gate(0.5));
        assert_eq!(with(|s| s.limits_rad[0] = 0.0), E::Limit(ScanAngle::Precession, 0.0));
        assert!(matches!(with(|s| s.gate = f64::NAN), E::Gate(gate) if gate.is_nan()));
    }
}
