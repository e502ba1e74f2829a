//! Where the anti-Sun frame stands during a run of samples.
//!
//! An [`Arc`] is longitude and latitude over one run as polynomials of degree 4 about the middle.
//!
//! Limits: runs last at most two hours; over that time the error of an L2 orbit's direction is below
//! 1e-13 rad.

use super::lanes::offset;
use crate::survey::clock::SampleClock;
use crate::survey::sampled::SampledSun;
use onboard_core::ephemeris::EphemerisError;
use std::f64::consts::PI;

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
        sun: &SampledSun<'_>,
        clock: &SampleClock,
        (first, last): (u64, u64),
    ) -> Result<Self, EphemerisError> {
        let length = last - first;
        let node = |i: u64| first + length * i / 4;
        let seen = |i: u64| sun.angles(clock, sun.seen_at(clock, node(i)));
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
