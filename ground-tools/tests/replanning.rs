//! Plans made from earlier plans: what changes, what is frozen, fixed and forbidden, and limits.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// A week of LiteBIRD into a folder, with further options.
fn plan(folder: &Path, options: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .args(["plan", "--quiet", "--set", "span.duration_days=7", "--aem-error-arcsec", "60"])
        .arg("--out")
        .arg(folder)
        .args(options)
        .output()
        .unwrap()
}

/// The timeline of a plan that is made.
fn made(folder: &Path, options: &[&str]) -> Value {
    let output = plan(folder, options);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&std::fs::read(folder.join("timeline.json")).unwrap()).unwrap()
}

/// The error of a plan that ends with an exit code.
fn refused(folder: &Path, code: i32, options: &[&str]) -> String {
    let output = plan(folder, options);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{error}");
    error
}

fn ids(timeline: &Value) -> Vec<String> {
    let sessions = timeline["sessions"].as_array().unwrap();
    sessions.iter().map(|it| it["id"].as_str().unwrap().to_owned()).collect()
}

fn count(value: &Value) -> usize {
    value.as_array().unwrap().len()
}

#[test]
fn a_plan_against_itself_changes_nothing() {
    let place = tempfile::tempdir().unwrap();
    let (first, second) = (place.path().join("first"), place.path().join("second"));
    let before = made(&first, &[]);
    assert!(before.get("against").is_none());
    let after = made(&second, &["--against", first.to_str().unwrap()]);
    assert_eq!(ids(&before), ids(&after));
    assert_eq!(after["against"]["kept"], ids(&before).len());
    assert_eq!(count(&after["against"]["added"]) + count(&after["against"]["dropped"]), 0);
    let page = std::fs::read_to_string(second.join("report.html")).unwrap();
    assert!(page.contains("no session changed"));
    // The page again, byte for byte.
    let again = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .args(["report", "--quiet", "--set", "span.duration_days=7", "--against"])
        .args([&first, &second])
        .output()
        .unwrap();
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
    assert_eq!(String::from_utf8(again.stdout).unwrap(), page);
}

#[test]
fn a_forbidden_session_goes_and_little_else() {
    let place = tempfile::tempdir().unwrap();
    let (first, second) = (place.path().join("first"), place.path().join("second"));
    let before = ids(&made(&first, &[]));
    let gone = before[3].as_str();
    let earlier = first.join("timeline.json");
    let options = ["--against", earlier.to_str().unwrap(), "--forbid", gone];
    let after = made(&second, &options);
    assert!(!ids(&after).iter().any(|it| it == gone));
    assert!(after["against"]["dropped"].as_array().unwrap().iter().any(|it| it == gone));
    // Each further change must bring a tenth of a mean session; none that is free is made.
    assert!(after["against"]["kept"].as_u64().unwrap() + 3 >= before.len() as u64);
    let rejected = after["rejected"].as_array().unwrap();
    let because = rejected.iter().find(|it| it["opportunity"] == gone).unwrap();
    assert_eq!(because["because"], "it is forbidden");
    // A price that nothing reaches leaves all others alone.
    let dear = [&options[..], &["--change-price", "1e9"]].concat();
    let after = made(&second, &dear);
    assert_eq!(count(&after["against"]["added"]), 0);
    assert_eq!(after["against"]["kept"].as_u64().unwrap() + 1, before.len() as u64);
}

#[test]
fn a_fixed_session_stands_and_a_frozen_part_stays() {
    let place = tempfile::tempdir().unwrap();
    let (first, second) = (place.path().join("first"), place.path().join("second"));
    let before = made(&first, &[]);
    let left_out = before["rejected"].as_array().unwrap();
    let wanted = left_out
        .iter()
        .find(|it| it["because"].as_str().unwrap().contains("max_sessions"))
        .unwrap()["opportunity"]
        .as_str()
        .unwrap();
    assert!(ids(&made(&second, &["--fix", wanted])).iter().any(|it| it == wanted));

    // Twice the time per day, but not before the fourth day.
    let earlier = first.to_str().unwrap();
    let until = "2032-04-04T00:00:00Z";
    let more = ["--set", "calibration.schedule.max_minutes_per_day=480"];
    let frozen = ["--against", earlier, "--freeze-until", until];
    let after = made(&second, &[&more[..], &frozen].concat());
    let early = |timeline: &Value| -> Vec<String> {
        let sessions = timeline["sessions"].as_array().unwrap();
        let early = sessions.iter().filter(|it| it["start_utc"].as_str().unwrap() < until);
        early.map(|it| it["id"].as_str().unwrap().to_owned()).collect()
    };
    assert!(!early(&before).is_empty());
    assert_eq!(early(&before), early(&after));
}

#[test]
fn what_contradicts_or_is_not_there_is_told() {
    let place = tempfile::tempdir().unwrap();
    let (first, second) = (place.path().join("first"), place.path().join("second"));
    let before = ids(&made(&first, &[]));
    let earlier = first.to_str().unwrap();
    let (one, twice) = (before[0].as_str(), format!("{0},{0}", before[0]));
    for (code, options, told) in [
        (2, vec!["--fix", one, "--forbid", one], "is both fixed and forbidden"),
        (
            2,
            vec!["--fix", "HFT-mars-1"],
            "--fix HFT-mars-1: the mission offers no such opportunity",
        ),
        (2, vec!["--forbid", &twice], "twice"),
        (2, vec!["--against", "nowhere"], "cannot read nowhere"),
        (2, vec!["--change-price", "3"], "--against"),
        (2, vec!["--against", earlier, "--change-price", "-3"], "from 0 to 1e12"),
        (2, vec!["--against", earlier, "--freeze-until", "2032-04-04"], "--freeze-until"),
        (2, vec!["--time-limit", "5"], "5 has no unit"),
        (2, vec!["--against", earlier, "--mission", "pico"], "this mission is PICO"),
        (
            2,
            vec!["--against", earlier, "--start", "2032-04-02T00:00:00 TDB"],
            "the start, which must be the same",
        ),
        (
            1,
            vec![
                "--against",
                earlier,
                "--freeze-until",
                "2032-04-06T00:00:00Z",
                "--set",
                "calibration.schedule.max_minutes_per_day=60",
            ],
            "calibration.schedule.max_minutes_per_day, the fixed sessions together",
        ),
    ] {
        let error = refused(&second, code, &options);
        assert!(error.contains(told), "{options:?}: {error}");
        assert!(!second.exists(), "{options:?} wrote something");
    }
    // A plan that holds a session twice is none.
    let text = std::fs::read_to_string(first.join("timeline.json")).unwrap();
    let mut timeline: Value = serde_json::from_str(&text).unwrap();
    let again = timeline["sessions"][0].clone();
    timeline["sessions"].as_array_mut().unwrap().push(again);
    let file = place.path().join("twice.json");
    std::fs::write(&file, timeline.to_string()).unwrap();
    let error = refused(&second, 2, &["--against", file.to_str().unwrap()]);
    assert!(error.contains("holds the session") && error.contains("twice"), "{error}");
    std::fs::write(&file, "{}").unwrap();
    let error = refused(&second, 2, &["--against", file.to_str().unwrap()]);
    assert!(error.contains("is no timeline as plan writes it"), "{error}");
}

#[test]
fn a_time_limit_is_told_in_the_output() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("plan");
    let options = ["--set", "span.duration_days=200", "--time-limit", "100ms"];
    let timeline = made(&folder, &options);
    assert_eq!(
        timeline["stopped"],
        "the time limit of 0.1 s was reached: the best schedule so far"
    );
    let number = |key: &str| timeline[key].as_f64().unwrap();
    assert!(number("objective") > 0.0 && number("upper_bound") >= number("objective"));
    // A limit that is not reached leaves no trace.
    let plain = made(&folder, &[]);
    let limited = made(&folder, &["--time-limit", "1h"]);
    assert_eq!(plain, limited);
}
