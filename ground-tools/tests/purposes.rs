//! What sessions measure and what they are worth by purpose, end to end, against the definitions.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use serde_json::Value;
use std::collections::BTreeMap;
use std::process::Command;

/// Per telescope, Jupiter at 5.2 au in mK, from a program of its own (astropy's constants and
/// `BlackBody`, the disc's share of the beam by scipy's quadrature), at 140, 195 and 402 GHz.
const JUPITER_MK: [(&str, f64); 3] = [
    ("LFT", 78.612_062_544_238_21),
    ("MFT", 56.324_433_390_963_72),
    ("HFT", 121.342_583_270_761_11),
];

/// Plans five days of LiteBIRD with these keys: exit code, timeline, standard error.
fn plan(keys: &str, options: &[&str]) -> (i32, Value, String) {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("base = \"litebird\"\n[span]\nduration_days = 5.0\n[calibration]\n{keys}\n");
    std::fs::write(folder.path().join("m.toml"), text).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .args(["plan", "--mission", "m.toml", "--out", "plan", "--quiet"])
        .args(options)
        .current_dir(folder.path())
        .output()
        .unwrap();
    let bytes = std::fs::read(folder.path().join("plan/timeline.json")).unwrap_or_default();
    let timeline = serde_json::from_slice(&bytes).unwrap_or_default();
    (output.status.code().unwrap(), timeline, String::from_utf8(output.stderr).unwrap())
}

fn planned(keys: &str, options: &[&str]) -> Value {
    let (code, timeline, error) = plan(keys, options);
    assert_eq!(code, 0, "{error}");
    timeline
}

fn sessions(timeline: &Value) -> &[Value] {
    let sessions = timeline["sessions"].as_array().unwrap();
    assert!(!sessions.is_empty());
    sessions
}

fn number(it: &Value, key: &str) -> f64 {
    it[key].as_f64().unwrap()
}

/// (signal / Jupiter's)^2 of a session.
fn share(session: &Value) -> f64 {
    let telescope = session["telescope"].as_str().unwrap();
    let reference = JUPITER_MK.iter().find(|it| it.0 == telescope).unwrap().1;
    (number(session, "antenna_temperature_mk") / reference).powi(2)
}

fn near(value: f64, expected: f64, relative: f64) {
    assert!((value / expected - 1.0).abs() < relative, "{value} is not {expected}");
}

#[test]
fn sessions_tell_impact_angles_coverage_and_strength() {
    let timeline = planned("targets = [\"jupiter\", \"neptune\"]", &[]);
    for session in sessions(&timeline) {
        let passes = session["transits"].as_array().unwrap();
        assert_eq!(session["passes"], passes.len());
        let impacts: Vec<f64> = passes.iter().map(|it| number(it, "impact_deg")).collect();
        for (pass, impact) in passes.iter().zip(&impacts) {
            let separation = number(pass, "min_separation_deg");
            // A pass cut off at the mission's ends or by a corner has its closest approach elsewhere.
            let curved = 1e-3 * separation.max(0.1);
            let whole = (impact.abs() - separation).abs() < curved;
            let at_end = pass["closest_tai_ns"] == pass["entry_tai_ns"]
                || pass["closest_tai_ns"] == pass["exit_tai_ns"];
            assert!(whole || at_end, "{impact} of {separation}");
            let zeta = number(pass, "scan_beam_angle_deg");
            assert!((-180.0..=180.0).contains(&zeta));
            assert!((0.0..360.0).contains(&number(pass, "hwp_deg")));
        }
        let ends = [number(session, "impact_min_deg"), number(session, "impact_max_deg")];
        assert!(impacts.iter().all(|it| (ends[0]..=ends[1]).contains(it)));
        // Minutes of passes under a plate that turns in a second.
        assert!((0.9..=1.0).contains(&number(session, "hwp_coverage")));
        let jupiter = session["target"] == "jupiter";
        let widest = if jupiter { 30.0..51.0 } else { 2.1..2.5 };
        assert!(widest.contains(&number(session, "angular_diameter_arcsec")), "{session}");
        assert!(jupiter == (number(session, "brightness_temperature_k") > 120.0));
        assert!(session["polarised_temperature_mk"].is_null());
    }
}

#[test]
fn a_linear_plan_adds_up_effective_seconds() {
    let keys = "targets = [\"jupiter\", \"neptune\"]\n[calibration.schedule]\n\
                weights = { jupiter = { gain = 2.0, pointing = 0.5 }, neptune = 0.001 }";
    let timeline = planned(keys, &[]);
    let value = |it: &Value| {
        let dwell = number(it, "dwell_s");
        if it["target"] == "jupiter" { 2.5 * share(it) * dwell } else { 0.001 * dwell }
    };
    let expected: f64 = sessions(&timeline).iter().map(value).sum();
    near(number(&timeline, "objective"), expected, 1e-9);
    assert!(sessions(&timeline)[0]["reason"].as_str().unwrap().contains("in view"));
}

#[test]
fn a_logarithmic_plan_counts_cells_by_purpose() {
    let keys = "targets = [\"jupiter\"]\n[calibration.schedule]\nobjective = \"log\"\n\
                weights = { jupiter = { beam_map = 1.0, gain = 0.1, pointing = 0.5 } }";
    let timeline = planned(keys, &[]);
    let mut cells: BTreeMap<(String, usize, String), f64> = BTreeMap::new();
    for session in sessions(&timeline) {
        let telescope = session["telescope"].as_str().unwrap();
        let step = if telescope == "LFT" { 18.0 / 8.0 } else { 28.0 / 8.0 };
        for pass in session["transits"].as_array().unwrap() {
            let effective = number(pass, "dwell_s") * share(session);
            let impact = (number(pass, "impact_deg") / step).floor();
            let zeta = ((number(pass, "scan_beam_angle_deg") + 180.0) / 22.5).floor() % 16.0;
            for (purpose, bin) in [(0, impact), (1, 0.0), (2, zeta)] {
                *cells.entry((telescope.to_owned(), purpose, bin.to_string())).or_default() +=
                    effective;
            }
        }
    }
    let weights = [1.0, 0.1, 0.5];
    let expected: f64 = cells.iter().map(|(key, t)| weights[key.1] * (1.0 + t / 600.0).ln()).sum();
    near(number(&timeline, "objective"), expected, 1e-5);
}

#[test]
fn polarised_sources_of_the_users_own_are_measured_against_the_crab() {
    let keys = "targets = [\"beacon\"]\n[[calibration.source]]\nname = \"beacon\"\n\
                ecliptic_longitude_deg = 190.0\necliptic_latitude_deg = 20.0\nflux_jy = 300.0\n\
                polarised_fraction = 0.1\n[calibration.schedule]\n\
                weights = { beacon = { polarisation_angle = 1.0 } }";
    let timeline = planned(keys, &["--set", "telescope.HFT.frequency_ghz=337"]);
    // 78.98 Jy (nu / GHz)^-0.347.
    let crab =
        BTreeMap::from([("LFT", 14.217_089_618), ("MFT", 12.672_874_068), ("HFT", 10.481_647_587)]);
    let value = |it: &Value| {
        let share: f64 = 30.0 / crab[it["telescope"].as_str().unwrap()];
        number(it, "dwell_s") * share * share * number(it, "hwp_coverage")
    };
    let expected: f64 = sessions(&timeline).iter().map(value).sum();
    near(number(&timeline, "objective"), expected, 1e-8);
    // The scan goes all around it.
    let least = sessions(&timeline).iter().map(|it| number(it, "impact_min_deg"));
    let most = sessions(&timeline).iter().map(|it| number(it, "impact_max_deg"));
    assert!(least.fold(0.0, f64::min) < 0.0 && most.fold(0.0, f64::max) > 0.0);
}

#[test]
fn weights_without_a_known_strength_are_refused_in_a_sentence() {
    let weighted = |target: &str, weight: &str| {
        format!(
            "targets = [\"{target}\"]\n[calibration.schedule]\nweights = {{ {target} = {weight} }}"
        )
    };
    let refused = |keys: &str, options: &[&str], parts: &[&str]| {
        let (code, timeline, error) = plan(keys, options);
        assert_eq!(code, 2, "{error}");
        assert!(timeline.is_null() && error.starts_with("error: "), "{error}");
        for part in parts {
            assert!(error.contains(part), "{part:?} is not in: {error}");
        }
    };
    let gain = weighted("jupiter", "{ gain = 1.0 }");
    let blind = ["--set", "telescope.MFT.frequency_ghz=none"];
    refused(&gain, &blind, &["weights.jupiter.gain", "frequency_ghz of telescope MFT"]);
    let high = ["--set", "telescope.HFT.frequency_ghz=900"];
    refused(&gain, &high, &["weights.jupiter.gain", "900 GHz", "telescope HFT"]);
    let angle = weighted("jupiter", "{ polarisation_angle = 1.0 }");
    let low = ["--set", "telescope.HFT.frequency_ghz=337"];
    refused(&angle, &low, &["weights.jupiter.polarisation_angle", "polarised signal of jupiter"]);
    refused(&weighted("jupiter", "{ beam_maps = 1.0 }"), &[], &["weights.jupiter.beam_map"]);
    refused(&weighted("jupiter", "{ gain = -1.0 }"), &[], &["weights.jupiter.gain", "-1.0"]);
    // Never seen from L2, and not in the table.
    refused(&weighted("moon", "{ gain = 1.0 }"), &[], &["weights.moon.gain", "signal of moon"]);
    let source = "targets = [\"here\"]\n[[calibration.source]]\nname = \"here\"\n\
                  ecliptic_longitude_deg = 190.0\necliptic_latitude_deg = 20.0\n";
    refused(&format!("{source}polarised_fraction = 0.5"), &[], &["flux_jy"]);
    let weights = "[calibration.schedule]\nweights = { here = { gain = 1.0 } }";
    refused(&format!("{source}{weights}"), &[], &["weights.here.gain", "flux_jy"]);
}
