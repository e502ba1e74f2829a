//! `gyrfalcon forecast` as a person runs it: rows, requirements, plans, instrument models, figures.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

const SMALL: [&str; 5] = ["forecast", "--duration", "30d", "--target", "jupiter"];

#[test]
fn rows_have_the_keys_of_the_page_and_requirements_their_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let text = "base = \"litebird\"\n\
                [[calibration.requirement]]\nquantity = \"gain\"\nsigma = \"20 %\"\ntelescope = \"MFT\"\n\
                [[calibration.requirement]]\nquantity = \"time_constant\"\nsigma = \"1 us\"\n\
                telescope = \"M1-100\"\nevery_days = 15\n";
    fs::write(folder.path().join("m.toml"), text).unwrap();
    let mission = ["--mission", "m.toml", "--telescope", "MFT", "--json", "--out", "rows.parquet"];
    let output = run(folder.path(), &[&SMALL[..], &mission].concat());
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        told.contains("requirements are missed: time_constant 1 us every 15 d of M1-100"),
        "{told}"
    );
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(fs::read(folder.path().join("rows.parquet")).unwrap().starts_with(b"PAR1"));
    let rows = found["rows"].as_array().unwrap();
    // Five channels, Jupiter and all: eight parameters and three radii; then requirements.
    assert_eq!(rows.len(), 5 * 2 * 11 + 5 + 2);
    let keys: Vec<&str> = rows[0].as_object().unwrap().keys().map(String::as_str).collect();
    for key in [
        "telescope",
        "detector",
        "target",
        "quantity",
        "sigma",
        "unit",
        "from_utc",
        "until_utc",
        "requirement",
        "met",
    ] {
        assert!(keys.contains(&key), "{key}");
    }
    let gain = rows
        .iter()
        .find(|it| it["detector"] == "M1-100" && it["target"] == "all" && it["quantity"] == "gain")
        .unwrap();
    assert_eq!(gain["unit"], "%");
    assert!((0.001..1.0).contains(&gain["sigma"].as_f64().unwrap()), "{gain}");
    let verdicts = found["requirements"].as_array().unwrap();
    assert_eq!(
        (&verdicts[0]["met"], &verdicts[1]["met"]),
        (&Value::Bool(true), &Value::Bool(false))
    );
    assert_eq!((&verdicts[1]["rows"], &verdicts[1]["missed_by_noise"]), (&2.into(), &2.into()));
    let missed = rows.iter().filter(|it| it["met"] == false);
    assert!(missed.clone().count() == 2 && missed.clone().all(|it| it["why"] == "noise"));
    let levels = found["profiles"][0]["level_db"].as_array().unwrap();
    assert!(levels.len() == 16 && levels.iter().all(|it| it.as_f64().is_none_or(|it| it < 0.0)));
    let angle = rows.iter().find(|it| it["quantity"] == "polarisation_angle").unwrap();
    assert!(angle["sigma"].is_null());

    let output = run(folder.path(), &[&SMALL[..], &mission[..4]].concat());
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("MFT/M1-100"), "{table}");
    assert!(table.starts_with("requirements:\n  gain 20 % of MFT: met in all 5 cases"), "{table}");
    assert!(table.contains("MISSED in 2 of 2 cases (noise 2), most by MFT/M1-100"), "{table}");
    assert!(table.contains("offset_y and time_constant"), "{table}");
}

#[test]
fn a_plans_sessions_teach_less_than_all_passes() {
    let folder = tempfile::tempdir().unwrap();
    let month = ["--duration", "30d", "--quiet"];
    let planned = run(folder.path(), &[&["plan", "--out", "plan"][..], &month].concat());
    assert!(planned.status.success(), "{}", String::from_utf8_lossy(&planned.stderr));
    let gain = |more: &[&str]| {
        let asked = ["forecast", "--json", "--telescope", "MFT", "--detector", "M1-140"];
        let found = json(&run(folder.path(), &[&asked[..], &month, more].concat()));
        let rows = found["rows"].as_array().unwrap().clone();
        let gain =
            rows.iter().find(|it| it["target"] == "all" && it["quantity"] == "gain").unwrap();
        gain["sigma"].as_f64().unwrap()
    };
    let (all, planned) = (gain(&[]), gain(&["--plan", "plan"]));
    assert!(planned > all && planned < 10.0 * all, "{planned} {all}");
}

#[test]
fn a_plan_says_first_what_it_does_not_teach() {
    let folder = tempfile::tempdir().unwrap();
    let text = "base = \"litebird\"\n[span]\nduration_days = 20\n\
                [[calibration.requirement]]\nquantity = \"gain\"\nsigma = \"10 %\"\ntelescope = \"MFT\"\n\
                [[calibration.requirement]]\nquantity = \"polarisation_angle\"\nsigma = \"1 deg\"\n\
                telescope = \"HFT\"\n";
    fs::write(folder.path().join("m.toml"), text).unwrap();
    let plan = ["plan", "--mission", "m.toml", "--out", "plan"];
    let output = run(folder.path(), &plan);
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && told.starts_with("ALERT: "), "{told}");
    let missed = "polarisation_angle 1 deg of HFT: MISSED in 5 of 5 cases (geometry 5)";
    for line in [&format!("ALERT: {missed}"), "  gain 10 % of MFT: met in all 5 cases, least by "] {
        assert!(told.contains(line), "{line} is not in {told}");
    }
    let (met, hours) = (told.find("  gain 10 %").unwrap(), told.find("hours offered").unwrap());
    assert!(met < hours && told.contains(" sessions; no session for "));
    let page = fs::read_to_string(folder.path().join("plan/report.html")).unwrap();
    let (alert, cards) = (page.find(missed).unwrap(), page.find("dl class=\"cards\"").unwrap());
    assert!(alert < cards && page.contains("What the plan teaches</h2>"));
    assert!(page.contains("1 of 2 met") && page.contains("MFT/M1-100"));

    let again = [&plan[..], &["--force", "--strict", "--json"]].concat();
    let output = run(folder.path(), &again);
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains("requirement polarisation_angle 1 deg of HFT: MISSED"), "{told}");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["requirements"][0]["met"], true);
    assert_eq!(found["longest_gaps"].as_array().unwrap().len(), 3);
    assert!(found["alerts"][0].is_string());
}

#[test]
fn figures_and_the_map_are_written_for_one_beam() {
    let folder = tempfile::tempdir().unwrap();
    let figure = ["--detector", "H3-402", "--figure", "figures", "--quiet"];
    let output = run(folder.path(), &[&SMALL[..], &figure].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for name in ["beam-map.png", "beam-map.svg", "beam-profile.png", "correlations.svg"] {
        let file = folder.path().join("figures").join(format!("HFT-H3-402-{name}"));
        assert!(fs::metadata(&file).unwrap().len() > 1000, "{name}");
    }
    let fits = fs::read(folder.path().join("figures/HFT-H3-402-beam-map.fits")).unwrap();
    assert!(fits.starts_with(b"SIMPLE") && fits.len().is_multiple_of(2880));
    let refused = run(folder.path(), &[&SMALL[..], &["--figure", "figures"]].concat());
    assert_eq!(refused.status.code(), Some(2));
    let told = String::from_utf8(refused.stderr).unwrap();
    assert!(told.contains("--figure draws one beam"), "{told}");
}

#[test]
fn a_mission_without_noise_says_what_is_needed() {
    let folder = tempfile::tempdir().unwrap();
    let pico = ["forecast", "--mission", "pico", "--duration", "5d"];
    let output = run(folder.path(), &pico);
    assert_eq!(output.status.code(), Some(2));
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.contains("net_uk_rts of PICO/- is needed"), "{told}");
    let given = ["--set", "telescope.PICO.net_uk_rts=30", "--target", "jupiter"];
    let output = run(folder.path(), &[&pico[..], &given].concat());
    assert!(output.status.success());
}
