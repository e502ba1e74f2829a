//! `gyrfalcon systematics`: the bias of effects, files, and bad input.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use serde_json::Value;
use std::process::{Command, Output};

fn systematics(arguments: &[&str]) -> Output {
    let all = [&["systematics", "--quiet", "--telescope", "MFT"], arguments].concat();
    Command::new(env!("CARGO_BIN_EXE_gyrfalcon")).args(all).output().unwrap()
}

/// A quick survey: a sample every 4 s for a year, coarse pixels.
const QUICK: [&str; 8] =
    ["--nside", "64", "--rate", "0.25", "--sun", "circular:0", "--duration", "365d"];

fn summary(arguments: &[&[&str]]) -> Value {
    let output = systematics(&[&QUICK, &arguments.concat()[..], &["--json"]].concat());
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{arguments:?}: {error}"))
}

#[test]
fn effects_have_spectra_maps_and_a_bias() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (rows, maps, pictures) = (path("cl.csv"), path("maps"), path("pictures"));
    let found = summary(&[
        &["--effect", "hwp_ip:eps=1e-5", "--effect", "angle:delta=1arcmin"][..],
        &["--fwhm", "0deg", "--cmb-lmax", "191", "--tod", "--realisations", "3"],
        &["--out", &rows, "--maps", &maps, "--svg", &pictures],
    ]);
    let effects = found["effects"].as_array().unwrap();
    let number = |at: usize, key: &str| effects[at].pointer(key).unwrap().as_f64().unwrap();
    // Closed form 4.799e-4; few samples per pixel add a little.
    assert!((number(0, "/delta_r") / 4.80e-4 - 1.0).abs() < 0.05, "{found}");
    assert!((number(0, "/closed_form_delta_r") / 4.798_973_6e-4 - 1.0).abs() < 1e-5, "{found}");
    // The same signal: odd l have 1e-7 of the power of even ones.
    assert!(number(0, "/timestream/p_uk") < 1e-12, "{found}");
    assert!(number(0, "/timestream/bb_relative") < 1e-9, "{found}");
    assert!(number(1, "/timestream/bb_relative") < 1e-9, "{found}");
    // sin^2(2 delta) C_EE, of another program 8.0045e-7.
    assert!((number(1, "/delta_r") / 8.004_504_5e-7 - 1.0).abs() < 0.02, "{found}");
    let scatter = number(1, "/realisations/standard_deviation");
    let off = number(1, "/realisations/mean") - number(1, "/delta_r");
    // Three skies: their mean is within 0.6 of a standard deviation, two in three times.
    assert!(scatter > 0.0 && off.abs() < 1.5 * scatter, "{found}");
    assert_eq!(effects[1]["realisations"]["delta_r"].as_array().unwrap().len(), 3);
    assert!(effects[0]["realisations"].is_null() && effects[1]["rms_uk"].is_null());
    assert_eq!((&effects[0]["sky"], &effects[1]["sky"]), (&"dipole".into(), &"CMB, mean".into()));
    let both = found["together_delta_r"].as_f64().unwrap();
    assert!(both > number(0, "/delta_r") && both < number(0, "/delta_r") + 1e-5, "{found}");
    let text = std::fs::read_to_string(rows).unwrap();
    assert!(text.lines().any(|line| line == "effect,ell,ee_uk2,bb_uk2"));
    assert!(text.lines().any(|line| line.starts_with("angle:delta=1arcmin,191,")));
    let there = |folder: &str, name: &str| std::path::Path::new(folder).join(name).exists();
    assert!(there(&maps, "residual-1.fits") && !there(&maps, "residual-2.fits"));
    for name in ["systematics.svg", "residual-1-q.svg", "residual-1-u.svg"] {
        assert!(there(&pictures, name), "{name}");
    }
    assert!(!there(&pictures, "residual-2-q.svg"));
}

/// A sky and a survey out of files, with a map that does not cover the sky.
#[test]
fn an_earlier_survey_and_a_sky_of_ones_own_give_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (survey, sky, residual) = (path("survey.fits"), path("sky.csv"), path("maps"));
    let scan = ["--nside", "16", "--rate", "1", "--sun", "circular:0", "--duration", "20d"];
    let collected: Vec<String> = [[1, -4], [1, 0], [2, -4], [3, -8], [3, -4], [4, -8], [5, -8]]
        .into_iter()
        .flat_map(|[n, m]| ["--moment".to_owned(), format!("{},{}", -n, -m)])
        .collect();
    let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .args(["survey", "--quiet", "--telescope", "MFT", "--out", &survey])
        .args(scan)
        .args(&collected)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    std::fs::write(&sky, "T,2,1,3,-4\nE,3,2,1,0.5\n").unwrap();
    let effect =
        ["--effect", "pointing:rho=1arcmin,chi=0.3rad", "--degrees", "2:40", "--sky", &sky];
    let told = |arguments: &[&str]| -> Value {
        let output = systematics(&[arguments, &effect, &["--json", "--parts"]].concat());
        serde_json::from_slice(&output.stdout)
            .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
    };
    let (new, old) = (told(&scan), told(&["--survey", &survey, "--maps", &residual]));
    let (new, old) = (&new["effects"][0], &old["effects"][0]);
    assert_eq!(new, old);
    assert!(new["unobserved_pixels"].as_u64().unwrap() > 100, "{new}");
    assert!(new["rms_uk"].as_f64().unwrap() > 1e-5 && new["sky"] == "given", "{new}");
    assert!(new["parts"]["temperature"].as_f64().unwrap() > 0.0, "{new}");
    // The residual is a sky of I, Q, U with pixels left out: refused as one.
    let residual = format!("{residual}/residual-1.fits");
    for (arguments, expected) in [
        (["--sky", &residual, "--survey", &survey], "a whole sky is needed"),
        (["--sky", &sky, "--survey", &sky], "is no FITS file"),
    ] {
        let effect = ["--effect", "gain:g=1e-3", "--degrees", "2:40"];
        refused(&[&arguments[..], &effect].concat(), expected);
    }
    let other = ["--effect", "hwp_2f:eps=1e-5", "--degrees", "2:40", "--survey", &survey];
    refused(&other, "no column H_0_2_RE or H_0_M2_RE");
    refused(&other, "--moment 2,-6");
    let degrees = ["--effect", "gain:g=1e-3", "--survey", &survey];
    refused(&degrees, "maps of N_side 16 have l up to 47");
}

#[test]
fn without_a_telescope_the_fastest_plate_turns() {
    let run = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
            .args(["systematics", "--effect", "gain:g=1e-3", "--effect", "hwp_ip:eps=1e-5"])
            .args(["--nside", "8", "--degrees", "2:20", "--sun", "circular:0", "--duration", "20d"])
            .args(arguments)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        [output.stdout, output.stderr].map(|it| String::from_utf8_lossy(&it).into_owned())
    };
    let [rows, told] = run(&["--out", "-"]);
    let [named, quiet] = run(&["--out", "-", "--telescope", "HFT"]);
    assert!(told.contains("the boresight looks through that of HFT, the fastest"), "{told}");
    assert!(!quiet.contains("fastest"));
    let bare = |text: &str| {
        let rows = text.lines().filter(|line| !line.starts_with('#'));
        rows.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!((bare(&rows).len(), bare(&rows)), (39, bare(&named)));
    let [table, _] = run(&[]);
    for part in ["effect  ", "hwp_ip:eps=1e-5", "dipole", "all together", "left out"] {
        assert!(table.contains(part), "{table}");
    }
}

fn refused(arguments: &[&str], expected: &str) {
    let output = systematics(arguments);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && error.contains(expected), "{arguments:?}: {error}");
}

#[test]
fn what_is_wrong_is_told() {
    let gain = ["--effect", "gain:g=1e-3"];
    for (arguments, expected) in [
        (&["--effect", "wobble"][..], "no such effect; there are pointing, wedge"),
        (&["--effect", "pointing:chi=1deg"], "rho is missing"),
        (&["--effect", "pointing:rho=1arcmin,eps=1"], "no parameter eps"),
        (&["--effect", "pointing:rho"], "KEY=VALUE"),
        (&["--effect", "pointing:rho=1"], "rho: 1"),
        (&["--detector", "all", "--effect", "gain:g=1e-3"], "--detector"),
    ] {
        refused(arguments, expected);
    }
    for (arguments, expected) in [
        (["--degrees", "1:9"], "within 2 and 600"),
        (["--degrees", "9:2"], "within 2 and 600"),
        (["--degrees", "2"], "a colon between"),
        (["--degrees", "2:3:4"], "a colon between"),
        (["--cmb-lmax", "601"], "from 2 to 600"),
        (["--nside", "100"], "a power of two"),
        (["--nside", "2048"], "1024 at most"),
        (["--nside", "32"], "maps of N_side 32 have l up to 95"),
        (["--noise", "-1"], "from 0 to"),
        (["--noise", "loud"], "--noise loud"),
        (["--f-sky", "1.5"], "from 0 to 1"),
        (["--f-sky", "0"], "above 0"),
        (["--fwhm", "-1deg"], "from 0 to 57 deg"),
        (["--dipole", "3362"], "with commas between"),
        (["--dipole", "3362,0deg,91deg"], "from -90 to 90 deg"),
        (["--rate", "0.0001"], "two samples per turn"),
        (["--sky", "nowhere.fits"], "nowhere.fits"),
        (["--survey", "nowhere.fits"], "nowhere.fits"),
        (["--realisations", "1"], "1 is not in 2..="),
    ] {
        refused(&[&gain[..], &arguments].concat(), expected);
    }
    // Two samples tell nothing of three numbers.
    let short = ["--duration", "2s", "--rate", "1", "--nside", "64"];
    refused(&[&gain[..], &short].concat(), "no pixel has I, Q and U");
}
