//! Measured attitudes: what the tracker makes of them, what it refuses, and whether its word holds.

use nalgebra::{DMatrix, DVector};
use onboard_core::attitude::attitude;
use onboard_core::direction::Direction;
use onboard_core::ephemeris::{EphemerisError, EphemerisTable};
use onboard_core::field_of_view::FieldOfView;
use onboard_core::frame::{Boresight, Ecliptic, Icrf};
use onboard_core::phase::{Phase, Rotor, TurnRate};
use onboard_core::rotation::Rotation;
use onboard_core::scan::{ScanParameters, ScanStrategy};
use onboard_core::sun::SunModel;
use onboard_core::time::{Duration, Instant};
use onboard_core::tracking::{
    Measurement, Refusal, ResumeError, ScanAngle, ScanAngles, SettingsError, Tracker,
    TrackerSettings,
};
use onboard_core::transit::{Channel, Transit};
use onboard_core::uncertainty::ScanCovariance;
use std::f64::consts::{PI, TAU};
use tests::{Noise, Plain, table, transits, turn_rate};

const ARCSEC: f64 = PI / 648_000.0;
const NOISE_RAD: f64 = 10.0 * ARCSEC;
const MINUTE_NS: i64 = 60_000_000_000;
const DAY_NS: i64 = 86_400_000_000_000;
const RADIUS_RAD: f64 = 0.5 * PI / 180.0;

const SETTINGS: TrackerSettings = TrackerSettings {
    angle_sigmas_rad: [1e-3, 1e-4, 1e-3],
    rate_sigmas: [1e-5, 1e-5],
    angle_walks: [0.0; 3],
    rate_walks: [0.0; 2],
    max_age: Duration::from_ns(5 * MINUTE_NS),
    max_lead: Duration::from_ns(1_000_000),
    gate: 30.0,
    limits_rad: [0.1, 0.01, 0.1],
};

fn at(ns: i64) -> Instant {
    Instant::from_tai_ns(ns)
}

fn sun() -> SunModel<'static> {
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
#[derive(Clone, Copy)]
struct Truth {
    angles: [f64; 3],
    rates: [f64; 2],
}

impl Truth {
    fn drawn(noise: &mut Noise) -> Self {
        Self {
            angles: SETTINGS.angle_sigmas_rad.map(|sigma| sigma * normal(noise)),
            rates: SETTINGS.rate_sigmas.map(|sigma| sigma * normal(noise)),
        }
    }

    /// The true scan where `model` is what is believed.
    fn of(&self, model: &ScanStrategy) -> ScanStrategy {
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

/// An attitude of `scan` with noise about each axis.
fn measured(scan: &ScanStrategy, ns: i64, sigma_rad: f64, noise: &mut Noise) -> Measurement {
    let ([x, y], z) = (normal_pair(noise), normal(noise));
    let shaken = Rotation::<Boresight, Boresight>::from_xyzw({
        let [x, y, z] = [x, y, z].map(|n| 0.5 * sigma_rad * n);
        let length = (1.0 + x * x + y * y + z * z).sqrt();
        [x / length, y / length, z / length, 1.0 / length]
    })
    .unwrap();
    let attitude = shaken.then(attitude(scan, &sun(), at(ns)).unwrap());
    Measurement { at: at(ns), attitude, sigma_rad }
}

/// A tracker that has seen `count` attitudes of `truth`, every `step_ns` from instant 0.
fn tracked(
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
const DAY_OF_ATTITUDES: (i64, i64) = (145, 10 * MINUTE_NS);

fn errors(truth: &ScanStrategy, model: &ScanStrategy, ns: i64) -> [f64; 3] {
    ScanAngles::modelled(truth, at(ns)).minus(&ScanAngles::modelled(model, at(ns)))
}

/// A fixed source that the boresight of `scan` crosses near `ns`, off its centre by a third of the
/// radius.
fn source(scan: &ScanStrategy, ns: i64) -> Vec<u8> {
    let aside = Direction::new(0.0, 0.0, 1.0).unwrap();
    let off = Rotation::<Boresight, Boresight>::about_y(RADIUS_RAD / 3.0);
    let seen = off.then(attitude(scan, &sun(), at(ns)).unwrap()).apply(aside);
    table(1_000_000, 0, 10 * DAY_NS as u64, &[vec![seen.xyz()]])
}

fn found(scan: &ScanStrategy, bytes: &[u8], span: (i64, i64)) -> Vec<Transit> {
    let target = EphemerisTable::parse(bytes).unwrap().body(1_000_000).unwrap();
    let field =
        FieldOfView::circle(Rotation::<Boresight, Boresight>::IDENTITY, RADIUS_RAD).unwrap();
    let span = (at(span.0), at(span.1));
    transits(&mut [Channel::new(scan, sun(), target, &field, span)])
}

#[test]
fn noise_about_three_axes_has_the_stated_covariance() {
    let mut noise = Noise::new(1);
    for alpha_deg in [1.5, 7.5, 45.0, 90.0, 150.0] {
        let plain = Plain { alpha_deg, beta_deg: 20.0, ..Plain::LITEBIRD };
        let scan = plain.strategy();
        let (s, c) = (alpha_deg.to_radians().sin(), alpha_deg.to_radians().cos());
        let draws = 40_000;
        let mut sums = [[0.0; 3]; 3];
        for _ in 0..draws {
            let shaken = measured(&scan, 123_456_789_012, NOISE_RAD, &mut noise);
            let seen = ScanAngles::measured(shaken.attitude, &scan, &sun(), shaken.at).unwrap();
            let off = seen.minus(&ScanAngles::modelled(&scan, shaken.at)).map(|e| e / NOISE_RAD);
            for (row, a) in sums.iter_mut().zip(off) {
                for (cell, b) in row.iter_mut().zip(off) {
                    *cell += a * b / f64::from(draws);
                }
            }
        }
        let stated = [
            [1.0 / (s * s), 0.0, -c / (s * s)],
            [0.0, 1.0, 0.0],
            [-c / (s * s), 0.0, 1.0 / (s * s)],
        ];
        for i in 0..3 {
            for j in 0..3 {
                // A sample covariance scatters by sqrt((C_ii C_jj + C_ij^2) / draws).
                let scatter = ((stated[i][i] * stated[j][j] + stated[i][j] * stated[i][j])
                    / f64::from(draws))
                .sqrt();
                let off = (sums[i][j] - stated[i][j]) / scatter;
                assert!(off.abs() < 4.5, "alpha {alpha_deg}, ({i}, {j}): {off} sigma");
            }
        }
    }
}

#[test]
fn beta_does_not_matter_to_the_angles() {
    for beta_deg in [0.0, 1e-9, 50.0, 90.0, 135.0] {
        let scan = Plain { beta_deg, ..Plain::LITEBIRD }.strategy();
        for ns in [0, 1, 987_654_321_012_345, 94_672_800_000_000_000] {
            let seen = attitude(&scan, &sun(), at(ns)).unwrap();
            let seen = ScanAngles::measured(seen, &scan, &sun(), at(ns)).unwrap();
            for off in seen.minus(&ScanAngles::modelled(&scan, at(ns))) {
                assert!(off.abs() < 1e-14, "beta {beta_deg}: {off:e}");
            }
        }
    }
}

/// Estimates and covariance by one least-squares solution over all measurements and the prior.
fn batch(model: &ScanStrategy, measurements: &[Measurement]) -> (DVector<f64>, DMatrix<f64>) {
    let rates = [model.parameters().precession.rate, model.parameters().spin.rate];
    let mut information = DMatrix::zeros(5, 5);
    for (i, sigma) in SETTINGS.angle_sigmas_rad.iter().enumerate() {
        information[(i, i)] = 1.0 / (sigma * sigma);
    }
    for (i, (sigma, rate)) in SETTINGS.rate_sigmas.iter().zip(rates).enumerate() {
        information[(3 + i, 3 + i)] = 1.0 / (sigma * rate.radians_per_second()).powi(2);
    }
    let mut right = DVector::zeros(5);
    let last = measurements.last().unwrap().at;
    for m in measurements {
        let seen = ScanAngles::measured(m.attitude, model, &sun(), m.at).unwrap();
        let off = DVector::from_row_slice(&seen.minus(&ScanAngles::modelled(model, m.at)));
        let t = m.at.since(at(0)).seconds();
        let h = DMatrix::from_row_slice(
            3,
            5,
            &[1.0, 0.0, 0.0, t, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, t],
        );
        let (s, c) = seen.alpha_rad.sin_cos();
        let noise = DMatrix::from_row_slice(
            3,
            3,
            &[1.0 / (s * s), 0.0, -c / (s * s), 0.0, 1.0, 0.0, -c / (s * s), 0.0, 1.0 / (s * s)],
        ) * (m.sigma_rad * m.sigma_rad);
        let weight = noise.try_inverse().unwrap();
        information += h.transpose() * &weight * &h;
        right += h.transpose() * weight * off;
    }
    // Scaled to unit diagonal before inversion: the rates' errors are tiny numbers.
    let scale = DMatrix::from_diagonal(&information.diagonal().map(|d| 1.0 / d.sqrt()));
    let covariance = &scale * (&scale * &information * &scale).try_inverse().unwrap() * &scale;
    let mut forward = DMatrix::identity(5, 5);
    let t = last.since(at(0)).seconds();
    (forward[(0, 3)], forward[(2, 4)]) = (t, t);
    let estimate = &forward * &covariance * right;
    (estimate, &forward * covariance * forward.transpose())
}

#[test]
fn the_filter_agrees_with_least_squares_over_all_data() {
    for (seed, plain) in (10..).zip([Plain::LITEBIRD, Plain::PICO, Plain::PLANCK]) {
        let mut noise = Noise::new(seed);
        let model = plain.strategy();
        let truth = Truth::drawn(&mut noise).of(&model);
        let all: Vec<_> =
            (0..40).map(|i| measured(&truth, i * 7 * MINUTE_NS, NOISE_RAD, &mut noise)).collect();
        let mut tracker = Tracker::new(&model, &SETTINGS, at(0)).unwrap();
        for m in &all {
            tracker.update(&sun(), m, m.at).unwrap();
        }
        let (estimate, covariance) = batch(&model, &all);
        let last = tracker.epoch().tai_ns();
        let ours = errors(tracker.strategy(), &model, last);
        let ScanCovariance { variances, covariances } = tracker.covariance_at(at(last));
        for i in 0..3 {
            let sigma = covariance[(i, i)].sqrt();
            let off = (ours[i] - estimate[i]) / sigma;
            assert!(off.abs() < 1e-3, "estimate {i}: {off:e} sigma");
            assert!((variances[i] / covariance[(i, i)] - 1.0).abs() < 1e-4, "variance {i}");
        }
        for (ours, (i, j)) in covariances.iter().zip([(0, 1), (0, 2), (1, 2)]) {
            let size = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
            assert!((ours - covariance[(i, j)]).abs() < 1e-4 * size, "covariance {i} {j}");
        }
        let (new, old) = (tracker.strategy().parameters(), model.parameters());
        let changes = [
            new.precession.rate.radians_per_second() - old.precession.rate.radians_per_second(),
            new.spin.rate.radians_per_second() - old.spin.rate.radians_per_second(),
        ];
        for (i, (change, sigma)) in (3..).zip(changes.iter().zip(tracker.rate_sigmas_rad_s())) {
            assert!((sigma / covariance[(i, i)].sqrt() - 1.0).abs() < 1e-4, "rate sigma {i}");
            assert!((change - estimate[i]).abs() < 1e-3 * sigma, "rate {i}");
        }
    }
}
