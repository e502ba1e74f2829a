//! Whether the tracker's word holds: its estimates, its predictions, its stated intervals.

use nalgebra::{DMatrix, DVector};
use onboard_core::attitude::attitude;
use onboard_core::direction::Direction;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::field_of_view::FieldOfView;
use onboard_core::frame::{Boresight, Ecliptic};
use onboard_core::rotation::Rotation;
use onboard_core::scan::ScanStrategy;
use onboard_core::tracking::{Measurement, ScanAngles, Tracker};
use onboard_core::transit::{Channel, Transit};
use onboard_core::uncertainty::ScanCovariance;
use std::f64::consts::PI;
use tests::attitudes::{
    DAY_NS, DAY_OF_ATTITUDES, MINUTE_NS, NOISE_RAD, SETTINGS, Truth, at, errors, measured, sun,
    tracked,
};
use tests::{Noise, Plain, table, transits};

const RADIUS_RAD: f64 = 0.5 * PI / 180.0;

/// The direction a third of the radius aside of the line of sight at `ns`.
fn beside(scan: &ScanStrategy, ns: i64) -> Direction<Ecliptic> {
    let aside = Rotation::<Boresight, Boresight>::about_y(RADIUS_RAD / 3.0);
    aside.then(attitude(scan, &sun(), at(ns)).unwrap()).apply(Direction::Z)
}

/// A fixed source that the boresight of `scan` passes at `ns`, a third of the radius aside.
fn source(scan: &ScanStrategy, ns: i64) -> Vec<u8> {
    table(1_000_000, 0, 10 * DAY_NS as u64, &[vec![beside(scan, ns).xyz()]])
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

/// Entry, exit and closest approach of predicted transits against true ones, worst case in seconds.
fn worst_times(predicted: &[Transit], real: &[Transit]) -> (f64, usize) {
    // A transit that grazes moves its ends by far more than the scan moves; a tenth of the radius
    // as half-chord bounds that to ten times.
    let grazing = RADIUS_RAD * 0.99_f64.sqrt();
    let (mut worst, mut compared) = (0.0_f64, 0);
    for (these, others) in [(predicted, real), (real, predicted)] {
        for one in these.iter().filter(|t| t.min_separation_rad < grazing) {
            let apart = |t: &Transit| t.closest.since(one.closest).seconds().abs();
            let other = others.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
            let ends = [
                one.entry.since(other.entry),
                one.exit.since(other.exit),
                one.closest.since(other.closest),
            ];
            worst = ends.iter().fold(worst, |worst, end| worst.max(end.seconds().abs()));
            compared += 1;
        }
    }
    (worst, compared)
}

#[test]
fn transits_a_day_ahead_hold_a_tenth_of_a_second() {
    for (seed, plain) in (20..).zip([Plain::LITEBIRD, Plain::PICO, Plain::PLANCK]) {
        for signs in [(1, 1), (-1, 1), (1, -1), (-1, -1)] {
            let mut noise = Noise::new(seed);
            let model = Plain { signs, ..plain }.strategy();
            let truth = Truth { rates: [1e-5, 1e-5], ..Truth::drawn(&mut noise) }.of(&model);
            let tracker = tracked(&model, &truth, DAY_OF_ATTITUDES, &mut noise);
            let mut all = 0;
            for sources in 0..8 {
                let centre = 2 * DAY_NS + sources * 2_345_678_901_234;
                let bytes = source(&truth, centre);
                let span = (2 * DAY_NS, 2 * DAY_NS + DAY_NS / 4);
                let real = found(&truth, &bytes, span);
                let (worst, compared) =
                    worst_times(&found(tracker.strategy(), &bytes, span), &real);
                assert!(worst < 0.1, "{signs:?}: {worst} s");
                all += compared;
            }
            assert!(all >= 16, "only {all} transits compared");
        }
    }
}

/// Stated and actual spread of a quantity over many seeds.
#[derive(Default)]
struct Spread {
    /// Actual error and stated standard deviation.
    cases: Vec<(f64, f64)>,
}

impl Spread {
    fn add(&mut self, error: f64, variance: f64) {
        self.cases.push((error, variance.sqrt()));
    }

    /// The stated 95 % interval must hold the truth in 93 to 97 % of the cases and be at most 1.5
    /// times as wide as the interval that holds 95 % of the errors.
    fn hold(&self, what: &str) {
        let count = self.cases.len();
        let inside = self.cases.iter().filter(|(e, sigma)| e.abs() <= 1.96 * sigma).count();
        let share = inside as f64 / count as f64;
        let mut errors: Vec<f64> = self.cases.iter().map(|(e, _)| e.abs()).collect();
        errors.sort_by(f64::total_cmp);
        let actual = errors[count * 95 / 100];
        let stated = 1.96 * self.cases.iter().map(|(_, sigma)| sigma).sum::<f64>() / count as f64;
        assert!((0.93..=0.97).contains(&share), "{what}: {share} inside");
        assert!(stated <= 1.5 * actual, "{what}: stated {stated:e}, actual {actual:e}");
    }
}

const SEEDS: u64 = 1_000;

/// Separation of the line of sight from a fixed direction.
fn separation(scan: &ScanStrategy, target: Direction<Ecliptic>, ns: i64) -> f64 {
    attitude(scan, &sun(), at(ns)).unwrap().apply(Direction::Z).separation_rad(target)
}

/// About how long before `ns` a target beside the line of sight entered the circle: the chord is
/// nearly straight, so the separation's square grows with that of the time.
fn half_chord_s(scan: &ScanStrategy, target: Direction<Ecliptic>, ns: i64) -> f64 {
    let later = separation(scan, target, ns + 10_000_000);
    let aside = RADIUS_RAD / 3.0;
    0.01 * ((RADIUS_RAD * RADIUS_RAD - aside * aside) / (later * later - aside * aside)).sqrt()
}

/// The instant near `ns` at which the target enters the circle, in seconds after `ns`.
fn entry(scan: &ScanStrategy, target: Direction<Ecliptic>, ns: i64) -> f64 {
    let depth = |s: f64| separation(scan, target, ns + (s * 1e9).round() as i64) - RADIUS_RAD;
    let (mut before, mut here) = (-0.05, 0.05);
    let (mut far, mut near) = (depth(before), depth(here));
    for _ in 0..12 {
        if (here - before).abs() < 1e-8 {
            break;
        }
        let next = here - near * (here - before) / (near - far);
        (before, far) = (here, near);
        (here, near) = (next, depth(next));
    }
    assert!(near.abs() < 1e-9, "no entry near {ns}: {near}");
    here
}

/// How the predicted entry moves with each angle, in s/rad, by central differences.
fn entry_gradient(scan: &ScanStrategy, target: Direction<Ecliptic>, ns: i64) -> [f64; 3] {
    let h = 1e-5;
    let rate = (separation(scan, target, ns + 1_000_000)
        - separation(scan, target, ns - 1_000_000))
        / 2e-3;
    let moved =
        |angles: [f64; 3]| separation(&Truth { angles, rates: [0.0; 2] }.of(scan), target, ns);
    [0, 1, 2].map(|i| {
        let mut step = [0.0; 3];
        step[i] = h;
        -(moved(step) - moved(step.map(|e| -e))) / (2.0 * h) / rate
    })
}

/// Runs `SEEDS` truths and trackers, and holds every angle's and an entry's stated interval at
/// `predicted_ns`.
fn intervals_hold(
    name: &str,
    plain: Plain,
    predicted_ns: i64,
    run: impl Fn(&ScanStrategy, &mut Noise) -> (ScanStrategy, Tracker),
) {
    let model = plain.strategy();
    let mut spreads: [Spread; 4] = Default::default();
    for seed in 0..SEEDS {
        let mut noise = Noise::new(seed.wrapping_mul(7_919).wrapping_add(plain.spin_ns));
        let (truth, tracker) = run(&model, &mut noise);
        let scan = tracker.strategy();
        let covariance = tracker.covariance_at(at(predicted_ns));
        let off = errors(&truth, scan, predicted_ns);
        for ((spread, error), variance) in spreads.iter_mut().zip(off).zip(covariance.variances) {
            spread.add(error, variance);
        }
        let target = beside(scan, predicted_ns);
        let near = predicted_ns - (half_chord_s(scan, target, predicted_ns) * 1e9) as i64;
        let predicted = near + (entry(scan, target, near) * 1e9) as i64;
        let late = entry(&truth, target, predicted);
        let gradient = entry_gradient(scan, target, predicted);
        spreads[3].add(late, tracker.covariance_at(at(predicted)).along(gradient));
    }
    for (spread, what) in spreads.iter().zip(["precession", "alpha", "spin", "entry"]) {
        spread.hold(&format!("{name}: {what}"));
    }
}

#[test]
// REQ-TRACK-2.
fn a_day_after_a_day_of_attitudes_the_intervals_hold() {
    for (name, plain) in [("LiteBIRD", Plain::LITEBIRD), ("Planck", Plain::PLANCK)] {
        intervals_hold(name, plain, 2 * DAY_NS, |model, noise| {
            let truth = Truth { rates: [0.0, 1e-5], ..Truth::drawn(noise) }.of(model);
            let tracker = tracked(model, &truth, DAY_OF_ATTITUDES, noise);
            (truth, tracker)
        });
    }
}

#[test]
fn a_day_after_a_single_attitude_the_intervals_hold() {
    for (name, plain) in [("LiteBIRD", Plain::LITEBIRD), ("Planck", Plain::PLANCK)] {
        intervals_hold(name, plain, DAY_NS, |model, noise| {
            let truth = Truth::drawn(noise).of(model);
            let tracker = tracked(model, &truth, (1, 1), noise);
            (truth, tracker)
        });
    }
}
