//! The products of a plan, read by others' parsers and against the command's own attitudes.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use ccsds_ndm::messages::aem::Aem;
use ccsds_ndm::traits::Ndm;
use parquet::basic::{LogicalType, TimeUnit};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

/// On the circular Sun plan and pointing follow the same directions to the last digit.
const MISSION: [&str; 5] = ["--quiet", "--duration", "1d", "--sun", "circular"];
const ARCSEC: f64 = std::f64::consts::PI / 648_000.0;

fn gyrfalcon(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .env_remove("SOURCE_DATE_EPOCH")
        .args(arguments)
        .output()
        .unwrap()
}

fn run(arguments: &[&str]) -> String {
    let output = gyrfalcon(arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

fn plan(folder: &Path, extra: &[&str]) {
    let out = folder.to_str().unwrap();
    run(&[&["plan", "--out", out], &MISSION[..], extra].concat());
}

/// A plan with all products.
struct Plan {
    _scratch: tempfile::TempDir,
    folder: PathBuf,
    timeline: Value,
}

static PLAN: LazyLock<Plan> = LazyLock::new(|| {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().join("plan");
    plan(&folder, &["--also", "all"]);
    let timeline = serde_json::from_slice(&std::fs::read(folder.join("timeline.json")).unwrap());
    Plan { _scratch: scratch, folder, timeline: timeline.unwrap() }
});

impl Plan {
    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.folder.join(name)).unwrap()
    }

    fn text(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }

    fn sessions(&self) -> &[Value] {
        self.timeline["sessions"].as_array().unwrap()
    }

    fn start_ns(&self) -> i64 {
        self.timeline["start_tai_ns"].as_i64().unwrap()
    }
}

/// Rows of a CSV with comment lines.
fn rows(text: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

/// Boresight to ICRF as `pointing` has it, at instants in ns of TAI; `line` names another line of sight.
fn pointing(start_ns: i64, instants: &[i64], line: &[&str]) -> Vec<[f64; 4]> {
    let elapsed = |ns: &i64| {
        let ns = ns - start_ns;
        format!("{}.{:09}", ns / 1_000_000_000, ns % 1_000_000_000)
    };
    let half = (0.5 * 84_381.448 * ARCSEC).sin_cos();
    let mut found = Vec::new();
    for part in instants.chunks(1000) {
        let at = part.iter().map(elapsed).collect::<Vec<_>>().join(",");
        let text = run(&[&["pointing", "--at", &at], &MISSION[..], line].concat());
        found.extend(rows(&text).iter().map(|row| {
            let [x, y, z, w]: [f64; 4] =
                ["q_x", "q_y", "q_z", "q_w"].map(|key| row[key].parse().unwrap());
            let (sin, cos): (f64, f64) = half;
            // R_x(obliquity) takes the ecliptic's components to ICRF's.
            [cos * x + sin * w, cos * y - sin * z, cos * z + sin * y, cos * w - sin * x]
        }));
    }
    found
}

fn dot(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn apart(a: [f64; 4], b: [f64; 4]) -> f64 {
    let sign = dot(a, b).signum();
    let difference: f64 = a.iter().zip(b).map(|(a, b)| (a - sign * b).powi(2)).sum();
    4.0 * (0.5 * difference.sqrt()).asin()
}

fn slerp(a: [f64; 4], b: [f64; 4], part: f64) -> [f64; 4] {
    let half = 0.5 * apart(a, b);
    let (p, q) = ((half * (1.0 - part)).sin() / half.sin(), (half * part).sin() / half.sin());
    std::array::from_fn(|index| p * a[index] + q * b[index])
}

/// The vector of q* p: half the small turn from one attitude to another, in the body.
fn between([x, y, z, w]: [f64; 4], to: [f64; 4]) -> [f64; 3] {
    [
        w * to[0] - x * to[3] - y * to[2] + z * to[1],
        w * to[1] - y * to[3] - z * to[0] + x * to[2],
        w * to[2] - z * to[3] - x * to[1] + y * to[0],
    ]
}

/// ns of TAI of an AEM's UTC, 37 s behind.
fn tai_ns(utc: &str) -> i64 {
    ephem::time::parse_time(&format!("{utc}Z")).unwrap().tai_ns()
}

/// Epoch in ns of TAI, quaternion, rate.
type State = (i64, [f64; 4], [f64; 3]);

/// Every row, by segment.
fn states(aem: &Aem) -> Vec<Vec<State>> {
    let segment = |it: &ccsds_ndm::messages::aem::AemSegment| {
        let states = it.data.attitude_states.iter().map(|state| {
            let state = state.quaternion_ang_vel.as_ref().unwrap();
            let (q, v) = (&state.quaternion, &state.ang_vel);
            let rate = [v.angvel_x.value, v.angvel_y.value, v.angvel_z.value];
            (tai_ns(&state.epoch.to_string()), [q.q1, q.q2, q.q3, q.qc], rate)
        });
        states.collect()
    };
    aem.body.segment.iter().map(segment).collect()
}

#[test]
fn an_aem_in_either_notation_gives_back_the_attitude() {
    let kvn = Aem::from_kvn(&PLAN.text("attitude.aem")).unwrap();
    let xml = Aem::from_xml(&PLAN.text("attitude.xml")).unwrap();
    let segments = states(&kvn);
    assert_eq!(segments, states(&xml));
    for segment in &kvn.body.segment {
        let metadata = &segment.metadata;
        assert_eq!(metadata.ref_frame_a, "ICRF");
        assert_eq!(metadata.ref_frame_b, "SC_BODY_1");
        assert_eq!(metadata.angvel_frame.as_deref(), Some("SC_BODY_1"));
        assert_eq!((&*metadata.object_name, &*metadata.object_id), ("LITEBIRD", "UNKNOWN"));
        assert_eq!(metadata.time_system, "UTC");
    }
    // Every session lies in one segment, padded, and segments do not meet.
    for session in PLAN.sessions() {
        let [start, end] = ["start_tai_ns", "end_tai_ns"].map(|key| session[key].as_i64().unwrap());
        let inside = |it: &&Vec<State>| it[0].0 < start + 1000 && end < it[it.len() - 1].0 + 1000;
        assert_eq!(segments.iter().filter(inside).count(), 1);
    }
    assert!(segments.windows(2).all(|pair| pair[0][pair[0].len() - 1].0 < pair[1][0].0));
    let rows: Vec<_> = segments.iter().flat_map(|it| it.windows(2)).collect();
    // Signs go on from row to row.
    assert!(rows.iter().all(|pair| dot(pair[0].1, pair[1].1) > 0.9));
    let some: Vec<_> = rows.iter().step_by(rows.len().div_ceil(700)).collect();
    let instants: Vec<i64> = some.iter().map(|pair| pair[0].0).collect();
    for (pair, expected) in some.iter().zip(pointing(PLAN.start_ns(), &instants, &[])) {
        assert!(apart(pair[0].1, expected) < 2.1e-10, "{}", apart(pair[0].1, expected));
    }
    let mut worst = 0.0_f64;
    for part in [0.25, 0.5, 0.75] {
        let offset = |pair: &[State]| {
            #[expect(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "s")]
            let ns = ((pair[1].0 - pair[0].0) as f64 * part) as i64;
            ns
        };
        let instants: Vec<i64> = some.iter().map(|pair| pair[0].0 + offset(pair)).collect();
        for (pair, expected) in some.iter().zip(pointing(PLAN.start_ns(), &instants, &[])) {
            worst = worst.max(apart(slerp(pair[0].1, pair[1].1, part), expected));
        }
    }
    let text = PLAN.text("attitude.aem");
    let stated = text.split("errs by at most ").nth(1).unwrap().split(' ').next().unwrap();
    let stated = stated.parse::<f64>().unwrap() * ARCSEC;
    assert!(stated <= ARCSEC && worst <= stated && worst > 0.8 * stated, "{worst} {stated}");
}

#[test]
fn verify_finds_the_mission_in_its_own_aem() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("plan");
    let mission = ["--quiet", "--duration", "1d"];
    let also = ["--also", "aem,aem-xml", "--out", out.to_str().unwrap()];
    run(&[&["plan"], &mission[..], &also].concat());
    for name in ["attitude.aem", "attitude.xml"] {
        let file = out.join(name);
        let arguments = ["verify", file.to_str().unwrap(), "--json", "--limit", "1.5mas"];
        let report: Value =
            serde_json::from_str(&run(&[&arguments[..], &mission].concat())).unwrap();
        assert_eq!(report["verdict"], "pass", "{report}");
    }
}

#[test]
fn the_whole_mission_is_one_segment_at_the_error_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("plan");
    let mission = ["--quiet", "--duration", "3h", "--aem-span", "all", "--aem-error-arcsec", "20"];
    run(&[&["plan", "--out", out.to_str().unwrap()], &mission[..]].concat());
    let text = std::fs::read_to_string(out.join("attitude.aem")).unwrap();
    assert_eq!(text.matches("META_START").count(), 1);
    assert!(text.contains("samples every 18 s of TAI"), "{}", &text[..1500]);
    let rows = states(&Aem::from_kvn(&text).unwrap());
    let (first, last) = (rows[0][0].0, rows[0][rows[0].len() - 1].0);
    assert!((10_800_000_000_000 - (last - first)).abs() < 2000, "{}", last - first);
}

#[test]
fn a_line_of_sight_has_an_aem_of_its_own() {
    let message = |arguments: &[&str]| {
        let text = run(&[&["pointing", "--format", "aem"], &MISSION[..], arguments].concat());
        (Aem::from_kvn(&text).unwrap(), text)
    };
    let folder = tempfile::tempdir().unwrap();
    let mission = folder.path().join("mission.toml");
    // q = (0.1, -0.2, 0.3, sqrt(0.86)).
    let telescope = "base = \"litebird\"\n[[telescope]]\nname = \"side\"\n\
                     fwhm_arcmin = 20.0\n\
                     boresight_quaternion_xyzw = [0.1, -0.2, 0.3, 0.9273618495495703]\n";
    std::fs::write(&mission, telescope).unwrap();
    let side = ["--telescope", "side", "--mission", mission.to_str().unwrap()];
    for (line, frame, arguments, step_ns) in [
        (&[][..], "SC_BODY_1", &["--aem-error-arcsec", "20"][..], 18_000_000_000),
        (&side[..], "INSTRUMENT_1", &["--step", "10.5"][..], 10_500_000_000),
    ] {
        let (aem, text) = message(&[line, arguments].concat());
        let [segment] = &aem.body.segment[..] else { panic!("{}", aem.body.segment.len()) };
        assert_eq!(segment.metadata.ref_frame_b, frame);
        assert_eq!(segment.metadata.angvel_frame.as_deref(), Some(frame));
        assert_eq!(text.contains("the frame of side"), !line.is_empty());
        let states = states(&aem).concat();
        assert!(
            states[1..states.len() - 1].windows(2).all(|pair| pair[1].0 - pair[0].0 == step_ns)
        );
        let some: Vec<_> = states.iter().skip(1).step_by(37).collect();
        let instants: Vec<i64> = some.iter().map(|it| it.0).collect();
        for (state, expected) in some.iter().zip(pointing(PLAN.start_ns(), &instants, line)) {
            assert!(apart(state.1, expected) < 2.1e-10, "{}", apart(state.1, expected));
        }
        // |omega| does not depend on the frame it is told in, the components do: 2 q* q' near enough.
        for pair in states.windows(2).step_by(50) {
            #[expect(clippy::cast_precision_loss, reason = "some seconds")]
            let seconds = (pair[1].0 - pair[0].0) as f64 * 1e-9;
            for (turned, rate) in between(pair[0].1, pair[1].1).iter().zip(pair[0].2) {
                let rate = rate.to_radians();
                assert!((2.0 * turned / seconds - rate).abs() < 3e-5, "{turned} {rate}");
            }
        }
    }
    for (arguments, said) in [
        (&["--format", "aem", "--at", "0"][..], "--at names single instants"),
        (&["--format", "aem", "--step", "0.0005"], "whole milliseconds"),
        (&["--format", "aem", "--step", "4000"], "more than 0.25 rad"),
        (&["--format", "aem", "--stamp", "today"], "--stamp"),
        (&[], "pointing needs instants"),
        (&["--at", "0", "--aem-error-arcsec", "2"], "--format aem is needed"),
    ] {
        let output = gyrfalcon(&[&["pointing"], arguments, &MISSION].concat());
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && error.contains(said), "{arguments:?}: {error}");
        assert!(output.stdout.is_empty());
    }
    let output = gyrfalcon(&[&["transits", "--format", "aem"], &MISSION[..]].concat());
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("a form of pointing alone"), "{error}");
}

#[test]
fn equal_plans_are_equal_bytes_and_stale_products_vanish() {
    let folder = tempfile::tempdir().unwrap();
    let other = folder.path().join("plan");
    plan(&other, &["--also", "ck,stk,ppl,aem,aem-xml,parquet"]);
    let names = |folder: &Path| {
        let mut names: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|it| it.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    let all = names(&PLAN.folder);
    assert_eq!(names(&other), all);
    for name in &all {
        assert_eq!(PLAN.bytes(name), std::fs::read(other.join(name)).unwrap(), "{name}");
    }
    plan(&other, &["--stamp", "2031-05-06T07:08:09Z", "--also", "stk,aem"]);
    let kept = names(&other);
    let always = ["timeline.csv", "timeline.ics", "timeline.json", "uplink.tbl"];
    assert!(always.iter().all(|name| kept.iter().any(|it| it == name)), "{kept:?}");
    assert!(kept.iter().any(|it| it == "attitude.a") && !kept.iter().any(|it| it == "frame.tf"));
    let text = |name: &str| std::fs::read_to_string(other.join(name)).unwrap();
    assert!(text("attitude.aem").contains("CREATION_DATE = 2031-05-06T07:08:09\n"));
    assert!(text("timeline.ics").contains("DTSTAMP:20310506T070809Z\r\n"));
    assert!(PLAN.text("attitude.aem").contains("CREATION_DATE = 2032-03-31T23:58:50.8"));
    // What others put there stays refused.
    std::fs::write(other.join("notes.txt"), "mine").unwrap();
    let output = gyrfalcon(&[&["plan", "--out", other.to_str().unwrap()], &MISSION[..]].concat());
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn the_calendar_has_the_sessions() {
    let text = PLAN.text("timeline.ics");
    assert!(text.split("\r\n").all(|line| line.len() <= 75));
    let events = mission::occasions::read_calendar(&text).unwrap();
    assert_eq!(events.len(), PLAN.sessions().len());
    let unfolded = text.replace("\r\n ", "");
    for (event, session) in events.iter().zip(PLAN.sessions()) {
        let id = session["id"].as_str().unwrap();
        assert_eq!(unfolded.matches(&format!("UID:{id}@litebird.gyrfalcon\r\n")).count(), 1);
        for (at, key, side) in [(event.from, "start_tai_ns", 1), (event.until, "end_tai_ns", -1)] {
            let outward = side * (session[key].as_i64().unwrap() - at.tai_ns());
            assert!((0..1_000_000_000).contains(&outward), "{id}: {outward}");
        }
        let target = session["target"].as_str().unwrap();
        assert_eq!(event.summary, format!("{}: {target}", session["telescope"].as_str().unwrap()));
    }
}

#[test]
fn parquet_has_the_rows_and_types_of_the_csv() {
    let file = std::fs::File::open(PLAN.folder.join("timeline.parquet")).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let metadata = reader.metadata().file_metadata();
    let pairs = metadata.key_value_metadata().unwrap();
    let digest = pairs.iter().find(|it| it.key == "mission_sha256").unwrap();
    assert_eq!(digest.value.as_deref(), PLAN.timeline["mission_sha256"].as_str());
    let columns = metadata.schema_descr().columns();
    let logical = |name: &str| {
        columns.iter().find(|it| it.name() == name).unwrap().logical_type_ref().cloned()
    };
    assert_eq!(logical("start_utc"), Some(LogicalType::timestamp(true, TimeUnit::NANOS)));
    assert_eq!(logical("start_tdb"), Some(LogicalType::timestamp(false, TimeUnit::NANOS)));
    assert_eq!(logical("target"), Some(LogicalType::String));
    let read: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    assert_eq!(read.len(), PLAN.sessions().len());
    for (row, session) in read.iter().zip(PLAN.sessions()) {
        assert_eq!(row.get_string(0).unwrap(), session["id"].as_str().unwrap());
        let start = session["start_tai_ns"].as_i64().unwrap();
        assert_eq!(row.get_long(7).unwrap(), start);
        // UTC is 37 s behind TAI; 2000-01-01T12:00:00 is Unix time 946728000.
        assert_eq!(row.get_long(3).unwrap(), start - 37_000_000_000 + 946_728_000_000_000_000);
        assert!((row.get_double(10).unwrap() - session["dwell_s"].as_f64().unwrap()).abs() < 1e-12);
    }
    // Rows of other verbs, and none at all.
    let folder = tempfile::tempdir().unwrap();
    for (arguments, count) in [
        (&["transits", "--telescope", "HFT"][..], None),
        (&["transits", "--target", "jupiter", "--set", "calibration.radius_deg=1e-9"], Some(0)),
        (&["pointing", "--step", "3600"], Some(25)),
    ] {
        let path = folder.path().join("rows.parquet");
        let out = ["--format", "parquet", "--out", path.to_str().unwrap()];
        run(&[arguments, &MISSION, &out].concat());
        let table = rows_of(&path);
        let text = run(&[arguments, &MISSION[..]].concat());
        assert_eq!(table, rows(&text).len(), "{arguments:?}");
        assert!(count.is_none_or(|count| count == table), "{arguments:?}: {table}");
    }
}

fn rows_of(path: &Path) -> usize {
    let reader = SerializedFileReader::new(std::fs::File::open(path).unwrap()).unwrap();
    reader.get_row_iter(None).unwrap().map(Result::unwrap).count()
}

#[test]
fn pointing_periods_cut_the_mission_without_gaps() {
    let periods = rows(&PLAN.text("pointing-periods.csv"));
    let number = |row: &BTreeMap<String, String>, key: &str| row[key].parse::<i64>().unwrap();
    assert_eq!(number(&periods[0], "start_tai_ns"), PLAN.start_ns());
    let end = number(&periods[periods.len() - 1], "end_tai_ns");
    assert_eq!(end, PLAN.start_ns() + 86_400_000_000_000);
    let joined = |pair: &[BTreeMap<String, String>]| {
        pair[0]["end_tai_ns"] == pair[1]["start_tai_ns"]
            && pair[0]["sessions"] != pair[1]["sessions"]
    };
    assert!(periods.windows(2).all(joined));
    for period in &periods {
        let (from, until) = (number(period, "start_tai_ns"), number(period, "end_tai_ns"));
        let running: Vec<&str> = PLAN
            .sessions()
            .iter()
            .filter(|it| {
                it["start_tai_ns"].as_i64().unwrap() <= from
                    && until <= it["end_tai_ns"].as_i64().unwrap()
            })
            .map(|it| it["id"].as_str().unwrap())
            .collect();
        assert_eq!(period["sessions"], running.join(";"));
        assert_eq!(period["mode"], if running.is_empty() { "survey" } else { "calibration" });
        assert!((period["spin_period_s"].parse::<f64>().unwrap() - 1200.0).abs() < 1e-9);
    }
}

#[test]
fn a_c_kernel_holds_the_samples_of_the_aem() {
    let bytes = PLAN.bytes("attitude.bc");
    assert_eq!(bytes.len() % 1024, 0);
    let whole = |at: usize| i32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let number = |address: usize| {
        f64::from_le_bytes(bytes[8 * (address - 1)..8 * address].try_into().unwrap())
    };
    assert_eq!((&bytes[..8], &bytes[88..96]), (&b"DAF/CK  "[..], &b"LTL-IEEE"[..]));
    let summary = 1024 * (usize::try_from(whole(76)).unwrap() - 1);
    let segment: Vec<i32> = (0..6).map(|index| whole(summary + 40 + 4 * index)).collect();
    assert_eq!(segment[..4], [-999_000, 1, 3, 1]);
    let (begin, finish) =
        (usize::try_from(segment[4]).unwrap(), usize::try_from(segment[5]).unwrap());
    let segments = states(&Aem::from_kvn(&PLAN.text("attitude.aem")).unwrap());
    let rows: Vec<_> = segments.iter().flatten().collect();
    #[expect(clippy::cast_precision_loss, reason = "small")]
    let counts = (segments.len() as f64, rows.len() as f64);
    assert!((number(finish - 1) - counts.0).abs() < 0.5 && (number(finish) - counts.1).abs() < 0.5);
    for (index, (ns, quaternion, _)) in rows.iter().enumerate() {
        let [w, x, y, z] = [0, 1, 2, 3].map(|part| number(begin + 7 * index + part));
        assert!(apart([-x, -y, -z, w], *quaternion) < 2.1e-10);
        #[expect(clippy::cast_precision_loss, reason = "below 2^53")]
        let us = (ns / 1000) as f64;
        assert!((number(begin + 7 * rows.len() + index) - us).abs() < 0.5);
    }
    let directory = (rows.len() - 1) / 100;
    let after = begin + 8 * rows.len();
    for place in 0..directory {
        let epoch = number(begin + 7 * rows.len() + 100 * place + 99);
        assert!((number(after + place) - epoch).abs() < 0.5);
    }
}

#[test]
fn stk_has_the_quaternions_of_the_aem_and_the_sessions() {
    let text = PLAN.text("attitude.a");
    assert!(text.starts_with("stk.v.11.0\n") && text.ends_with("\nEND Attitude\n"));
    let segments = states(&Aem::from_kvn(&PLAN.text("attitude.aem")).unwrap());
    let rows: Vec<_> = segments.iter().flatten().collect();
    assert!(text.contains(&format!("NumberOfAttitudePoints {}\n", rows.len())));
    let data = text.split("AttitudeTimeQuaternions\n\n").nth(1).unwrap();
    let epoch = rows[0].0 / 1_000_000_000 * 1_000_000_000;
    for (line, (ns, quaternion, _)) in data.lines().zip(&rows) {
        let words: Vec<f64> = line.split(' ').map(|it| it.parse().unwrap()).collect();
        #[expect(clippy::cast_precision_loss, reason = "days in ns")]
        let elapsed = (ns - epoch) as f64 * 1e-9;
        assert!((words[0] - elapsed).abs() < 1e-6);
        assert!(quaternion.iter().zip(&words[1..]).all(|(a, b)| (a - b).abs() < 1e-15));
    }
    let intervals = PLAN.text("sessions.int");
    assert_eq!(intervals.matches("\" \"").count(), 2 * PLAN.sessions().len());
    for session in PLAN.sessions() {
        assert!(intervals.contains(&format!(" \"{}\"\n", session["id"].as_str().unwrap())));
    }
}

#[test]
fn what_is_not_legal_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("plan");
    let out = out.to_str().unwrap();
    for (extra, sentence) in [
        (&["--aem-error-arcsec", "0"][..], "an error from 0.001 to 60 arcsec is needed"),
        (&["--aem-error-arcsec", "-1"], "an error from 0.001 to 60 arcsec is needed"),
        (&["--aem-error-arcsec", "nan"], "is not a number"),
        (&["--stamp", "yesterday"], "--stamp: time 'yesterday'"),
        (&["--stamp", "2031-01-01T00:00:00"], "names no time scale"),
        (&["--also", "oem,stk"], "possible values: parquet, aem, aem-xml, ppl, stk, ck, all"),
        (&["--naif-id", "7"], "-2000000"),
        (&["--aem-span", "some"], "possible values: sessions, all"),
        (&["--also", "ck", "--set", "calibration.schedule.max_minutes_per_day=1"], "no session"),
    ] {
        let output = gyrfalcon(&[&["plan", "--out", out], &MISSION[..], extra].concat());
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{extra:?}: {error}");
        assert!(error.contains(sentence), "{extra:?}: {error}");
        assert!(!Path::new(out).exists(), "{extra:?}");
    }
    let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .env("SOURCE_DATE_EPOCH", "soon")
        .args([&["plan", "--out", out], &MISSION[..]].concat())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("SOURCE_DATE_EPOCH is 'soon'"));
}
