//! `gyrfalcon survey`: its numbers, its files, the flight core on real ephemerides, and bad input.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]
#![expect(clippy::float_cmp, reason = "whole numbers of samples")]

use formats::fits::{
    Column, ColumnChoice, Frames, Map, MapFrame, MapHeader, Polcconv, Values, read_map, write_maps,
};
use planner::healpix::{Nside, Ordering};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"));
    command.arg("survey").args(arguments).env_remove("GYRFALCON_ISA");
    command
}

fn run(arguments: &[&str]) -> Output {
    command(arguments).output().unwrap()
}

fn stdout(arguments: &[&str]) -> Vec<u8> {
    let output = run(arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    output.stdout
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_slice(&stdout(&[arguments, &["--json"]].concat())).unwrap()
}

fn refused(arguments: &[&str], words: &[&str]) {
    let output = run(arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
    for word in words {
        assert!(error.contains(word), "{arguments:?}: {word} is not in: {error}");
    }
}

fn column(path: &Path, name: &str) -> Map {
    let frames = Frames { accepted: &[MapFrame::Ecliptic, MapFrame::Galactic], unsaid: None };
    read_map(path, ColumnChoice::Name(name), frames).unwrap()
}

/// A month of LiteBIRD at 1 Hz on the circular Sun, as the reference has it.
const MONTH: [&str; 9] = [
    "--duration",
    "30d",
    "--sun",
    "circular:0deg",
    "--set",
    "scan.spin_phase_deg=180",
    "--rate",
    "1",
    "--quiet",
];

#[test]
fn numbers_are_those_of_the_reference() {
    let found = json(
        &[
            &MONTH[..],
            &["--nside", "64", "--telescope", "HFT", "--moment", "1,0", "--spin", "-2,4"],
        ]
        .concat(),
    );
    let close = |value: &Value, expected: f64, bound: f64| {
        let value = value.as_f64().unwrap();
        assert!((value / expected - 1.0).abs() < bound, "{value} {expected}");
    };
    assert_eq!(found["nside"], 64);
    assert_eq!(found["samples"], 2_592_000);
    close(&found["mean_hits"], 52.734_375, 1e-15);
    close(&found["sigma_hits"], 55.873_651_632_917_34, 1e-6);
    close(&found["sigma_hits_normalised"], 1.059_529_986_520_506_6, 1e-6);
    assert_eq!(found["unobserved_pixels"], 49_152 - 30_887);
    let [one, two] = &found["crosslink"].as_array().unwrap()[..] else { panic!("two moments") };
    assert_eq!((&one["n"], &one["m"]), (&1.into(), &0.into()));
    assert_eq!((&two["n"], &two["m"]), (&(-2).into(), &4.into()));
    assert_eq!(one["mean"], Value::Null);
    close(&one["mean_observed"], 0.510_240_287_345_698_8, 1e-9);
    close(&two["mean_observed"], 0.037_215_193_498_113_78, 1e-6);
    close(&found["scan_beam_amplitude_deg"], 5.119, 1e-3);
    assert!(found["provenance"]["mission_sha256"].is_string());
}

#[test]
fn real_ephemerides_frames_steps_and_detectors_agree_with_the_flight_core() {
    let folder = tempfile::tempdir().unwrap();
    let base = [
        "--nside",
        "256",
        "--moment",
        "1,0",
        "--moment",
        "2,4",
        "--moment",
        "0.5,0",
        "--telescope",
        "HFT",
        "--quiet",
        "--set",
        "telescope.HFT.detectors.grid_deg=9",
    ];
    for (name, options) in [
        ("ecliptic", &["--rate", "7", "--duration", "30000s"][..]),
        ("galactic", &["--rate", "20e6/1048576", "--galactic", "--duration", "9000s"]),
        ("steps", &["--rate", "3", "--orbit-step", "2.5h", "--duration", "30000s"]),
    ] {
        let maps = ["auto", "plain"].map(|isa| {
            let path = folder.path().join(format!("{name}-{isa}.fits"));
            let arguments = [&base[..], options, &["--out", path.to_str().unwrap()]].concat();
            let output = command(&arguments).env("GYRFALCON_ISA", isa).output().unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            path
        });
        let [hits, plain] = [0, 1].map(|which| column(&maps[which], "HITS").values);
        assert!(hits == plain, "{name}");
        assert!(hits.iter().sum::<f64>() > 100_000.0);
        for part in ["H_1_0_RE", "H_1_0_IM", "H_2_4_RE", "H_2_4_IM", "H_0P5_0_RE"] {
            let [fast, plain] = [0, 1].map(|which| column(&maps[which], part).values);
            for (fast, plain) in fast.iter().zip(&plain) {
                assert!(fast.is_nan() == plain.is_nan());
                let off = if fast.is_nan() { 0.0 } else { (fast - plain).abs() };
                assert!(off < 1e-10, "{name} {part}: {fast} {plain}");
            }
        }
    }
}

#[test]
fn files_are_whole_and_say_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let base = ["--duration", "2d", "--rate", "1", "--nside", "16", "--quiet", "--moment", "2,0"];
    let out = path("m.fits");
    let summary = json(
        &[&base[..], &["--snapshot", "1d,192.348min", "--out", out.to_str().unwrap()]].concat(),
    );
    let files: Vec<&str> =
        summary["files"].as_array().unwrap().iter().map(|it| it.as_str().unwrap()).collect();
    let expected = ["m-192.348min.fits", "m-1d.fits", "m.fits"].map(path);
    assert_eq!(files, expected.each_ref().map(|it| it.to_str().unwrap()));
    let snapshots = summary["snapshots"].as_array().unwrap();
    assert_eq!(snapshots[1]["elapsed_s"], 86_400.0);
    for (file, samples) in expected.iter().zip([11_541.0, 86_400.0, 172_800.0]) {
        let hits = column(file, "HITS");
        assert_eq!((hits.ordering, hits.frame), (Ordering::Ring, MapFrame::Ecliptic));
        assert_eq!(hits.values.iter().sum::<f64>(), samples);
    }

    stdout(&[&base[..], &["--out", out.to_str().unwrap()]].concat());
    let nested = path("n.fits");
    stdout(&[&base[..], &["--nested", "--out", nested.to_str().unwrap()]].concat());
    let (ring, nested) = (column(&out, "H_2_0_ABS2"), column(&nested, "H_2_0_ABS2"));
    assert_eq!(nested.ordering, Ordering::Nested);
    for pixel in 0..ring.nside.pixels() {
        let (a, b) =
            (ring.values[ring.nside.ring_of_nested(pixel) as usize], nested.values[pixel as usize]);
        assert!(a == b || (a.is_nan() && b.is_nan()));
    }

    let bytes =
        |threads: &str| stdout(&[&base[..], &["--threads", threads, "--out", "-"]].concat());
    let one = bytes("1");
    assert_eq!(one, std::fs::read(&out).unwrap());
    assert_eq!(one, bytes("2"));
    assert_eq!(one, bytes("4"));

    let png = path("png");
    stdout(
        &[&base[..], &["--png", png.to_str().unwrap(), "--patch", "10deg,80deg,20deg"]].concat(),
    );
    for name in ["hits.png", "hits-patch1.png", "h_2_0.png", "h_2_0-patch1.png"] {
        assert!(std::fs::read(png.join(name)).unwrap().starts_with(b"\x89PNG"), "{name}");
    }
}

#[test]
fn detectors_share_a_map_or_have_their_own() {
    let base = [
        "--duration",
        "6h",
        "--rate",
        "1",
        "--nside",
        "8",
        "--quiet",
        "--telescope",
        "LFT",
        "--set",
        "telescope.LFT.detectors.grid_deg=8",
    ];
    let all = json(&base);
    let each = json(&[&base[..], &["--per-detector"]].concat());
    let each = each["per_detector"].as_array().unwrap();
    assert!(each.len() > 2);
    assert_eq!(all["detectors"], each.len());
    let sum: u64 = each.iter().map(|it| it["samples"].as_u64().unwrap()).sum();
    assert_eq!(all["samples"], sum);
    assert_eq!(each[0]["detector"], "g000");
    assert_ne!(each[0]["sigma_hits"], each[1]["sigma_hits"]);
}

/// A sky that is the same everywhere.
fn uniform_sky(path: &Path, frame: MapFrame, stokes: [f64; 3]) {
    let value = |index: usize| move |_: u32| stokes[index];
    let (i, q, u) = (value(0), value(1), value(2));
    let column = |name, values| Column { name, unit: "K", values: Values::Double(values) };
    let header = MapHeader {
        nside: Nside::new(16).unwrap(),
        ordering: Ordering::Ring,
        frame,
        name: "SKY".to_owned(),
        polcconv: Some(Polcconv::Cosmo),
        cards: Vec::new(),
    };
    let columns = [column("I_STOKES", &i), column("Q_STOKES", &q), column("U_STOKES", &u)];
    let mut bytes = Vec::new();
    write_maps(&mut bytes, &header, &columns).unwrap();
    std::fs::write(path, bytes).unwrap();
}

#[test]
fn a_sky_of_q_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let (sky, out) = (folder.path().join("sky.fits"), folder.path().join("m.fits"));
    for frame in [MapFrame::Ecliptic, MapFrame::Galactic] {
        uniform_sky(&sky, frame, [0.0, 1.0, 0.0]);
        let galactic = if frame == MapFrame::Galactic { &["--galactic"][..] } else { &[] };
        for plate in
            [&["--set", "scan.n_margin=1"][..], &["--set", "telescope.HFT.hwp_rate_rpm=none"]]
        {
            let base = [
                "--duration",
                "30d",
                "--rate",
                "2",
                "--nside",
                "16",
                "--quiet",
                "--telescope",
                "HFT",
            ];
            let files = ["--sky", sky.to_str().unwrap(), "--out", out.to_str().unwrap()];
            let found = json(&[&base[..], &files, galactic, plate].concat());
            assert_eq!(found["sky"]["left_out_samples"], 0);
            let made = folder.path().join("m-iqu.fits");
            let map = |name| column(&made, name);
            let (i, q, u) = (map("I_STOKES"), map("Q_STOKES"), map("U_STOKES"));
            let condition = map("CONDITION");
            assert_eq!(q.frame, frame);
            let mut solved = 0;
            for pixel in 0..q.values.len() {
                if !q.values[pixel].is_nan() && condition.values[pixel] < 1e3 {
                    solved += 1;
                    assert!((q.values[pixel] - 1.0).abs() < 1e-9);
                    assert!(i.values[pixel].abs() < 1e-9 && u.values[pixel].abs() < 1e-9);
                }
            }
            assert!(solved > 100, "{solved}");
        }
    }
    refused(&["--sky", sky.to_str().unwrap()], &["--sky", "--out"]);
    std::fs::write(&sky, "no FITS").unwrap();
    let out = out.to_str().unwrap();
    refused(&["--sky", sky.to_str().unwrap(), "--out", out], &["sky.fits", "FITS"]);
}

#[cfg(unix)]
#[test]
fn an_interrupt_keeps_snapshots() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("m.fits");
    // Far more than can be done while the test waits.
    let arguments = [
        "--sun",
        "circular:0deg",
        "--duration",
        "60y",
        "--rate",
        "500",
        "--nside",
        "4",
        "--snapshot",
        "1d",
        "--quiet",
        "--out",
        out.to_str().unwrap(),
    ];
    let mut child = command(&arguments).stderr(std::process::Stdio::piped()).spawn().unwrap();
    let snapshot = folder.path().join("m-1d.fits");
    for _ in 0..600 {
        if snapshot.exists() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    let status = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(status.success());
    assert_eq!(child.wait().unwrap().code(), Some(1));
    let mut told = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut told).unwrap();
    assert!(told.contains("interrupted") && told.contains("m-1d.fits"), "{told}");
    assert_eq!(column(&snapshot, "HITS").values.iter().sum::<f64>(), 43_200_000.0);
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 1);
}

#[test]
fn slow_sampling_is_a_warning() {
    let output = run(&["--duration", "1h", "--rate", "5", "--nside", "8", "--telescope", "HFT"]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success());
    assert!(error.contains("sampling_ok fails for HFT"), "{error}");
}

#[test]
fn bad_input_is_a_sentence() {
    refused(&["--nside", "100"], &["--nside", "100", "power of two"]);
    refused(&["--nside", "8192"], &["8192", "2048", "6.4 GB"]);
    refused(&["--moment", "2,4"], &["--moment 2,4", "half-wave plate", "--telescope LFT"]);
    refused(&["--mission", "planck", "--moment", "0,1"], &["no half-wave plate", "m = 0"]);
    refused(&["--moment", "2"], &["--moment 2", "comma"]);
    refused(&["--moment", "0.25,0"], &["0.25", "half"]);
    refused(&["--moment", "x,0"], &["--moment x,0"]);
    refused(&["--rate", "0"], &["--rate 0", "above 0 Hz"]);
    refused(&["--rate", "1e-4"], &["--rate", "samples per turn"]);
    refused(&["--snapshot", "5"], &["--snapshot 5", "unit"]);
    refused(&["--snapshot", "9y"], &["--snapshot 9y", "1095.75 d"]);
    refused(&["--orbit-step", "0s"], &["--orbit-step 0s", "above 0 s"]);
    refused(&["--patch", "1deg,2deg"], &["--patch", "side"]);
    refused(&["--patch", "1deg,95deg,2deg"], &["latitude"]);
    refused(&["--threads", "0"], &["--threads"]);
    refused(&["--detector", "d9"], &["--detector d9"]);
    refused(&["--json", "--out", "-"], &["--json", "--out -"]);
    let output = command(&["--duration", "1h"]).env("GYRFALCON_ISA", "mmx").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("GYRFALCON_ISA=mmx"));
    let short = ["--duration", "1h", "--rate", "1", "--nside", "8", "--quiet"];
    refused(&[&short[..], &["--out", "/dev/full"]].concat(), &["/dev/full"]);
    refused(&[&short[..], &["--out", "/nowhere/m.fits"]].concat(), &["/nowhere/m.fits"]);
    refused(&[&short[..], &["--png", "/dev/null/pictures"]].concat(), &["/dev/null/pictures"]);
}
