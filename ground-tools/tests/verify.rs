//! `vectors` and `verify` as a user runs them: what one verb writes the other takes, a C compiler
//! reads the header, and bad histories are refused with a sentence.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use serde_json::Value;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn gyrfalcon(folder: &Path, arguments: &[&str], input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The command may refuse before it reads.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    child.wait_with_output().unwrap()
}

fn run(folder: &Path, arguments: &[&str], input: &str) -> (i32, String, String) {
    let output = gyrfalcon(folder, arguments, input);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

fn stdout(folder: &Path, arguments: &[&str], input: &str) -> String {
    let (code, out, error) = run(folder, arguments, input);
    assert_eq!(code, 0, "{arguments:?}: {error}");
    out
}

const POINTING: [&str; 5] = ["pointing", "--duration", "3h", "--step", "60"];

/// A row's time and quaternion.
type Attitude = (String, [f64; 4]);

fn attitudes(csv: &str) -> Vec<Attitude> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(csv.as_bytes());
    let header = reader.headers().unwrap().clone();
    let place = |name: &str| header.iter().position(|it| it == name).unwrap();
    let places = ["q_x", "q_y", "q_z", "q_w"].map(place);
    let time = place("time_tdb");
    reader
        .records()
        .map(|row| {
            let row = row.unwrap();
            (row[time].to_owned(), places.map(|at| row[at].parse().unwrap()))
        })
        .collect()
}

/// Ecliptic components to ICRF components, by hand: a turn about x by the obliquity.
fn to_icrf([x, y, z, w]: [f64; 4]) -> [f64; 4] {
    let half = 0.5 * (84_381.448_f64 / 3600.0).to_radians();
    let (sin, cos) = half.sin_cos();
    [cos * x + sin * w, cos * y - sin * z, cos * z + sin * y, cos * w - sin * x]
}

fn kvn(rows: &[Attitude], kind: &str, extra: &str) -> String {
    let (meta, scalar_first) = match kind {
        "1.0" => ("ATTITUDE_DIR = A2B\nQUATERNION_TYPE = FIRST\n", true),
        _ => ("", false),
    };
    let mut text = format!(
        "CCSDS_AEM_VERS = {kind}\nCREATION_DATE = 2032-04-01T00:00:00\nORIGINATOR = TEST\n\n\
         META_START\nCOMMENT made by a test\nOBJECT_NAME = S\nOBJECT_ID = 2032-001A\n\
         REF_FRAME_A = ICRF\nREF_FRAME_B = SC_BODY_1\n{meta}TIME_SYSTEM = TDB\n\
         START_TIME = {}\nSTOP_TIME = {}\nATTITUDE_TYPE = QUATERNION{}\nMETA_STOP\n\nDATA_START\n",
        rows[0].0,
        rows.last().unwrap().0,
        if extra.is_empty() { "" } else { "/ANGVEL" }
    );
    for (time, quaternion) in rows {
        let mut turned = to_icrf(*quaternion);
        if scalar_first {
            turned.rotate_right(1);
        }
        let fields = turned.map(|it| it.to_string()).join(" ");
        writeln!(text, "{time} {fields}{extra}").unwrap();
    }
    text + "DATA_STOP\n"
}

fn xml(rows: &[Attitude]) -> String {
    let mut states = String::new();
    for (time, quaternion) in rows {
        let [x, y, z, w] = to_icrf(*quaternion);
        writeln!(
            states,
            "<attitudeState><quaternionEphemeris><EPOCH>{time}</EPOCH><quaternion><Q1>{x}</Q1>\
             <Q2>{y}</Q2><Q3>{z}</Q3><QC>{w}</QC></quaternion></quaternionEphemeris>\
             </attitudeState>"
        )
        .unwrap();
    }
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<aem id=\"CCSDS_AEM_VERS\" version=\"2.0\">\n\
         <header><CREATION_DATE>2032-04-01T00:00:00</CREATION_DATE><ORIGINATOR>T</ORIGINATOR>\
         </header>\n<body><segment><metadata><OBJECT_NAME>S</OBJECT_NAME>\
         <OBJECT_ID>X</OBJECT_ID><REF_FRAME_A>EME2000</REF_FRAME_A>\
         <REF_FRAME_B>SC_BODY_1</REF_FRAME_B><TIME_SYSTEM>TDB</TIME_SYSTEM>\
         <ATTITUDE_TYPE>QUATERNION</ATTITUDE_TYPE></metadata>\n<data>{states}</data></segment>\
         </body></aem>\n"
    )
}

fn summary(folder: &Path, arguments: &[&str], input: &str) -> Value {
    let all = [&["verify", "--duration", "3h", "--json"], arguments].concat();
    serde_json::from_str(&stdout(folder, &all, input)).unwrap()
}

fn largest(summary: &Value) -> f64 {
    summary["residual_arcsec"]["max"]["total"].as_f64().unwrap()
}

#[test]
fn what_pointing_writes_verifies() {
    let folder = tempfile::tempdir().unwrap();
    let csv = stdout(folder.path(), &POINTING, "");
    let checked = summary(folder.path(), &[], &csv);
    assert_eq!((&checked["verdict"], &checked["rows"]), (&"pass".into(), &181.into()));
    assert!(largest(&checked) < 1e-6, "{checked}");
    assert_eq!(checked["periods_within_tolerance"], true);
    assert_eq!(checked["resonance"]["verdict"], "pass");
    let fitted = checked["resonance"]["precession_period_min"].as_f64().unwrap();
    assert!((fitted - 192.348).abs() < 1e-6, "{fitted}");
    let ratio = checked["fit"]["ratio"].as_f64().unwrap();
    assert!((ratio - 192.348 / 20.0).abs() < 1e-8, "{ratio}");

    let rows = attitudes(&csv);
    for text in
        [kvn(&rows, "2.0", ""), kvn(&rows, "2.0", " 0 0 0"), kvn(&rows, "1.0", ""), xml(&rows)]
    {
        let checked = summary(folder.path(), &[], &text);
        assert_eq!(checked["rows"], 181);
        assert!(largest(&checked) < 1e-6, "{checked}");
    }
    // The conjugate sense, ICRF, and another sensor's frame.
    let mut inverse = String::from("time_tdb,q_x,q_y,q_z,q_w\n");
    for (time, quaternion) in &rows {
        let [x, y, z, w] = to_icrf(*quaternion);
        writeln!(inverse, "{time},{},{},{},{w}", -x, -y, -z).unwrap();
    }
    let checked = summary(folder.path(), &["--inverse", "--frame", "icrf"], &inverse);
    assert!(largest(&checked) < 1e-6, "{checked}");
    let telescope = "[[telescope]]\nname = \"T\"\nfwhm_arcmin = 20.0\n\
                     [[telescope.detector]]\nname = \"d\"\nquaternion_xyzw = [0.1, 0.0, 0.0, \
                     0.99498743710662]\n";
    std::fs::write(folder.path().join("m.toml"), format!("base = \"litebird\"\n{telescope}"))
        .unwrap();
    let detector = ["--mission", "m.toml", "--detector", "d"];
    let csv = stdout(folder.path(), &[&POINTING[..], &detector].concat(), "");
    let checked = summary(folder.path(), &detector, &csv);
    assert!(largest(&checked) < 1e-6, "{checked}");
    let (code, _, error) =
        run(folder.path(), &["verify", "--mission", "m.toml", "--duration", "3h"], &csv);
    assert_eq!(code, 1, "{error}");
}

#[test]
fn an_aem_may_say_the_same_in_other_words() {
    let folder = tempfile::tempdir().unwrap();
    let rows = attitudes(&stdout(folder.path(), &POINTING, ""));
    // A tenth decimal below five changes nothing.
    let finer: Vec<Attitude> = rows
        .iter()
        .map(|(time, quaternion)| (format!("{}4", time.replace("04-01T", "092T")), *quaternion))
        .collect();
    let (good, first) = (kvn(&finer, "2.0", ""), kvn(&finer, "1.0", ""));
    let swap = |text: &str, pairs: &[(&str, &str)]| {
        pairs.iter().fold(text.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        })
    };
    for text in [
        good.clone(),
        swap(&good, &[("FRAME_A = ICRF", "FRAME_A = GCRF")]),
        swap(&good, &[("FRAME_A = ICRF", "FRAME_A = icrf"), ("= TDB", "= tdb")]),
        swap(&good, &[("FRAME_A = ICRF", "FRAME_A = j2000"), ("= QUATERNION", "= quaternion")]),
        swap(&good, &[("FRAME_A = ICRF", "FRAME_A = ICRF3")]),
        swap(&first, &[("= A2B", "= a2b"), ("= FIRST", "= first")]),
        swap(&xml(&finer), &[(">EME2000<", ">gcrf<"), (">TDB<", ">tdb<")]),
        // The names of XML say where the scalar is.
        swap(
            &xml(&finer),
            &[("<TIME_SYSTEM>", "<QUATERNION_TYPE>FIRST</QUATERNION_TYPE><TIME_SYSTEM>")],
        ),
    ] {
        let checked = summary(folder.path(), &[], &text);
        assert_eq!(checked["rows"], 181);
        assert!(largest(&checked) < 1e-6, "{checked}");
    }
    // On UTC, with the letter of its zone.
    let utc: Vec<Attitude> = rows
        .iter()
        .map(|(time, quaternion)| {
            let at = ephem::time::parse_time(&format!("{time} TDB")).unwrap();
            (ephem::time::format_utc(at), *quaternion)
        })
        .collect();
    let text = swap(&kvn(&utc, "2.0", ""), &[("= TDB", "= utc")]);
    assert!(largest(&summary(folder.path(), &[], &text)) < 1e-6);
}

#[test]
fn wrong_attitudes_fail_and_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let csv = stdout(
        folder.path(),
        &["pointing", "--duration", "2d", "--step", "60", "--set", "scan.spin_period_min=20.002"],
        "",
    );
    let arguments = ["verify", "--duration", "2d", "--json"];
    let (code, out, error) = run(folder.path(), &arguments, &csv);
    assert_eq!(code, 1, "{error}");
    let told: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(
        (&told["verdict"], &told["periods_within_tolerance"]),
        (&"fail".into(), &false.into())
    );
    let offset = told["fit"]["spin"]["period_offset_s"].as_f64().unwrap();
    assert!((offset - 0.12).abs() < 1e-6, "{offset}");
    assert!(error.contains("the spin period is off by 0.120000 s"), "{error}");

    // One wrong row among many, and a gap; the residual rows go to a file.
    let csv = stdout(folder.path(), &POINTING, "");
    let mut lines: Vec<String> = csv.lines().map(str::to_owned).collect();
    let first = lines.iter().position(|line| !line.starts_with('#')).unwrap() + 1;
    let mut fields: Vec<String> = lines[first + 70].split(',').map(str::to_owned).collect();
    fields[3] = (fields[3].parse::<f64>().unwrap() + 1e-4).to_string();
    lines[first + 70] = fields.join(",");
    lines.drain(first + 100..first + 120);
    let text = lines.join("\n");
    let arguments = ["verify", "--duration", "3h", "--out", "rows.csv", "--json"];
    let (code, out, error) = run(folder.path(), &arguments, &text);
    assert_eq!(code, 1, "{error}");
    let told: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(told["outliers"].as_array().unwrap().len(), 1, "{told}");
    assert_eq!(told["outliers"][0]["line"], first + 71);
    assert_eq!(told["gaps"][0]["seconds"], 1260.0);
    assert_eq!(told["periods_within_tolerance"], true);
    let rows = std::fs::read_to_string(folder.path().join("rows.csv")).unwrap();
    assert_eq!(rows.lines().filter(|line| line.ends_with(",true")).count(), 1);
    let text_report = run(folder.path(), &["verify", "--duration", "3h"], &text).1;
    for part in ["outlier: line", "gap: 1260 s", "spin period (s)", "verdict: fail"] {
        assert!(text_report.contains(part), "{part}: {text_report}");
    }
    let (code, ..) = run(folder.path(), &["verify", "--duration", "3h", "--against", "fit"], &text);
    assert_eq!(code, 0);
}

#[test]
fn rows_far_apart_are_ambiguous() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--mission", "planck", "--duration", "20d", "--quiet"];
    let csv =
        stdout(folder.path(), &[&["pointing", "--step", "7200"], &arguments[..]].concat(), "");
    let verify = [&["verify"], &arguments[..]].concat();
    let (code, _, error) = run(folder.path(), &verify, &csv);
    assert_eq!(code, 1, "{error}");
    assert!(error.contains("rows 7200 s apart") && error.contains("ambiguous"), "{error}");
    let (code, _, error) = run(folder.path(), &[&verify[..], &["--search", "0.1"]].concat(), &csv);
    assert_eq!(code, 0, "{error}");
}

#[test]
fn bad_histories_are_refused_with_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let head = "elapsed_s,q_x,q_y,q_z,q_w\n";
    let rows = vec![
        ("2032-04-01T00:00:00".to_owned(), [0.0, 0.0, 0.0, 1.0]),
        ("2032-04-01T00:01:00".to_owned(), [0.0, 0.0, 0.6, 0.8]),
    ];
    let good = kvn(&rows, "2.0", "");
    let with = |from: &str, to: &str| good.replace(from, to);
    let cases: Vec<(String, &[&str])> = vec![
        (String::new(), &["empty", "AEM"]),
        (head.to_owned(), &["no attitudes"]),
        ("elapsed_s,q_x,q_y,q_z\n0,0,0,0\n".into(), &["line 1", "no column q_w"]),
        ("t,q_x,q_y,q_z,q_w\n0,0,0,0,1\n".into(), &["line 1", "tai_ns, elapsed_s, time_tdb"]),
        (format!("{head}0,0,0,NaN,1\n"), &["line 2", "q_z is 'NaN'", "finite"]),
        (format!("{head}0,0,0,0,1\n1,0,0,0.5,1\n"), &["line 3", "norm", "1.118", "0.001"]),
        (format!("{head}5,0,0,0,1\n4,0,0,0,1\n"), &["line 3", "'4'", "earlier"]),
        (format!("{head}5,0,0,0,1\n5,0,0,0,1\n"), &["line 3", "'5'", "row before"]),
        (format!("{head}0,0,0,1\n"), &["line 2", "4 fields", "5"]),
        (format!("{head}1e9,0,0,0,1\n"), &["line 2", "outside the mission"]),
        (format!("{head}0,0,0,0,1\n1,0,0,0,1\n"), &["2 times", "3 or more"]),
        (with("TIME_SYSTEM = TDB", "TIME_SYSTEM = GPS"), &["line 11", "GPS", "UTC, TAI, TT, TDB"]),
        (with("REF_FRAME_A = ICRF", "REF_FRAME_A = TOD"), &["line 9", "TOD", "ICRF, EME2000"]),
        (with("ATTITUDE_TYPE = QUATERNION", "ATTITUDE_TYPE = WHEEL"), &["line 14", "SPIN"]),
        (with("ATTITUDE_TYPE = QUATERNION", "ATTITUDE_TYPE = EULER_ANGLE"), &["no EULER_ROT_SEQ"]),
        (with("CCSDS_AEM_VERS = 2.0", "CCSDS_AEM_VERS = 3.0"), &["line 1", "3.0", "1.0, 2.0"]),
        (with("DATA_STOP", ""), &["without DATA_STOP"]),
        (with(" 0 0 0.979", " 0 0.979"), &["an epoch and 4 numbers"]),
        (xml(&rows).replace("<QC>", "<QX>").replace("</QC>", "</QX>"), &["no QC"]),
        (xml(&rows).replace("</aem>", ""), &["not readable as XML"]),
    ];
    for (text, parts) in cases {
        std::fs::write(folder.path().join("h.txt"), &text).unwrap();
        let (code, _, error) = run(folder.path(), &["verify", "h.txt", "--duration", "3h"], "");
        assert_eq!(code, 2, "{text}: {error}");
        assert!(error.starts_with("error: h.txt"), "{error}");
        for part in parts {
            assert!(error.contains(part), "lacks {part:?}: {error}\n{text}");
        }
    }
    for (arguments, part) in [
        (&["verify", "none.csv"][..], "none.csv"),
        (&["verify", "h.txt", "--limit", "1"], "--limit"),
        (&["verify", "h.txt", "--search", "50"], "below 50"),
        (&["vectors", "--step", "0.1"], "fewer are needed"),
        (&["vectors", "--table", "none.tbl"], "none.tbl"),
        (&["pointing", "--at", "0", "--format", "c"], "--format c"),
        (&["vectors", "--count", "2", "--out", "no/such/v.csv"], "no/such"),
    ] {
        let (code, _, error) = run(folder.path(), arguments, "");
        assert_eq!(code, 2, "{arguments:?}: {error}");
        assert!(error.contains(part), "{arguments:?}: {error}");
    }
    std::fs::write(folder.path().join("h.aem"), &good).unwrap();
    let (code, _, error) = run(folder.path(), &["verify", "h.aem", "--frame", "icrf"], "");
    assert_eq!((code, error.contains("--frame is for a CSV")), (2, true), "{error}");
}

#[test]
fn vectors_come_in_three_forms_that_agree() {
    let folder = tempfile::tempdir().unwrap();
    let base = ["vectors", "--duration", "30d", "--count", "50", "--telescope", "HFT"];
    for name in ["v.csv", "v.jsonl", "v.h", "again.h"] {
        stdout(folder.path(), &[&base[..], &["--out", name]].concat(), "");
    }
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(read("v.h"), read("again.h"));
    let drawn =
        |seed: &str| stdout(folder.path(), &[&base[..], &["--seed", seed, "--quiet"]].concat(), "");
    assert_eq!(drawn("1"), drawn("1"));
    assert_ne!(drawn("1"), drawn("2"));

    let lines: Vec<Value> =
        read("v.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let of = |kind: &str| lines.iter().filter(|it| it["kind"] == kind).count();
    assert_eq!(of("vector"), 50);
    let transits = of("transit");
    assert!(transits > 10);
    let count = |name: &str| read(name).lines().filter(|it| !it.starts_with('#')).count() - 1;
    assert_eq!((count("v.csv"), count("v.transits.csv")), (50, transits));
    let text = read("v.csv");
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    for (row, line) in reader.records().zip(&lines) {
        for (name, field) in header.iter().zip(&row.unwrap()) {
            match &line[name] {
                Value::String(text) => assert_eq!(text, field),
                Value::Number(number) if number.is_f64() => {
                    let bits = field.parse::<f64>().unwrap().to_bits();
                    assert_eq!(number.as_f64().unwrap().to_bits(), bits, "{name}");
                }
                other => assert_eq!(other.to_string(), field, "{name}"),
            }
        }
    }
    // What is verified is what is written, and what the onboard table gives.
    let rows = text.replace("elapsed_ns", "elapsed");
    let checked: Value = serde_json::from_str(&stdout(
        folder.path(),
        &["verify", "--duration", "30d", "--telescope", "HFT", "--json", "--search", "0.01"],
        &rows,
    ))
    .unwrap();
    assert!(largest(&checked) < 1e-6, "{checked}");
    stdout(folder.path(), &["table", "build", "--duration", "30d", "--out", "t.tbl"], "");
    stdout(folder.path(), &[&base[..], &["--table", "t.tbl", "--out", "t.csv"]].concat(), "");
    assert!(read("t.csv").contains("# table_sha256: "));
    let (code, _, error) =
        run(folder.path(), &["vectors", "--table", "t.tbl", "--duration", "31d"], "");
    assert_eq!((code, error.contains("another mission")), (2, true), "{error}");
}

#[test]
fn a_c_compiler_reads_the_header_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    if Command::new("cc").arg("--version").output().is_err() {
        return;
    }
    let base = ["vectors", "--duration", "30d", "--count", "20", "--out"];
    stdout(folder.path(), &[&base[..], &["v.h"]].concat(), "");
    stdout(folder.path(), &[&base[..], &["v.jsonl"]].concat(), "");
    let none = ["vectors", "--duration", "1h", "--at", "0", "--target", "uranus", "--out", "e.h"];
    stdout(folder.path(), &none, "");
    let program = r#"
#include "v.h"
#include <inttypes.h>
#include <stdio.h>
int main(void) {
    int i;
    for (i = 0; i < GYRFALCON_VECTOR_COUNT; i++) {
        const gyrfalcon_vector *v = &gyrfalcon_vectors[i];
        printf("%" PRId64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 "\n", v->tai_ns,
               gyrfalcon_bits(v->q[0]), gyrfalcon_bits(v->psi_rad), v->spin_phase);
    }
    for (i = 0; i < GYRFALCON_TRANSIT_COUNT; i++) {
        printf("%" PRId64 " %016" PRIx64 "\n", gyrfalcon_transits[i].entry_tai_ns,
               gyrfalcon_bits(gyrfalcon_transits[i].min_separation_rad));
    }
    return gyrfalcon_lines[0].telescope[0] == '-' ? 0 : 1;
}
"#;
    std::fs::write(folder.path().join("main.c"), program).unwrap();
    std::fs::write(
        folder.path().join("empty.c"),
        "#include \"e.h\"\nint main(void) { return 0; }\n",
    )
    .unwrap();
    for name in ["main", "empty"] {
        let compiled = Command::new("cc")
            .args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-o", name])
            .arg(format!("{name}.c"))
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    }
    let told = Command::new(folder.path().join("main")).output().unwrap();
    assert!(told.status.success());
    let mut expected = String::new();
    for line in std::fs::read_to_string(folder.path().join("v.jsonl")).unwrap().lines() {
        let row: Value = serde_json::from_str(line).unwrap();
        let bits = |key: &str| row[key].as_f64().unwrap().to_bits();
        if row["kind"] == "vector" {
            let spin = row["spin_phase"].as_str().unwrap().trim_start_matches("0x").to_owned();
            let (q, psi) = (bits("q_x"), bits("psi_rad"));
            writeln!(expected, "{} {q:016x} {psi:016x} {spin}", row["tai_ns"]).unwrap();
        } else {
            let separation = bits("min_separation_rad");
            writeln!(expected, "{} {separation:016x}", row["entry_tai_ns"]).unwrap();
        }
    }
    assert_eq!(String::from_utf8(told.stdout).unwrap(), expected);
}
