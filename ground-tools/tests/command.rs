//! The command as a user runs it: the main job, the paper's numbers, independent values.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

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

/// The columns and rows of a CSV with comment lines.
fn rows(text: &str) -> Vec<std::collections::BTreeMap<String, String>> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

fn reference(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(name)
}

#[test]
fn constraints_has_the_papers_numbers() {
    let at = |settings: &[&str]| {
        let mut arguments = vec!["constraints", "--json", "--quiet"];
        for setting in settings {
            arguments.extend(["--set", setting]);
        }
        json(&arguments)
    };
    let telescope = |value: &Value, name: &str| {
        let telescopes = value["telescopes"].as_array().unwrap();
        telescopes.iter().find(|it| it["name"] == name).unwrap().clone()
    };
    let close = |value: &Value, expected: f64| {
        assert!((value.as_f64().unwrap() - expected).abs() < 5e-4, "{value} {expected}");
    };
    let default = at(&[]);
    assert_eq!(default["full_sky"], true);
    let hft = telescope(&default, "HFT");
    close(&hft["t_beta_lower_plus_min"], 16.884);
    close(&hft["omega_max_plus_deg_s"], 0.26089);
    close(&hft["omega_max_minus_deg_s"], 0.22709);
    assert_eq!(hft["modulation_ok"], true);
    assert_eq!(hft["sampling_ok"], true);
    for (alpha, beta, minutes) in [("10", "85", 21.956), ("85", "10", 3.827)] {
        let (alpha, beta) = (format!("scan.alpha_deg={alpha}"), format!("scan.beta_deg={beta}"));
        let found = at(&[&alpha, &beta]);
        close(&telescope(&found, "HFT")["t_beta_lower_plus_min"], minutes);
    }
    // Undefined values are null, with the reason beside them.
    let flat = at(&["scan.alpha_deg=0", "scan.beta_deg=90", "telescope.HFT.hwp_rate_rpm=none"]);
    let hft = telescope(&flat, "HFT");
    assert!(hft["t_beta_lower_plus_min"].is_null() && hft["modulation_ok"].is_null());
    assert_eq!(hft["reasons"][0], "the telescope has no half-wave plate");
}

#[test]
fn visibility_hours_are_the_papers_when_its_model_is_asked_for() {
    for (mission, hours) in [("litebird", 3.15), ("pico", 1.81), ("planck", 1.63)] {
        let summary = json(&[
            "transits",
            "--mission",
            mission,
            "--observer",
            "sun",
            "--geometric",
            "--sun",
            "circular:191.37579428901796",
            "--set",
            "scan.spin_phase_deg=180",
            "--json",
        ]);
        let total = summary["integrated_hours"]["total"].as_f64().unwrap();
        assert!((total / hours - 1.0).abs() < 0.01, "{mission}: {total}");
    }
    // The truth from L2, as the README states it: first with the paper's Sun, then with the real.
    for (sun, total, mars) in
        [("circular:191.37579428901796", 2.738, 0.290), ("ephemeris", 2.730, 0.304)]
    {
        let phase = "scan.spin_phase_deg=180";
        let summary = json(&["transits", "--sun", sun, "--set", phase, "--json"]);
        let hours = &summary["integrated_hours"];
        assert!((hours["total"].as_f64().unwrap() - total).abs() < 0.001, "{sun}: {hours}");
        assert!((hours["mars"].as_f64().unwrap() - mars).abs() < 0.001, "{sun}: {hours}");
    }
}

#[test]
fn transits_on_given_directions_match_the_reference_to_a_millisecond() {
    let expected: Value =
        serde_json::from_str(&std::fs::read_to_string(reference("transits.json")).unwrap())
            .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mission = folder.path().join("mission.toml");
    let source = |name: &str| {
        let file = reference(&format!("directions_{name}_sun.csv"));
        format!("[[calibration.source]]\nname = \"own_{name}\"\ndirections = {file:?}\n")
    };
    std::fs::write(
        &mission,
        format!(
            "base = \"litebird\"\n[calibration]\ntargets = [\"own_mars\", \"own_jupiter\"]\n{}{}",
            source("mars"),
            source("jupiter")
        ),
    )
    .unwrap();
    let text = stdout(&[
        "transits",
        "--mission",
        mission.to_str().unwrap(),
        "--sun",
        "circular:191.37579428901796",
        "--set",
        "scan.spin_phase_deg=180",
    ]);
    let rows = rows(&text);
    for name in ["mars", "jupiter"] {
        let windows = &expected["windows"][format!("std|L0_real|sun|{name}")];
        let own = format!("own_{name}");
        let found: Vec<_> = rows.iter().filter(|row| row["target"] == own).collect();
        assert_eq!(found.len() as u64, windows["n"].as_u64().unwrap(), "{name}");
        let total: f64 = found.iter().map(|row| row["dwell_s"].parse::<f64>().unwrap()).sum();
        assert!((total - windows["total_s"].as_f64().unwrap()).abs() < 0.01, "{name}: {total}");
        let start: i64 = 1_017_662_367_814_344_741;
        for (row, window) in found.iter().zip(windows["first50"].as_array().unwrap()) {
            for (column, index) in [("entry_tai_ns", 0), ("exit_tai_ns", 1)] {
                let ns = row[column].parse::<i64>().unwrap() - start;
                let seconds = std::time::Duration::from_nanos(ns.unsigned_abs()).as_secs_f64();
                let off = seconds - window[index].as_f64().unwrap();
                assert!(off.abs() < 1e-3, "{name}: {off} s at {window}");
            }
        }
    }
}

#[test]
fn pointing_matches_fifty_digits() {
    let reference: Value =
        serde_json::from_str(&std::fs::read_to_string(reference("pointing_exact.json")).unwrap())
            .unwrap();
    let case = &reference["cases"]["std"];
    let times: Vec<&str> =
        case["rows"].as_array().unwrap().iter().map(|row| row["t"].as_str().unwrap()).collect();
    let text = stdout(&[
        "pointing",
        "--at",
        &times.join(","),
        "--telescope",
        "HFT",
        "--sun",
        "circular:0",
        "--set",
        "scan.spin_phase_deg=180",
    ]);
    let rows = rows(&text);
    assert_eq!(rows.len(), times.len());
    for (row, expected) in rows.iter().zip(case["rows"].as_array().unwrap()) {
        let number = |key: &str| row[key].parse::<f64>().unwrap();
        for (key, index) in [("x", 0), ("y", 1), ("z", 2)] {
            let off = number(key) - expected["n"][index].as_f64().unwrap();
            assert!(off.abs() < 1e-12, "{key}: {off:e}");
        }
        for (key, expected) in [("psi_deg", &expected["psi"]), ("hwp_deg", &expected["hwp"])] {
            let off = (number(key).to_radians() - expected.as_f64().unwrap()).sin();
            assert!(off.abs() < 1e-11, "{key}: {off:e}");
        }
    }
}

#[test]
fn the_plan_is_complete_consistent_and_repeatable() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let plan = |name: &str| {
        let out = path(name);
        json(&["plan", "--duration", "60d", "--out", out.to_str().unwrap(), "--json"])
    };
    let summary = plan("a");
    plan("b");
    let read = |name: &str, file: &str| std::fs::read(path(name).join(file)).unwrap();
    for file in ["timeline.json", "timeline.csv", "uplink.tbl", "report.html"] {
        assert!(read("a", file) == read("b", file), "{file} differs between equal runs");
    }
    let timeline: Value = serde_json::from_slice(&read("a", "timeline.json")).unwrap();
    let sessions = timeline["sessions"].as_array().unwrap();
    assert_eq!(summary["sessions"], sessions.len());
    assert!(sessions.len() > 50);
    let number = |key: &str| timeline[key].as_f64().unwrap();
    assert!(number("objective") <= number("upper_bound"));
    let gap = (number("upper_bound") - number("objective")) / number("upper_bound");
    assert!((gap - number("gap")).abs() < 1e-12);
    let dwell: f64 = sessions.iter().map(|it| it["dwell_s"].as_f64().unwrap()).sum();
    assert!((dwell - number("objective")).abs() < 1e-6 * dwell);

    let mut per_day = std::collections::BTreeMap::new();
    let mut busy = std::collections::BTreeMap::<String, i64>::new();
    let mut starts: Vec<i64> = Vec::new();
    for session in sessions {
        let (start, end) =
            (session["start_tai_ns"].as_i64().unwrap(), session["end_tai_ns"].as_i64().unwrap());
        let transits = session["transits"].as_array().unwrap();
        let entry = transits[0]["entry_tai_ns"].as_i64().unwrap();
        let exit = transits.iter().map(|it| it["exit_tai_ns"].as_i64().unwrap()).max().unwrap();
        assert_eq!(entry - start, 600_000_000_000, "setup");
        assert_eq!(end - exit, 300_000_000_000, "cooldown");
        let free = busy.entry(session["telescope"].as_str().unwrap().to_owned()).or_insert(start);
        assert!(*free <= start, "sessions overlap on one telescope");
        *free = end;
        starts.push(start);
        // No leap second is known after 2016: UTC days are 86400 s long.
        let day =
            |ns: i64| (ns - 37_000_000_000 + 43_200_000_000_000).div_euclid(86_400_000_000_000);
        let midnight = day(end) * 86_400_000_000_000 - 43_200_000_000_000 + 37_000_000_000;
        let before = if day(start) < day(end) { midnight - start } else { end - start };
        *per_day.entry(day(start)).or_insert(0) += before;
        *per_day.entry(day(end)).or_insert(0) += end - start - before;
    }
    assert!(per_day.values().all(|ns| *ns <= 240 * 60_000_000_000), "240 minutes per UTC day");
    starts.sort_unstable();
    let within_a_day =
        |i: usize| starts.get(i + 4).is_none_or(|s| s - starts[i] >= 86_400_000_000_000);
    assert!((0..starts.len()).all(within_a_day), "4 sessions in a day");

    // The same sessions go on board, and the table is good.
    let table = path("a").join("uplink.tbl");
    let inspected = json(&["table", "inspect", table.to_str().unwrap(), "--json"]);
    assert_eq!(inspected["sessions"], sessions.len());
    let verified =
        json(&["table", "verify", table.to_str().unwrap(), "--duration", "60d", "--json"]);
    assert_eq!(verified["verdict"], "pass");
}

#[test]
fn the_default_table_takes_at_most_16_kib_and_errs_at_most_1_mas() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("t.tbl");
    let built = json(&["table", "build", "--out", table.to_str().unwrap(), "--json"]);
    assert!(built["ephemeris_bytes"].as_u64().unwrap() <= 16 * 1024, "{built}");
    let verified = json(&["table", "verify", table.to_str().unwrap(), "--json"]);
    for body in verified["bodies"].as_array().unwrap() {
        assert!(body["max_error_mas"].as_f64().unwrap() <= 1.0, "{body}");
        assert!(body["rate_over_bound"].as_f64().unwrap() <= 1.0, "{body}");
    }
    assert_eq!(verified["bodies"].as_array().unwrap().len(), 6);
    let all = "mercury,venus,mars,jupiter,saturn,uranus,neptune,moon,earth,tau_a,cas_a,cen_a";
    let out = table.to_str().unwrap();
    stdout(&["table", "build", "--target", all, "--duration", "400d", "--out", out]);
    let verified = json(&["table", "verify", out, "--duration", "400d", "--json"]);
    assert_eq!(verified["verdict"], "pass", "{verified}");
    assert_eq!(verified["bodies"].as_array().unwrap().len(), 13);
}

#[test]
fn rows_come_as_csv_and_as_json_lines() {
    let arguments = ["transits", "--duration", "40d", "--telescope", "HFT"];
    let csv = rows(&stdout(&arguments));
    let lines = stdout(&[&arguments[..], &["--format", "jsonl"]].concat());
    let lines: Vec<Value> = lines.lines().map(|it| serde_json::from_str(it).unwrap()).collect();
    assert_eq!(csv.len(), lines.len());
    assert!(csv.len() > 100);
    assert!(lines[0]["provenance"]["kernel_sha256"].is_string());
    for (row, line) in csv.iter().zip(&lines) {
        assert_eq!(row["target"], line["target"].as_str().unwrap());
        assert_eq!(row["entry_tai_ns"].parse::<i64>().unwrap(), line["entry_tai_ns"]);
        let psi = |text: &str| text.parse::<f64>().unwrap().to_bits();
        assert_eq!(psi(&row["psi_deg"]), psi(&line["psi_deg"].to_string()));
    }
    let order: Vec<i64> = lines.iter().map(|it| it["entry_tai_ns"].as_i64().unwrap()).collect();
    assert!(order.is_sorted());
}

#[test]
fn every_preset_lists_shows_and_runs() {
    let listed = json(&["missions", "--json"]);
    for preset in listed.as_array().unwrap() {
        let name = preset["preset"].as_str().unwrap();
        let resolved = stdout(&["missions", name, "--resolved"]);
        assert!(resolved.contains("[scan]"), "{resolved}");
        let summary = json(&["transits", "--mission", name, "--duration", "120d", "--json"]);
        assert!(summary["transits"].as_u64().unwrap() > 0, "{name}");
    }
    assert_eq!(listed.as_array().unwrap().len(), 6);
}

#[test]
fn detectors_are_kept_apart_and_twins_agree() {
    let folder = tempfile::tempdir().unwrap();
    let mission = folder.path().join("mission.toml");
    let detector = |name: &str, x: f64| {
        format!(
            "[[telescope.detector]]\nname = \"{name}\"\nquaternion_xyzw = [{x}, 0.0, 0.0, {}]\n",
            (1.0 - x * x).sqrt()
        )
    };
    let text = format!(
        "base = \"litebird\"\n[[telescope]]\nname = \"T\"\nfwhm_arcmin = 20.0\n{}{}{}",
        detector("a", 0.1),
        detector("b", -0.05),
        detector("twin_of_a", 0.1)
    );
    std::fs::write(&mission, text).unwrap();
    let out = folder.path().join("rows.csv");
    let (mission, rows_file) = (mission.to_str().unwrap(), out.to_str().unwrap());
    let summary = json(&[
        "transits",
        "--mission",
        mission,
        "--detector",
        "all",
        "--duration",
        "200d",
        "--json",
        "--out",
        rows_file,
    ]);
    let rows = rows(&std::fs::read_to_string(&out).unwrap());
    assert_eq!(summary["transits"], rows.len());
    let of = |name: &str| rows.iter().filter(|row| row["detector"] == name).collect::<Vec<_>>();
    let edges = |name: &str| -> Vec<String> {
        of(name).iter().map(|row| row["entry_tai_ns"].clone() + &row["exit_tai_ns"]).collect()
    };
    assert!(edges("a").len() > 50);
    assert_eq!(edges("a"), edges("twin_of_a"));
    assert_ne!(edges("a"), edges("b"));
    for name in ["a", "b", "twin_of_a"] {
        let seconds: f64 = of(name).iter().map(|row| row["dwell_s"].parse::<f64>().unwrap()).sum();
        let hours = &summary["integrated_hours"][format!("T/{name}")]["total"];
        assert!((hours.as_f64().unwrap() * 3600.0 - seconds).abs() < 1e-6, "{name}: {hours}");
    }
}

#[test]
fn tables_are_told_apart_and_their_records_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let limits = "calibration.schedule.avoidance=[{ body = \"earth\", angle_deg = 30.0 }]";
    let (old, new) = (path("old.tbl"), path("new.tbl"));
    stdout(&["table", "build", "--duration", "30d", "--out", &old]);
    let build = ["table", "build", "--duration", "40d", "--sequence", "2", "--set", limits];
    stdout(&[&build[..], &["--out", &new]].concat());

    let inspected = json(&["table", "inspect", &new, "--json"]);
    assert_eq!((&inspected["avoidance"], &inspected["sequence"]), (&1.into(), &2.into()));
    let forwards = json(&["table", "diff", &old, &new, "--json"]);
    assert_eq!(forwards["accepted"], true, "{forwards}");
    let bodies = forwards["bodies"].as_array().unwrap();
    let earth = bodies.iter().find(|it| it["name"] == "the Earth").unwrap();
    assert_eq!(earth["in"], "new");
    let sun = bodies.iter().find(|it| it["body"] == 10).unwrap();
    let mas = sun["max_difference_mas"].as_f64().unwrap();
    assert!(mas > 0.0 && mas < 2.0, "two fits to 1 mas differ by at most 2: {mas}");
    let fields: Vec<&str> = forwards["fields"]
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["field"].as_str().unwrap())
        .collect();
    assert_eq!(fields, ["sequence", "validity", "mission SHA-256", "avoidance"]);
    let backwards = json(&["table", "diff", &new, &old, "--json"]);
    assert_eq!(backwards["accepted"], false);
    assert!(backwards["refusal"].as_str().unwrap().contains("--sequence 3"), "{backwards}");
    assert_eq!(json(&["table", "diff", &new, &new, "--json"])["identical"], true);

    let (clock, back) = (path("clock.tbl"), path("rollback.tbl"));
    let at = ["--at", "2032-04-01T00:00:00 TAI", "--valid-for", "7d"];
    let record = ["table", "clock", "--ticks", "5", "--tick-ns", "1e9/65536", "--out", &clock];
    stdout(&[&record[..], &at].concat());
    let told = json(&["table", "inspect", &clock, "--json"]);
    // 1e9/65536 = 15258 + 101/128.
    assert_eq!(told["tick_ns"], "15258 + 14555633995661443072/2^64");
    assert_eq!(told["at_tai_ns"], 1_017_662_400_000_000_000_i64);
    let until = ["--until", "2032-05-01T00:00:00Z", "--out", &back];
    stdout(&[&["table", "rollback", &new, &old][..], &until].concat());
    let told = json(&["table", "inspect", &back, "--json"]);
    assert_eq!((&told["from"], &told["to"]), (&2.into(), &1.into()));
    let set = json(&["table", "inspect", &old, "--json"]);
    assert_eq!(told["to_set_digest"], set["set_digest"]);
}

/// A replanned spacecraft is the same one whatever its file says, but for its name.
#[test]
fn another_spacecraft_s_table_needs_an_order() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (flown, edited, pico) = (path("flown.tbl"), path("edited.tbl"), path("pico.tbl"));
    let build = |more: &[&str], out: &str| {
        stdout(
            &[&["table", "build", "--start", "2032-04-01T00:00:00 TDB"], more, &["--out", out]]
                .concat(),
        );
    };
    build(&["--duration", "10d"], &flown);
    let other = ["--set", "name=\"LiteBIRD replanned\"", "--set", "product.object_name=LITEBIRD"];
    let spin = ["--set", "scan.spin_period_min=21", "--duration", "20d", "--after", "1"];
    build(&[&other[..], &spin].concat(), &edited);
    build(&["--mission", "pico", "--duration", "20d", "--after", "1"], &pico);
    assert_eq!(json(&["table", "diff", &flown, &edited, "--json"])["accepted"], true);
    let refused = json(&["table", "diff", &flown, &pico, "--json"]);
    assert_eq!(refused["accepted"], false);
    let why = refused["refusal"].as_str().unwrap();
    assert!(why.contains("another spacecraft's") && why.contains("table change"), "{why}");
    let order = path("change.tbl");
    let until = ["--until", "2032-04-20T00:00:00Z", "--out", &order];
    stdout(&[&["table", "change", &flown, &pico][..], &until].concat());
    let told = json(&["table", "inspect", &order, "--json"]);
    let of = |file: &str| json(&["table", "inspect", file, "--json"]);
    assert_eq!(told["from_spacecraft"], of(&flown)["spacecraft"]);
    assert_eq!(told["to_spacecraft"], of(&pico)["spacecraft"]);
    assert_eq!((&told["sequence"], &told["set_digest"]), (&2.into(), &of(&pico)["set_digest"]));
}
