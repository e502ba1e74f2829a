//! Fixed sources and direction tables.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use ephem::apparent::{Corrections, Observer, Sky, SkyError};
use ephem::fit::{FitOptions, fit};
use ephem::source::{FIRST_OWN_SOURCE, SUN_AS_TARGET, Source, names};
use ephem::time::parse_time;
use ephem::verify::verify;
use onboard_core::ephemeris::{EphemerisTable, FIRST_USER_BODY};
use onboard_core::time::{Duration, Instant};
use std::collections::BTreeSet;
use std::fmt::Write as _;

fn start() -> Instant {
    parse_time("2032-04-01T00:00:00 TDB").unwrap()
}

fn after(seconds: f64) -> Instant {
    start().plus(Duration::from_seconds(seconds))
}

/// A table of what `sky` sees of `name`, every `step_s` from `first_s`, to `digits` decimals.
fn table(sky: &Sky, name: &str, grid: (f64, f64, i32), digits: usize) -> String {
    let (first_s, step_s, rows) = grid;
    let source = Source::by_name(name).unwrap();
    let mut text = String::from("# made for a test\nelapsed_s,x,y,z\n");
    for row in 0..rows {
        let elapsed_s = first_s + step_s * f64::from(row);
        let [x, y, z] = sky.direction(&source, after(elapsed_s)).unwrap().xyz();
        let _ = writeln!(text, "{elapsed_s},{x:.digits$},{y:.digits$},{z:.digits$}");
    }
    text
}

#[test]
fn built_in_sources_have_capitals() {
    let titles = ["jupiter", "tau_a", "orion_a", "moon"].map(ephem::source::title);
    assert_eq!(titles, ["Jupiter", "Tau A", "orion_a", "Moon"]);
}

#[test]
fn every_source_has_its_own_lasting_number() {
    let numbers: Vec<i32> = names().map(|name| Source::by_name(name).unwrap().body()).collect();
    assert_eq!(numbers[..9], [1, 2, 4, 5, 6, 7, 8, 301, 399]);
    assert_eq!(numbers[9], SUN_AS_TARGET);
    assert_eq!(numbers[10..], [FIRST_USER_BODY, FIRST_USER_BODY + 1, FIRST_USER_BODY + 2]);
    assert_eq!(numbers.iter().collect::<BTreeSet<_>>().len(), numbers.len());
    assert_eq!(Source::at_icrs("a", 3, 0.0, 0.0).unwrap().body(), FIRST_OWN_SOURCE + 3);
    let error = Source::by_name("pluto").unwrap_err().to_string();
    assert!(error.contains("unknown target 'pluto'; legal are mercury, venus, mars"), "{error}");
}

#[test]
fn fixed_directions_lie_where_their_coordinates_say() {
    let mut sky = Sky::from_l2(start());
    sky.corrections = Corrections::Geometric;
    let seen = |source: &Source| sky.direction(source, start()).unwrap();
    let given = Source::at_ecliptic("a", 0, 210.5, 0.3).unwrap();
    assert!((seen(&given).longitude_rad().to_degrees() - (210.5 - 360.0)).abs() < 1e-12);
    assert!((seen(&given).latitude_rad().to_degrees() - 0.3).abs() < 1e-12);
    // The Crab nebula lies 1.29 deg south of the ecliptic at longitude 84.1 deg.
    let crab = seen(&Source::by_name("tau_a").unwrap());
    assert!((crab.longitude_rad().to_degrees() - 84.1).abs() < 0.01);
    assert!((crab.latitude_rad().to_degrees() + 1.29).abs() < 0.01);
    let same = Source::at_icrs("a", 0, 83.633_083_333, 22.0145).unwrap();
    assert!(seen(&same).separation_rad(crab) < 1e-10);
    for (lon, lat) in [(361.0, 0.0), (0.0, 91.0), (f64::NAN, 0.0), (0.0, f64::INFINITY)] {
        assert!(Source::at_ecliptic("a", 0, lon, lat).is_err());
        assert!(Source::at_icrs("a", 0, lon, lat).is_err());
    }
    let error = Source::at_icrs("crab", 0, 83.6, -122.0).unwrap_err().to_string();
    assert_eq!(error, "source 'crab': declination_deg is -122 deg; legal is -90 to 90");
}

#[test]
fn six_hourly_tables_are_good_to_1e_12() {
    let mut sky = Sky::from_l2(start());
    for (observer, name) in [
        (Observer::Sun, "mercury"),
        (Observer::Sun, "mars"),
        (Observer::Earth, "moon"),
        (Observer::Spacecraft, "jupiter"),
    ] {
        sky.observer = observer;
        let source = Source::by_name(name).unwrap();
        let text = table(&sky, name, (-43_200.0, 21_600.0, 300), 15);
        let tabulated = Source::from_csv("t", 0, &text).unwrap();
        // Away from the first and last rows, where windows are one-sided.
        for step in 0..500 {
            let at = after(f64::from(step) * 12_611.7 + 90_000.0);
            let error = sky
                .direction(&tabulated, at)
                .unwrap()
                .separation_rad(sky.direction(&source, at).unwrap());
            assert!(error < 1e-12, "{name}: {error:e}");
        }
        let inside = sky.direction(&tabulated, after(-43_200.0));
        assert!(inside.is_ok());
        let error = sky.direction(&tabulated, after(-43_201.0)).unwrap_err();
        assert!(matches!(error, SkyError::OutOfTable { .. }));
        assert!(error.to_string().contains("tabulated from -43200 to 6415200 s"), "{error}");
    }
}

#[test]
fn tables_are_fitted_whether_smooth_or_rounded() {
    let sky = Sky::from_l2(start());
    let options = FitOptions { tolerance_rad: 1e-12, ..FitOptions::GROUND };
    // Seven decimals are what many services print: rough at 1e-12, so rows become breaks.
    for (digits, split) in [(15, false), (7, true)] {
        let text = table(&sky, "mars", (-86_400.0, 21_600.0, 400), digits);
        let sources = [Source::from_csv("t", 0, &text).unwrap()];
        let table = fit(&sky, &sources, (start(), after(6e6)), &options).unwrap();
        let own = table.bodies.iter().find(|body| body.name == "t").unwrap();
        assert_eq!(own.spans > 1, split, "{own:?}");
        let parsed = EphemerisTable::parse(&table.bytes).unwrap();
        for check in verify(parsed, &sky, &sources, 3000, 2).unwrap() {
            assert!(check.max_error_rad < 1.2e-12 && check.bounds_hold, "{check:?}");
        }
    }
    let text = table(&sky, "mars", (-86_400.0, 21_600.0, 400), 15);
    let sources = [Source::from_csv("t", 0, &text).unwrap()];
    let error = fit(&sky, &sources, (start(), after(1e7)), &options).unwrap_err().to_string();
    assert!(error.contains("the directions of 't' are tabulated from"), "{error}");
}

#[test]
fn directions_too_rough_for_any_granule_are_named() {
    // Rows every second that jump by 1e-6, and too few coefficients for the curves between them.
    let mut text = String::from("elapsed_s,x,y,z\n");
    for row in 0..200 {
        let jump = 1e-6 * (f64::from(row) * 1.7).sin();
        let _ = writeln!(text, "{row},1,{jump},0");
    }
    let sky = Sky::from_l2(start());
    let sources = [Source::from_csv("noise", 0, &text).unwrap()];
    let options =
        FitOptions { tolerance_rad: 1e-12, rough_tolerance_rad: 1e-12, max_coefficients: 4 };
    let error = fit(&sky, &sources, (start(), after(150.0)), &options).unwrap_err().to_string();
    assert!(
        error.starts_with("the direction of 'noise' is too rough at 2032-04-01T00:0"),
        "{error}"
    );
    assert!(error.ends_with("rad, not 1.0e-12"), "{error}");
}

#[test]
fn wrong_tables_are_refused_with_their_line() {
    let rows = |edit: &dyn Fn(usize) -> Option<&'static str>| {
        let mut text = String::from("# a comment\nelapsed_s, x, y, z\n");
        for row in 0..8 {
            let usual = format!("{}, 1.0, 0.0, 0.0", row * 10);
            text += edit(row).unwrap_or(&usual);
            text.push('\n');
        }
        text
    };
    assert!(Source::from_csv("t", 0, &rows(&|_| None)).is_ok());
    let said = |text: &str| Source::from_csv("t", 0, text).unwrap_err().to_string();
    for (line, expected) in [
        ("20, 1.0, 0.0", "line 5"),
        ("20, one, 0.0, 0.0", "line 5: x is 'one'; legal is a finite number"),
        ("20, 1.0, inf, 0.0", "line 5: y is 'inf'"),
        ("20, 1.0, 0.0, 2e-3", "line 5: (x, y, z) has length 1.0000019"),
        ("20, 0.0, 0.0, 0.0", "line 5: (x, y, z) has length 0; legal is 1 within 1e-6"),
        ("9, 1.0, 0.0, 0.0", "line 5: elapsed_s is '9', not later than the row before"),
        ("10.0, 1.0, 0.0, 0.0", "line 5: elapsed_s is '10.0', not later"),
        ("1e1, 1.0, 0.0, 0.0", "line 5: elapsed_s is '1e1'; legal is a number of seconds"),
        ("20.0000000001, 1.0, 0.0, 0.0", "with up to nine decimals"),
        ("nan, 1.0, 0.0, 0.0", "line 5: elapsed_s is 'nan'"),
    ] {
        let said = said(&rows(&|row| (row == 2).then_some(line)));
        assert!(said.starts_with("source 't': ") && said.contains(expected), "{said}");
    }
    let seven = rows(&|row| (row == 7).then_some("# gone"));
    assert!(said(&seven).contains("the table has 7 rows; legal is 8 or more"));
    assert!(said("").contains("the header is ''"));
    assert!(said("t,x,y,z\n").contains("the header is 't,x,y,z'; legal are the columns"));
    assert!(said("elapsed_s,x,x,y,z\n").contains("the header is"));
    // Columns may stand in any order.
    let turned = "z,y,x,elapsed_s\n".to_owned()
        + "0,0,1,0\n0,0,1,1\n0,0,1,2\n0,0,1,3\n0,0,1,4\n0,0,1,5\n0,0,1,6\n0,0,1,7\n";
    assert!(Source::from_csv("t", 0, &turned).is_ok());
}
