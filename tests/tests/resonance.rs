//! The predicted variance of hits against maps of the survey kernel.

mod simulation;
mod turning;

use simulation::{Simulation, UNITS};

/// Samples in a number of units of time: 3.0 Hz, and a spin is no whole number of samples.
const SAMPLING: (u32, u32) = (151, 10_070);

/// The paper's angles; minutes of precession with a spin of 20 min.
fn litebird(minutes: f64) -> Simulation {
    Simulation::litebird(minutes, 128)
}

/// `(sigma_hits / mean)^2` of the kernel's map: whole sky, north, south. Counting samples adds
/// about 7e-5.
fn simulated(case: &Simulation) -> [f64; 3] {
    let maps = case.maps(SAMPLING, &[]);
    let half = |sign: f64| {
        let hits: Vec<f64> = (0..maps.nside().pixels())
            .filter(|&pixel| maps.nside().center(pixel).1 * sign >= 0.0)
            .map(|pixel| maps.hits(pixel) as f64)
            .collect();
        let mean = hits.iter().sum::<f64>() / hits.len() as f64;
        hits.iter().map(|hits| (hits / mean - 1.0).powi(2)).sum::<f64>() / hits.len() as f64
    };
    [half(0.0), half(1.0), half(-1.0)]
}

/// Correlation, slope of the second on the first, largest relative difference of roots.
fn compare(pairs: &[(f64, f64)]) -> (f64, f64, f64) {
    let count = pairs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
    let (a, b) = (mean(|it| it.0), mean(|it| it.1));
    let (mut aa, mut ab, mut bb, mut worst) = (0.0, 0.0, 0.0, 0.0_f64);
    for (x, y) in pairs {
        aa += (x - a).powi(2);
        ab += (x - a) * (y - b);
        bb += (y - b).powi(2);
        worst = worst.max(((x / y).sqrt() - 1.0).abs());
    }
    (ab / (aa * bb).sqrt(), ab / aa, worst)
}

/// Predicted and simulated variance at precession periods in minutes.
fn pairs(case: Simulation, minutes: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    let mut predictor = case.predictor();
    minutes
        .map(|minutes| {
            let case = Simulation { precession: Simulation::units(minutes * 60.0), ..case };
            (predictor.predict(&case.motion()).variance, simulated(&case)[0])
        })
        .collect()
}

#[test]
fn exact_commensurability_depends_on_the_start() {
    let mut predictor = litebird(192.0).predictor();
    for (phase, expected) in [(0.0, 0.27645), (0.032_724_9, 0.25389)] {
        let case = Simulation { precession_phase_rad: phase, ..litebird(192.0) };
        let sigma = predictor.predict(&case.motion()).sigma();
        assert!((sigma / expected - 1.0).abs() < 6e-3, "{sigma} {expected}");
        assert!((sigma / simulated(&case)[0].sqrt() - 1.0).abs() < 5e-3, "{sigma}");
    }
}

#[test]
fn hemispheres_differ_as_simulated() {
    let mut predictor = litebird(192.0).predictor();
    for minutes in [192.0825, 192.225] {
        let case = litebird(minutes);
        let found = predictor.hemispheres(&case.motion());
        let [_, north, south] = simulated(&case).map(f64::sqrt);
        assert!((found.north / north - 1.0).abs() < 0.01, "{found:?} {north}");
        assert!((found.south / south - 1.0).abs() < 0.01, "{found:?} {south}");
        assert!((north / south - 1.0).abs() > 0.02, "{north} {south}");
    }
}

/// Equally spaced points from 192 min to `last`.
fn follows(count: u32, last: f64) {
    let step = (last - 192.0) / f64::from(count - 1);
    let minutes = (0..count).map(|i| 192.0 + step * f64::from(i));
    let found = compare(&pairs(litebird(192.0), minutes));
    let (correlation, slope, worst) = found;
    assert!(correlation > 0.998 && (slope - 1.0).abs() < 0.02 && worst < 0.01, "{found:?}");
}

#[test]
fn variance_follows_simulation() {
    follows(17, 192.2);
}

#[test]
#[ignore = "a minute of simulation"]
fn variance_follows_simulation_at_101_points() {
    follows(101, 193.0);
}

#[test]
fn other_strategies() {
    let base = litebird(192.0);
    let turned = Simulation { precession_phase_rad: 1.0, spin_phase_rad: 0.3, ..base };
    for (name, case, from, step) in [
        ("reversed", Simulation { spin: -base.spin, ..base }, 192.0, 0.0125),
        (
            "equal",
            Simulation { alpha_deg: 47.5, beta_deg: 47.5, spin: 937 * UNITS, ..base },
            140.555,
            0.005,
        ),
        (
            "small",
            Simulation { alpha_deg: 30.0, beta_deg: 60.0, spin: 900 * UNITS, ..base },
            105.0,
            0.01,
        ),
        (
            "wide",
            Simulation { alpha_deg: 55.0, beta_deg: 40.0, spin: 1500 * UNITS, ..turned },
            187.5,
            0.01,
        ),
    ] {
        let pairs = pairs(case, (0..7).map(|i| from + step * f64::from(i)));
        let (correlation, slope, worst) = compare(&pairs);
        assert!(correlation > 0.998, "{name}: {correlation} {slope} {worst}: {pairs:?}");
    }
    let flat = Simulation { alpha_deg: 15.0, beta_deg: 78.0, spin: 700 * UNITS, nside: 64, ..base };
    let pairs = pairs(flat, (0..5).map(|i| 150.03 + 0.02 * f64::from(i)));
    for (a, b) in &pairs {
        let flat = |x: f64, y: f64| (x - y).abs() < 2e-4;
        assert!(flat(*a, pairs[0].0) && flat(*b, pairs[0].1), "{pairs:?}");
        assert!((a / b - 1.0).abs() < 2e-3, "{pairs:?}");
    }
}

#[test]
fn surveys_of_other_lengths() {
    for (quarter_days, bound) in [(2 * 1461, 0.01), (700, 0.01), (1461 + 500, 0.01)] {
        for minutes in [192.0825, 192.335] {
            let case = Simulation { quarter_days, ..litebird(minutes) };
            let sigma = case.predictor().predict(&case.motion()).sigma();
            let simulated = simulated(&case)[0].sqrt();
            assert!((sigma / simulated - 1.0).abs() < bound, "{quarter_days}: {sigma} {simulated}");
        }
    }
}
