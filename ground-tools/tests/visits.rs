//! `gyrfalcon visits`: against `transits`, the paper's features, its counting, and bad input.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]
#![expect(
    clippy::cast_precision_loss,
    reason = "counts and ns, compared far above their last digit"
)]

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};

const DAY_S: f64 = 86_400.0;

fn gyrfalcon(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gyrfalcon")).args(arguments).output().unwrap()
}

fn stdout(arguments: &[&str]) -> String {
    let output = gyrfalcon(arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&stdout(arguments)).unwrap()
}

fn rows(text: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

/// The longest gaps of a place in days, the longest first.
fn longest_days(place: &Value) -> Vec<f64> {
    let gaps = place["longest_gaps"].as_array().unwrap();
    gaps.iter().map(|gap| gap["seconds"].as_f64().unwrap() / DAY_S).collect()
}

/// The longest gap that is another feature: less than `share` of the longest.
fn next_feature(days: &[f64], share: f64) -> Option<f64> {
    days.iter().copied().find(|it| *it < share * days[0])
}

#[test]
fn a_targets_visits_are_its_transits() {
    let span = ["--duration", "200d", "--out", "-"];
    for view in
        [&["--target", "jupiter,neptune"][..], &["--telescope", "LFT", "--target", "saturn"]]
    {
        let visits = rows(&stdout(&[&["visits"][..], view, &span].concat()));
        let transits = rows(&stdout(&[&["transits"][..], view, &span].concat()));
        assert!(visits.len() > 20);
        assert_eq!(visits.len(), transits.len());
        for (visit, transit) in visits.iter().zip(&transits) {
            for (column, value) in visit {
                if column != "revisit_s" && column != "gap_s" {
                    assert_eq!(value, &transit[column], "{column}");
                }
            }
        }
    }
}

#[test]
fn rows_and_summary_agree() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("visits.csv");
    let summary = json(&[
        "visits",
        "--paper-pixels",
        "--target",
        "uranus",
        "--duration",
        "1y",
        "--json",
        "--out",
        out.to_str().unwrap(),
    ]);
    let rows = rows(&std::fs::read_to_string(out).unwrap());
    assert!(rows.is_sorted_by_key(|row| row["entry_tai_ns"].parse::<i64>().unwrap()));
    assert_eq!(summary["counting"], "crossings");
    let places = summary["places"].as_array().unwrap();
    let names: Vec<&str> = places.iter().map(|it| it["target"].as_str().unwrap()).collect();
    assert_eq!(names, ["uranus", "pixel:64:ring:0", "pixel:64:ring:7200", "pixel:64:ring:24576"]);
    for place in places {
        let own: Vec<_> = rows.iter().filter(|row| row["target"] == place["target"]).collect();
        assert_eq!(own.len() as u64, place["visits"].as_u64().unwrap());
        let number = |row: &BTreeMap<String, String>, key: &str| row[key].parse::<f64>().ok();
        let dwell: f64 = own.iter().filter_map(|row| number(row, "dwell_s")).sum();
        assert!((dwell - place["total_dwell_s"].as_f64().unwrap()).abs() < 1e-6);
        let mut revisits: Vec<f64> =
            own.iter().filter_map(|row| number(row, "revisit_s")).collect();
        revisits.sort_by(f64::total_cmp);
        let told = &place["revisit"];
        assert_eq!(told["count"].as_u64().unwrap(), revisits.len() as u64);
        let middle = revisits.len() / 2;
        let median = if revisits.len().is_multiple_of(2) {
            f64::midpoint(revisits[middle - 1], revisits[middle])
        } else {
            revisits[middle]
        };
        let last = *revisits.last().unwrap();
        for (key, value) in [
            ("shortest_s", revisits[0]),
            ("median_s", median),
            ("mean_s", revisits.iter().sum::<f64>() / revisits.len() as f64),
            ("longest_s", last),
        ] {
            assert!((told[key].as_f64().unwrap() / value - 1.0).abs() < 1e-9, "{key}");
        }
        for bins in ["logarithmic", "linear"] {
            let edges = told[bins]["edges_s"].as_array().unwrap();
            let counts = told[bins]["counts"].as_array().unwrap();
            assert_eq!(edges.len(), counts.len() + 1);
            for (index, count) in counts.iter().enumerate() {
                let (low, high) =
                    (edges[index].as_f64().unwrap(), edges[index + 1].as_f64().unwrap());
                let plain = revisits.iter().filter(|it| **it >= low && **it < high).count();
                assert_eq!(count.as_u64().unwrap(), plain as u64);
            }
        }
        // Each row's revisit is the next row's entry less its own.
        for pair in own.windows(2) {
            let ns = |row: &BTreeMap<String, String>, key: &str| row[key].parse::<i64>().unwrap();
            let revisit = (ns(pair[1], "entry_tai_ns") - ns(pair[0], "entry_tai_ns")) as f64 / 1e9;
            let gap = (ns(pair[1], "entry_tai_ns") - ns(pair[0], "exit_tai_ns")) as f64 / 1e9;
            assert!((number(pair[0], "revisit_s").unwrap() - revisit).abs() < 1e-6);
            assert!((number(pair[0], "gap_s").unwrap() - gap).abs() < 1e-6);
        }
    }
    let marks = summary["marks"].as_array().unwrap();
    let seconds: Vec<f64> = marks.iter().map(|it| it["seconds"].as_f64().unwrap()).collect();
    for (found, expected) in seconds.iter().zip([1_200.0, 11_540.88, 31_557_600.0]) {
        assert!((found - expected).abs() < 1e-6);
    }
}

#[test]
fn the_papers_revisit_features_come_back() {
    // Longest about 6 months; then 10 d for LiteBIRD, 90 d for PICO, and for Planck the other half of
    // the year: of the pixel on the ecliptic and of each outer planet, over three years.
    for (mission, second) in [("litebird", 8.0..11.0), ("pico", 77.0..95.0)] {
        let summary = json(&[
            "visits",
            "--mission",
            mission,
            "--paper-pixels",
            "--target",
            "jupiter,saturn,uranus,neptune",
            "--json",
        ]);
        let places = summary["places"].as_array().unwrap();
        for place in places {
            let days = longest_days(place);
            let name = &place["target"];
            match name.as_str().unwrap() {
                // The pole is in reach all year: its longest gaps are short.
                "pixel:64:ring:0" => assert!(days[0] < 3.0, "{mission} {name} {days:?}"),
                // At latitude 45 deg no hole of the scan passes: 6 months, then less than 4 d.
                "pixel:64:ring:7200" => {
                    assert!((160.0..175.0).contains(&days[0]), "{mission} {days:?}");
                    assert!(next_feature(&days, 0.9).unwrap() < 4.0, "{mission} {days:?}");
                }
                _ => {
                    assert!((165.0..220.0).contains(&days[0]), "{mission} {name} {days:?}");
                    let next = next_feature(&days, 0.7).unwrap();
                    assert!(second.contains(&next), "{mission} {name} {days:?}");
                }
            }
        }
    }
    let summary = json(&[
        "visits",
        "--mission",
        "planck",
        "--theta-phi",
        "90deg,180deg",
        "--target",
        "jupiter,saturn,uranus,neptune",
        "--json",
    ]);
    for place in summary["places"].as_array().unwrap() {
        let days = longest_days(place);
        assert!((185.0..240.0).contains(&days[0]), "{days:?}");
        assert!((150.0..175.0).contains(&next_feature(&days, 0.92).unwrap()), "{days:?}");
    }
}

#[test]
fn sampled_counting_is_the_papers() {
    let pixel = ["visits", "--theta-phi", "45deg,180deg", "--duration", "60d"];
    let exact = rows(&stdout(&[&pixel[..], &["--out", "-"]].concat()));
    let run = |rate: &str| {
        rows(&stdout(&[&pixel[..], &["--sampled", "--rate", rate, "--out", "-"]].concat()))
    };
    let ns = |row: &BTreeMap<String, String>, key: &str| row[key].parse::<i64>().unwrap();
    for (rate, period_ns) in [("19", 1e9 / 19.0), ("2.5Hz", 4e8)] {
        let sampled = run(rate);
        assert!(sampled.len() > 30 && sampled.len() <= exact.len());
        let start = ns(&exact[0], "entry_tai_ns");
        let origin = 1_017_662_367_814_344_741_i64;
        assert!(start > origin);
        for row in &sampled {
            let (first, last) = (ns(row, "entry_tai_ns"), ns(row, "exit_tai_ns"));
            let visit = exact
                .iter()
                .find(|it| ns(it, "entry_tai_ns") <= first + 1 && last - 1 <= ns(it, "exit_tai_ns"))
                .unwrap();
            assert!(((first - ns(visit, "entry_tai_ns")) as f64) < period_ns + 1.0);
            assert!(((ns(visit, "exit_tai_ns") - last) as f64) < period_ns + 1.0);
            let index = (first - origin) as f64 / period_ns;
            assert!((index - index.round()).abs() < 1e-4, "{index}");
        }
        // The paper's revisit time runs from the last sample inside to the next one inside.
        for pair in sampled.windows(2) {
            let difference =
                (ns(&pair[1], "entry_tai_ns") - ns(&pair[0], "exit_tai_ns")) as f64 / 1e9;
            assert!((pair[0]["revisit_s"].parse::<f64>().unwrap() - difference).abs() < 1e-6);
            assert!(difference * 1e9 > 1.9 * period_ns);
        }
    }
}

#[test]
fn detectors_and_orderings_can_be_chosen() {
    let listed = json(&[
        "visits",
        "--pixel",
        "5",
        "--nside",
        "2",
        "--nested",
        "--direction",
        "-10deg,45deg",
        "--telescope",
        "MFT",
        "--duration",
        "2d",
        "--json",
    ]);
    let places = listed["places"].as_array().unwrap();
    let names: Vec<_> = places.iter().map(|it| it["target"].as_str().unwrap()).collect();
    assert_eq!(names, ["pixel:2:nested:5", "direction:-10deg:45deg"]);
    assert!(places.iter().all(|it| it["telescope"] == "MFT" && it["detector"] == "-"));
    let text = stdout(&["visits", "--direction", "0deg,90deg", "--duration", "2h"]);
    assert!(text.contains("direction:0deg:90deg") && text.contains("LiteBIRD"), "{text}");
}

#[test]
fn a_place_that_is_not_visited_says_so() {
    let there = ["visits", "--theta-phi", "90deg,10deg", "--duration", "1d"];
    let text = stdout(&there);
    assert!(text.contains("no visit"), "{text}");
    let summary = json(&[&there[..], &["--json"]].concat());
    let place = &summary["places"][0];
    assert_eq!(place["visits"], 0);
    assert!(place["revisit"]["longest_s"].is_null());
    assert_eq!(rows(&stdout(&[&there[..], &["--out", "-"]].concat())).len(), 0);
}

/// A folder's files, sorted by name.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    entries
        .map(|it| (it.file_name().into_string().unwrap(), std::fs::read(it.path()).unwrap()))
        .collect()
}

/// What is written in a drawing.
fn texts(svg: &[u8]) -> Vec<String> {
    let document = roxmltree::Document::parse(std::str::from_utf8(svg).unwrap()).unwrap();
    let texts = document.descendants().filter(|node| node.has_tag_name("text"));
    texts.filter_map(|node| node.text().map(String::from)).collect()
}

#[test]
fn figures_are_written_for_every_place() {
    let folder = tempfile::tempdir().unwrap();
    let (png, svg) = (folder.path().join("a"), folder.path().join("b/c"));
    let run = |more: &[&str]| {
        let places = ["--theta-phi", "45deg,180deg", "--theta-phi", "90deg,10deg"];
        let direction = ["--direction", "10deg,-5deg", "--duration", "30d"];
        stdout(&[&["visits"][..], &places, &direction, more].concat())
    };
    let told = run(&["--png", png.to_str().unwrap(), "--svg", svg.to_str().unwrap()]);
    let (png, svg) = (files(&png), files(&svg));
    let places = ["direction-10deg--5deg", "pixel-64-ring-24455", "pixel-64-ring-7200"];
    let mut stems: Vec<String> = Vec::new();
    for place in places {
        for quantity in ["dwell", "gap", "revisit"] {
            for bins in ["linear", "log"] {
                stems.push(format!("{place}-{quantity}-{bins}"));
            }
        }
    }
    let names = |extension: &str| -> Vec<String> {
        stems.iter().map(|stem| format!("{stem}.{extension}")).collect()
    };
    assert_eq!(png.keys().cloned().collect::<Vec<_>>(), names("png"));
    assert_eq!(svg.keys().cloned().collect::<Vec<_>>(), names("svg"));
    assert!(png.values().all(|bytes| bytes.starts_with(b"\x89PNG\r\n\x1a\n")));
    for name in png.keys().chain(svg.keys()) {
        assert!(told.contains(name), "{name} is not told");
    }
    for (name, bytes) in &svg {
        let texts = texts(bytes);
        let marked = |mark: &str| texts.iter().any(|text| text.starts_with(mark));
        if name.contains("revisit-log") || name.contains("gap-log") {
            // 11540.88 s.
            assert!(marked("spin 20.00 min") && marked("precession 3.21 h"), "{name} {texts:?}");
        }
        if name.starts_with("pixel-64-ring-24455") {
            assert!(marked("no visit by crossings"), "{name} {texts:?}");
        }
    }
    // Again: the same bytes, and quiet or not the same results; as JSON the files are in the summary.
    let again = folder.path().join("again");
    assert!(run(&["--svg", again.to_str().unwrap(), "--quiet"]).contains("again/"));
    assert_eq!(files(&again), svg);
    let summary = run(&["--svg", again.to_str().unwrap(), "--json"]);
    let summary: Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["figures"].as_array().unwrap().len(), 18);
}

#[test]
fn figures_that_cannot_be_written_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let taken = folder.path().join("taken");
    std::fs::write(&taken, "a file").unwrap();
    let place = ["visits", "--pixel", "7200", "--duration", "1d"];
    let output = gyrfalcon(&[&place[..], &["--png", taken.to_str().unwrap()]].concat());
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("taken"), "{error}");
    // One of the names is a folder's: none of the files is written.
    let blocked = folder.path().join("blocked");
    std::fs::create_dir_all(blocked.join("pixel-64-ring-7200-gap-log.svg")).unwrap();
    let output = gyrfalcon(&[&place[..], &["--svg", blocked.to_str().unwrap()]].concat());
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("gap-log.svg"), "{error}");
    assert_eq!(std::fs::read_dir(&blocked).unwrap().count(), 1);

    let pixels: Vec<String> = (0..51).map(|number| number.to_string()).collect();
    let unused = folder.path().join("unused");
    let arguments = ["visits", "--pixel", &pixels.join(","), "--png", unused.to_str().unwrap()];
    let output = gyrfalcon(&arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("51 places") && error.contains("at most 50"), "{error}");
    assert!(!unused.exists());
}

#[test]
fn a_galactic_place_is_the_ecliptic_one_by_another_name() {
    // The galactic centre in ecliptic axes by astropy 8.0, whose galactic frame is 0.02 arcsec off.
    let run = |there: &[&str]| {
        rows(&stdout(&[&["visits"][..], there, &["--duration", "40d", "--out", "-"]].concat()))
    };
    let galactic = run(&["--galactic", "--direction", "0deg,0deg"]);
    let [x, y, z] = [-0.054_875_657_712_592_f64, -0.993_821_367_039_231, -0.096_476_694_630_799];
    let (longitude, latitude) = (y.atan2(x).to_degrees(), z.asin().to_degrees());
    let ecliptic = run(&["--direction", &format!("{longitude}deg,{latitude}deg")]);
    assert!(galactic.len() > 20);
    assert_eq!(galactic.len(), ecliptic.len());
    for (one, other) in galactic.iter().zip(&ecliptic) {
        assert_eq!(one["target"], "direction:0deg:0deg:galactic");
        let ns = |row: &BTreeMap<String, String>| row["entry_tai_ns"].parse::<i64>().unwrap();
        // 0.02 arcsec along or across the edge of a circle of degrees.
        assert!((ns(one) - ns(other)).abs() < 20_000_000, "{one:?} {other:?}");
    }
    let names = run(&["--galactic", "--theta-phi", "90deg,0deg"]);
    assert!(names.len() > 20);
    assert!(names.iter().all(|row| row["target"] == "pixel:64:ring:24448:galactic"), "{names:?}");
}

#[test]
fn equal_inputs_give_equal_bytes() {
    let run = ["visits", "--paper-pixels", "--target", "mars", "--duration", "90d", "--json"];
    assert_eq!(stdout(&run), stdout(&run));
}

#[test]
fn bad_input_is_refused_with_what_is_legal() {
    for (arguments, parts) in [
        (&["--pixel", "49152"][..], ["--pixel 49152", "0 to 49151"]),
        (&["--pixel", "0", "--nside", "100"], ["nside 100", "power of two"]),
        (&["--pixel", "0", "--nside", "4096"], ["nside 4096", "2048"]),
        (&["--target", "pluto"], ["--target pluto", "mars"]),
        (&["--direction", "10,20"], ["--direction 10,20", "no unit"]),
        (&["--direction", "10deg"], ["--direction 10deg", "comma"]),
        (&["--theta-phi", "181deg,0deg"], ["--theta-phi 181deg", "0 to 180 deg"]),
        (&["--theta-phi", "1parsec,0deg"], ["parsec", "deg, arcmin"]),
        (&["--sampled", "--rate", "0"], ["--rate 0", "above 0 Hz"]),
        (&["--sampled", "--rate", "-1"], ["--rate", "-1"]),
        (&["--rate", "19"], ["--sampled", "required"]),
        (&["--telescope", "HTF"], ["--telescope HTF", "HFT"]),
        (&["--format", "c", "--out", "no-such-file.h"], ["--format c", "csv, jsonl or parquet"]),
    ] {
        let output = gyrfalcon(&[&["visits"][..], arguments].concat());
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        for part in parts {
            assert!(error.contains(part), "{arguments:?} lacks {part:?}: {error}");
        }
    }
}
