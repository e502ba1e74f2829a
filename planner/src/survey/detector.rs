//! A detector of a survey: where it points, what stands before it, in which direction it is sensitive.
//!
//! Frames and angles are those of the conventions: the detector's z axis is its line of sight, its x
//! axis the zero of the crossing angle psi.

use super::mount::Mount;
use super::rates::ExactRotor;
use onboard_core::frame::{Boresight, Detector};
use onboard_core::rotation::Rotation;

/// A detector of a survey.
#[derive(Debug, Clone)]
pub struct SurveyDetector {
    /// Detector frame to mission boresight frame.
    pub rotation: Rotation<Detector, Boresight>,
    /// The half-wave plate before it, if any.
    pub plate: Option<ExactRotor>,
    /// Angle from its x axis to its sensitive direction in radians, in the sense of psi. Maps of I, Q
    /// and U depend on it; hits and moments do not.
    pub polarisation_rad: f64,
}

impl SurveyDetector {
    /// The boresight itself, without a plate, sensitive along its x axis.
    pub const BORESIGHT: Self =
        Self { rotation: Rotation::IDENTITY, plate: None, polarisation_rad: 0.0 };

    /// Angle of the line of sight from the spin axis in radians, the boresight's being `beta_rad`.
    #[must_use]
    pub fn polar_rad(&self, beta_rad: f64) -> f64 {
        let (cos, sin) = Mount::new(beta_rad, self.rotation, 0).polar;
        sin.atan2(cos)
    }
}
