//! Spacecraft states against CSPICE, and OEM files written from known tracks.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use ephem::apparent::Sky;
use ephem::fit::{FitOptions, MILLIARCSECOND_RAD, fit};
use ephem::kernel::{Kernel, SUN, StateError};
use ephem::source::Source;
use ephem::time::{format_tdb, format_utc, parse_time};
use ephem::trajectory::{L2_FRACTION, Trajectory, TrajectoryError};
use ephem::verify::verify;
use hifitime::{Epoch, TimeScale};
use nalgebra::Vector3;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::time::{Duration, Instant};
use std::fmt::Write as _;

const TYPES: &[u8] = include_bytes!("data/segment_types.bsp");
const BURN: &[u8] = include_bytes!("data/burn.bsp");
const REFERENCE: &str = include_str!("data/spice_states.csv");

fn at_tdb(seconds: f64) -> Instant {
    ephem::time::from_epoch(Epoch::from_et_seconds(seconds).to_time_scale(TimeScale::TAI)).unwrap()
}

#[test]
fn every_segment_type_agrees_with_cspice() {
    let kernel = Kernel::embedded();
    let mut compared = 0;
    for line in REFERENCE.lines().skip_while(|line| !line.starts_with("body")).skip(1) {
        let (body, numbers) = line.split_once(',').unwrap();
        let body: i32 = body.parse().unwrap();
        let numbers: Vec<f64> = numbers.split(',').map(|text| text.parse().unwrap()).collect();
        let bytes = if body == -999 { BURN } else { TYPES };
        let trajectory = Trajectory::from_spk("test.bsp", bytes, Some(body)).unwrap();
        let Ok(state) = trajectory.state(&kernel, at_tdb(numbers[0])) else {
            // The first and last instant may round out of the segment by a nanosecond.
            let (start, end) = trajectory.coverage().unwrap();
            let at = at_tdb(numbers[0]);
            assert!(at < start || at > end, "{line}");
            continue;
        };
        let position = Vector3::new(numbers[1], numbers[2], numbers[3]);
        let velocity = Vector3::new(numbers[4], numbers[5], numbers[6]);
        // TDB is rounded to 0.12 us and the ns on the way: 4e-6 km at 30 km/s.
        assert!((state.position_km - position).norm() < 1e-5, "{line}");
        assert!((state.velocity_km_s - velocity).norm() < 1e-11, "{line}");
        compared += 1;
    }
    assert!(compared > 120, "{compared}");
}

#[test]
fn the_spacecraft_of_an_spk_is_chosen() {
    let only = Trajectory::from_spk("burn.bsp", BURN, None).unwrap();
    assert_eq!(only.name(), "burn.bsp");
    assert_eq!(only.breaks().len(), 1);
    let said = |bytes, id| Trajectory::from_spk("a.bsp", bytes, id).unwrap_err().to_string();
    assert!(said(TYPES, None).contains("does not hold exactly one spacecraft"));
    assert!(said(TYPES, None).contains("-931"));
    assert!(said(BURN, Some(-5)).contains("lacks the spacecraft asked for: it holds [-999]"));
    assert!(said(TYPES, Some(-940)).contains("SPICE frame 17: legal is 1 (J2000)"));
    assert!(
        said(TYPES, Some(-905))
            .contains("SPK type 5: legal are 1, 2, 3, 8, 9, 12, 13, 18, 19 and 21")
    );
}

#[test]
fn files_are_told_apart_by_their_content() {
    let folder = std::env::temp_dir().join(format!("ephem-trajectory-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = |name: &str| folder.join(name).display().to_string();
    std::fs::write(path("types.bsp"), TYPES).unwrap();
    std::fs::write(path("l2.oem"), oem(&Track::new(Vector3::zeros()))).unwrap();
    std::fs::write(path("notes.txt"), "hello").unwrap();
    assert!(Trajectory::load(&path("types.bsp:-913")).is_ok());
    assert_eq!(Trajectory::load(&path("l2.oem")).unwrap().name(), "l2.oem");
    assert!(matches!(Trajectory::load(&path("notes.txt")), Err(TrajectoryError::Kind { .. })));
    assert!(matches!(Trajectory::load(&path("none.bsp")), Err(TrajectoryError::Read { .. })));
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn l2_lies_beyond_the_earth() {
    let kernel = Kernel::embedded();
    let at = parse_time("2032-04-01T00:00:00 TDB").unwrap();
    let l2 = Trajectory::l2().state(&kernel, at).unwrap();
    let (sun, earth) = (kernel.state(SUN, at).unwrap(), kernel.state(3, at).unwrap());
    let ratio =
        (l2.position_km - earth.position_km).norm() / (earth.position_km - sun.position_km).norm();
    assert!((ratio - L2_FRACTION).abs() < 1e-12);
    assert_eq!(Trajectory::l2().coverage(), None);
}

/// L2 to the 40th day, then drifting off with a velocity kick.
struct Track {
    kernel: Kernel,
    start: Instant,
    burn: Instant,
    end: Instant,
    kick_km_s: Vector3<f64>,
}

impl Track {
    fn new(kick_km_s: Vector3<f64>) -> Self {
        let start = parse_time("2032-04-01T00:00:00Z").unwrap();
        let day = |days: f64| start.plus(Duration::from_seconds(days * 86_400.0));
        Self { kernel: Kernel::embedded(), start, burn: day(40.0), end: day(100.0), kick_km_s }
    }

    /// Position and velocity from the Sun; at the burn itself, the side asked for.
    fn state(&self, at: Instant, after: bool) -> (Vector3<f64>, Vector3<f64>) {
        let l2 = Trajectory::l2().state(&self.kernel, at).unwrap();
        let sun = self.kernel.state(SUN, at).unwrap();
        let drift = if after { at.since(self.burn).seconds() } else { 0.0 };
        let kick = if after { self.kick_km_s } else { Vector3::zeros() };
        (
            l2.position_km - sun.position_km + kick * drift,
            l2.velocity_km_s - sun.velocity_km_s + kick,
        )
    }
}

fn oem(track: &Track) -> String {
    let mut text = String::from(
        "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2030-01-01T00:00:00\nORIGINATOR = TEST\n\n",
    );
    for (from, to, after) in [(track.start, track.burn, false), (track.burn, track.end, true)] {
        let (first, last) = (format_utc(from), format_utc(to));
        let _ = write!(
            text,
            "META_START\nCOMMENT a segment\nOBJECT_NAME = TEST\nOBJECT_ID = 2030-001A\nCENTER_NAME = SUN\nREF_FRAME = EME2000\nTIME_SYSTEM = UTC\nSTART_TIME = {first}\nSTOP_TIME = {last}\nINTERPOLATION = HERMITE\nINTERPOLATION_DEGREE = 7\nMETA_STOP\n"
        );
        let mut at = from;
        while at <= to {
            let (p, v) = track.state(at, after);
            let _ = writeln!(
                text,
                "{} {:.9} {:.9} {:.9} {:.12} {:.12} {:.12}",
                format_utc(at),
                p.x,
                p.y,
                p.z,
                v.x,
                v.y,
                v.z
            );
            at = at.plus(Duration::from_seconds(21_600.0));
        }
        text += "COVARIANCE_START\nEPOCH = 2032-04-01T00:00:00\n1.0\n2.0 3.0\nCOVARIANCE_STOP\n";
    }
    text
}

#[test]
fn an_oem_gives_back_the_track_it_was_written_from() {
    let track = Track::new(Vector3::new(0.01, -0.02, 0.005));
    let trajectory = Trajectory::from_oem("burn.oem", &oem(&track)).unwrap();
    assert_eq!(trajectory.coverage(), Some((track.start, track.end)));
    assert_eq!(trajectory.breaks(), [track.burn]);
    for hours in [0.0, 1.5, 500.0, 959.9, 960.1, 1500.3, 2399.0, 2400.0] {
        let at = track.start.plus(Duration::from_seconds(hours * 3600.0));
        let state = trajectory.state(&track.kernel, at).unwrap();
        let sun = track.kernel.state(SUN, at).unwrap();
        let (p, v) = track.state(at, at >= track.burn);
        assert!((state.position_km - sun.position_km - p).norm() < 1e-5, "{hours}");
        assert!((state.velocity_km_s - sun.velocity_km_s - v).norm() < 1e-10, "{hours}");
    }
    let beyond = track.end.plus(Duration::from_ns(1));
    let error = trajectory.state(&track.kernel, beyond).unwrap_err();
    assert!(matches!(error, StateError::OutOfTrajectory { .. }));
    assert!(error.to_string().contains(&format_tdb(track.end)), "{error}");
}

#[test]
fn a_table_splits_at_a_burn() {
    for kick in [Vector3::new(0.01, -0.02, 0.005), Vector3::new(2.0, 0.0, 0.0)] {
        let track = Track::new(kick);
        let trajectory = Trajectory::from_oem("burn.oem", &oem(&track)).unwrap();
        check_split(trajectory, (track.start, track.end), track.burn);
    }
    let trajectory = Trajectory::from_spk("burn.bsp", BURN, None).unwrap();
    let (span, burn) = (trajectory.coverage().unwrap(), trajectory.breaks()[0]);
    check_split(trajectory, span, burn);
}

#[test]
fn a_rough_oem_is_fitted_within_its_noise() {
    // Metres and mm/s: the track bends at every row by what was rounded off.
    let track = Track::new(Vector3::zeros());
    let kernel = &track.kernel;
    let (first, last) = (format_utc(track.start), format_utc(track.end));
    for interpolation in ["HERMITE", "LAGRANGE"] {
        let mut text = format!(
            "CCSDS_OEM_VERS = 2.0\nMETA_START\nCENTER_NAME = EARTH\nREF_FRAME = ICRF\nTIME_SYSTEM = UTC\nSTART_TIME = {first}\nSTOP_TIME = {last}\nINTERPOLATION = {interpolation}\nMETA_STOP\n"
        );
        let mut at = track.start;
        while at <= track.end {
            let l2 = Trajectory::l2().state(kernel, at).unwrap();
            let earth = kernel.state(399, at).unwrap();
            let p = l2.position_km - earth.position_km;
            let v = l2.velocity_km_s - earth.velocity_km_s;
            let _ = writeln!(
                text,
                "{} {:.3} {:.3} {:.3} {:.6} {:.6} {:.6}",
                format_utc(at),
                p.x,
                p.y,
                p.z,
                v.x,
                v.y,
                v.z
            );
            at = at.plus(Duration::from_seconds(3600.0));
        }
        let mut sky = Sky::from_l2(track.start);
        sky.trajectory = Trajectory::from_oem("rough.oem", &text).unwrap();
        let sources = ["mars", "moon"].map(|name| Source::by_name(name).unwrap());
        for options in [FitOptions::UPLINK, FitOptions::GROUND] {
            let fitted = fit(&sky, &sources, (track.start, track.end), &options).unwrap();
            assert!(fitted.bytes.len() < 20_000, "{:?}", fitted.bodies);
            let table = EphemerisTable::parse(&fitted.bytes).unwrap();
            for check in verify(table, &sky, &sources, 2000, 7).unwrap() {
                assert!(check.max_error_rad < MILLIARCSECOND_RAD && check.bounds_hold, "{check:?}");
            }
        }
    }
}

fn check_split(trajectory: Trajectory, span: (Instant, Instant), burn: Instant) {
    let mut sky = Sky::from_l2(span.0);
    sky.trajectory = trajectory;
    let sources = ["mars", "jupiter", "tau_a"].map(|name| Source::by_name(name).unwrap());
    for (options, limit_rad) in
        [(FitOptions::UPLINK, MILLIARCSECOND_RAD), (FitOptions::GROUND, 6e-12)]
    {
        let fitted = fit(&sky, &sources, span, &options).unwrap();
        let table = EphemerisTable::parse(&fitted.bytes).unwrap();
        for body in &fitted.bodies {
            assert!(body.max_error_rad <= options.tolerance_rad, "{body:?}");
            let spans: Vec<_> = table.spans().filter(|span| span.body == body.body).collect();
            assert!(spans.len() >= 2 && spans.len() == body.spans, "{body:?}");
            // Spans meet, the second within a few ns of the burn, and they cover both ends.
            assert_eq!(spans[0].start, span.0);
            assert!(spans.last().unwrap().end().unwrap() >= span.1);
            for pair in spans.windows(2) {
                assert_eq!(pair[0].end(), Some(pair[1].start));
            }
            assert!(spans.iter().any(|s| (0..1000).contains(&burn.since(s.start).ns())));
        }
        for check in verify(table, &sky, &sources, 2000, 7).unwrap() {
            assert!(check.max_error_rad < limit_rad, "{check:?}");
            assert!(check.bounds_hold, "{check:?}");
        }
    }
}
