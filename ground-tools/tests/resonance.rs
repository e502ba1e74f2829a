//! `gyrfalcon resonance`: verdicts, the paper's scan, real orbits, actuators, and bad input.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use serde_json::Value;
use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gyrfalcon")).args(arguments).output().unwrap()
}

fn resonance(arguments: &[&str]) -> Output {
    run(&[&["resonance", "--quiet"], arguments].concat())
}

/// The summary and the exit code.
fn checked(arguments: &[&str]) -> (Value, Option<i32>) {
    let output = resonance(&[arguments, &["--json"]].concat());
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    let value = serde_json::from_slice(&output.stdout);
    (value.unwrap_or_else(|_| panic!("{arguments:?}: {error}")), output.status.code())
}

/// Rows of a scan: minutes, sigma, p, q.
fn scan(arguments: &[&str]) -> Vec<(f64, f64, i64, i64)> {
    let output = resonance(arguments);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    let mut lines = text.lines().skip_while(|line| line.starts_with('#'));
    assert_eq!(lines.next(), Some("precession_period_min,sigma_predicted,p,q,m"));
    lines
        .map(|line| {
            let cells: Vec<f64> = line.split(',').map(|it| it.parse().unwrap()).collect();
            #[expect(clippy::cast_possible_truncation, reason = "whole numbers")]
            let [p, q] = [cells[2] as i64, cells[3] as i64];
            (cells[0], cells[1], p, q)
        })
        .collect()
}

#[test]
fn litebird_passes_on_its_orbit_and_on_a_circle() {
    for sun in ["ephemeris", "circular"] {
        let (found, code) = checked(&["--sun", sun]);
        assert_eq!(code, Some(0), "{found}");
        assert_eq!(found["verdict"], "pass");
        let number = |key: &str| found[key].as_f64().unwrap();
        assert!((number("eta") - 9.6174).abs() < 1e-12);
        assert!(number("sigma_smooth") < number("sigma_floor"));
        assert!(number("sigma_floor") < number("sigma_predicted"));
        assert!(number("sigma_predicted") < number("sigma_bound_in_box"));
        let excess = number("sigma_bound_in_box") / number("sigma_floor") - 1.0;
        assert!((number("excess") - excess).abs() < 1e-12 && excess < 0.01);
        for key in ["p", "q", "m", "precession_period_min", "wavelength_deg"] {
            assert!(found["worst"][key].is_number(), "{key}: {found}");
        }
        assert!(found["worst"]["distance_in_tolerances"].as_f64().unwrap() > 1.0);
        let recommended = &found["recommended"];
        assert_eq!(recommended["verdict"], "pass");
        assert!(recommended["sigma_bound_in_box"].as_f64() <= found["sigma_bound_in_box"].as_f64());
    }
}

#[test]
fn wide_tolerances_and_resonant_periods_fail_and_say_why() {
    for (arguments, p, q) in [
        (&["--tolerance", "1.5s,0.16s"][..], 125, 13),
        (&["--set", "scan.precession_period_min=192.08"], 48, 5),
        (&["--set", "scan.precession_period_min=192"], 48, 5),
        (&["--set", "scan.precession_period_min=192", "--tolerance", "0s,0s"], 48, 5),
    ] {
        let (found, code) = checked(arguments);
        assert_eq!(code, Some(1), "{found}");
        assert_eq!(found["verdict"], "fail");
        assert_eq!([&found["worst"]["p"], &found["worst"]["q"]], [p, q], "{found}");
        let error = String::from_utf8(resonance(arguments).stderr).unwrap();
        assert!(error.contains(&format!("{p}/{q}")) && error.contains("FAIL"), "{error}");
    }
}

#[test]
fn the_papers_scan_has_its_resonances() {
    let found = scan(&["--scan", "192:193:0.0025"]);
    assert_eq!(found.len(), 401);
    assert!((found[1].0 - 192.0025).abs() < 1e-12 && (found[400].0 - 193.0).abs() < 1e-12);
    let within = |low: f64, high: f64| {
        let inside = found.iter().filter(|it| (low - 1e-9..=high + 1e-9).contains(&it.0));
        *inside.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
    };
    assert!((within(192.0, 193.0).0 - 192.0825).abs() < 0.0026);
    for (minutes, p, q) in [
        (192.0825, 48, 5),
        (192.225, 125, 13),
        (192.3025, 173, 18),
        (192.4175, 77, 8),
        (192.645, 106, 11),
    ] {
        let peak = within(minutes - 0.015, minutes + 0.015);
        assert!((peak.0 - minutes).abs() < 0.0076, "{minutes}: {peak:?}");
        assert_eq!((peak.2, peak.3), (p, q), "{minutes}");
    }
}

/// The ellipse and L2 are in the certificate: simulations on DE440 within the box keep below it.
#[test]
#[ignore = "a minute of simulation: cargo test --test resonance -- --ignored"]
fn simulations_on_the_real_orbit_keep_below_the_bound() {
    let bound = checked(&[]).0["sigma_bound_in_box"].as_f64().unwrap();
    for minutes in ["192.328", "192.348", "192.368"] {
        let set = format!("scan.precession_period_min={minutes}");
        let output = run(&[
            "survey",
            "--quiet",
            "--json",
            "--nside",
            "128",
            "--rate",
            "4.7423",
            "--duration",
            "365.25d",
            "--set",
            &set,
        ]);
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let number = |key: &str| found[key].as_f64().unwrap();
        let mean = number("mean_hits");
        let sigma = number("sigma_hits") / mean;
        assert!(sigma < bound && sigma > 0.985 * bound, "{minutes}: {sigma} {bound}");
    }
}

#[test]
fn cross_link_means_are_those_of_the_survey() {
    let (found, _) = checked(&["--crosslink", "1,2,4", "--sun", "circular", "--nside", "64"]);
    let output = run(&[
        "survey",
        "--quiet",
        "--json",
        "--nside",
        "64",
        "--rate",
        "4.7423",
        "--duration",
        "365.25d",
        "--sun",
        "circular",
        "--moment",
        "1,0",
        "--moment",
        "2,0",
        "--moment",
        "4,0",
    ]);
    let simulated: Value = serde_json::from_slice(&output.stdout).unwrap();
    for index in 0..3 {
        let mean = |value: &Value| value["crosslink"][index]["mean"].as_f64().unwrap();
        let (a, b) = (mean(&found), mean(&simulated));
        assert!((a / b - 1.0).abs() < 0.02, "{index}: {a} {b}");
    }
}

#[test]
fn actuators_say_how_long_they_last() {
    let (found, code) = checked(&[
        "--spin-rate-error",
        "0.01arcsec/s",
        "--spin-rate-drift",
        "0.001arcsec/s/d",
        "--correct-every",
        "3d",
    ]);
    assert_eq!(code, Some(0), "{found}");
    let actuators = &found["actuators"];
    // 0.013 arcsec/s of 1080 arcsec/s.
    let tolerance = actuators["spin_tolerance_s"].as_f64().unwrap();
    assert!((tolerance - 1200.0 * 0.013 / (1080.0 - 0.013)).abs() < 1e-9, "{tolerance}");
    assert!(actuators["moire_free_for_s"].as_f64().unwrap() > 30.0 * 86_400.0);
    let (worse, code) = checked(&["--spin-rate-error", "1arcsec/s"]);
    assert_eq!(code, Some(1));
    assert_eq!(worse["actuators"]["moire_free_for_s"], 0.0);
}

#[test]
fn pairs_are_recommended_out_of_the_ranges_named() {
    let (found, _) = checked(&[
        "--nside",
        "32",
        "--precession-range",
        "190:194:0.25",
        "--spin-range",
        "19:21:0.5",
    ]);
    let number = |key: &str| found["recommended"][key].as_f64().unwrap();
    assert!((190.0..=194.0).contains(&number("precession_period_min")));
    assert!((19.0..=21.0).contains(&number("spin_period_min")));
    assert!(found["golden_ratio"]["tolerances_survived"].is_number());
    // A wheel whose steps leave three precession periods.
    let (found, _) = checked(&[
        "--nside",
        "32",
        "--precession-range",
        "190:194",
        "--precession-rate-step",
        "1arcsec/s",
    ]);
    let minutes = found["recommended"]["precession_period_min"].as_f64().unwrap();
    let steps = 360.0 * 60.0 / minutes;
    assert!((steps - steps.round()).abs() < 1e-6, "{minutes}");
}

#[test]
fn the_figure_names_resonances_and_the_box() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let output = resonance(&["--scan", "192:193:0.01", "--json", "--png", out, "--svg", out]);
    assert!(output.status.success());
    let svg = std::fs::read_to_string(folder.path().join("resonance.svg")).unwrap();
    for name in ["48/5+", "77/8-", "77/8+", "106/11-", "tolerance", "recommended", "predicted"] {
        assert!(svg.contains(name), "{name}");
    }
    assert!(folder.path().join("resonance.png").exists());
}

#[test]
fn plan_says_so_at_the_top() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("plan");
    let plan = |more: &[&str]| {
        run(&[&["plan", "--duration", "20d", "--out", out.to_str().unwrap()], more].concat())
    };
    let resonant = ["--set", "scan.precession_period_min=192.08"];
    let failed = plan(&resonant);
    assert!(failed.status.success());
    let text = String::from_utf8(failed.stdout).unwrap();
    let top = text.split("calibration timeline").next().unwrap();
    assert!(top.contains("RESONANCE: FAIL") && top.contains("48/5+"), "{text}");
    let timeline = || -> Value {
        serde_json::from_slice(&std::fs::read(out.join("timeline.json")).unwrap()).unwrap()
    };
    assert_eq!(timeline()["resonance"]["verdict"], "fail");
    assert!(timeline()["resonance"]["recommended"]["precession_period_min"].is_number());
    assert_eq!(plan(&[&resonant[..], &["--strict"]].concat()).status.code(), Some(1));
    assert_eq!(plan(&["--strict"]).status.code(), Some(0));
    assert_eq!(timeline()["resonance"]["verdict"], "pass");
    // Periods that cannot be judged do not stop a plan.
    let slow = plan(&["--set", "scan.spin_period_min=200"]);
    assert!(slow.status.success());
    assert!(String::from_utf8_lossy(&slow.stderr).contains("resonance cannot be judged"));
    assert!(timeline()["resonance"].is_null());
}

#[test]
fn right_angles_zeros_and_reversed_rotations_are_legal() {
    for set in [
        "scan.alpha_deg=0",
        "scan.beta_deg=90",
        "scan.beta_deg=0",
        "scan.spin_sign=-1",
        "scan.precession_sign=-1",
    ] {
        let (found, code) = checked(&["--nside", "32", "--set", set]);
        assert!(code == Some(0) || code == Some(1), "{set}: {found}");
        assert!(found["sigma_bound_in_box"].as_f64().unwrap() > 0.0, "{set}");
    }
    // Both reversed is a mirror image.
    let both =
        ["--sun", "circular", "--set", "scan.spin_sign=-1", "--set", "scan.precession_sign=-1"];
    let mirrored = checked(&both).0["sigma_predicted"].as_f64().unwrap();
    let forward = checked(&["--sun", "circular"]).0["sigma_predicted"].as_f64().unwrap();
    assert!((mirrored / forward - 1.0).abs() < 0.01, "{mirrored} {forward}");
}

#[test]
fn bad_input_is_a_sentence() {
    for (arguments, words) in [
        (&["--tolerance", "-1s,0s"][..], "-1s is negative"),
        (
            &["--tolerance", "4h,0s"],
            "the tolerance of the precession period is 14400 s, but must be",
        ),
        (&["--tolerance", "0s,20min"], "the tolerance of the spin period is 1200 s, but must be"),
        (&["--tolerance", "1,2"], "1 has no unit"),
        (&["--tolerance", "1s"], "with a comma between are needed"),
        (&["--set", "scan.precession_period_min=20"], "must be shorter than the precession period"),
        (&["--set", "tolerance.spin_period_s=-1"], "tolerance.spin_period_s = -1"),
        (&["--duration", "5d"], "30 d or more are needed"),
        (&["--scan", "192:192:0.1"], "the range has no width"),
        (&["--scan", "193:192:0.1"], "the range has no width"),
        (&["--scan", "192:193:0"], "a step above 0 min"),
        (&["--scan", "192:193:1e-9"], "a larger step is needed"),
        (&["--scan", "192:193"], "LO:HI:STEP in minutes"),
        (&["--scan", "19:30:1"], "above the spin period, 20 min"),
        (&["--nside", "1024"], "up to 512 is supported"),
        (&["--nside", "100"], "a power of two"),
        (&["--fwhm", "1arcsec"], "a full width from 14.7 arcmin to 200 deg is needed"),
        (&["--fwhm", "1"], "has no unit"),
        (&["--allow", "-1"], "a percentage from 0"),
        (&["--crosslink", "0"], "orders from 1 to"),
        (&["--precession-range", "192:192"], "the range has no width"),
        (&["--spin-range", "19:200"], "must be shorter than the precession period 192.348 min"),
        (&["--spin-rate-error", "0.001deg"], "an angle per time is needed"),
        (&["--spin-rate-error", "-1deg/s"], "a rate from 0 is needed"),
        (&["--correct-every", "3d"], "an error, step or drift of a rate is needed"),
    ] {
        let output = resonance(arguments);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(error.contains(words), "{arguments:?}: {error}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
}
