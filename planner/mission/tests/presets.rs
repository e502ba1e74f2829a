//! The presets: their values, and their canonical text as golden files.
//!
//! `UPDATE_GOLDEN=1 cargo test -p mission --test presets` rewrites the golden files.

use mission::Mission;
use mission::presets;
use num_rational::BigRational;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

fn preset(name: &str) -> Mission {
    Mission::load(name, &[]).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn values_are_those_of_the_publications() {
    // alpha deg, beta deg, precession min, spin in seconds.
    for (name, alpha, beta, precession, spin_s) in [
        ("litebird", "45.0", "50.0", "192.348", 1200),
        ("pico", "26.0", "69.0", "600.0", 60),
        ("planck", "7.5", "85.0", "262980.0", 60),
        ("wmap", "22.5", "70.0", "60.0", 129),
        ("epic", "45.0", "55.0", "192.0", 60),
        ("core", "30.0", "65.0", "5760.0", 120),
    ] {
        let scan = preset(name).scan;
        assert_eq!(scan.alpha_deg.text(), alpha, "{name}");
        assert_eq!(scan.beta_deg.text(), beta, "{name}");
        assert_eq!(scan.precession_period_min.text(), precession, "{name}");
        let spin = scan.spin_period_min.times(60, 1);
        assert_eq!(spin, BigRational::from_integer(spin_s.into()), "{name}");
        assert!(scan.covers_full_sky(), "{name}");
    }
}

#[test]
fn litebird_carries_three_telescopes_and_the_others_one_without_a_plate() {
    let litebird = preset("litebird");
    let carried: Vec<_> = litebird
        .telescopes
        .iter()
        .map(|t| (t.name.as_str(), t.hwp_rate_rpm.as_ref().unwrap().text(), t.fwhm_arcmin.text()))
        .collect();
    assert_eq!(
        carried,
        [("LFT", "46.0", "23.7"), ("MFT", "39.0", "28.0"), ("HFT", "61.0", "17.9")]
    );
    let reach: Vec<f64> = litebird
        .telescopes
        .iter()
        .map(|t| t.field_of_view.unwrap().reach_rad().to_degrees())
        .collect();
    let corner = 9.0_f64.to_radians().tan().hypot(4.0_f64.to_radians().tan()).atan().to_degrees();
    for (reach, expected) in reach.iter().zip([corner, 14.0, 14.0]) {
        assert!((reach - expected).abs() < 1e-12, "{reach} {expected}");
    }
    let plate = litebird.telescopes[2].hwp.unwrap();
    assert!((plate.rate.radians_per_second() - TAU * 61.0 / 60.0).abs() < 1e-15);
    for name in &presets::NAMES[1..] {
        let telescopes = preset(name).telescopes;
        assert_eq!(telescopes.len(), 1, "{name}");
        assert!(telescopes[0].hwp.is_none() && telescopes[0].field_of_view.is_none(), "{name}");
    }
}

#[test]
fn every_preset_is_clean_and_names_its_source() {
    for name in presets::NAMES {
        assert_eq!(preset(name).warnings, [], "{name}");
        let text = presets::find(name).unwrap();
        assert!(text.starts_with("# ") && (text.contains("arXiv:") || text.contains("ApJ")));
    }
}

#[test]
fn the_canonical_text_is_golden_and_reads_back() {
    for name in presets::NAMES {
        let mission = preset(name);
        let path = golden(name);
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            std::fs::write(&path, mission.resolved_toml()).unwrap();
        }
        let expected = std::fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert_eq!(mission.resolved_toml(), expected, "{name}");
        let again = Mission::from_toml(&expected, "resolved", Path::new(""), &[]).unwrap();
        assert_eq!(format!("{again:?}"), format!("{mission:?}"), "{name}");
        assert_eq!(again.digest(), mission.digest(), "{name}");
    }
}

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(format!("{name}.toml"))
}
