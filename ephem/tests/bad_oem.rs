//! OEM files that are wrong: each refused with line, key, value and what would be legal.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use ephem::kernel::Kernel;
use ephem::time::parse_time;
use ephem::trajectory::Trajectory;

const GOOD: &str = "\
CCSDS_OEM_VERS = 2.0
COMMENT made for a test
CREATION_DATE = 2030-01-01T00:00:00
ORIGINATOR = TEST
META_START
OBJECT_NAME = TEST
OBJECT_ID = 2030-001A
CENTER_NAME = EARTH BARYCENTER
REF_FRAME = ICRF
TIME_SYSTEM = TDB
START_TIME = 2032-04-01T00:00:00
USEABLE_START_TIME = 2032-04-01T12:00:00
USEABLE_STOP_TIME = 2032-04-03T12:00:00.5
STOP_TIME = 2032-095T00:00:00
INTERPOLATION = LAGRANGE
INTERPOLATION_DEGREE = 3
META_STOP
2032-04-01T00:00:00 1500000.0 0.0 0.0 0.0 0.3 0.0
2032-04-02T00:00:00 1500000.0 25920.0 0.0 0.0 0.3 0.0 0.0 0.0 0.0
2032-04-03T00:00:00 1500000.0 51840.0 0.0 0.0 0.3 0.0
2032-04-04T00:00:00.000 1.5E6 77760 0 0 0.3 0
";

fn refusal(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from}");
    Trajectory::from_oem("a.oem", &GOOD.replacen(from, to, 1)).unwrap_err().to_string()
}

#[test]
fn the_good_one_is_read() {
    let trajectory = Trajectory::from_oem("a.oem", GOOD).unwrap();
    let (start, end) = trajectory.coverage().unwrap();
    assert_eq!(start, parse_time("2032-04-01T12:00:00 TDB").unwrap());
    assert_eq!(end, parse_time("2032-04-03T12:00:00.5 TDB").unwrap());
    let kernel = Kernel::embedded();
    let at = parse_time("2032-04-02T12:00:00 TDB").unwrap();
    let state = trajectory.state(&kernel, at).unwrap();
    let offset = state.position_km - kernel.state(3, at).unwrap().position_km;
    assert!((offset - nalgebra::Vector3::new(1.5e6, 38_880.0, 0.0)).norm() < 1e-6);
    // Windows line ends and a byte order mark change nothing.
    let windows = format!("\u{feff}{}", GOOD.replace('\n', "\r\n"));
    assert_eq!(Trajectory::from_oem("a.oem", &windows).unwrap().coverage(), Some((start, end)));
}

#[test]
fn refusals_name_line_key_value_and_what_is_legal() {
    for (from, to, expected) in [
        ("VERS = 2.0", "VERS = 9.0", "line 1: CCSDS_OEM_VERS is '9.0'; legal is 1.0, 2.0, 3.0"),
        (
            "CCSDS_OEM_VERS",
            "CCSDS_OPM_VERS",
            "line 1: 'CCSDS_OPM_VERS = 2.0' is not CCSDS_OEM_VERS",
        ),
        ("ORIGINATOR", "ORIGNATOR", "line 4: unknown key 'ORIGNATOR'; legal are CCSDS_OEM_VERS"),
        (
            "REF_FRAME = ICRF",
            "REF_FRAME = TOD",
            "line 9: REF_FRAME is 'TOD'; legal is ICRF, GCRF, EME2000, J2000",
        ),
        ("= TDB", "= GPS", "line 10: TIME_SYSTEM is 'GPS'; legal is UTC, TDB, TAI, TT"),
        (
            "EARTH BARYCENTER",
            "MARS",
            "line 8: CENTER_NAME is 'MARS'; legal is SUN, EARTH, EARTH BARYCENTER",
        ),
        (
            "LAGRANGE",
            "PROPAGATE",
            "line 15: INTERPOLATION is 'PROPAGATE'; legal is HERMITE, LAGRANGE, LINEAR",
        ),
        (
            "DEGREE = 3",
            "DEGREE = 0",
            "line 16: INTERPOLATION_DEGREE is '0'; legal is a whole number from 1 to 27",
        ),
        ("DEGREE = 3", "DEGREE = x", "line 16: INTERPOLATION_DEGREE is 'x'"),
        (
            "USEABLE_START_TIME",
            "USABLE_START_TIME",
            "line 12: unknown key 'USABLE_START_TIME'; legal are CENTER_NAME",
        ),
        (
            "STOP_TIME = 2032-095",
            "STOP_TIME = 2032-400",
            "line 14: STOP_TIME: time '2032-400T00:00:00' has day of the year 400: legal is 1 to 366",
        ),
        ("TIME_SYSTEM = TDB\n", "", "line 16: META_STOP, but the block has no TIME_SYSTEM"),
        (
            "OBJECT_NAME = TEST",
            "OBJECT_NAME",
            "line 6: 'OBJECT_NAME' is not of the form KEY = value",
        ),
        (
            "OBJECT_NAME = TEST",
            "REF_FRAME = ICRF",
            "line 9: REF_FRAME is 'ICRF'; legal is one value, and line 6 gives it already",
        ),
        ("META_STOP\n", "", "line 17: '2032-04-01T00:00:00 1500000.0"),
        ("51840.0 0.0 0.0 0.3 0.0", "51840.0 0.0 0.0 0.3", "line 20: '2032-04-03T00:00:00"),
        ("51840.0", "nan", "is not a plausible state"),
        ("51840.0", "5184o.0", "is not a state: epoch, x y z in km"),
        ("77760 0 0 0.3 0", "77760 0 0 300.3 1e4", "below 1e11 km and 1000 km/s"),
        (
            "2032-04-02T00:00:00 ",
            "2032-04-05T00:00:00 ",
            "line 20: the epoch '2032-04-03T00:00:00' is not later than the one before",
        ),
        (
            "2032-04-02T00:00:00 ",
            "2032-04-02 ",
            "line 19: epoch: time '2032-04-02' is not of the form",
        ),
        (
            "USEABLE_STOP_TIME = 2032-04-03",
            "USEABLE_STOP_TIME = 2032-03-03",
            "line 5 has no useable span",
        ),
    ] {
        let said = refusal(from, to);
        assert!(said.starts_with("the trajectory 'a.oem', "), "{said}");
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn files_that_end_too_early_are_refused() {
    let states = GOOD.find("2032-04-01T00:00:00 1").unwrap();
    let said = |text: &str| Trajectory::from_oem("a.oem", text).unwrap_err().to_string();
    assert!(said("").contains("before its first line"));
    assert!(said(&GOOD[..60]).contains("before any META_START"));
    assert!(said(&GOOD[..states - 12]).contains("inside a META block"));
    assert!(said(&GOOD[..states]).contains("has 0 states; legal is 2 or more"));
    assert!(said(&format!("{GOOD}COVARIANCE_START\n1.0\n")).contains("without COVARIANCE_STOP"));
    for length in 0..GOOD.len() {
        // Whatever a cut leaves, it is read or refused.
        let _ = Trajectory::from_oem("a.oem", &GOOD[..length]);
    }
}

#[test]
fn overlapping_segments_are_refused() {
    let body = &GOOD[GOOD.find("META_START").unwrap()..];
    let said = Trajectory::from_oem("a.oem", &format!("{GOOD}{body}")).unwrap_err().to_string();
    assert!(said.contains("begins at line 22 is useable from 2032-04-01T12:00:00"), "{said}");
    let later = body.replace("2032-04-0", "2032-05-0").replace("2032-095", "2032-125");
    let trajectory = Trajectory::from_oem("a.oem", &format!("{GOOD}{later}")).unwrap();
    assert_eq!(trajectory.breaks().len(), 2);
    let gap = parse_time("2032-04-20T00:00:00 TDB").unwrap();
    let error = trajectory.state(&Kernel::embedded(), gap).unwrap_err().to_string();
    assert!(error.contains("with a gap there"), "{error}");
}
