//! The predicted cross-link means against moments of the survey kernel.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use onboard_core::frame::{Boresight, Detector};
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::time::Instant;
use planner::healpix::Nside;
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

#[test]
fn explore() {
    let base = Case::litebird(192.348, 128);
    for (name, case, hz) in [
        ("standard", base, 19.0),
        ("standard 64", Case { nside: 64, ..base }, 9.5),
        ("48/5+", Case::litebird(192.0825, 128), 19.0),
        ("192", Case::litebird(192.0, 128), 19.0),
        ("192 shifted", Case { precession_phase_rad: 0.032_724_9, ..Case::litebird(192.0, 128) }, 9.5),
        ("reversed", Case { spin: -base.spin, ..base }, 9.5),
        ("equal", Case { alpha_deg: 47.5, beta_deg: 47.5, spin: 937 * UNITS, precession: Case::units(140.555 * 60.0), ..base }, 9.5),
        ("small", Case { alpha_deg: 30.0, beta_deg: 65.0, spin: 900 * UNITS, precession: Case::units(105.03 * 60.0), ..base }, 9.5),
        ("wide", Case { alpha_deg: 55.0, beta_deg: 40.0, spin: 1500 * UNITS, precession: Case::units(187.51 * 60.0), ..base }, 9.5),
        ("flat", Case { alpha_deg: 15.0, beta_deg: 78.0, spin: 700 * UNITS, precession: Case::units(150.03 * 60.0), ..base }, 9.5),
        ("7/1", Case { nside: 64, alpha_deg: 30.0, beta_deg: 65.0, spin: 900 * UNITS, precession: Case::units(105.0 * 60.0), ..base }, 9.5),
        ("two years", Case { days: 730.5, ..base }, 9.5),
    ] {
        let before = std::time::Instant::now();
        let predicted = case.predicted();
        let took = before.elapsed().as_secs_f64();
        let before = std::time::Instant::now();
        let (simulated, unobserved) = case.simulated(hz);
        println!("{name}: {took:.3} s, simulation {:.1} s, unobserved {unobserved}", before.elapsed().as_secs_f64());
        let Some(predicted) = predicted else { println!("  none"); continue };
        for (it, simulated) in predicted.iter().zip(&simulated) {
            println!("  {} smooth {:.6} mean {:.6} simulated {:.6} {:+.3}%", it.order, it.smooth_mean, it.mean, simulated, 100.0 * (it.mean / simulated - 1.0));
        }
    }
}

#[test]
fn explore_window() {
    let case = Case::litebird(192.348, 128);
    let window = Window::pixel(Nside::new(128).unwrap()).unwrap();
    let w = window.weights();
    for x in 1..=6 { println!("{x} {}", w[x * 128].powi(2)); }
    println!("sum {}", w.iter().map(|w| w * w).sum::<f64>());
    println!("sum from 4 {}", w[512..].iter().map(|w| w * w).sum::<f64>());
    let mut p = Predictor::new(45f64.to_radians(), 50f64.to_radians(), window);
    let it = p.predict(&case.motion());
    println!("{} {} want 0.064916", it.variance, it.smooth_variance);
    println!("{} {:?}", it.resonances.len(), &it.resonances[..12]);
}
#[test]
fn explore_tail() {
    let base = Case::litebird(192.348, 64);
    for (name, case, hz) in [
        ("standard", base, 9.5),
        ("reversed", Case { spin: -base.spin, ..base }, 9.5),
        ("192", Case::litebird(192.0, 64), 9.5),
        ("192 shifted", Case { precession_phase_rad: 0.032_724_9, ..Case::litebird(192.0, 64) }, 9.5),
    ] {
        let before = std::time::Instant::now();
        let predicted = case.predicted();
        let took = before.elapsed().as_secs_f64();
        let before = std::time::Instant::now();
        let (simulated, unobserved) = case.simulated(hz);
        println!("{name}: {took:.3} s, simulation {:.1} s, unobserved {unobserved}", before.elapsed().as_secs_f64());
        let Some(predicted) = predicted else { println!("  none"); continue };
        for (it, simulated) in predicted.iter().zip(&simulated) {
            println!("  {} smooth {:.6} mean {:.6} simulated {:.6} {:+.3}%", it.order, it.smooth_mean, it.mean, simulated, 100.0 * (it.mean / simulated - 1.0));
        }
    }
    let window = Window::pixel(Nside::new(64).unwrap()).unwrap();
    let w = window.weights();
    for x in 1..=12 { println!("{x} {}", w[(x * 64).min(w.len()-1)].powi(2)); }
    println!("sum {} from 6 {}", w.iter().map(|w| w * w).sum::<f64>(), w[384..].iter().map(|w| w * w).sum::<f64>());
    let mut p = Predictor::new(45f64.to_radians(), 50f64.to_radians(), window);
}
