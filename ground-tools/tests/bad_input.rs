//! Bad input ends with exit code 2 and a sentence that says what, where, and what would be legal;
//! nothing is left half-written.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs the command in `folder`; returns the exit code and standard error.
fn run(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

/// Bad input: exit code 2, one sentence with all of `parts`, and no file written.
fn refused(folder: &Path, arguments: &[&str], parts: &[&str]) {
    let before = listing(folder);
    let (code, error) = run(folder, arguments);
    assert_eq!(code, 2, "{arguments:?}: {error}");
    assert!(error.starts_with("error: "), "{arguments:?}: {error}");
    assert!(!error.contains("panicked"), "{arguments:?}: {error}");
    for part in parts {
        assert!(error.contains(part), "{arguments:?} lacks {part:?}: {error}");
    }
    assert_eq!(listing(folder), before, "{arguments:?} left something behind");
}

fn listing(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

#[test]
fn numbers_out_of_range() {
    let folder = tempfile::tempdir().unwrap();
    for (setting, parts) in [
        ("scan.alpha_deg=181", ["scan.alpha_deg", "181", "from 0 to 180 deg"]),
        ("scan.beta_deg=-1", ["scan.beta_deg", "-1", "from 0 to 180 deg"]),
        ("scan.alpha_deg=nan", ["scan.alpha_deg", "nan", "0 to 180 deg"]),
        ("scan.beta_deg=140", ["scan.alpha_deg + scan.beta_deg", "185", "180"]),
        ("scan.spin_period_min=0", ["scan.spin_period_min = 0", "a period from", "min is needed"]),
        ("scan.spin_period_min=-20", ["scan.spin_period_min", "-20", "spin_sign"]),
        ("scan.precession_period_min=nan", ["scan.precession_period_min", "nan", "a period from"]),
        ("calibration.radius_deg=0", ["calibration.radius_deg", "0", "180 deg"]),
        ("calibration.radius_deg=180.5", ["calibration.radius_deg", "180.5", "180 deg"]),
        ("scan.alpa_deg=45", ["unknown key", "scan.alpa_deg", "did you mean scan.alpha_deg"]),
        ("calibration.targets=[\"marz\"]", ["calibration.targets", "marz", "mars"]),
        ("span.duration_days=0", ["span.duration_days", "0", "above 0"]),
    ] {
        refused(folder.path(), &["transits", "--set", setting], &parts);
    }
    refused(folder.path(), &["plan", "--mission", "litebrid"], &["litebrid", "litebird"]);
    refused(folder.path(), &["transits", "--target", "pluto"], &["--target pluto", "mars"]);
    refused(folder.path(), &["transits", "--telescope", "HTF"], &["--telescope HTF", "HFT"]);
    refused(folder.path(), &["transits", "--detector", "d9"], &["--detector d9"]);
    refused(folder.path(), &["pointing", "--at", "1e9"], &["--at", "beyond the mission"]);
    refused(folder.path(), &["transits", "--start", "2032-04-01T00:00:00"], &["--start", "TDB"]);
    refused(folder.path(), &["transits", "--duration", "20"], &["--duration", "no unit"]);
}

#[test]
fn legal_oddities_run() {
    let folder = tempfile::tempdir().unwrap();
    let (code, error) = run(
        folder.path(),
        &["transits", "--json", "--duration", "5d", "--set", "scan.alpha_deg=20"],
    );
    assert_eq!(code, 0, "{error}");
    assert!(error.contains("warning: ") && error.contains("full sky"), "{error}");
    for setting in ["scan.alpha_deg=0", "scan.beta_deg=90"] {
        for verb in ["constraints", "transits"] {
            let (code, error) =
                run(folder.path(), &[verb, "--json", "--duration", "5d", "--set", setting]);
            assert_eq!(code, 0, "{verb} {setting}: {error}");
        }
    }
}

#[test]
fn a_mission_file_is_named_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.toml"), "base = \"pico\"\n\n[scan]\nalpa_deg = 3\n")
        .unwrap();
    refused(
        folder.path(),
        &["constraints", "--mission", "m.toml"],
        &["m.toml, line 4", "unknown key scan.alpa_deg", "scan.alpha_deg"],
    );
    std::fs::write(folder.path().join("m.toml"), "base = \n").unwrap();
    refused(folder.path(), &["constraints", "--mission", "m.toml"], &["m.toml", "line 1"]);
}

#[test]
fn kernels() {
    let folder = tempfile::tempdir().unwrap();
    let good = std::fs::read(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../ephem/data/de440-2024-2046.bsp"),
    )
    .unwrap();
    let kernel = folder.path().join("k.bsp");
    let check = |bytes: &[u8], parts: &[&str]| {
        std::fs::write(&kernel, bytes).unwrap();
        refused(folder.path(), &["transits", "--ephemeris", "k.bsp"], parts);
    };
    check(&good[..1_000_000], &["k.bsp"]);
    check(&good[..500], &["k.bsp"]);
    check(b"", &["k.bsp"]);
    check(b"not a kernel at all, just some text that is long enough to be read", &["k.bsp"]);
    let mut swapped = good.clone();
    swapped[88..96].copy_from_slice(b"BIG-IEEE");
    check(&swapped, &["k.bsp", "damaged", "summary format"]);
    // Bits of the file record that lead elsewhere: summary format, first summary, the FTP mark.
    for at in [8, 12, 76, 79, 700] {
        let mut flipped = good.clone();
        flipped[at] ^= 0x10;
        check(&flipped, &["k.bsp"]);
    }
    refused(folder.path(), &["transits", "--ephemeris", "no.bsp"], &["no.bsp"]);
    refused(
        folder.path(),
        &["transits", "--quiet", "--start", "2050-01-01T00:00:00 TDB"],
        &["2050-01-01", "from 2024-01-01", "to 2046-01-01"],
    );
    refused(folder.path(), &["plan", "--duration", "20y"], &["2046"]);
    refused(folder.path(), &["transits", "--trajectory", "no.oem"], &["no.oem"]);
}

#[test]
fn places_that_cannot_be_written() {
    let folder = tempfile::tempdir().unwrap();
    refused(
        folder.path(),
        &["transits", "--duration", "2d", "--out", "no/such/folder.csv"],
        &["no/such/folder.csv"],
    );
    refused(folder.path(), &["transits", "--duration", "2d", "--out", "."], &["it is a folder"]);
    refused(folder.path(), &["plan", "--out", "-"], &["--out FOLDER"]);
    let other = folder.path().join("thesis");
    std::fs::create_dir(&other).unwrap();
    std::fs::write(other.join("chapter1.tex"), "precious").unwrap();
    refused(folder.path(), &["plan", "--out", "thesis"], &["thesis", "not empty", "--force"]);
    std::fs::write(folder.path().join("file"), "x").unwrap();
    refused(folder.path(), &["plan", "--duration", "2d", "--out", "file"], &["file"]);
    refused(folder.path(), &["plan", "--duration", "2d", "--out", "file/below"], &["file"]);
    assert_eq!(std::fs::read_to_string(other.join("chapter1.tex")).unwrap(), "precious");
}

#[test]
fn uplink_tables() {
    let folder = tempfile::tempdir().unwrap();
    let (code, error) =
        run(folder.path(), &["table", "build", "--duration", "30d", "--out", "good.tbl"]);
    assert_eq!(code, 0, "{error}");
    let good = std::fs::read(folder.path().join("good.tbl")).unwrap();
    let bad = folder.path().join("bad.tbl");
    std::fs::write(&bad, b"").unwrap();
    let check = |bytes: &[u8], parts: &[&str]| {
        std::fs::write(&bad, bytes).unwrap();
        for verb in ["inspect", "verify"] {
            refused(folder.path(), &["table", verb, "bad.tbl"], parts);
        }
    };
    check(&good[..good.len() - 1], &["bad.tbl", "cut short"]);
    check(&good[..10], &["bad.tbl", "cut short"]);
    check(
        b"#!/bin/sh and then some more text, so that it is long enough to hold a header",
        &["bad.tbl", "not an uplink table"],
    );
    let flip = |at: usize| {
        let mut bytes = good.clone();
        bytes[at] ^= 1;
        bytes
    };
    check(&flip(20), &["bad.tbl", "damaged", "header"]);
    check(&flip(70), &["bad.tbl", "damaged", "directory"]);
    check(&flip(good.len() / 2), &["bad.tbl", "damaged", "ephemeris"]);
    check(&flip(good.len() - 1), &["bad.tbl", "damaged", "mission"]);
    let mut older = good.clone();
    older[8] = 0;
    check(&older, &["bad.tbl", "format version is 0", "version 3 is needed"]);
    refused(folder.path(), &["table", "inspect", "none.tbl"], &["none.tbl"]);
    refused(folder.path(), &["table", "diff", "good.tbl", "none.tbl"], &["none.tbl"]);
    let back = ["table", "rollback", "good.tbl", "good.tbl", "--until", "2032-05-01T00:00:00Z"];
    refused(folder.path(), &back, &["good.tbl has sequence 1", "a smaller one"]);
    let clock = |tick: &'static str, at: &'static str| {
        ["table", "clock", "--ticks", "5", "--tick-ns", tick, "--valid-for", "7d", "--at", at]
    };
    refused(folder.path(), &clock("0", "2032-04-01T00:00:00Z"), &["--tick-ns 0", "above 0"]);
    refused(folder.path(), &clock("1000", "2032-04-01T00:00:00"), &["--at", "time scale"]);
    refused(folder.path(), &clock("ten", "2032-04-01T00:00:00Z"), &["--tick-ns ten"]);
    let change = ["table", "change", "good.tbl", "good.tbl", "--until", "2032-05-01T00:00:00Z"];
    refused(folder.path(), &change, &["same spacecraft", "no order is needed"]);
    std::fs::write(&bad, b"GYRCLOCK, but not a whole one").unwrap();
    refused(folder.path(), &["table", "inspect", "bad.tbl"], &["bad.tbl", "72 bytes", "29"]);

    // A sound table of another mission fails the check instead: exit code 1.
    let (code, error) = run(
        folder.path(),
        &["table", "verify", "good.tbl", "--duration", "30d", "--set", "scan.alpha_deg=46"],
    );
    assert_eq!(code, 1, "{error}");
    assert!(error.contains("another mission"), "{error}");
}

/// A number that the spacecraft would refuse, or that would leave none for later, is not written.
#[test]
fn sequence_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let clock = [
        "table",
        "clock",
        "--ticks",
        "5",
        "--tick-ns",
        "1000",
        "--valid-for",
        "7d",
        "--at",
        "2032-04-01T00:00:00Z",
    ];
    let short = ["--duration", "2d"];
    let verbs = [&["table", "build"][..], &["plan"], &clock];
    for verb in verbs {
        let with = |more: &[&'static str]| {
            let span: &[&str] = if verb == &clock[..] { &[] } else { &short };
            [verb, span, more].concat()
        };
        for (sequence, after, told) in [
            ("4294967295", "0", "--sequence 4294967295 is not legal: --sequence 1 to 1000 are"),
            ("4294966296", "0", "--sequence 4294966296 is not legal: --sequence 1 to 1000 are"),
            ("0", "0", "--sequence 0 is not legal: --sequence 1 to 1000 are"),
            ("7", "7", "--sequence 7 is not legal: --sequence 8 to 1007 are"),
            ("1008", "7", "--sequence 1008 is not legal: --sequence 8 to 1007 are"),
        ] {
            let arguments = with(&["--sequence", sequence, "--after", after]);
            refused(folder.path(), &arguments, &[told, "--after"]);
        }
        refused(folder.path(), &with(&["--after", "4294967295"]), &["--after 4294967295"]);
    }
}

#[test]
fn usage_mistakes_end_with_2_too() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [&["transit"][..], &["transits", "--fromat", "csv"], &[]] {
        let (code, error) = run(folder.path(), arguments);
        assert_eq!(code, 2, "{arguments:?}");
        assert!(error.contains("Usage") || error.contains("tip"), "{error}");
    }
    let (code, _) = run(folder.path(), &["--help"]);
    assert_eq!(code, 0);
}
