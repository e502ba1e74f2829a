//! The attitude against 50-digit arithmetic, anywhere in three years.

use onboard_core::attitude::sweep;
use onboard_core::detector::detector_at;
use onboard_core::direction::Direction;
use onboard_core::frame::{Boresight, Detector};
use onboard_core::hwp::hwp_phase;
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use serde_json::Value;
use tests::{Plain, turn_rate};

/// The accuracy that `docs/conventions.md` promises.
const TOLERANCE_RAD: f64 = 1e-12;

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap()
}

fn number(value: &Value, key: &str) -> f64 {
    match text(value, key) {
        "pi" => std::f64::consts::PI,
        decimal => decimal.parse().unwrap(),
    }
}

/// A decimal with at most nine places as an exact integer of 1e-9.
fn nano(decimal: &str) -> i64 {
    let (whole, fraction) = decimal.split_once('.').unwrap_or((decimal, ""));
    whole.parse::<i64>().unwrap() * 1_000_000_000
        + format!("{fraction:0<9}").parse::<i64>().unwrap()
}

fn minutes_ns(decimal: &str) -> u64 {
    u64::try_from(nano(decimal)).unwrap() * 60
}

fn difference(a: f64, b: f64) -> f64 {
    (a - b).sin().abs()
}

#[test]
// REQ-ATT-1.
fn directions_angles_and_plate_match_fifty_digits() {
    let reference: Value =
        serde_json::from_str(include_str!("../data/pointing_exact.json")).unwrap();
    let mut rows = 0;
    for (name, case) in reference["cases"].as_object().unwrap() {
        let cfg = &case["cfg"];
        let sign = |key: &str| i8::try_from(cfg[key].as_i64().unwrap()).unwrap();
        let plain = Plain {
            alpha_deg: number(cfg, "alpha"),
            beta_deg: number(cfg, "beta"),
            precession_ns: minutes_ns(text(cfg, "Ta")),
            spin_ns: minutes_ns(text(cfg, "Tb")),
            signs: (sign("sa"), sign("sb")),
            phases_rad: (number(cfg, "pa"), number(cfg, "pb")),
        };
        let scan = plain.strategy();
        let sun = SunModel::Circular(Rotor {
            rate: turn_rate(31_557_600_000_000_000, 1),
            start: Phase::from_radians(number(cfg, "L0")),
        });
        let detector: Rotation<Detector, Boresight> = match cfg["det"].as_array() {
            None => Rotation::IDENTITY,
            Some(rag) => {
                let angle =
                    |i: usize| rag[i].as_str().unwrap().parse::<f64>().unwrap().to_radians();
                detector_at(angle(0), angle(1), angle(2))
            }
        };
        let rpm = nano(text(cfg, "rpm")) / 1_000_000_000;
        // The scan runs on elapsed time alone: a start that is not zero changes nothing.
        for row in case["rows"].as_array().unwrap() {
            let at = Instant::from_tai_ns(nano(text(row, "t")));
            let seen = sweep(&scan, &sun, detector, at).unwrap();
            let x = seen.attitude.apply(Direction::new(1.0, 0.0, 0.0).unwrap());
            for (ours, key) in [(seen.direction, "n"), (x, "x")] {
                let theirs = row[key].as_array().unwrap();
                let theirs = |i: usize| theirs[i].as_f64().unwrap();
                let theirs = Direction::new(theirs(0), theirs(1), theirs(2)).unwrap();
                let off = ours.separation_rad(theirs);
                assert!(off < TOLERANCE_RAD, "{name} {key} at {}: {off:e}", row["t"]);
            }
            let longitude = row["phi"].as_f64().unwrap();
            let rho = seen.direction.latitude_rad().cos();
            assert!(difference(seen.direction.longitude_rad(), longitude) * rho < TOLERANCE_RAD);
            let psi = row["psi"].as_f64().unwrap();
            assert!(
                difference(seen.crossing_angle_rad, psi) * rho < TOLERANCE_RAD,
                "{name} psi at {}: {} {psi}",
                row["t"],
                seen.crossing_angle_rad
            );
            if rpm > 0 {
                // One turn in 60/rpm s; the period in ns is not an integer, so scale the rate.
                let per_minute = turn_rate(60_000_000_000, 1);
                let rate = (0..rpm).fold(0_u128, |sum, _| sum.wrapping_add(per_minute.bits()));
                let plate = Rotor {
                    rate: onboard_core::phase::TurnRate::from_bits(rate),
                    start: Phase::ZERO,
                };
                let hwp = row["hwp"].as_f64().unwrap();
                let off = difference(hwp_phase(&scan, plate, at).radians(), hwp);
                assert!(off < TOLERANCE_RAD, "{name} hwp at {}: {off:e}", row["t"]);
            }
            rows += 1;
        }
    }
    assert_eq!(rows, 40);
}

#[test]
fn speed_and_scan_beam_angle_match_differences_of_directions() {
    let signs = [(1, 1), (1, -1), (-1, 1), (-1, -1)];
    for signs in signs {
        let scan = Plain { signs, ..Plain::LITEBIRD }.strategy();
        let sun = SunModel::Circular(Rotor {
            rate: turn_rate(31_557_600_000_000_000, 1),
            start: Phase::ZERO,
        });
        let detector = detector_at(0.12, 0.7, 0.3);
        for step in 0..200_i64 {
            let at = Instant::from_tai_ns(step * 98_765_432_101);
            let here = sweep(&scan, &sun, detector, at).unwrap();
            let near = |ns: i64| {
                let at = Instant::from_tai_ns(at.tai_ns() + ns);
                sweep(&scan, &sun, detector, at).unwrap().direction.xyz()
            };
            let (before, after) = (near(-5_000_000), near(5_000_000));
            let velocity: [f64; 3] = std::array::from_fn(|i| (after[i] - before[i]) / 0.01);
            let speed = velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
            assert!((speed - here.speed_rad_s).abs() < 1e-10, "{speed} {}", here.speed_rad_s);
            let axis = |x, y| here.attitude.apply(Direction::new(x, y, 0.0).unwrap()).xyz();
            let along = |axis: [f64; 3]| axis.iter().zip(velocity).map(|(a, v)| a * v).sum::<f64>();
            let zeta = along(axis(1.0, 0.0)).atan2(along(axis(0.0, 1.0)));
            assert!(difference(zeta, here.scan_beam_angle_rad) < 1e-7, "{signs:?} {step}");
        }
    }
}
