//! Fitted tables against ANISE states with light time and aberration of their own, and bounds
//! against the motion they bound.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use anise::almanac::Almanac;
use anise::frames::Frame;
use anise::naif::SPK;
use ephem::apparent::{Corrections, Observer, Sky, SkyError};
use ephem::fit::{FitError, FitOptions, FittedTable, MILLIARCSECOND_RAD, fit};
use ephem::source::{Source, names};
use ephem::time::{parse_time, to_epoch};
use ephem::verify::{VerifyError, verify};
use hifitime::{Epoch, TimeUnits};
use nalgebra::{Matrix4, Vector3, Vector4};
use onboard_core::ephemeris::{BODY_BYTES, EphemerisTable, HEADER_BYTES, SUN};
use onboard_core::time::{Duration, Instant};

const KERNEL: &[u8] = include_bytes!("../data/de440-2024-2046.bsp");
const LIGHT_KM_S: f64 = 299_792.458;

fn start() -> Instant {
    parse_time("2032-04-01T00:00:00 TDB").unwrap()
}

/// Three years of 365.25 d.
fn mission() -> (Instant, Instant) {
    (start(), start().plus(Duration::from_seconds(1095.75 * 86_400.0)))
}

fn planets() -> Vec<Source> {
    ["mars", "jupiter", "saturn", "uranus", "neptune"].map(|n| Source::by_name(n).unwrap()).into()
}

fn fitted(sky: &Sky, sources: &[Source], options: &FitOptions) -> FittedTable {
    fit(sky, sources, mission(), options).unwrap()
}

/// ANISE's own almanac, with whole-file look-up and its own time conversion.
struct Reference {
    almanac: Almanac,
}

impl Reference {
    fn new() -> Self {
        Self { almanac: Almanac::from_spk(SPK::parse(KERNEL).unwrap()) }
    }

    fn state(&self, body: i32, at: Epoch) -> (Vector3<f64>, Vector3<f64>) {
        let barycenter = Frame::from_ephem_j2000(0);
        let state =
            self.almanac.translate(Frame::from_ephem_j2000(body), barycenter, at, None).unwrap();
        (
            Vector3::from_column_slice(state.radius_km.as_slice()),
            Vector3::from_column_slice(state.velocity_km_s.as_slice()),
        )
    }

    /// Apparent direction from L2: light time by substitution, aberration by a boost of the wave's
    /// four-vector.
    fn direction(&self, body: i32, at: Epoch) -> Vector3<f64> {
        let (sun, sun_v) = self.state(10, at);
        let (earth, earth_v) = self.state(3, at);
        let g = 0.010_078_240_4;
        let here = sun + (earth - sun) * (1.0 + g);
        let velocity = sun_v + (earth_v - sun_v) * (1.0 + g);
        if body == SUN {
            return ecliptic(here - sun).normalize();
        }
        let mut path = self.state(body, at).0 - here;
        for _ in 0..8 {
            let light_time = (path.norm() / LIGHT_KM_S).seconds();
            path = self.state(body, at - light_time).0 - here;
        }
        ecliptic(boosted(path.normalize(), velocity / LIGHT_KM_S)).normalize()
    }
}

/// The direction n of a source in the frame of an observer moving at `b`: light's four-vector is
/// (1, -n), and the boost is I + (gamma - 1) b b^T/b^2 with -gamma b in the mixed entries.
fn boosted(n: Vector3<f64>, b: Vector3<f64>) -> Vector3<f64> {
    let gamma = 1.0 / (1.0 - b.norm_squared()).sqrt();
    let mut boost = Matrix4::identity();
    boost[(0, 0)] = gamma;
    for row in 0..3 {
        boost[(0, row + 1)] = -gamma * b[row];
        boost[(row + 1, 0)] = -gamma * b[row];
        for column in 0..3 {
            boost[(row + 1, column + 1)] += (gamma - 1.0) * b[row] * b[column] / b.norm_squared();
        }
    }
    let seen = boost * Vector4::new(1.0, -n.x, -n.y, -n.z);
    -Vector3::new(seen[1], seen[2], seen[3]) / seen[0]
}

fn ecliptic(v: Vector3<f64>) -> Vector3<f64> {
    let (sin, cos) = (84_381.448_f64 / 3600.0).to_radians().sin_cos();
    Vector3::new(v.x, cos * v.y + sin * v.z, cos * v.z - sin * v.y)
}

#[test]
fn the_default_table_is_within_a_milliarcsecond_and_has_the_size_stated() {
    let sky = Sky::from_l2(start());
    let table = fitted(&sky, &planets(), &FitOptions::UPLINK);
    // 14.6 KiB, as the head of `fit.rs` and `docs/onboard.md` say.
    assert_eq!(table.bytes.len(), 14_968);
    let parsed = EphemerisTable::parse(&table.bytes).unwrap();
    let reference = Reference::new();
    let (start, end) = mission();
    let length_s = end.since(start).seconds();
    assert_eq!(table.bodies.len(), 6);
    for body in &table.bodies {
        let mut worst = 0.0_f64;
        // Steps of the golden section visit the span evenly and meet no granule's pattern.
        for step in 0..3000 {
            let share = (f64::from(step) * 0.618_033_988_749_895).fract();
            let at = start.plus(Duration::from_seconds(share * length_s));
            let seen = parsed.body(body.body).unwrap().state(at).unwrap();
            let expected = reference.direction(body.body, to_epoch(at));
            worst = worst.max((Vector3::from(seen.direction.xyz()) - expected).norm());
        }
        assert!(worst <= MILLIARCSECOND_RAD, "{}: {worst:e}", body.name);
        assert!(body.max_error_rad <= MILLIARCSECOND_RAD && worst < body.max_error_rad * 1.1);
    }
    // Both ends of the mission are covered.
    for body in &table.bodies {
        let body = parsed.body(body.body).unwrap();
        assert!(body.state(start).is_ok() && body.state(end).is_ok());
    }
}

#[test]
fn ground_tables_are_as_exact_as_the_sky() {
    let mut sky = Sky::from_l2(start());
    let all: Vec<Source> = names().map(|name| Source::by_name(name).unwrap()).collect();
    let outer = |source: &&Source| !matches!(source.name(), "earth" | "sun");
    let other: Vec<Source> = all.iter().filter(outer).cloned().collect();
    for observer in [Observer::Spacecraft, Observer::Earth, Observer::Sun] {
        for corrections in [Corrections::Apparent, Corrections::Geometric] {
            (sky.observer, sky.corrections) = (observer, corrections);
            let sources = if observer == Observer::Spacecraft { &all } else { &other };
            for (options, limit_rad) in [
                (FitOptions::GROUND, 5.5e-12),
                (
                    FitOptions { tolerance_rad: 1e-12, max_coefficients: 20, ..FitOptions::GROUND },
                    1.2e-12,
                ),
            ] {
                let table = fitted(&sky, sources, &options);
                let parsed = EphemerisTable::parse(&table.bytes).unwrap();
                for check in verify(parsed, &sky, sources, 400, 11).unwrap() {
                    assert!(check.max_error_rad < limit_rad, "{check:?}");
                    assert!(check.bounds_hold, "{check:?}");
                }
                assert!(
                    table
                        .bodies
                        .iter()
                        .all(|b| b.coefficients <= usize::from(options.max_coefficients))
                );
            }
        }
    }
}

#[test]
fn bounds_hold_and_are_tight() {
    let sky = Sky::from_l2(start());
    let all: Vec<Source> = names().map(|name| Source::by_name(name).unwrap()).collect();
    for options in [FitOptions::UPLINK, FitOptions::GROUND] {
        let table = fitted(&sky, &all, &options);
        let parsed = EphemerisTable::parse(&table.bytes).unwrap();
        for check in verify(parsed, &sky, &all, 20_000, 3).unwrap() {
            assert!(check.bounds_hold, "{check:?}");
            assert!(check.rate_over_bound > 0.8, "{check:?}");
            assert!(check.acceleration_over_bound > 0.8, "{check:?}");
        }
    }
}

#[test]
fn verification_sees_a_wrong_table() {
    let sky = Sky::from_l2(start());
    let mut table = fitted(&sky, &planets(), &FitOptions::UPLINK);
    // The rate bound of the first body, which has one span, halved: 16 into its record and 32 into
    // its span's.
    let spans = HEADER_BYTES + BODY_BYTES * table.bodies.len();
    for at in [HEADER_BYTES + 16, spans + 32] {
        let bound = f64::from_le_bytes(table.bytes[at..at + 8].try_into().unwrap());
        table.bytes[at..at + 8].copy_from_slice(&(bound / 2.0).to_le_bytes());
    }
    // A coefficient of the last body, moved by 2 mas.
    let last = table.bytes.len() - 24 * 20;
    let c = f64::from_le_bytes(table.bytes[last..last + 8].try_into().unwrap());
    table.bytes[last..last + 8].copy_from_slice(&(c + 2.0 * MILLIARCSECOND_RAD).to_le_bytes());
    let parsed = EphemerisTable::parse(&table.bytes).unwrap();
    let checks = verify(parsed, &sky, &planets(), 2000, 5).unwrap();
    assert!(!checks[0].bounds_hold && checks[1].bounds_hold);
    assert!(checks.iter().filter(|c| c.max_error_rad > MILLIARCSECOND_RAD).count() == 1);
    let error = verify(parsed, &sky, &planets()[1..], 5, 5).unwrap_err();
    assert_eq!(error, VerifyError::UnknownBody(4));
}

#[test]
fn tables_are_continuous_at_their_joints() {
    let sky = Sky::from_l2(start());
    let table = fitted(&sky, &planets(), &FitOptions::UPLINK);
    let parsed = EphemerisTable::parse(&table.bytes).unwrap();
    let mut joints = 0;
    for span in parsed.spans() {
        let body = parsed.body(span.body).unwrap();
        for granule in 1..span.granules {
            let ns = i64::try_from(span.granule_ns.get()).unwrap() * i64::from(granule);
            let joint = span.start.plus(Duration::from_ns(ns));
            let before = body.state(joint.plus(Duration::from_ns(-1))).unwrap().direction;
            let after = body.state(joint).unwrap().direction;
            assert!(before.separation_rad(after) < 2e-15, "body {}", span.body);
            joints += 1;
        }
    }
    assert!(joints > 5);
}

#[test]
fn equal_inputs_give_equal_bytes() {
    let sky = Sky::from_l2(start());
    let mut reversed = planets();
    reversed.reverse();
    let first = fitted(&sky, &planets(), &FitOptions::UPLINK);
    assert_eq!(first.bytes, fitted(&sky, &reversed, &FitOptions::UPLINK).bytes);
}

#[test]
fn short_spans_fit_too() {
    let sky = Sky::from_l2(start());
    for seconds in [1.0, 59.0, 61.0, 86_400.0] {
        let end = start().plus(Duration::from_seconds(seconds));
        let table = fit(&sky, &planets(), (start(), end), &FitOptions::UPLINK).unwrap();
        let parsed = EphemerisTable::parse(&table.bytes).unwrap();
        for check in verify(parsed, &sky, &planets(), 50, 1).unwrap() {
            assert!(check.max_error_rad <= MILLIARCSECOND_RAD && check.bounds_hold, "{check:?}");
        }
    }
}

#[test]
fn refusals_say_what_is_wrong() {
    let sky = Sky::from_l2(start());
    let (start, end) = mission();
    let with = |tolerance_rad, max_coefficients| {
        let options = FitOptions { tolerance_rad, rough_tolerance_rad: 1e-9, max_coefficients };
        fit(&sky, &planets(), (start, end), &options).unwrap_err()
    };
    assert!(matches!(with(f64::NAN, 64), FitError::Tolerance(_)));
    assert!(matches!(with(0.0, 64), FitError::Tolerance(_)));
    assert!(matches!(with(1e-9, 3), FitError::Coefficients(3)));
    assert!(matches!(with(1e-9, 65), FitError::Coefficients(65)));
    let options = FitOptions::UPLINK;
    assert!(matches!(fit(&sky, &[], (end, start), &options), Err(FitError::Span { .. })));
    let twice = [planets(), planets()].concat();
    let error = fit(&sky, &twice, (start, end), &options).unwrap_err();
    assert_eq!(error, FitError::Twice { name: "mars".to_owned(), body: 4 });
    let late = parse_time("2045-06-01T00:00:00 TDB").unwrap();
    let beyond = late.plus(end.since(start));
    let error = fit(&sky, &planets(), (late, beyond), &options).unwrap_err();
    assert!(matches!(error, FitError::Sky(SkyError::State(_))));
    assert!(error.to_string().contains("its ephemeris runs from 2024-01-01"), "{error}");
}
