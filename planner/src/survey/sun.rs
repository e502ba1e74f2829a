//! Where the anti-Sun frame stands during a run of samples.
//!
//! [`SurveySun`] is the Sun as a survey takes it: circular on the sample clock, or from a table, and
//! optionally in steps: the direction then stands still until the next step's first sample
//! (Falcons.jl's thruster mode). An `Arc` is longitude and latitude over one run as polynomials
//! of degree 4 about the middle.
//!
//! Limits: an arc lasts at most `LONGEST_ARC_S`; over it the error of an L2 orbit's direction is
//! below 1e-13 rad.

use super::clock::{SampledScan, phase_at};
use onboard_core::ephemeris::EphemerisError;
use onboard_core::phase::Rotor;
use onboard_core::sun::SunModel;
use onboard_core::time::Duration;
use std::f64::consts::PI;

/// Longest time that one arc may span, in seconds.
pub(super) const LONGEST_ARC_S: f64 = 7200.0;

/// The Sun-to-spacecraft direction of a survey.
#[derive(Debug, Clone, Copy)]
pub struct SurveySun<'a> {
    /// Where the direction comes from.
    pub source: SunSource<'a>,
    /// Time between steps of the direction; none moves it with every sample.
    pub step: Option<Duration>,
}

/// Where the Sun-to-spacecraft direction comes from.
#[derive(Debug, Clone, Copy)]
pub enum SunSource<'a> {
    /// Uniform longitude in turns per sample, latitude 0.
    Circular(Rotor),
    /// From a table.
    Table(SunModel<'a>),
}

impl SurveySun<'_> {
    /// The sample whose direction sample `j` sees: itself, or the first of its step.
    #[must_use]
    pub fn seen_at(&self, scan: &SampledScan, j: u64) -> u64 {
        match self.step_of(scan, j) {
            Some((step, number)) => scan.first_sample_at(Duration::from_ns(step * number)),
            None => j,
        }
    }

    /// The first sample after `j` at which the direction steps.
    pub(super) fn next_step(&self, scan: &SampledScan, j: u64) -> u64 {
        match self.step_of(scan, j) {
            Some((step, number)) => {
                scan.first_sample_at(Duration::from_ns(step.saturating_mul(number + 1)))
            }
            None => u64::MAX,
        }
    }

    fn step_of(&self, scan: &SampledScan, j: u64) -> Option<(i64, i64)> {
        let step = self.step.map(Duration::ns).filter(|&ns| ns > 0)?;
        Some((step, scan.elapsed(j).ns() / step))
    }

    /// Longitude and latitude at sample `j` in radians, steps left aside.
    pub(super) fn angles(&self, scan: &SampledScan, j: u64) -> Result<(f64, f64), EphemerisError> {
        match &self.source {
            SunSource::Circular(longitude) => Ok((phase_at(*longitude, j).radians(), 0.0)),
            SunSource::Table(model) => {
                let at = model.state(scan.start, scan.instant(j))?.direction;
                Ok((at.longitude_rad(), at.latitude_rad()))
            }
        }
    }
}

/// Longitude and latitude of the anti-Sun direction over a run of samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arc {
    /// The middle in samples from the run's first, and the reciprocal of half of its length.
    middle: f64,
    per_half: f64,
    /// Sine and cosine of longitude and latitude at the middle.
    pub(super) longitude: (f64, f64),
    pub(super) latitude: (f64, f64),
    /// Departures from the middle in powers of the scaled time.
    longitude_powers: [f64; 5],
    latitude_powers: [f64; 5],
}

impl Arc {
    /// The arc over samples `first` to `last`, both included.
    pub(super) fn new(
        sun: &SurveySun<'_>,
        scan: &SampledScan,
        first: u64,
        last: u64,
    ) -> Result<Self, EphemerisError> {
        let length = last - first;
        let node = |i: u64| first + length * i / 4;
        let seen = |i: u64| sun.angles(scan, sun.seen_at(scan, node(i)));
        let (longitude, latitude) = seen(2)?;
        let mut departures = [(0.0, 0.0); 5];
        let mut at = [0.0; 5];
        let middle = offset(node(2) - first);
        let half = offset(length).max(1.0) / 2.0;
        for i in 0..5 {
            let (l, b) = seen(i)?;
            let turned = (l - longitude + 3.0 * PI).rem_euclid(2.0 * PI) - PI;
            let slot = usize::try_from(i).unwrap_or(0);
            departures[slot] = (turned, b - latitude);
            at[slot] = (offset(node(i) - first) - middle) / half;
        }
        Ok(Self {
            middle,
            per_half: 1.0 / half,
            longitude: longitude.sin_cos(),
            latitude: latitude.sin_cos(),
            longitude_powers: powers(at, departures.map(|it| it.0)),
            latitude_powers: powers(at, departures.map(|it| it.1)),
        })
    }

    /// Departures of longitude and latitude from the middle at `samples` after the run's first.
    #[inline(always)]
    pub(super) fn departure(&self, samples: f64) -> (f64, f64) {
        let x = (samples - self.middle) * self.per_half;
        let horner = |c: &[f64; 5]| (((c[4] * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
        (horner(&self.longitude_powers), horner(&self.latitude_powers))
    }
}

#[expect(clippy::cast_precision_loss, reason = "runs are far shorter than 2^53 samples")]
pub(super) fn offset(samples: u64) -> f64 {
    samples as f64
}

/// Coefficients of the polynomial through `values` at `at`; points that coincide count once.
fn powers(at: [f64; 5], values: [f64; 5]) -> [f64; 5] {
    // Newton's divided differences, then multiplied out.
    let mut divided = values;
    for order in 1..5 {
        for i in (order..5).rev() {
            let span = at[i] - at[i - order];
            divided[i] = if span > 0.0 { (divided[i] - divided[i - 1]) / span } else { 0.0 };
        }
    }
    let mut result = [0.0; 5];
    for i in (0..5).rev() {
        for j in (1..5).rev() {
            result[j] = result[j - 1] - at[i] * result[j];
        }
        result[0] = divided[i] - at[i] * result[0];
    }
    result
}
