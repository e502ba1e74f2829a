//! What is surveyed: everything that decides which pixel is seen when, and at which angle.
//!
//! A [`Survey`] owns all of it, the Sun's table included, and is plain data: fill in its fields.
//!
//! Limits: those of [`SampledScan`], and [`MOST_MOMENTS`] moments.

use super::detector::SurveyDetector;
use super::frame::MapFrame;
use super::moment::{MOST_MOMENTS, Moment};
use super::scan::{SampledScan, SamplingError};
use super::sun::SurveySun;
use crate::healpix::Nside;
use onboard_core::ephemeris::EphemerisError;
use thiserror::Error;

/// What to survey.
#[derive(Debug, Clone)]
pub struct Survey {
    /// The strategy and the rate of its samples.
    pub scan: SampledScan,
    /// Where the anti-Sun axis points.
    pub sun: SurveySun,
    /// Who looks; all are collected in one map.
    pub detectors: Vec<SurveyDetector>,
    /// Resolution of the map.
    pub nside: Nside,
    /// Frame of the map.
    pub frame: MapFrame,
    /// Averages to take.
    pub moments: Vec<Moment>,
}

impl Survey {
    /// The moments that are collected: the first [`MOST_MOMENTS`].
    #[must_use]
    pub fn collected(&self) -> &[Moment] {
        self.moments.get(..MOST_MOMENTS).unwrap_or(&self.moments)
    }
}

/// Why a survey has no map.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum SurveyError {
    /// The strategy cannot be sampled at its rate.
    #[error(transparent)]
    Sampling(#[from] SamplingError),
    /// The Sun's table does not serve the samples.
    #[error("the Sun's table does not serve the samples: {0:?}")]
    Ephemeris(EphemerisError),
    /// The system gives no threads.
    #[error("{threads} threads cannot be started")]
    Threads {
        /// How many were asked for.
        threads: usize,
    },
    /// It was asked to stop before its end.
    #[error("stopped before its end")]
    Stopped,
}

impl From<EphemerisError> for SurveyError {
    fn from(error: EphemerisError) -> Self {
        Self::Ephemeris(error)
    }
}
