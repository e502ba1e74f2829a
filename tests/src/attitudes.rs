//! Measured attitudes of a scan that is not quite as believed.

use crate::{Noise, turn_rate};
use onboard_core::attitude::attitude;
use onboard_core::frame::Boresight;
use onboard_core::phase::{Phase, Rotor, TurnRate};
use onboard_core::rotation::Rotation;
use onboard_core::scan::{ScanParameters, ScanStrategy};
use onboard_core::sun::SunModel;
use onboard_core::time::{Duration, Instant};
use onboard_core::tracking::{Measurement, ScanAngles, Tracker, TrackerSettings};
use std::f64::consts::{PI, TAU};

/// One arcsecond in radians.
pub const ARCSEC: f64 = PI / 648_000.0;
/// Noise of the star tracker about each axis.
pub const NOISE_RAD: f64 = 10.0 * ARCSEC;
/// A minute in ns.
pub const MINUTE_NS: i64 = 60_000_000_000;
/// A day in ns.
pub const DAY_NS: i64 = 86_400_000_000_000;

/// What the trackers are told.
pub const SETTINGS: TrackerSettings = TrackerSettings {
    angle_sigmas_rad: [1e-3, 1e-4, 1e-3],
    rate_sigmas: [1e-5, 1e-5],
    angle_walks: [0.0; 3],
    rate_walks: [0.0; 2],
    max_age: Duration::from_ns(5 * MINUTE_NS),
    max_lead: Duration::from_ns(1_000_000),
    gate: 30.0,
    limits_rad: [0.1, 0.01, 0.1],
};

/// The instant `ns` after the epoch of the scale.
#[must_use]
pub fn at(ns: i64) -> Instant {
    Instant::from_tai_ns(ns)
}

/// A circular Sun.
#[must_use]
pub fn sun() -> SunModel<'static> {
    SunModel::Circular(Rotor {
        rate: turn_rate(31_557_600_000_000_000, 1),
        start: Phase::from_radians(0.3),
    })
}

/// Two independent standard normal numbers (Box and Muller).
fn normal_pair(noise: &mut Noise) -> [f64; 2] {
    let size = (-2.0 * (1.0 - noise.unit()).ln()).sqrt();
    let (sin, cos) = (TAU * noise.unit()).sin_cos();
    [size * cos, size * sin]
}

fn normal(noise: &mut Noise) -> f64 {
    normal_pair(noise)[0]
}

/// True errors of a model: angles at instant 0, relative rates.
#[derive(Debug, Clone, Copy)]
pub struct Truth {
    /// Errors of precession phase, alpha and spin phase at instant 0, rad.
    pub angles: [f64; 3],
    /// Relative errors of precession and spin rate.
    pub rates: [f64; 2],
}

impl Truth {
    /// Errors as likely as [`SETTINGS`] say.
    pub fn drawn(noise: &mut Noise) -> Self {
        Self {
            angles: SETTINGS.angle_sigmas_rad.map(|sigma| sigma * normal(noise)),
            rates: SETTINGS.rate_sigmas.map(|sigma| sigma * normal(noise)),
        }
    }

    /// The true scan where `model` is what is believed.
    ///
    /// # Panics
    /// When the errors make it no strategy.
    #[must_use]
    pub fn of(&self, model: &ScanStrategy) -> ScanStrategy {
        let old = *model.parameters();
        let moved = |rotor: Rotor, angle: f64, relative: f64| {
            let change = relative * rotor.rate.radians_per_second();
            Rotor {
                rate: rotor.rate.plus(TurnRate::from_radians_per_second(change)),
                start: rotor.start.plus(Phase::from_radians(angle)),
            }
        };
        ScanStrategy::new(ScanParameters {
            alpha_rad: old.alpha_rad + self.angles[1],
            precession: moved(old.precession, self.angles[0], self.rates[0]),
            spin: moved(old.spin, self.angles[2], self.rates[1]),
            ..old
        })
        .unwrap()
    }
}

/// An attitude with noise about each axis.
///
/// # Panics
/// When the noise is not a small angle.
pub fn shaken<F>(
    attitude: Rotation<Boresight, F>,
    sigma_rad: f64,
    noise: &mut Noise,
) -> Rotation<Boresight, F> {
    let ([x, y], z) = (normal_pair(noise), normal(noise));
    let turn = Rotation::<Boresight, Boresight>::from_xyzw({
        let [x, y, z] = [x, y, z].map(|n| 0.5 * sigma_rad * n);
        let length = (1.0 + x * x + y * y + z * z).sqrt();
        [x / length, y / length, z / length, 1.0 / length]
    })
    .unwrap();
    turn.then(attitude)
}

/// An attitude of `scan` with noise about each axis.
///
/// # Panics
/// When the noise is not a small angle.
pub fn measured(scan: &ScanStrategy, ns: i64, sigma_rad: f64, noise: &mut Noise) -> Measurement {
    let attitude = shaken(attitude(scan, &sun(), at(ns)).unwrap(), sigma_rad, noise);
    Measurement { at: at(ns), attitude, sigma_rad }
}

/// A tracker that has seen `count` attitudes of `truth`, every `step_ns` from instant 0.
///
/// # Panics
/// When one of them is refused.
pub fn tracked(
    model: &ScanStrategy,
    truth: &ScanStrategy,
    (count, step_ns): (i64, i64),
    noise: &mut Noise,
) -> Tracker {
    let mut tracker = Tracker::new(model, &SETTINGS, at(0)).unwrap();
    for ns in (0..count).map(|i| i * step_ns) {
        tracker.update(&sun(), &measured(truth, ns, NOISE_RAD, noise), at(ns)).unwrap();
    }
    tracker
}

/// Every ten minutes for a day.
pub const DAY_OF_ATTITUDES: (i64, i64) = (145, 10 * MINUTE_NS);

/// True minus modelled angles at `ns`.
#[must_use]
pub fn errors(truth: &ScanStrategy, model: &ScanStrategy, ns: i64) -> [f64; 3] {
    ScanAngles::modelled(truth, at(ns)).minus(&ScanAngles::modelled(model, at(ns)))
}
