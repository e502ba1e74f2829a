//! A survey on its clock of samples: what its kernels read.
//!
//! All rates are turns per sample, rounded once; the Sun's table is borrowed from the survey.

use super::clock::{SampleClock, phase_at};
use super::definition::{Survey, SurveyError};
use super::frame::MapFrame;
use super::mount::Mount;
use super::sun::SunSource;
use crate::healpix::Nside;
use onboard_core::direction::Direction;
use onboard_core::ephemeris::EphemerisError;
use onboard_core::frame::{Boresight, Detector, Ecliptic};
use onboard_core::phase::Rotor;
use onboard_core::rotation::Rotation;
use onboard_core::sun::SunModel;
use onboard_core::time::Duration;

/// Who looks where at each sample.
#[derive(Debug)]
pub(crate) struct Sampled<'t> {
    pub(super) clock: SampleClock,
    pub(super) sun: SampledSun<'t>,
    pub(super) detectors: Vec<SampledDetector>,
}

/// A detector with the plate before it, in turns per sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct SampledDetector {
    pub(super) rotation: Rotation<Detector, Boresight>,
    pub(super) plate: Option<Rotor>,
}

/// A map's resolution and frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Pixels {
    pub(crate) nside: Nside,
    pub(crate) frame: MapFrame,
}

/// The Sun-to-spacecraft direction at each sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct SampledSun<'t> {
    source: SampledSource<'t>,
    step: Option<Duration>,
}

#[derive(Debug, Clone, Copy)]
enum SampledSource<'t> {
    /// Turns per sample.
    Circular(Rotor),
    Table(SunModel<'t>),
}

impl<'t> Sampled<'t> {
    /// The survey with every rate rounded.
    pub(crate) fn of(survey: &'t Survey) -> Result<Self, SurveyError> {
        let clock = survey.scan.clock()?;
        let hz = &survey.scan.sampling_hz;
        let source = match &survey.sun.source {
            SunSource::Circular(longitude) => SampledSource::Circular(longitude.sampled(hz)),
            SunSource::Table(table) => SampledSource::Table(table.model()?),
        };
        let detectors = survey
            .detectors
            .iter()
            .map(|it| SampledDetector {
                rotation: it.rotation,
                plate: it.plate.as_ref().map(|plate| plate.sampled(hz)),
            })
            .collect();
        Ok(Self { clock, sun: SampledSun { source, step: survey.sun.step }, detectors })
    }
}

impl Sampled<'_> {
    /// The detectors' mounts, and the different plates before them.
    pub(super) fn mounts(&self) -> (Vec<Mount>, Vec<Rotor>) {
        let detectors = self.detectors.iter().map(|it| (it.rotation, it.plate));
        Mount::all(self.clock.beta_rad, detectors)
    }
}

impl SampledSun<'_> {
    /// The sample whose direction sample `j` sees: itself, or the first of its step.
    pub(super) fn seen_at(&self, clock: &SampleClock, j: u64) -> u64 {
        match self.step_of(clock, j) {
            Some((step, number)) => clock.first_sample_at(Duration::from_ns(step * number)),
            None => j,
        }
    }

    /// The first sample after `j` at which the direction steps.
    pub(super) fn next_step(&self, clock: &SampleClock, j: u64) -> u64 {
        match self.step_of(clock, j) {
            Some((step, number)) => {
                clock.first_sample_at(Duration::from_ns(step.saturating_mul(number + 1)))
            }
            None => u64::MAX,
        }
    }

    fn step_of(&self, clock: &SampleClock, j: u64) -> Option<(i64, i64)> {
        let step = self.step.map(Duration::ns).filter(|&ns| ns > 0)?;
        Some((step, clock.elapsed(j).ns() / step))
    }

    /// Longitude and latitude at sample `j` in radians, steps left aside.
    pub(super) fn angles(&self, clock: &SampleClock, j: u64) -> Result<(f64, f64), EphemerisError> {
        match &self.source {
            SampledSource::Circular(longitude) => Ok((phase_at(*longitude, j).radians(), 0.0)),
            SampledSource::Table(model) => {
                let at = model.state(clock.start, clock.instant(j))?.direction;
                Ok((at.longitude_rad(), at.latitude_rad()))
            }
        }
    }

    /// The direction that sample `j` sees.
    pub(super) fn direction(
        &self,
        clock: &SampleClock,
        j: u64,
    ) -> Result<Direction<Ecliptic>, EphemerisError> {
        let seen = self.seen_at(clock, j);
        match &self.source {
            SampledSource::Circular(longitude) => {
                let (sin, cos) = phase_at(*longitude, seen).sin_cos();
                Ok(Direction::new(cos, sin, 0.0).unwrap_or(Direction::Z))
            }
            SampledSource::Table(model) => {
                Ok(model.state(clock.start, clock.instant(seen))?.direction)
            }
        }
    }
}
