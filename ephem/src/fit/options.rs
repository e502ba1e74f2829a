//! How well a table is fitted, and which options are legal.

use super::error::FitError;
use core::f64::consts::PI;
use onboard_core::ephemeris::MAX_COEFFICIENTS;

/// One milliarcsecond in radians.
pub const MILLIARCSECOND_RAD: f64 = PI / (180.0 * 3_600_000.0);

/// Smallest tolerance that the rounding of times and states allows.
const SMALLEST_TOLERANCE_RAD: f64 = 1e-12;
const LARGEST_TOLERANCE_RAD: f64 = 1e-3;
const FEWEST_COEFFICIENTS: u16 = 4;

/// How well to fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// Largest angle between table and sky in radians, 1e-12 to 1e-3.
    pub tolerance_rad: f64,
    /// Largest angle where a tabulated trajectory is too rough for that one; not below it.
    ///
    /// The tolerance then grows tenfold up to this, for the bodies concerned.
    pub rough_tolerance_rad: f64,
    /// Most coefficients of a granule, 4 to 64: fewer are quicker to evaluate, more take less space.
    pub max_coefficients: u16,
}

impl FitOptions {
    /// For uplink: within 1 mas, few bytes, and short enough series to be quick on board.
    pub const UPLINK: Self = Self {
        tolerance_rad: MILLIARCSECOND_RAD,
        rough_tolerance_rad: MILLIARCSECOND_RAD,
        max_coefficients: 24,
    };
    /// For the ground: as exact as the sky itself, quick to evaluate; 1 mas on a rough trajectory.
    pub const GROUND: Self = Self {
        tolerance_rad: 5e-12,
        rough_tolerance_rad: MILLIARCSECOND_RAD,
        max_coefficients: 16,
    };

    /// Refuses options out of range.
    pub(super) fn check(&self) -> Result<(), FitError> {
        let tolerance = self.tolerance_rad;
        if !(SMALLEST_TOLERANCE_RAD..=LARGEST_TOLERANCE_RAD).contains(&tolerance) {
            return Err(FitError::Tolerance(tolerance));
        }
        let found = self.rough_tolerance_rad;
        if !(tolerance..=LARGEST_TOLERANCE_RAD).contains(&found) {
            return Err(FitError::RoughTolerance { found, least: tolerance });
        }
        if !(FEWEST_COEFFICIENTS..=MAX_COEFFICIENTS).contains(&self.max_coefficients) {
            return Err(FitError::Coefficients(self.max_coefficients));
        }
        Ok(())
    }
}
