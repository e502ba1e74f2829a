//! The predicted cross-link means against moments of the survey kernel.

use onboard_core::frame::{Boresight, Detector};
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::time::Instant;
use planner::healpix::Nside;
use planner::resonance::crosslink::mean_of_d;
use planner::resonance::{Crosslink, Motion, Predictor, Window};
use planner::survey::clock::turns_per_sample;
use planner::survey::{
    Collector, Isa, MapFrame, Moment, Progress, SampledScan, SunSource, Survey, SurveyDetector,
    SurveyStatistics, SurveySun,
};
use rayon::ThreadPoolBuilder;

const ORDERS: [u32; 6] = [1, 2, 3, 4, 5, 6];

/// Angles in degrees, periods in units of 0.005 s (negative: reversed).
#[derive(Debug, Clone, Copy)]
struct Case {
    alpha_deg: f64,
    beta_deg: f64,
    precession: i64,
    spin: i64,
    precession_phase_rad: f64,
    days: f64,
    nside: u32,
}

/// Units of a second in which periods are whole.
const UNITS: i64 = 200;

impl Case {
    /// The paper's angles and spin, one year.
    fn litebird(minutes: f64, nside: u32) -> Self {
        Self {
            alpha_deg: 45.0,
            beta_deg: 50.0,
            precession: Self::units(minutes * 60.0),
            spin: 1200 * UNITS,
            precession_phase_rad: 0.0,
            days: 365.25,
            nside,
        }
    }

    fn units(seconds: f64) -> i64 {
        (seconds * UNITS as f64).round() as i64
    }

    fn motion(&self) -> Motion {
        let seconds = |units: i64| units as f64 / UNITS as f64;
        Motion {
            precession_phase_rad: self.precession_phase_rad,
            duration_s: self.days * 86_400.0,
            ..Motion::year(seconds(self.precession), seconds(self.spin))
        }
    }

    fn predicted(&self) -> Option<Vec<Crosslink>> {
        let window = Window::pixel(Nside::new(self.nside).unwrap()).unwrap();
        Predictor::new(self.alpha_deg.to_radians(), self.beta_deg.to_radians(), window)
            .crosslinks(&self.motion(), &ORDERS)
    }

    /// Means over observed pixels of `|h_n|^2`, n of [`ORDERS`], at about `hz`; unobserved pixels.
    fn simulated(&self, hz: f64) -> (Vec<f64>, u64) {
        // No spin is a whole number of samples.
        let (samples, units) = (1009, (1009.0 * UNITS as f64 / hz).round() as u64);
        let rotor = |period: i64, start: f64| {
            let rate = turns_per_sample(units, samples * period.unsigned_abs());
            let rate = if period < 0 { rate.reversed() } else { rate };
            Rotor { rate, start: Phase::from_radians(start) }
        };
        let moments = ORDERS.map(|n| Moment::new(f64::from(n), 0.0).unwrap());
        let unit_ns = 1_000_000_000 / UNITS as u128;
        let scan = SampledScan {
            start: Instant::from_tai_ns(0),
            period: ((u128::from(units) * unit_ns) << 64).div_ceil(u128::from(samples)),
            alpha_rad: self.alpha_deg.to_radians(),
            beta_rad: self.beta_deg.to_radians(),
            precession: rotor(self.precession, self.precession_phase_rad),
            spin: rotor(self.spin, 0.0),
        };
        let rotation: Rotation<Detector, Boresight> = Rotation::IDENTITY;
        let year = 31_557_600 * UNITS;
        let survey = Survey {
            scan,
            sun: SurveySun { source: SunSource::Circular(rotor(year, 0.0)), step: None },
            detectors: &[SurveyDetector { rotation, plate: None }],
            nside: Nside::new(self.nside).unwrap(),
            frame: MapFrame::Ecliptic,
            moments: &moments,
        };
        let count = (self.motion().duration_s * UNITS as f64) as u64 * samples / units;
        let pool = ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let mut collector = Collector::new(&survey, Isa::best());
        assert!(collector.collect(0..count, &pool, &Progress::default()).unwrap());
        let statistics = SurveyStatistics::of(&collector.finish());
        let means = statistics.moments.iter().map(|it| it.mean_observed.unwrap()).collect();
        (means, statistics.unobserved_pixels)
    }
}

/// Every mean within `bound` of the simulation's, which observes all pixels.
fn agree(name: &str, case: &Case, (hz, bound): (f64, f64)) {
    let predicted = case.predicted().unwrap();
    let (simulated, unobserved) = case.simulated(hz);
    assert_eq!(unobserved, 0, "{name}");
    for (it, simulated) in predicted.iter().zip(simulated) {
        let off = it.mean / simulated - 1.0;
        println!("{name} {}: {:.6} {simulated:.6} {:+.2}%", it.order, it.mean, 100.0 * off);
        assert!(off.abs() < bound, "{name}: {it:?} {simulated}");
    }
}

#[test]
fn means_follow_simulation() {
    agree("standard", &Case::litebird(192.348, 64), (7.0, 0.01));
    agree("commensurate", &Case::litebird(192.0, 64), (7.0, 0.01));
}

#[test]
#[ignore = "a minute of simulation"]
fn means_of_the_standard_strategy() {
    let base = Case::litebird(192.348, 128);
    agree("192.348", &base, (19.0, 0.015));
    let published = [(1, 0.047_180_9), (2, 0.080_549_6), (4, 0.025_411_9)];
    let predicted = base.predicted().unwrap();
    for (order, mean) in published {
        let it = predicted.iter().find(|it| it.order == order).unwrap();
        assert!((it.mean / mean - 1.0).abs() < 0.02, "{it:?} {mean}");
    }
    agree("192.0825", &Case::litebird(192.0825, 128), (9.5, 0.015));
    agree("192", &Case::litebird(192.0, 128), (9.5, 0.015));
    let turned = Case { precession_phase_rad: 0.032_724_9, ..Case::litebird(192.0, 128) };
    agree("192 turned", &turned, (9.5, 0.015));
    agree("reversed", &Case { spin: -base.spin, ..base }, (9.5, 0.015));
    agree("two years", &Case { days: 730.5, ..base }, (9.5, 0.015));
}

#[test]
#[ignore = "half a minute of simulation"]
fn means_of_other_strategies() {
    for (name, [alpha_deg, beta_deg], seconds, minutes) in [
        ("equal", [47.5, 47.5], 937, 140.555),
        ("small", [30.0, 65.0], 900, 105.03),
        ("wide", [55.0, 40.0], 1500, 187.51),
        ("flat", [15.0, 78.0], 700, 150.03),
    ] {
        let case = Case {
            alpha_deg,
            beta_deg,
            spin: seconds * UNITS,
            precession: Case::units(minutes * 60.0),
            ..Case::litebird(0.0, 128)
        };
        agree(name, &case, (9.5, 0.02));
    }
}

#[test]
fn holes_have_no_means() {
    let base = Case::litebird(192.348, 64);
    for (alpha_deg, beta_deg) in [(30.0, 50.0), (0.0, 91.0), (100.0, 5.0)] {
        assert_eq!(Case { alpha_deg, beta_deg, ..base }.predicted(), None);
    }
    assert_eq!(Case { days: 90.0, ..base }.predicted(), None);
    // Seven spins each precession, for ever the same.
    let seven = Case { alpha_deg: 30.0, beta_deg: 65.0, spin: 900 * UNITS, ..base };
    let seven = Case { precession: 7 * seven.spin, ..seven };
    assert_eq!(seven.predicted(), None);
    assert!(seven.simulated(3.0).1 > 0);
    let window = Window::pixel(Nside::new(16).unwrap()).unwrap();
    let mut predictor = Predictor::new(0.8, 0.9, window);
    assert_eq!(predictor.crosslinks(&base.motion(), &[0]), None);
    assert_eq!(predictor.crosslinks(&base.motion(), &[]), Some(Vec::new()));
}

/// A matrix by rows.
type Matrix = [[f64; 3]; 3];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn about_z(angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
}

fn about_y(angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
}

/// `D^l_mn` of a rotation, as a sum over factorials of its Euler angles.
fn wigner_of(rotation: &Matrix, [l, m, n]: [i32; 3]) -> [f64; 2] {
    let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
    let tilt = rotation[2][2].clamp(-1.0, 1.0).acos();
    let first = rotation[1][2].atan2(rotation[0][2]);
    let last = rotation[2][1].atan2(-rotation[2][0]);
    let (sin_half, cos_half) = (0.5 * tilt).sin_cos();
    let root = [l + m, l - m, l + n, l - n].map(factorial).iter().product::<f64>().sqrt();
    let small: f64 = (0.max(n - m)..=(l + n).min(l - m))
        .map(|i| {
            let below = [l + n - i, i, m - n + i, l - m - i].map(factorial).iter().product::<f64>();
            let sign = if (m - n + i) % 2 == 0 { 1.0 } else { -1.0 };
            sign * root / below
                * cos_half.powi(2 * l + n - m - 2 * i)
                * sin_half.powi(m - n + 2 * i)
        })
        .sum();
    let (sin, cos) = (-f64::from(m) * first - f64::from(n) * last).sin_cos();
    [small * cos, small * sin]
}

#[test]
fn time_averages_meet_the_formula() {
    let angles = [0.7, 1.1];
    let base = Motion {
        precession_phase_rad: 0.4,
        spin_phase_rad: 2.2,
        longitude_rad: -0.9,
        orbit_period_s: 1.0,
        duration_s: 1.3,
        ..Motion::year(0.19, 0.053)
    };
    let indices = [[2, 1, 0], [3, -2, 1], [2, 2, 2], [4, 3, 2], [5, -1, 4], [4, 0, -4]];
    for motion in [base, Motion { spin_period_s: -0.05, duration_s: 1.0, ..base }] {
        let steps = 40_000;
        let mut sums = [[0.0; 2]; 6];
        for step in 0..=steps {
            let t = motion.duration_s * f64::from(step) / f64::from(steps);
            let turn =
                |period: f64, start: f64| about_z(std::f64::consts::TAU * t / period + start);
            let chain = [
                turn(motion.orbit_period_s, motion.longitude_rad),
                about_y(std::f64::consts::FRAC_PI_2),
                turn(
                    motion.precession_period_s,
                    motion.precession_phase_rad + std::f64::consts::PI,
                ),
                about_y(angles[0]),
                turn(motion.spin_period_s, motion.spin_phase_rad),
                about_y(angles[1]),
            ];
            let rotation = chain.iter().skip(1).fold(chain[0], |a, b| product(&a, b));
            // Simpson's rule.
            let weight =
                if step == 0 || step == steps { 1.0 } else { f64::from(2 + 2 * (step % 2)) };
            for (sum, at) in sums.iter_mut().zip(indices) {
                let [re, im] = wigner_of(&rotation, at);
                *sum = [sum[0] + weight * re, sum[1] + weight * im];
            }
        }
        for (sum, at) in sums.iter().zip(indices) {
            let [re, im] = mean_of_d(&motion, angles, at);
            let scale = 1.0 / (3.0 * f64::from(steps));
            let off = (re - sum[0] * scale).hypot(im - sum[1] * scale);
            assert!(off < 1e-9, "{at:?}: {re} {im} {sum:?} {off:e}");
        }
    }
}
