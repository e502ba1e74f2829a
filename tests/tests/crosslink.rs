//! The predicted cross-link means against moments of the survey kernel.

mod simulation;
mod turning;

use planner::healpix::Nside;
use planner::resonance::{Crosslink, Motion, Predictor, Window, mean_of_d};
use planner::survey::{Moment, SurveyStatistics};
use simulation::{Simulation, UNITS};

const ORDERS: [u32; 6] = [1, 2, 3, 4, 5, 6];

fn predicted(case: &Simulation) -> Option<Vec<Crosslink>> {
    case.predictor().crosslinks(&case.motion(), &ORDERS)
}

/// Means over observed pixels of `|h_n|^2`, n of [`ORDERS`], at about `hz`; unobserved pixels.
fn simulated(case: &Simulation, hz: f64) -> (Vec<f64>, u64) {
    // No spin is a whole number of samples.
    let sampling = (1009, (1009.0 * UNITS as f64 / hz).round() as u32);
    let moments = ORDERS.map(|n| Moment::new(f64::from(n), 0.0).unwrap());
    let statistics = SurveyStatistics::of(&case.maps(sampling, &moments));
    let means = statistics.moments.iter().map(|it| it.mean_observed.unwrap()).collect();
    (means, statistics.unobserved_pixels)
}

/// Every mean within `bound` of the simulation's, which observes all pixels.
fn agree(name: &str, case: &Simulation, (hz, bound): (f64, f64)) {
    let predicted = predicted(case).unwrap();
    let (simulated, unobserved) = simulated(case, hz);
    assert_eq!(unobserved, 0, "{name}");
    for (it, simulated) in predicted.iter().zip(simulated) {
        let off = it.mean / simulated - 1.0;
        println!("{name} {}: {:.6} {simulated:.6} {:+.2}%", it.order, it.mean, 100.0 * off);
        assert!(off.abs() < bound, "{name}: {it:?} {simulated}");
    }
}

#[test]
fn means_follow_simulation() {
    agree("standard", &Simulation::litebird(192.348, 64), (7.0, 0.01));
    agree("commensurate", &Simulation::litebird(192.0, 64), (7.0, 0.01));
}

#[test]
#[ignore = "a minute of simulation"]
fn means_of_the_standard_strategy() {
    let base = Simulation::litebird(192.348, 128);
    agree("192.348", &base, (19.0, 0.015));
    let published = [(1, 0.047_180_9), (2, 0.080_549_6), (4, 0.025_411_9)];
    let predicted = predicted(&base).unwrap();
    for (order, mean) in published {
        let it = predicted.iter().find(|it| it.order == order).unwrap();
        assert!((it.mean / mean - 1.0).abs() < 0.02, "{it:?} {mean}");
    }
    agree("192.0825", &Simulation::litebird(192.0825, 128), (9.5, 0.015));
    agree("192", &Simulation::litebird(192.0, 128), (9.5, 0.015));
    let turned =
        Simulation { precession_phase_rad: 0.032_724_9, ..Simulation::litebird(192.0, 128) };
    agree("192 turned", &turned, (9.5, 0.015));
    agree("reversed", &Simulation { spin: -base.spin, ..base }, (9.5, 0.015));
    agree("two years", &Simulation { quarter_days: 2922, ..base }, (9.5, 0.015));
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
        let case = Simulation {
            alpha_deg,
            beta_deg,
            spin: seconds * UNITS,
            precession: Simulation::units(minutes * 60.0),
            ..Simulation::litebird(0.0, 128)
        };
        agree(name, &case, (9.5, 0.02));
    }
}

#[test]
fn holes_have_no_means() {
    let base = Simulation::litebird(192.348, 64);
    for (alpha_deg, beta_deg) in [(30.0, 50.0), (0.0, 91.0), (100.0, 5.0)] {
        assert_eq!(predicted(&Simulation { alpha_deg, beta_deg, ..base }), None);
    }
    assert_eq!(predicted(&Simulation { quarter_days: 360, ..base }), None);
    // Seven spins each precession, for ever the same.
    let seven = Simulation { alpha_deg: 30.0, beta_deg: 65.0, spin: 900 * UNITS, ..base };
    let seven = Simulation { precession: 7 * seven.spin, ..seven };
    assert_eq!(predicted(&seven), None);
    assert!(simulated(&seven, 3.0).1 > 0);
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
