//! `gyrfalcon systematics`: the bias of effects, files, and bad input.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use serde_json::Value;
use std::process::{Command, Output};

fn systematics(arguments: &[&str]) -> Output {
    let all = [&["systematics", "--quiet", "--telescope", "MFT"], arguments].concat();
    Command::new(env!("CARGO_BIN_EXE_gyrfalcon")).args(all).output().unwrap()
}

/// A quick survey: 1 Hz, a year, coarse pixels.
const QUICK: [&str; 8] =
    ["--nside", "128", "--rate", "1", "--sun", "circular:0", "--duration", "365d"];

fn summary(arguments: &[&str]) -> Value {
    let output = systematics(&[&QUICK, arguments, &["--json"]].concat());
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{arguments:?}: {error}"))
}

#[test]
fn effects_have_spectra_maps_and_a_bias() {
    let folder = tempfile::tempdir().unwrap();
    let (rows, maps) = (folder.path().join("cl.csv"), folder.path().join("maps"));
    let found = summary(&[
        "--effect",
        "hwp_ip:eps=1e-5",
        "--effect",
        "angle:delta=1arcmin",
        "--fwhm",
        "0deg",
        "--cmb-lmax",
        "191",
        "--tod",
        "--out",
        rows.to_str().unwrap(),
        "--maps",
        maps.to_str().unwrap(),
        "--svg",
        folder.path().to_str().unwrap(),
    ]);
    let effects = found["effects"].as_array().unwrap();
    let number = |at: usize, key: &str| effects[at][key].as_f64().unwrap();
    // Closed form 4.799e-4; few samples per pixel add a little.
    assert!((number(0, "delta_r") / 4.80e-4 - 1.0).abs() < 0.05, "{found}");
    assert!(number(0, "timestream_difference") < 1e-6, "{found}");
    // sin^2(2 delta) C_EE, of another program 8.0045e-7.
    assert!((number(1, "delta_r") / 8.004_504_5e-7 - 1.0).abs() < 0.02, "{found}");
    assert_eq!((&effects[0]["sky"], &effects[1]["sky"]), (&"dipole".into(), &"CMB, mean".into()));
    assert!(effects[1]["timestream_difference"].is_null());
    let text = std::fs::read_to_string(rows).unwrap();
    assert!(text.lines().any(|line| line == "effect,ell,ee_uk2,bb_uk2"));
    assert!(text.lines().any(|line| line.starts_with("angle:delta=1arcmin,191,")));
    assert!(maps.join("residual-1.fits").exists() && !maps.join("residual-2.fits").exists());
    assert!(folder.path().join("systematics.svg").exists());
}

#[test]
fn what_is_wrong_is_told() {
    for (arguments, expected) in [
        (vec!["--effect", "wobble"], "no such effect; there are pointing, wedge"),
        (vec!["--effect", "pointing:chi=1deg"], "rho is missing"),
        (vec!["--effect", "pointing:rho=1arcmin,eps=1"], "no parameter eps"),
        (vec!["--effect", "pointing:rho"], "KEY=VALUE"),
        (vec!["--effect", "gain:g=1e-3", "--degrees", "1:9"], "within 2 and 600"),
        (vec!["--effect", "gain:g=1e-3", "--degrees", "2"], "a colon between"),
        (vec!["--effect", "gain:g=1e-3", "--cmb-lmax", "601"], "from 2 to 600"),
        (vec!["--effect", "gain:g=1e-3", "--nside", "100"], "a power of two"),
        (vec!["--effect", "gain:g=1e-3", "--nside", "2048"], "1024 at most"),
    ] {
        let output = systematics(&arguments);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && error.contains(expected), "{arguments:?}: {error}");
    }
}
