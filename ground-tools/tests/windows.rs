//! Windows of a mission: its own clock, its own sessions.
#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};

fn run(folder: &Path, arguments: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"));
    command.args(arguments.split_whitespace()).current_dir(folder).output().unwrap()
}

fn succeeded(folder: &Path, arguments: &str) -> String {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

const fn telescope(mission: &str) -> &str {
    if mission.len() == 6 { "Planck" } else { "HFT" }
}

/// Target and entry of each row, ns of TAI.
fn entries(rows: &str) -> Vec<(String, i64)> {
    let rows: String =
        rows.lines().filter(|it| !it.starts_with('#')).map(|it| it.to_owned() + "\n").collect();
    let mut reader = csv::Reader::from_reader(rows.as_bytes());
    let row = |row: BTreeMap<String, String>| {
        (row["target"].clone(), row["entry_tai_ns"].parse().unwrap())
    };
    reader.deserialize().map(|it| row(it.unwrap())).collect()
}

#[test]
fn a_window_has_the_transits_of_the_whole_mission() {
    let folder = tempfile::tempdir().unwrap();
    for mission in ["litebird", "planck"] {
        let of = |window: &str| {
            entries(&succeeded(
                folder.path(),
                &format!(
                    "transits --mission {mission} --telescope {} --quiet {window}",
                    telescope(mission)
                ),
            ))
        };
        let whole = of("--until +34d");
        let within = of("--from +32d --duration 1d");
        let start = whole[0].1 / 86_400_000_000_000;
        assert!(!within.is_empty() && within.len() < whole.len() && start >= 0);
        // The tables are fitted over other spans: a nanoradian moves an entry by a microsecond.
        for (target, entry) in &within[1..] {
            let same = |it: &&(String, i64)| it.0 == *target && (it.1 - entry).abs() < 1_000_000;
            assert_eq!(whole.iter().filter(same).count(), 1, "{mission} {target} {entry}");
        }
    }
}

#[test]
fn sessions_keep_their_names_in_any_window() {
    let folder = tempfile::tempdir().unwrap();
    for mission in ["litebird", "planck"] {
        let plan = |window: &str, out: &str| -> Value {
            succeeded(
                folder.path(),
                &format!("plan --mission {mission} --quiet --out {out} {window}"),
            );
            let text =
                std::fs::read_to_string(folder.path().join(out).join("timeline.json")).unwrap();
            serde_json::from_str(&text).unwrap()
        };
        let whole = plan("--until +34d", &format!("{mission}-whole"));
        let window = plan("--from +32d --until +1d", &format!("{mission}-window"));
        let offered = |plan: &Value| -> BTreeMap<String, Option<i64>> {
            let sessions = plan["sessions"].as_array().unwrap().iter();
            let start =
                |it: &Value| (it["id"].as_str().unwrap().to_owned(), it["start_tai_ns"].as_i64());
            let rejected = plan["rejected"].as_array().unwrap().iter();
            let id = |it: &Value| (it["opportunity"].as_str().unwrap().to_owned(), None);
            sessions.map(start).chain(rejected.map(id)).collect()
        };
        let (all, some) = (offered(&whole), offered(&window));
        assert!(some.values().any(Option::is_some), "{mission}: {some:?}");
        for (id, start) in &some {
            let known =
                all.get(id).unwrap_or_else(|| panic!("{mission}: {id} is not of the mission"));
            if let (Some(start), Some(known)) = (start, known) {
                assert!((start - known).abs() < 1_000_000, "{id}");
            }
        }
        assert_eq!(whole["provenance"]["start_tai_ns"], window["provenance"]["start_tai_ns"]);
    }
}

#[test]
fn a_windowed_survey_goes_on_where_the_other_ends() {
    let folder = tempfile::tempdir().unwrap();
    let hits = |window: &str| -> f64 {
        let words = format!(
            "survey --telescope HFT --nside 16 --rate 0.5 --moment 2,4 --json --quiet {window}"
        );
        let answer: Value = serde_json::from_str(&succeeded(folder.path(), &words)).unwrap();
        answer["samples"].as_f64().unwrap()
    };
    assert!((hits("--duration 2d") - 86_400.0).abs() < 1.0);
    assert!((hits("--from +1d --duration 1d") - 43_200.0).abs() < 1.0);
}

#[test]
fn a_window_beyond_the_mission_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, sentence) in [
        ("plan --from 2019-01-01", "a window within the mission is needed"),
        ("transits --from +2d --until 2032-04-02", "a window within the mission is needed"),
        ("pointing --from +1d --until +1d --at 5", "lies beyond the mission"),
        ("resonance --from +1d", "judged from the mission's start"),
    ] {
        let output = run(folder.path(), arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains(sentence), "{arguments}: {said}");
    }
}
