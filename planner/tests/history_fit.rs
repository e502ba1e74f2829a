//! Fits of synthetic histories: known errors come back, as well as the covariance says.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "a test may turn numbers into others"
)]

use ephem::random::SplitMix64;
use mission::{Mission, Override};
use onboard_core::attitude::attitude;
use onboard_core::frame::Boresight;
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::scan::ScanStrategy;
use onboard_core::sun::SunModel;
use onboard_core::time::{Duration, Instant};
use planner::history_fit::{Estimate, Fit, FitError, Measured, Observable, fit};

const ARCSEC: f64 = std::f64::consts::PI / 648_000.0;

fn model(mission: &str, settings: &[&str]) -> (ScanStrategy, SunModel<'static>) {
    let mut all = vec![Override::set("orbit.sun=circular").unwrap()];
    all.extend(settings.iter().map(|it| Override::set(it).unwrap()));
    let mission = Mission::load(mission, &all).unwrap();
    let start = Instant::from_tai_ns(1_017_662_367_814_344_741);
    let sun = SunModel::Circular(mission.orbit.circular_sun(Phase::ZERO).unwrap());
    (mission.scan_strategy(start).unwrap(), sun)
}

/// A standard normal number: the sum of twelve even ones.
fn normal(random: &mut SplitMix64) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

struct Truth {
    /// Relative errors of the precession and the spin period.
    periods: [f64; 2],
    /// Errors of the start phases, rad.
    phases: [f64; 2],
    alpha_rad: f64,
    noise_rad: f64,
}

impl Truth {
    const EXACT: Self =
        Self { periods: [0.0; 2], phases: [0.0; 2], alpha_rad: 0.0, noise_rad: 0.0 };

    fn strategy(&self, scan: &ScanStrategy) -> ScanStrategy {
        let mut parameters = *scan.parameters();
        let turned = |rotor: Rotor, period: f64, phase: f64| {
            // Rates in 2^-128 turn/ns; the change is small enough for an f64.
            let bits = i128::from_ne_bytes(rotor.rate.bits().to_ne_bytes());
            let scaled = bits / 1_000_000_000 * i128::from((-period / (1.0 + period) * 1e9) as i64);
            let rate = u128::from_ne_bytes((bits + scaled).to_ne_bytes());
            Rotor {
                rate: onboard_core::phase::TurnRate::from_bits(rate),
                start: rotor.start.plus(Phase::from_radians(phase)),
            }
        };
        parameters.precession = turned(parameters.precession, self.periods[0], self.phases[0]);
        parameters.spin = turned(parameters.spin, self.periods[1], self.phases[1]);
        parameters.alpha_rad += self.alpha_rad;
        ScanStrategy::new(parameters).unwrap()
    }

    fn rows(
        &self,
        (scan, sun): &(ScanStrategy, SunModel<'_>),
        seconds: impl Iterator<Item = f64>,
        seed: u64,
    ) -> Vec<Measured> {
        let truth = self.strategy(scan);
        let mut random = SplitMix64(seed);
        seconds
            .map(|elapsed| {
                let at = scan.parameters().start.plus(Duration::from_seconds(elapsed));
                let [x, y, z] = [(); 3].map(|()| self.noise_rad * normal(&mut random));
                let noise = Rotation::<Boresight, Boresight>::about_x(x)
                    .then(Rotation::<Boresight, Boresight>::about_y(y))
                    .then(Rotation::<Boresight, Boresight>::about_z(z));
                Measured { at, attitude: noise.then(attitude(&truth, sun, at).unwrap()) }
            })
            .collect()
    }
}

fn every(step_s: f64, count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(move |index| f64::from(index) * step_s)
}

fn near(found: Estimate, truth: f64, what: &str) {
    assert!((found.offset - truth).abs() < 4.0 * found.sigma, "{what}: {found:?}, truth {truth}");
}

/// Rate errors of a truth.
fn rate_errors(model: &ScanStrategy, truth: &Truth) -> [f64; 2] {
    let (was, is) = (*model.parameters(), *truth.strategy(model).parameters());
    [(was.precession, is.precession), (was.spin, is.spin)]
        .map(|(was, is)| is.rate.radians_per_second() - was.rate.radians_per_second())
}

fn check(model: &ScanStrategy, truth: &Truth, found: &Fit) {
    let precession = found.precession.unwrap();
    let [wa, wb] = rate_errors(model, truth);
    near(precession.rate, wa, "precession rate");
    near(found.spin.rate, wb, "spin rate");
    near(precession.at_start, truth.phases[0], "precession phase");
    near(found.spin.at_start, truth.phases[1], "spin phase");
    near(found.alpha.unwrap(), truth.alpha_rad, "alpha");
}

#[test]
fn period_errors_come_back_over_many_slipped_turns() {
    let truth = Truth {
        periods: [3e-3, -4e-3],
        phases: [0.02, -0.3],
        alpha_rad: 1e-4,
        noise_rad: 10.0 * ARCSEC,
    };
    for (mission, settings, step) in [
        ("litebird", &[][..], 600.0),
        ("litebird", &["scan.spin_sign=-1", "scan.precession_sign=-1"], 61.0),
        ("pico", &[], 97.0),
        ("planck", &[], 600.0),
    ] {
        let model = model(mission, settings);
        let rows = truth.rows(&model, every(step, 20_000), 7);
        let found = fit(&model.0, &model.1, &rows, 0.01).unwrap();
        assert_eq!(found.observable, Observable::Both);
        check(&model.0, &truth, &found);
        assert!((found.sigma_rad / truth.noise_rad - 1.0).abs() < 0.02, "{}", found.sigma_rad);
        assert!(found.used.iter().all(|used| *used), "{mission}");
    }
}

#[test]
fn outliers_are_named_and_gaps_bridged() {
    let truth = Truth { periods: [1e-4, 1e-4], noise_rad: 5.0 * ARCSEC, ..Truth::EXACT };
    let model = model("litebird", &[]);
    let times = every(30.0, 1500).chain(every(30.0, 1500).map(|it| it + 4_000_000.0));
    let mut rows = truth.rows(&model, times, 3);
    let wrong: Vec<usize> = (0..rows.len()).filter(|index| index % 23 == 11).collect();
    for (rank, index) in wrong.iter().enumerate() {
        // From 60 arcsec to half a turn, about different axes.
        let size = 60.0 * ARCSEC * 10_f64.powf(rank as f64 / wrong.len() as f64 * 4.0);
        let off = if rank % 2 == 0 {
            Rotation::<Boresight, Boresight>::about_x(size)
        } else {
            Rotation::about_z(size)
        };
        rows[*index].attitude = off.then(rows[*index].attitude);
    }
    let found = fit(&model.0, &model.1, &rows, 0.01).unwrap();
    let named: Vec<usize> =
        found.used.iter().enumerate().filter(|it| !it.1).map(|it| it.0).collect();
    assert_eq!(named, wrong);
    check(&model.0, &truth, &found);
}

#[test]
fn pulls_have_unit_variance() {
    let truth = Truth {
        periods: [2e-4, -1e-4],
        phases: [0.1, 0.2],
        alpha_rad: -2e-4,
        noise_rad: 20.0 * ARCSEC,
    };
    let model = model("pico", &[]);
    let [wa, wb] = rate_errors(&model.0, &truth);
    let pull = |it: Estimate, truth: f64| (it.offset - truth) / it.sigma;
    let seeds = 1000_u64;
    let (mut squares, mut inside) = ([0.0; 5], [0_u32; 5]);
    for seed in 0..seeds {
        let rows = truth.rows(&model, every(41.0, 120), 1000 + seed);
        let found = fit(&model.0, &model.1, &rows, 0.01).unwrap();
        let precession = found.precession.unwrap();
        let pulls = [
            pull(precession.rate, wa),
            pull(found.spin.rate, wb),
            pull(precession.at_start, truth.phases[0]),
            pull(found.spin.at_start, truth.phases[1]),
            pull(found.alpha.unwrap(), truth.alpha_rad),
        ];
        for ((square, inside), pull) in squares.iter_mut().zip(&mut inside).zip(pulls) {
            *square += pull * pull;
            *inside += u32::from(pull.abs() < 1.959_964);
        }
    }
    for (square, inside) in squares.iter().zip(inside) {
        let variance = square / seeds as f64;
        assert!((variance - 1.0).abs() < 0.2, "variance {variance}");
        assert!((930..=970).contains(&inside), "{inside} of {seeds} in the 95 % interval");
    }
}

#[test]
fn rates_of_phase_and_spin_are_correlated_as_stated() {
    let truth = Truth { noise_rad: 20.0 * ARCSEC, ..Truth::EXACT };
    let model = model("pico", &[]);
    let (mut seen, mut stated) = (0.0, 0.0);
    for seed in 0..400 {
        let found = fit(&model.0, &model.1, &truth.rows(&model, every(41.0, 100), seed), 0.01);
        let found = found.unwrap();
        seen += found.precession.unwrap().rate.offset * found.spin.rate.offset;
        stated += found.rate_covariance;
    }
    assert!(stated < 0.0 && (seen / stated - 1.0).abs() < 0.2, "{seen:e} {stated:e}");
}

#[test]
fn rows_too_far_apart_are_ambiguous_and_uneven_ones_are_not() {
    let truth = Truth { periods: [0.0, 5e-3], noise_rad: ARCSEC, ..Truth::EXACT };
    let model = model("planck", &[]);
    let even = truth.rows(&model, every(7200.0, 500), 1);
    assert!(matches!(fit(&model.0, &model.1, &even, 0.01), Err(FitError::Spin(_))));
    // A narrower range holds one rate again.
    let narrow = Truth { periods: [0.0, 5e-4], ..truth };
    let rows = narrow.rows(&model, every(7200.0, 500), 1);
    check(&model.0, &narrow, &fit(&model.0, &model.1, &rows, 0.001).unwrap());
    let mut random = SplitMix64(5);
    let times: Vec<f64> = every(7200.0, 500).map(|it| it + 600.0 * random.unit()).collect();
    let uneven = truth.rows(&model, times.into_iter(), 1);
    check(&model.0, &truth, &fit(&model.0, &model.1, &uneven, 0.01).unwrap());
}

#[test]
fn near_alpha_of_zero_only_the_sum_is_fitted() {
    let truth =
        Truth { periods: [1e-3, 1e-3], phases: [0.1, 0.2], noise_rad: ARCSEC, ..Truth::EXACT };
    for (alpha, beta, observable, sense) in
        [("0", "90", Observable::Sum, 1.0), ("180", "0", Observable::Difference, -1.0)]
    {
        let alpha = format!("scan.alpha_deg={alpha}");
        let beta = format!("scan.beta_deg={beta}");
        let model = model("litebird", &[&alpha, &beta]);
        let rows = truth.rows(&model, every(60.0, 2000), 2);
        let found = fit(&model.0, &model.1, &rows, 0.01).unwrap();
        assert_eq!(found.observable, observable);
        assert!(found.precession.is_none() && found.alpha.is_none());
        let [wa, wb] = rate_errors(&model.0, &truth);
        near(found.spin.rate, wb + sense * wa, "rate");
        near(found.spin.at_start, 0.2 + sense * 0.1, "phase");
    }
}

#[test]
fn three_rows_are_needed() {
    let model = model("litebird", &[]);
    for count in 0..3 {
        let rows = Truth::EXACT.rows(&model, every(60.0, count), 1);
        assert!(matches!(fit(&model.0, &model.1, &rows, 0.01), Err(FitError::Few(_))));
    }
    let rows = Truth::EXACT.rows(&model, every(60.0, 3), 1);
    check(&model.0, &Truth::EXACT, &fit(&model.0, &model.1, &rows, 0.01).unwrap());
}
