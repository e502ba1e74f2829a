//! Time scales against the full theory of TDB.

use ephem::time::{parse_time, tdb_ns};

const REFERENCE: &str = include_str!("data/tdb_minus_tt.csv");

#[test]
fn tdb_lies_within_35_us_of_the_full_theory() {
    let mut squares = 0.0;
    let mut count = 0.0;
    for line in REFERENCE.lines().skip_while(|line| !line.starts_with("tt,")).skip(1) {
        let (tt, expected) = line.split_once(',').unwrap();
        let at = parse_time(&format!("{tt} TT")).unwrap();
        let tt_ns = at.tai_ns() + 32_184_000_000;
        let ours_us = f64::from(i32::try_from(tdb_ns(at) - tt_ns).unwrap()) * 1e-3;
        let error_us = ours_us - expected.parse::<f64>().unwrap() * 1e6;
        assert!(error_us.abs() < 35.0, "{line}: {error_us} us");
        squares += error_us * error_us;
        count += 1.0;
    }
    assert!((squares / count).sqrt() < 20.0);
}
