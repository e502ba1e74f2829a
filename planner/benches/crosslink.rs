//! How long do the cross-link means of one configuration take, beside their simulation.
//!
//! One table, all of it from one run on one thread: the best of several passes of the closed form,
//! one pass of the survey kernel over a year. `--test` makes one short pass of each.

#![expect(clippy::print_stdout, reason = "a bench tells")]

use onboard_core::frame::{Boresight, Detector};
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::time::Instant as Epoch;
use planner::healpix::Nside;
use planner::resonance::{Motion, Predictor, Window};
use planner::survey::clock::turns_per_sample;
use planner::survey::{
    Collector, Isa, MapFrame, Moment, Progress, SampledScan, SunSource, Survey, SurveyDetector,
    SurveySun,
};
use rayon::ThreadPoolBuilder;
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
    let rotor = |numerator, denominator: u64| Rotor {
        rate: turns_per_sample(numerator, denominator * HZ),
        start: Phase::from_bits(0),
    };
    let moments: Vec<Moment> =
        ORDERS.iter().filter_map(|&n| Moment::new(f64::from(n), 0.0).ok()).collect();
    let rotation = Rotation::<Detector, Boresight>::IDENTITY;
    let survey = Survey {
        scan: SampledScan {
            start: Epoch::from_tai_ns(0),
            period: (1_000_000_000_u128 << 64).div_ceil(u128::from(HZ)),
            alpha_rad: 45_f64.to_radians(),
            beta_rad: 50_f64.to_radians(),
            precession: rotor(1000, precession_ms),
            spin: rotor(1, spin_s),
        },
        sun: SurveySun { source: SunSource::Circular(rotor(1, 31_557_600)), step: None },
        detectors: &[SurveyDetector { rotation, plate: None }],
        nside,
        frame: MapFrame::Ecliptic,
        moments: &moments,
    };
    let Ok(pool) = ThreadPoolBuilder::new().num_threads(1).build() else { return f64::NAN };
    let before = Instant::now();
    let mut collector = Collector::new(&survey, Isa::best());
    let _ = collector.collect(0..samples, &pool, &Progress::default());
    black_box(collector.finish());
    before.elapsed().as_secs_f64()
}

fn main() {
    let test = std::env::args().any(|it| it == "--test");
    let samples = if test { 1 << 16 } else { 31_557_600 * HZ };
    println!("six cross-link means of a year: closed form, simulation at {HZ} Hz, seconds");
    for nside in [64, 128] {
        let Ok(nside) = Nside::new(nside) else { continue };
        for (name, precession_ms, spin_s) in CONFIGURATIONS {
            let periods = (precession_ms, spin_s);
            let passes = if test { 1 } else { 7 };
            let closed =
                (0..passes).map(|_| closed_seconds(nside, periods)).fold(f64::INFINITY, f64::min);
            let simulated = simulated_seconds(nside, periods, samples);
            println!("nside {:>4}  {name:<22} {closed:>7.3} {simulated:>8.2}", nside.get());
        }
    }
}
