//! One test for each rule of the tracker: what it takes in, what it refuses, and by how much it
//! corrects.

extern crate std;

use super::filter::ErrorCovariance;
use super::{
    Measurement, MeasurementRefusal, Noise, ResumeError, ScanAngle, Tracker, TrackerSettings,
    anchored, corrected, identity, prior,
};
use crate::attitude::attitude;
use crate::phase::{Phase, Rotor, TurnRate};
use crate::scan::{ScanParameters, ScanStrategy};
use crate::sun::SunModel;
use crate::time::{Duration, Instant};
use nalgebra::{Matrix3, Vector3};
use std::vec::Vec;

const SECOND: i64 = 1_000_000_000;
const EPOCH: Instant = Instant::from_tai_ns(50 * SECOND);
const NOISE_RAD: f64 = 1e-5;

const SETTINGS: TrackerSettings = TrackerSettings {
    angle_sigmas_rad: [0.02, 0.01, 0.03],
    rate_sigmas: [1e-4, 2e-4],
    angle_walks: [1e-6, 2e-6, 3e-6],
    rate_walks: [1e-9, 2e-9],
    max_age: Duration::from_ns(30 * SECOND),
    max_lead: Duration::from_ns(2 * SECOND),
    gate: 16.0,
    limits_rad: [0.2; 3],
};

fn parameters() -> ScanParameters {
    let rotor = |rate, start| Rotor {
        rate: TurnRate::from_radians_per_second(rate),
        start: Phase::from_radians(start),
    };
    ScanParameters {
        start: Instant::from_tai_ns(0),
        alpha_rad: 0.8,
        beta_rad: 0.9,
        precession: rotor(5e-4, 0.3),
        spin: rotor(5e-3, -1.0),
    }
}

fn model() -> ScanStrategy {
    ScanStrategy::new(parameters()).unwrap()
}

fn sun() -> SunModel<'static> {
    let rate = TurnRate::from_radians_per_second(2e-7);
    SunModel::Circular(Rotor { rate, start: Phase::from_radians(0.4) })
}

/// The model with these errors in precession phase, alpha and spin phase.
fn off([precession, alpha, spin]: [f64; 3]) -> ScanStrategy {
    let mut there = parameters();
    there.precession.start = there.precession.start.plus(Phase::from_radians(precession));
    there.alpha_rad += alpha;
    there.spin.start = there.spin.start.plus(Phase::from_radians(spin));
    ScanStrategy::new(there).unwrap()
}

fn seen(truth: &ScanStrategy, at: Instant) -> Measurement {
    Measurement { at, attitude: attitude(truth, &sun(), at).unwrap(), sigma_rad: NOISE_RAD }
}

fn after(ns: i64) -> Instant {
    EPOCH.plus(Duration::from_ns(ns))
}

fn tracker() -> Tracker {
    Tracker::new(&model(), &SETTINGS, EPOCH).unwrap()
}

/// A tracker that has taken a first attitude of the truth.
fn settled(truth: &ScanStrategy) -> Tracker {
    let mut tracker = tracker();
    tracker.update(&sun(), &seen(truth, EPOCH), EPOCH).unwrap();
    tracker
}

fn nearly(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * b.abs().max(1e-30)
}

#[test]
fn an_attitude_tells_its_angles_as_well_as_geometry_allows() {
    let alpha: f64 = 0.8;
    let noise = Noise::new(1e-5, alpha);
    let certain = ErrorCovariance::diagonal([0.0; 5]);
    let [a, tilt, b] = noise.with(&certain);
    assert!(nearly(a, 1e-5 / alpha.sin()) && nearly(tilt, 1e-5) && nearly(b, a));
    assert!(nearly(noise.sum, (1e-5 / (0.5 * alpha).cos()).powi(2)));
    assert!(nearly(noise.difference, (1e-5 / (0.5 * alpha).sin()).powi(2)));
    let known = ErrorCovariance::diagonal([4e-10, 9e-10, 16e-10, 0.0, 0.0]);
    let [a_known, tilt_known, b_known] = noise.with(&known);
    assert!(nearly(a_known * a_known, a * a + 4e-10));
    assert!(nearly(tilt_known * tilt_known, tilt * tilt + 9e-10));
    assert!(nearly(b_known * b_known, b * b + 16e-10));
}

/// The covariance of the angles as a matrix.
fn matrix(covariance: &ErrorCovariance) -> Matrix3<f64> {
    let angles = covariance.angles();
    let ([a, b, c], [ab, ac, bc]) = (angles.variances, angles.covariances);
    Matrix3::new(a, ab, ac, ab, b, bc, ac, bc, c)
}

#[test]
fn chi_squared_and_correction_are_those_of_all_three_angles_together() {
    let alpha: f64 = 0.8;
    let (sin, cos) = alpha.sin_cos();
    let noise = Noise::new(2e-3, alpha);
    // As the head of `angles.rs` has it.
    let noise_part = Matrix3::new(1.0, 0.0, -cos, 0.0, sin * sin, 0.0, -cos, 0.0, 1.0)
        * (2e-3_f64 / sin).powi(2);
    let mut covariance = ErrorCovariance::diagonal([4e-6, 1e-6, 9e-6, 1e-12, 4e-12]);
    covariance.propagate(1_000.0, &SETTINGS.walks());
    // Correlated angles to begin with.
    covariance.observe(&mut [0.0; 5], &[1.0, 0.5, -0.3, 0.0, 0.0], 0.0, 1e-6);
    for innovation in [[1e-3, 0.0, 0.0], [0.0, 2e-3, 0.0], [0.0, 0.0, -3e-3], [1e-3, -2e-3, 4e-3]] {
        let (mut own, mut errors) = (covariance, [0.0; 5]);
        let before = matrix(&own);
        let chi2 = noise.observe(&mut own, &mut errors, innovation);
        let inverse = (before + noise_part).try_inverse().unwrap();
        let told = Vector3::from(innovation);
        let weighed = inverse * told;
        assert!(nearly(chi2, told.dot(&weighed)), "{innovation:?}: {chi2}");
        let expected = before * weighed;
        let [a, tilt, b, ..] = errors;
        for (got, expected) in [a, tilt, b].into_iter().zip(expected.iter()) {
            assert!((got - expected).abs() < 1e-12, "{got} {expected}");
        }
        let left = before - before * inverse * before;
        assert!((matrix(&own) - left).norm() < 1e-9 * left.norm());
    }
}

#[test]
fn what_is_known_before_is_as_the_settings_say() {
    let known = prior(&model(), &SETTINGS);
    let [a, alpha, b] = known.angles().variances;
    assert!(nearly(a, 4e-4) && nearly(alpha, 1e-4) && nearly(b, 9e-4));
    let [a_rate, b_rate] = known.rate_variances();
    assert!(nearly(a_rate, 5e-8_f64.powi(2)) || (a_rate.sqrt() / 5e-8 - 1.0).abs() < 1e-6);
    assert!((b_rate.sqrt() / 1e-6 - 1.0).abs() < 1e-6);
    let sigmas = tracker().rate_sigmas_rad_s();
    assert!((sigmas[0] / 5e-8 - 1.0).abs() < 1e-6 && (sigmas[1] / 1e-6 - 1.0).abs() < 1e-6);
}

#[test]
// REQ-TRACK-2.
fn what_is_known_fades_with_time_in_both_directions() {
    let tracker = tracker();
    let [now, later, before] =
        [0, 400 * SECOND, -400 * SECOND].map(|ns| tracker.covariance_at(after(ns)).variances);
    let [_, alpha, spin] = now;
    assert!(nearly(later[1], alpha + 4e-12 * 400.0) && nearly(before[1], later[1]));
    let grown = spin + (1e-6_f64 * 400.0).powi(2) + 9e-12 * 400.0 + 4e-18 * 400.0_f64.powi(3) / 3.0;
    assert!((later[2] / grown - 1.0).abs() < 1e-6, "{} {grown}", later[2]);
}

#[test]
// REQ-TRACK-1.
fn an_attitude_corrects_the_strategy_there_and_then() {
    let errors = [3e-3, -2e-3, 5e-3];
    let truth = off(errors);
    let mut tracker = tracker();
    let shown = tracker.update(&sun(), &seen(&truth, after(20 * SECOND)), after(21 * SECOND));
    let shown = shown.unwrap();
    for (innovation, error) in shown.innovation_rad.into_iter().zip(errors) {
        assert!((innovation - error).abs() < 1e-9);
    }
    assert!(shown.chi2 > 0.0 && shown.chi2 < SETTINGS.gate);
    assert_eq!((tracker.accepted(), tracker.refused_in_a_row()), (1, 0));
    assert_eq!(tracker.epoch(), after(20 * SECOND));
    let at = after(20 * SECOND);
    let (own, real) = (tracker.strategy(), truth.phases(at));
    let phases = own.phases(at);
    let left = |own: Phase, real: Phase| real.plus(own.negated()).radians().abs();
    assert!(left(phases.0, real.0) < 1e-5 && left(phases.1, real.1) < 1e-5);
    assert!((own.parameters().alpha_rad - truth.parameters().alpha_rad).abs() < 1e-6);
    let known = tracker.covariance_at(at).variances.map(f64::sqrt);
    assert!(known.into_iter().all(|sigma| sigma > 0.5 * NOISE_RAD && sigma < 3.0 * NOISE_RAD));
}

#[test]
// REQ-TRACK-1.
fn age_and_lead_count_to_the_last_nanosecond() {
    let truth = model();
    let at = after(100 * SECOND);
    let told = |now: Instant| tracker().update(&sun(), &seen(&truth, at), now).map(|_| ());
    let (age, lead) = (SETTINGS.max_age, SETTINGS.max_lead);
    let later = |ns: i64| at.plus(Duration::from_ns(ns));
    assert_eq!(told(later(age.ns())), Ok(()));
    let stale = Duration::from_ns(age.ns() + 1);
    assert_eq!(told(later(stale.ns())), Err(MeasurementRefusal::Stale(stale)));
    assert_eq!(told(later(-lead.ns())), Ok(()));
    let future = Duration::from_ns(lead.ns() + 1);
    assert_eq!(told(later(-future.ns())), Err(MeasurementRefusal::Future(future)));
}

#[test]
// REQ-TRACK-1.
fn attitudes_come_in_order_and_only_the_first_at_the_epoch() {
    let truth = model();
    let told = |tracker: &mut Tracker, ns: i64| {
        tracker.update(&sun(), &seen(&truth, after(ns)), after(ns)).map(|_| ())
    };
    let not_after = |ns: i64| Err(MeasurementRefusal::NotAfter(after(ns)));
    assert_eq!(told(&mut tracker(), -1), not_after(0));
    assert_eq!(told(&mut tracker(), 0), Ok(()));
    assert_eq!(told(&mut tracker(), 1), Ok(()));
    let mut tracker = tracker();
    assert_eq!(told(&mut tracker, SECOND), Ok(()));
    assert_eq!(told(&mut tracker, SECOND), not_after(SECOND));
    assert_eq!(told(&mut tracker, SECOND - 1), not_after(SECOND));
    assert_eq!((tracker.accepted(), tracker.refused_in_a_row()), (1, 2));
    assert_eq!(told(&mut tracker, SECOND + 1), Ok(()));
    assert_eq!((tracker.accepted(), tracker.refused_in_a_row()), (2, 0));
}

#[test]
// REQ-TRACK-1.
fn the_stated_noise_is_within_its_range() {
    let told = |sigma_rad: f64| {
        let m = Measurement { sigma_rad, ..seen(&model(), EPOCH) };
        tracker().update(&sun(), &m, EPOCH).map(|_| ())
    };
    for sigma_rad in [1e-7, 1e-3] {
        assert_eq!(told(sigma_rad), Ok(()));
    }
    for sigma_rad in [0.99e-7, 1.01e-3] {
        assert_eq!(told(sigma_rad), Err(MeasurementRefusal::Sigma(sigma_rad)));
    }
}

#[test]
// REQ-TRACK-1.
fn alpha_must_tell_precession_from_spin() {
    let degree = core::f64::consts::PI / 180.0;
    let told = |alpha_rad: f64| {
        let scan = ScanStrategy::new(ScanParameters { alpha_rad, beta_rad: 0.01, ..parameters() });
        let scan = scan.unwrap();
        let mut tracker = Tracker::new(&scan, &SETTINGS, EPOCH).unwrap();
        tracker.update(&sun(), &seen(&scan, EPOCH), EPOCH)
    };
    for alpha in [1.001 * degree, 178.999 * degree] {
        assert!(told(alpha).is_ok(), "{alpha}");
    }
    for alpha in [0.999 * degree, 179.001 * degree] {
        let refused = told(alpha);
        assert!(matches!(refused, Err(MeasurementRefusal::Unobservable(_))), "{refused:?}");
    }
}

#[test]
// REQ-TRACK-1.
fn a_phase_known_worse_than_an_eighth_of_a_turn_is_ambiguous() {
    let eighth = core::f64::consts::FRAC_PI_4;
    let told = |precession: f64, spin: f64| {
        let settings = TrackerSettings {
            angle_sigmas_rad: [precession, 0.01, spin],
            rate_sigmas: [0.01; 2],
            ..SETTINGS
        };
        let mut tracker = Tracker::new(&model(), &settings, EPOCH).unwrap();
        // After so long the rates' errors have grown into the phases.
        let at = after(60_000 * SECOND);
        let sigma = tracker.covariance_at(at).variances.map(f64::sqrt);
        let truth = model();
        (sigma, tracker.update(&sun(), &seen(&truth, at), at).map(|_| ()))
    };
    let (sigma, refused) = told(0.5, 0.0);
    assert!(sigma[2] > eighth && sigma[0] < eighth, "{sigma:?}");
    let spin = matches!(refused, Err(MeasurementRefusal::Ambiguous(ScanAngle::Spin, _)));
    assert!(spin, "{refused:?}");
    let settings = TrackerSettings { rate_sigmas: [0.01, 0.0], ..SETTINGS };
    let mut tracker = Tracker::new(&model(), &settings, EPOCH).unwrap();
    let told = |tracker: &mut Tracker, seconds: i64| {
        let at = after(seconds * SECOND);
        tracker.update(&sun(), &seen(&model(), at), at).map(|_| ())
    };
    // 5e-6 rad/s unknown: an eighth of a turn after 157,000 s.
    let refused = told(&mut tracker, 160_000);
    let precession =
        matches!(refused, Err(MeasurementRefusal::Ambiguous(ScanAngle::Precession, _)));
    assert!(precession, "{refused:?}");
    assert_eq!(told(&mut tracker, 150_000), Ok(()));
}

#[test]
// REQ-TRACK-1.
fn the_gate_is_the_largest_chi_squared_taken() {
    let truth = off([0.03, 0.0, 0.0]);
    let told = |gate: f64| {
        let settings = TrackerSettings { gate, ..SETTINGS };
        let mut tracker = Tracker::new(&model(), &settings, EPOCH).unwrap();
        let answer = tracker.update(&sun(), &seen(&truth, EPOCH), EPOCH);
        (answer, tracker)
    };
    let chi2 = told(1e4).0.unwrap().chi2;
    assert!(chi2 > 1.0 && chi2 < 16.0);
    assert!(told(chi2).0.is_ok());
    let (refused, left) = told(chi2.next_down());
    assert!(
        matches!(refused, Err(MeasurementRefusal::Outlier(it)) if it.chi2.to_bits() == chi2.to_bits())
    );
    assert_eq!((left.accepted(), left.refused_in_a_row()), (0, 1));
    assert_eq!(left.strategy().parameters(), &parameters());
}

#[test]
// REQ-TRACK-1.
fn every_angle_has_its_own_limit() {
    let limits = [0.02, 0.01, 0.03];
    for (place, angle) in super::settings::ANGLES.into_iter().enumerate() {
        let told = |by: f64| {
            let mut errors = [0.0; 3];
            errors[place] = by * limits[place];
            let settings = TrackerSettings { limits_rad: limits, gate: 1e4, ..SETTINGS };
            let mut tracker = Tracker::new(&model(), &settings, EPOCH).unwrap();
            tracker.update(&sun(), &seen(&off(errors), EPOCH), EPOCH).map(|_| ())
        };
        for sign in [1.0, -1.0] {
            assert_eq!(told(0.999 * sign), Ok(()));
            let refused = told(1.001 * sign);
            let named =
                matches!(refused, Err(MeasurementRefusal::Correction(it, _)) if it == angle);
            assert!(named, "{refused:?}");
        }
    }
}

#[test]
fn a_corrected_rotor_holds_at_the_measurement() {
    let rotor = parameters().spin;
    let elapsed = Duration::from_ns(1_234 * SECOND);
    let moved = anchored(rotor, elapsed, 0.01, 1e-6);
    let turned = |later: Duration| moved.phase(later).plus(rotor.phase(later).negated()).radians();
    assert!((turned(elapsed) - 0.01).abs() < 1e-12);
    let later = Duration::from_ns(elapsed.ns() + 1_000 * SECOND);
    assert!((turned(later) - 0.011).abs() < 1e-9);
    let scan = corrected(&model(), &[0.02, 0.03, 0.04, 2e-7, 3e-7], EPOCH);
    let there = ScanStrategy::new(scan).unwrap();
    let (own, old) = (there.phases(EPOCH), model().phases(EPOCH));
    assert!((own.0.plus(old.0.negated()).radians() - 0.02).abs() < 1e-12);
    assert!((own.1.plus(old.1.negated()).radians() - 0.04).abs() < 1e-12);
    assert!((scan.alpha_rad - parameters().alpha_rad - 0.03).abs() < 1e-15);
    let faster =
        |own: Rotor, old: Rotor| own.rate.radians_per_second() - old.rate.radians_per_second();
    assert!((faster(scan.precession, parameters().precession) - 2e-7).abs() < 1e-15);
    assert!((faster(scan.spin, parameters().spin) - 3e-7).abs() < 1e-15);
    assert_eq!((scan.start, scan.beta_rad), (parameters().start, parameters().beta_rad));
}

#[test]
fn a_restart_forgets_all() {
    let truth = off([3e-3, 1e-3, 2e-3]);
    let mut tracker = settled(&truth);
    tracker.update(&sun(), &seen(&truth, EPOCH), EPOCH).unwrap_err();
    assert_eq!((tracker.accepted(), tracker.refused_in_a_row()), (1, 1));
    let other = off([0.1, 0.1, 0.1]);
    tracker.restart(&other, after(7 * SECOND));
    let fresh = Tracker::new(&other, &SETTINGS, after(7 * SECOND)).unwrap();
    assert_eq!(tracker.state(), fresh.state());
    assert_eq!((tracker.accepted(), tracker.refused_in_a_row()), (0, 0));
}

#[test]
// REQ-TRACK-3.
fn a_state_goes_on_only_where_it_began() {
    let truth = off([3e-3, 1e-3, 2e-3]);
    let mut saved = settled(&truth);
    saved.update(&sun(), &seen(&truth, EPOCH), EPOCH).unwrap_err();
    let state = saved.state();
    let mut again = tracker();
    assert_eq!(again.resume(&state), Ok(()));
    assert_eq!(again.state(), state);
    assert_eq!((again.accepted(), again.refused_in_a_row(), again.epoch()), (1, 1, EPOCH));
    assert_eq!(again.strategy().parameters(), saved.strategy().parameters());

    let refused = |state| {
        let mut fresh = tracker();
        let before = fresh.state();
        let why = fresh.resume(&state).unwrap_err();
        assert_eq!(fresh.state(), before);
        why
    };
    let mut other = state;
    other.nominal ^= 1;
    assert_eq!(refused(other), ResumeError::OtherStrategy);
    let mut other = state;
    other.scan.start = after(1);
    assert_eq!(refused(other), ResumeError::OtherStrategy);
    let mut other = state;
    other.scan.beta_rad = other.scan.beta_rad.next_up();
    assert_eq!(refused(other), ResumeError::OtherStrategy);
    let mut other = state;
    other.scan.alpha_rad = f64::NAN;
    assert!(matches!(refused(other), ResumeError::Scan(_)));
    let mut other = state;
    other.covariance = ErrorCovariance::diagonal([-1.0, 1.0, 1.0, 1.0, 1.0]);
    assert_eq!(refused(other), ResumeError::Covariance);
    let nominal: Vec<u32> =
        [model(), off([0.0, 0.0, 1e-6]), off([0.0, 1e-6, 0.0])].iter().map(identity).collect();
    assert!(nominal[0] != nominal[1] && nominal[0] != nominal[2]);
}

#[test]
// REQ-TRACK-1.
fn the_eighth_of_a_turn_and_the_limit_themselves_are_taken() {
    let eighth = super::MAX_PHASE_SIGMA_RAD;
    let noise = Noise { sum: 0.0, alpha: 1e-10, difference: 0.0 };
    let told = |variance: f64| {
        let mut tracker = tracker();
        tracker.covariance = ErrorCovariance::diagonal([variance, 1e-4, 1e-4, 0.0, 0.0]);
        tracker.take(EPOCH, [0.0; 3], &noise).map(|_| ())
    };
    let mut variance = eighth * eighth;
    while variance.sqrt() > eighth {
        variance = variance.next_down();
    }
    assert_eq!(variance.sqrt().to_bits(), eighth.to_bits());
    assert_eq!(told(variance), Ok(()));
    let refused = told(eighth.next_up() * eighth.next_up() * (1.0 + 1e-15));
    assert!(matches!(refused, Err(MeasurementRefusal::Ambiguous(ScanAngle::Precession, _))));

    let truth = off([0.0, 0.005, 0.0]);
    let told = |limit: f64| {
        let settings = TrackerSettings { limits_rad: [0.2, limit, 0.2], ..SETTINGS };
        let mut tracker = Tracker::new(&model(), &settings, EPOCH).unwrap();
        tracker.update(&sun(), &seen(&truth, EPOCH), EPOCH).map(|_| ())
    };
    let Err(MeasurementRefusal::Correction(ScanAngle::Alpha, error)) = told(0.004) else {
        panic!("beyond its limit")
    };
    assert_eq!(told(error.abs()), Ok(()));
}
