//! A mission file's demands on the plan, end to end: kept where they can be, told apart where they
//! contradict each other, refused in a sentence where they cannot be read.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use ephem::time::parse_time;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

const SCHEDULE: &str = "[calibration.schedule]\n";
const SECOND_NS: i64 = 1_000_000_000;

/// A folder with `m.toml`, five days of Jupiter and Neptune with `keys` in their schedule.
fn mission(keys: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "base = \"litebird\"\n[span]\nduration_days = 5.0\n[calibration]\n\
         targets = [\"jupiter\", \"neptune\"]\n{SCHEDULE}{keys}\n"
    );
    std::fs::write(folder.path().join("m.toml"), text).unwrap();
    folder
}

fn put(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).unwrap();
}

/// Plans `m.toml` into `plan`; the exit code and standard error.
fn plan(folder: &Path) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .args(["plan", "--mission", "m.toml", "--out", "plan", "--quiet"])
        .current_dir(folder)
        .output()
        .unwrap();
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

/// The timeline of a plan that must succeed.
fn timeline(folder: &Path) -> Value {
    let (code, error) = plan(folder);
    assert_eq!(code, 0, "{error}");
    serde_json::from_slice(&std::fs::read(folder.join("plan/timeline.json")).unwrap()).unwrap()
}

/// Ends with the exit code and one sentence that has all of `parts`; nothing is written.
fn refused(folder: &Path, code: i32, parts: &[&str]) {
    let before = contents(folder);
    let (found, error) = plan(folder);
    assert_eq!(found, code, "{parts:?}: {error}");
    assert!(error.starts_with("error: ") && !error.contains("panicked"), "{error}");
    for part in parts {
        assert!(error.contains(part), "{part:?} is not in: {error}");
    }
    assert!(contents(folder) == before, "something was written: {error}");
}

/// Every file below a folder, with its bytes.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(contents(&path));
        } else {
            all.push((path.clone(), std::fs::read(&path).unwrap()));
        }
    }
    all.sort();
    all
}

fn ns(utc: &str) -> i64 {
    parse_time(utc).unwrap().tai_ns()
}

/// Reserved intervals of the sessions, in ns of TAI.
fn reserved(timeline: &Value) -> Vec<(i64, i64)> {
    let number = |it: &Value, key: &str| it[key].as_i64().unwrap();
    let sessions = timeline["sessions"].as_array().unwrap();
    sessions.iter().map(|it| (number(it, "start_tai_ns"), number(it, "end_tai_ns"))).collect()
}

fn because(timeline: &Value) -> Vec<&str> {
    let rejected = timeline["rejected"].as_array().unwrap();
    rejected.iter().map(|it| it["because"].as_str().unwrap()).collect()
}

/// Names of constraints that begin with `rule`.
fn constraints<'t>(timeline: &'t Value, rule: &str) -> Vec<&'t Value> {
    let all = timeline["constraints"].as_array().unwrap();
    all.iter().filter(|it| it["name"].as_str().unwrap().starts_with(rule)).collect()
}

const DARK_FROM: &str = "2032-04-02T00:00:00Z";
const DARK_UNTIL: &str = "2032-04-03T12:00:00Z";

#[test]
fn blackouts_from_either_format_are_kept_and_named() {
    let csv = mission("blackouts = \"b.csv\"");
    let rows = format!("start_utc,end_utc,reason\n# a comment\n{DARK_FROM},{DARK_UNTIL},orbit\n");
    put(csv.path(), "b.csv", &rows);
    let ics = mission("blackouts = \"b.ics\"");
    put(
        ics.path(),
        "b.ics",
        "BEGIN:VCALENDAR\r\nVERSION:2.0\r\nPRODID:x\r\nBEGIN:VEVENT\r\nUID:1\r\n\
         DTSTART:20320402T000000Z\r\nDTEND:20320403T120000Z\r\nSUMMARY:orbit\r\nEND:VEVENT\r\n\
         BEGIN:VEVENT\r\nUID:2\r\nSTATUS:CANCELLED\r\nDTSTART:20320404T000000Z\r\n\
         DTEND:20320405T000000Z\r\nSUMMARY:called off\r\nEND:VEVENT\r\nEND:VCALENDAR\r\n",
    );
    let free = timeline(mission("").path());
    let (from, until) = (ns(DARK_FROM), ns(DARK_UNTIL));
    let touching = |timeline: &Value| {
        reserved(timeline).iter().filter(|it| it.0 < until && it.1 > from).count()
    };
    assert!(touching(&free) > 0, "without the blackout there are sessions in it");
    let (csv, ics) = (timeline(csv.path()), timeline(ics.path()));
    for kept in [&csv, &ics] {
        assert_eq!(touching(kept), 0);
        let named = because(kept).into_iter().filter(|it| it.contains("blackout"));
        let named: Vec<_> = named.collect();
        assert!(!named.is_empty());
        let sentence = "it touches the blackout from 2032-04-02T00:00:00.000000000Z to \
                        2032-04-03T12:00:00.000000000Z: orbit";
        assert!(named.iter().all(|it| *it == sentence), "{named:?}");
    }
    assert_eq!(csv["sessions"], ics["sessions"]);
}

#[test]
fn the_memory_never_overflows() {
    let others = "max_sessions = \"none\"\nmax_minutes_per_day = \"none\"\n";
    let data = "data = { rate_bit_s = 20e6, memory_bit = 2e10, contacts = \"c.csv\" }\n";
    let folder = mission(&format!("{others}{data}"));
    let contacts = [
        ("2032-04-02T13:00:00Z", "2032-04-02T17:00:00Z", 4_000_000_i128),
        ("2032-04-04T13:00:00Z", "2032-04-04T17:00:00Z", 2_000_000),
    ];
    let rows = contacts.map(|(a, b, rate)| format!("{a},{b},{rate}\n")).concat();
    put(folder.path(), "c.csv", &format!("start_utc,end_utc,bit_s\n{rows}"));
    let kept = timeline(folder.path());
    let free = timeline(mission(others).path());
    let objective = |it: &Value| it["objective"].as_f64().unwrap();
    assert!(objective(&kept) < objective(&free), "the memory binds");
    assert!(because(&kept).contains(&"the memory would overflow before the next contacts"));
    assert!(!constraints(&kept, "data from ").is_empty());

    // The memory is stepped from event to event, in bits times 10^9.
    let mut produced: Vec<(i64, i64)> = Vec::new();
    for session in kept["sessions"].as_array().unwrap() {
        let transits = session["transits"].as_array().unwrap();
        let times = |key: &'static str| transits.iter().map(move |it| it[key].as_i64().unwrap());
        produced.push((times("entry_tai_ns").min().unwrap(), times("exit_tai_ns").max().unwrap()));
    }
    let sent: Vec<_> = contacts.iter().map(|(a, b, rate)| (ns(a), ns(b), *rate)).collect();
    let mut events: Vec<i64> = produced.iter().flat_map(|it| [it.0, it.1]).collect();
    events.extend(sent.iter().flat_map(|it| [it.0, it.1]));
    events.sort_unstable();
    let (mut held, mut fullest) = (0_i128, 0_i128);
    for pair in events.windows(2) {
        let within = |from: i64, until: i64| from <= pair[0] && pair[1] <= until;
        let recording = produced.iter().filter(|it| within(it.0, it.1)).count();
        let draining: i128 = sent.iter().filter(|it| within(it.0, it.1)).map(|it| it.2).sum();
        let rate = i128::try_from(recording).unwrap() * 20_000_000 - draining;
        held = (held + rate * i128::from(pair[1] - pair[0])).max(0);
        fullest = fullest.max(held);
    }
    let memory = 20_000_000_000 * i128::from(SECOND_NS);
    assert!(fullest <= memory, "{fullest} of {memory}");
    assert!(fullest > memory / 2, "{fullest} of {memory}: the test would show nothing");
}

#[test]
fn contradictions_name_their_keys_and_leave_an_earlier_plan_alone() {
    let folder = mission("");
    timeline(folder.path());
    let path = folder.path().join("m.toml");
    let plain = std::fs::read_to_string(&path).unwrap();
    let few = "min_sessions = { count = 2, days = 5.0 }\n";
    put(
        folder.path(),
        "b.csv",
        "start_utc,end_utc,reason\n2032-03-30T00:00:00Z,2032-04-09T00:00:00Z,dark\n",
    );
    for (keys, other) in [
        ("blackouts = \"b.csv\"\n", "blackouts"),
        ("max_minutes_per_day = 10.0\n", "max_minutes_per_day"),
    ] {
        std::fs::write(&path, format!("{plain}{few}{keys}")).unwrap();
        refused(
            folder.path(),
            1,
            &[
                "no schedule meets calibration.schedule.",
                "calibration.schedule.min_sessions",
                &format!("calibration.schedule.{other}"),
                "of the 2 sessions asked for of ",
                "at most 0 can be had",
                "asking for 2 fewer, or leaving out any one of these rules",
            ],
        );
    }
    // Where nothing was, nothing is.
    std::fs::remove_dir_all(folder.path().join("plan")).unwrap();
    refused(folder.path(), 1, &["calibration.schedule.min_sessions"]);
}

#[test]
fn seasons_gaps_and_logarithms_are_accounted_for() {
    let folder = mission(
        "min_sessions = { count = 1, days = 2.5 }\n\
         longest_gain_gap = { days = 0.25, price_per_day = 5.0 }\n",
    );
    let linear = timeline(folder.path());
    let seasons = constraints(&linear, "min_sessions jupiter on ");
    assert!(!seasons.is_empty());
    for season in &seasons {
        assert!(season["used"].as_f64().unwrap() >= season["limit"].as_f64().unwrap(), "{season}");
    }
    assert!(!constraints(&linear, "longest_gain_gap ").is_empty());

    // Seconds in view are worth less and less: the logarithm takes other sessions.
    let (plain, log) =
        (timeline(mission("").path()), timeline(mission("objective = \"log\"").path()));
    let dwell = |timeline: &Value| -> f64 {
        let sessions = timeline["sessions"].as_array().unwrap();
        sessions.iter().map(|it| it["dwell_s"].as_f64().unwrap()).sum()
    };
    assert!(dwell(&log) <= dwell(&plain) * (1.0 + 1e-9));
    let objective = log["objective"].as_f64().unwrap();
    assert!(objective > 0.0 && objective <= log["upper_bound"].as_f64().unwrap());
    // ln(1 + t / 600 s) of each cell is at most t / 600 s.
    assert!(objective <= dwell(&log) / 600.0 * (1.0 + 1e-9), "{objective}");
}

/// A fortnight of LiteBIRD with one key in its schedule.
fn fortnight(key: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "base = \"litebird\"\n[span]\nstart = \"2032-04-01T00:00:00Z\"\nduration_days = 14\n\
         {SCHEDULE}{key}\n"
    );
    put(folder.path(), "m.toml", &text);
    timeline(folder.path())
}

/// `HiGHS` proves 1039.7015 s.
#[test]
fn a_thermal_window_as_long_as_the_mission_is_solved_to_the_end() {
    let plan = fortnight("thermal = { minutes = 180, window_hours = 336 }");
    let number = |key: &str| plan[key].as_f64().unwrap();
    assert!((number("objective") - 1_039.701_5).abs() < 1e-3, "{}", number("objective"));
    let stopped = plan["stopped"].as_str().unwrap();
    assert!(number("gap") < 1e-9 && stopped.starts_with("optimal"), "{stopped}");
}

/// Nothing but gaps counts at such a price, in the schedule and in its bound.
#[test]
fn gaps_at_any_price_are_bounded_as_they_are_charged() {
    let plan = fortnight("longest_gain_gap = { days = 0.5, price_per_day = 1e6 }");
    let number = |key: &str| plan[key].as_f64().unwrap();
    assert!(number("objective") <= number("upper_bound") && number("objective") < -1e6);
    assert!(number("gap") < 1e-6, "{}", number("gap"));
}

#[test]
fn files_that_cannot_be_used_are_named_with_the_line() {
    let blackouts = "blackouts = \"b.csv\"";
    let data = "data = { rate_bit_s = 1e6, memory_bit = 1e11, contacts = \"c.csv\" }";
    let (dark, ground) = ("start_utc,end_utc,reason\n", "start_utc,end_utc,bit_s\n");
    let cases: [(&str, &str, String, &[&str]); 7] = [
        (
            blackouts,
            "b.csv",
            format!("{dark}2032-04-03T00:00:00Z,2032-04-02T00:00:00Z,back\n"),
            &["b.csv, line 2", "the end 2032-04-02T00:00:00Z does not come after"],
        ),
        (
            blackouts,
            "b.csv",
            format!("{dark}2032-04-02T00:00:00,2032-04-03T00:00:00Z,x\n"),
            &["b.csv, line 2", "start_utc", "2032-04-02T00:00:00", "scale"],
        ),
        (
            blackouts,
            "b.csv",
            "from,to,why\n".to_owned(),
            &["b.csv, line 1", "from, to, why", "start_utc, end_utc, reason is needed"],
        ),
        (blackouts, "other.csv", String::new(), &["cannot read", "b.csv"]),
        (data, "other.csv", String::new(), &["cannot read", "c.csv"]),
        (
            data,
            "c.csv",
            format!("{ground}2032-04-02T00:00:00Z,2032-04-02T04:00:00Z,-8e6\n"),
            &["c.csv, line 2", "bit_s is -8e6", "from 0 to 1e18"],
        ),
        (
            data,
            "c.csv",
            format!("{ground}2032-04-02T00:00:00Z,2032-04-02T04:00:00Z,8 Mbit/s\n"),
            &["c.csv, line 2", "bit_s is 8 Mbit/s", "from 0 to 1e18"],
        ),
    ];
    for (keys, name, text, parts) in cases {
        let folder = mission(keys);
        put(folder.path(), name, &text);
        refused(folder.path(), 2, parts);
    }
}

#[test]
fn values_that_cannot_be_are_named_with_their_key_and_line() {
    // The schedule's first key stands in line 7.
    for (keys, parts) in [
        ("setup_s = -1.0", ["setup_s", "-1.0", "a duration from 0"]),
        ("setup_s = \"10 min\"", ["setup_s", "10 min", "a duration"]),
        ("max_minutes_per_day = 0.0", ["max_minutes_per_day", "0.0", "above 0"]),
        ("max_minutes_per_day = -5", ["max_minutes_per_day", "-5", "above 0"]),
        ("thermal = { minutes = 60.0 }", ["thermal.window_hours", "needed", ""]),
        (
            "thermal = { minutes = -60.0, window_hours = 24.0 }",
            ["thermal.minutes", "-60", "above 0"],
        ),
        (
            "min_sessions = { count = 1.5, days = 3.0 }",
            ["min_sessions.count", "1.5", "whole number"],
        ),
        (
            "min_sessions = { count = 1, weeks = 3.0 }",
            ["unknown key", "min_sessions.weeks", "days"],
        ),
        (
            "longest_gain_gap = { days = 3.0, price_per_day = -1.0 }",
            ["price_per_day", "-1", "price"],
        ),
        ("avoidance = [{ body = \"erth\", angle_deg = 3.0 }]", ["body", "erth", "earth"]),
        ("objective = \"quadratic\"", ["objective", "quadratic", "log"]),
        ("blackout = \"b.csv\"", ["unknown key", "schedule.blackout", "schedule.blackouts"]),
    ] {
        refused(mission(keys).path(), 2, &[&["m.toml, line 7"][..], &parts].concat());
    }
}

#[test]
fn seasons_are_met_where_gaps_cost_more_than_sessions() {
    let folder = tempfile::tempdir().unwrap();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/commissioning");
    for name in ["contacts.csv", "blackouts.ics"] {
        std::fs::copy(example.join(name), folder.path().join(name)).unwrap();
    }
    let text = std::fs::read_to_string(example.join("mission.toml")).unwrap();
    put(folder.path(), "m.toml", &text);
    let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .args(["plan", "--mission", "m.toml", "--out", "plan", "--quiet"])
        .args(["--set", "calibration.schedule.exclusive=telescope"])
        .args(["--set", "calibration.schedule.thermal=none"])
        .args(["--set", "calibration.schedule.data.rate_bit_s=20e6"])
        .args(["--set", "calibration.schedule.data.memory_bit=3e11"])
        .args(["--set", "calibration.schedule.longest_gain_gap.days=5.0"])
        .args(["--set", "calibration.schedule.longest_gain_gap.price_per_day=600"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let bytes = std::fs::read(folder.path().join("plan/timeline.json")).unwrap();
    let timeline: Value = serde_json::from_slice(&bytes).unwrap();
    let seasons = timeline["constraints"].as_array().unwrap().iter();
    let seasons: Vec<&Value> =
        seasons.filter(|it| it["name"].as_str().unwrap().starts_with("min_sessions")).collect();
    assert!(!seasons.is_empty());
    for season in seasons {
        assert!(season["used"].as_f64().unwrap() >= season["limit"].as_f64().unwrap(), "{season}");
    }
}

#[test]
fn a_page_is_refused_where_a_file_of_the_plan_changed() {
    let folder = mission("blackouts = \"b.csv\"");
    let rows = |reason: &str| {
        format!("start_utc,end_utc,reason\n2032-04-02T00:00:00Z,2032-04-02T06:00:00Z,{reason}\n")
    };
    put(folder.path(), "b.csv", &rows("burn"));
    let timeline = timeline(folder.path());
    assert_eq!(timeline["files"][0]["path"], "b.csv");
    let report = || {
        let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
            .args(["report", "plan", "--mission", "m.toml", "--out", "again.html"])
            .current_dir(folder.path())
            .output()
            .unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, error) = report();
    assert_eq!(code, 0, "{error}");
    let page = std::fs::read_to_string(folder.path().join("again.html")).unwrap();
    assert!(page.contains(timeline["files"][0]["sha256"].as_str().unwrap()));
    put(folder.path(), "b.csv", &rows("other"));
    let (code, error) = report();
    assert_eq!(code, 2);
    assert!(error.contains("was planned with the file b.csv of SHA-256"), "{error}");
}
