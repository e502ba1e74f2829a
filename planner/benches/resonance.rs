//! How long do a scan, the check of a tolerance box and the cross-link means take, beside simulation.
//!
//! Two tables, all of it from one run on one thread, every predictor new: the best of several passes
//! of the closed forms, one pass of the survey kernel over a year. `cargo test --benches` makes one
//! short pass of each.

#![expect(clippy::print_stdout, reason = "a bench tells")]

use onboard_core::phase::Phase;
use onboard_core::time::Instant as Epoch;
use planner::healpix::Nside;
use planner::progress::Quietly;
use planner::resonance::{Motion, Orbit, Predictor, Tolerance, Window};
use planner::survey::{
    BigRational, ExactRotor, MapFrame, Moment, SampledScan, SunSource, Survey, SurveyDetector,
    SurveySun,
};
use std::convert::Infallible;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Instant;

const ORDERS: [u32; 6] = [1, 2, 3, 4, 5, 6];
const HZ: u64 = 19;

/// Precession in ms, spin in s; alpha 45 deg, beta 50 deg.
const CONFIGURATIONS: [(&str, u64, u64); 3] = [
    ("192.348 min, 20 min", 11_540_880, 1200),
    ("192.0825 min, 20 min", 11_524_950, 1200),
    ("192 min, 20 min", 11_520_000, 1200),
];

fn litebird() -> Option<Predictor> {
    let window = Window::pixel(Nside::new(128).ok()?).ok()?;
    Some(Predictor::new(45_f64.to_radians(), 50_f64.to_radians(), window))
}

/// 401 precession periods from 192 to 193 min.
fn scan_seconds() -> f64 {
    let Some(mut predictor) = litebird() else { return f64::NAN };
    let before = Instant::now();
    for i in 0..401 {
        let minutes = 192.0 + 0.0025 * f64::from(i);
        black_box(predictor.predict(&Motion::year(minutes * 60.0, 1200.0)));
    }
    before.elapsed().as_secs_f64()
}

/// The floor, and the bound over a box about 192.348 min.
fn check_seconds(orbit: &Orbit, [precession_s, spin_s]: [f64; 2]) -> [f64; 2] {
    let Some(mut predictor) = litebird() else { return [f64::NAN; 2] };
    let motion = Motion::year(192.348 * 60.0, 1200.0);
    let before = Instant::now();
    let floor = predictor.floor(&motion);
    let floor_s = before.elapsed().as_secs_f64();
    let Some(mut predictor) = litebird() else { return [f64::NAN; 2] };
    let before = Instant::now();
    let tolerance = Tolerance { precession_s, spin_s };
    let _ = black_box(predictor.certify(&motion, tolerance, orbit, [floor, 0.01]));
    [floor_s, before.elapsed().as_secs_f64()]
}

/// The anti-Sun longitude on the Earth's ellipse, to the second order of the eccentricity.
fn ellipse() -> Orbit {
    let direction = |share: f64| -> Result<[f64; 2], Infallible> {
        let mean = TAU * share;
        let e = 0.0167;
        Ok([mean + 2.0 * e * mean.sin() + 1.25 * e * e * (2.0 * mean).sin(), 0.0])
    };
    let Ok(orbit) = Orbit::follow(&Motion::year(192.348 * 60.0, 1200.0), 768, direction);
    orbit
}

fn best(passes: u32, seconds: impl Fn() -> f64) -> f64 {
    (0..passes).map(|_| seconds()).fold(f64::INFINITY, f64::min)
}

#[expect(clippy::cast_precision_loss, reason = "periods in seconds")]
fn closed_seconds(nside: Nside, (precession_ms, spin_s): (u64, u64)) -> f64 {
    let Ok(window) = Window::pixel(nside) else { return f64::NAN };
    let motion = Motion::year(precession_ms as f64 / 1000.0, spin_s as f64);
    let before = Instant::now();
    let mut predictor = Predictor::new(45_f64.to_radians(), 50_f64.to_radians(), window);
    black_box(predictor.crosslinks(black_box(&motion), &ORDERS));
    before.elapsed().as_secs_f64()
}

fn simulated_seconds(nside: Nside, (precession_ms, spin_s): (u64, u64), samples: u64) -> f64 {
    let rotor = |turns: u64, seconds: u64| ExactRotor {
        turns_per_s: BigRational::new(turns.into(), seconds.into()),
        start: Phase::ZERO,
    };
    let moments: Vec<Moment> =
        ORDERS.iter().filter_map(|&n| Moment::new(f64::from(n), 0.0).ok()).collect();
    let survey = Survey {
        scan: SampledScan {
            start: Epoch::from_tai_ns(0),
            sampling_hz: BigRational::from_integer(HZ.into()),
            alpha_rad: 45_f64.to_radians(),
            beta_rad: 50_f64.to_radians(),
            precession: rotor(1000, precession_ms),
            spin: rotor(1, spin_s),
        },
        sun: SurveySun { source: SunSource::Circular(rotor(1, 31_557_600)), step: None },
        detectors: vec![SurveyDetector::BORESIGHT],
        nside,
        frame: MapFrame::Ecliptic,
        moments,
    };
    let before = Instant::now();
    let _ = black_box(survey.run(0..samples, 1, &Quietly));
    before.elapsed().as_secs_f64()
}

fn main() {
    // Cargo gives `--bench` to `cargo bench` alone.
    let test = !std::env::args().any(|argument| argument == "--bench");
    let samples = if test { 1 << 16 } else { 31_557_600 * HZ };
    let passes = if test { 1 } else { 7 };
    println!("alpha 45 deg, beta 50 deg, nside 128, seconds");
    println!("scan of 401 precession periods        {:>8.4}", best(passes, scan_seconds));
    let orbits = [("circle", Orbit::CIRCULAR), ("ellipse", ellipse())];
    let floor = best(passes, || check_seconds(&orbits[0].1, [0.0, 0.0])[0]);
    println!("floor of 101 precession periods       {floor:>8.4}");
    for (name, orbit) in &orbits {
        for tolerance in [[0.6, 0.06], [1.5, 0.16]] {
            let seconds = best(passes, || check_seconds(orbit, tolerance)[1]);
            let [a, b] = tolerance;
            println!("bound within {a} s and {b:>4} s, {name:<9} {seconds:>8.4}");
        }
    }
    println!("six cross-link means of a year: closed form, simulation at {HZ} Hz, seconds");
    for nside in [64, 128] {
        let Ok(nside) = Nside::new(nside) else { continue };
        for (name, precession_ms, spin_s) in CONFIGURATIONS {
            let periods = (precession_ms, spin_s);
            let closed = best(passes, || closed_seconds(nside, periods));
            let simulated = simulated_seconds(nside, periods, samples);
            println!("nside {:>4}  {name:<22} {closed:>7.3} {simulated:>8.2}", nside.get());
        }
    }
}
