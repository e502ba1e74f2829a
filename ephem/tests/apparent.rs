//! Directions against values computed by independent programs on the same kernel.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use ephem::apparent::{Corrections, Observer, Sky, SkyError};
use ephem::source::Source;
use ephem::time::{format_tdb, parse_time};
use onboard_core::direction::Direction;
use onboard_core::frame::Ecliptic;
use onboard_core::time::Duration;

const REFERENCE: &str = include_str!("data/directions.csv");

/// Rounding of both programs' TDB (0.06 us) and positions (1e-7 km), at the distance of the Moon.
const LIMIT_RAD: f64 = 1e-12;

fn sky() -> Sky {
    Sky::from_l2(parse_time("2032-04-01T00:00:00 TDB").unwrap())
}

#[test]
fn directions_agree_with_independent_ones() {
    let mut sky = sky();
    let mut compared = 0;
    let mut worst = 0.0_f64;
    for line in REFERENCE.lines().skip_while(|line| !line.starts_with("observer")).skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let &[observer, corrections, name, tdb, x, y, z] = fields.as_slice() else {
            panic!("{line}")
        };
        sky.observer = match observer {
            "spacecraft" => Observer::Spacecraft,
            "earth" => Observer::Earth,
            _ => Observer::Sun,
        };
        sky.corrections =
            if corrections == "apparent" { Corrections::Apparent } else { Corrections::Geometric };
        let at = parse_time(&format!("{tdb} TDB")).unwrap();
        let number = |text: &str| text.parse::<f64>().unwrap();
        let expected: Direction<Ecliptic> =
            Direction::new(number(x), number(y), number(z)).unwrap();
        let seen = if name == "sun_to_spacecraft" {
            sky.sun_to_spacecraft(at).unwrap()
        } else {
            sky.direction(&Source::by_name(name).unwrap(), at).unwrap()
        };
        let error = seen.separation_rad(expected);
        assert!(error < LIMIT_RAD, "{line}: {error:e}");
        worst = worst.max(error);
        compared += 1;
    }
    assert_eq!(compared, 600);
    assert!(worst > 0.0, "two programs that round differently do not agree to the last bit");
}

#[test]
fn the_sun_to_spacecraft_direction_is_geometric_for_every_observer() {
    let mut sky = sky();
    let at = sky.mission_start;
    let first = sky.sun_to_spacecraft(at).unwrap().xyz();
    sky.observer = Observer::Sun;
    sky.corrections = Corrections::Geometric;
    assert_eq!(sky.sun_to_spacecraft(at).unwrap().xyz().map(f64::to_bits), first.map(f64::to_bits));
}

#[test]
fn an_observer_does_not_see_itself() {
    let mut sky = sky();
    sky.observer = Observer::Earth;
    let at = sky.mission_start;
    for corrections in [Corrections::Apparent, Corrections::Geometric] {
        sky.corrections = corrections;
        let error = sky.direction(&Source::by_name("earth").unwrap(), at).unwrap_err();
        assert_eq!(error, SkyError::Coincident { source_name: "earth".to_owned() });
    }
}

#[test]
fn light_from_before_the_kernel_is_named() {
    let sky = sky();
    let (start, _) = sky.kernel.coverage(8).unwrap();
    let neptune = Source::by_name("neptune").unwrap();
    let error = sky.direction(&neptune, start).unwrap_err();
    let SkyError::LightTime { needed, .. } = &error else { panic!("{error}") };
    // Neptune's light takes about 4.1 h.
    let light_time_s = start.since(*needed).seconds();
    assert!((14_000.0..16_000.0).contains(&light_time_s), "{light_time_s}");
    assert!(error.to_string().contains(&format_tdb(start)), "{error}");
    let later = start.plus(Duration::from_seconds(16_000.0));
    assert!(sky.direction(&neptune, later).is_ok());
}

#[test]
fn corrections_have_their_sizes() {
    // Aberration 20.5 arcsec at most from the Earth's speed; fixed sources have it too.
    let mut sky = sky();
    let mut largest = 0.0_f64;
    for month in 0..12 {
        let at = sky.mission_start.plus(Duration::from_seconds(f64::from(month) * 2.6e6));
        let source = Source::by_name("cas_a").unwrap();
        sky.corrections = Corrections::Apparent;
        let apparent = sky.direction(&source, at).unwrap();
        sky.corrections = Corrections::Geometric;
        let geometric = sky.direction(&source, at).unwrap();
        largest = largest.max(apparent.separation_rad(geometric));
    }
    let arcsec = largest.to_degrees() * 3600.0;
    assert!((20.0..21.2).contains(&arcsec), "{arcsec}");
}
