//! Legal but hostile input, odd targets of output, and signals.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"));
    command.args(arguments).current_dir(folder);
    command
}

fn run(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let output: Output = command(folder, arguments).output().unwrap();
    let code = output.status.code().unwrap_or(-1);
    (code, String::from_utf8_lossy(&output.stderr).into_owned())
}

fn good(folder: &Path, arguments: &[&str]) -> Vec<u8> {
    let output = command(folder, arguments).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    output.stdout
}

fn refused(folder: &Path, arguments: &[&str], parts: &[&str]) {
    let (code, error) = run(folder, arguments);
    assert_eq!(code, 2, "{arguments:?}: {error}");
    for part in parts {
        assert!(error.contains(part), "{arguments:?} lacks {part:?}: {error}");
    }
}

fn data(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    path.to_str().unwrap().to_owned()
}

fn listing(folder: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        entry.unwrap().file_name().to_string_lossy().into_owned()
    };
    let mut names: Vec<String> = std::fs::read_dir(folder).unwrap().map(name).collect();
    names.sort();
    names
}

const VECTORS: [&str; 6] = ["vectors", "--duration", "1d", "--count", "2", "--quiet"];

#[cfg(unix)]
#[test]
fn a_pipe_is_written_to_and_stays_one() {
    use std::os::unix::fs::FileTypeExt;
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("p");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let mut child =
        command(folder.path(), &[&VECTORS[..], &["--out", "p"]].concat()).spawn().unwrap();
    let text = std::fs::read_to_string(&pipe).unwrap();
    assert!(child.wait().unwrap().success());
    assert!(text.starts_with("# mission: LiteBIRD") && text.lines().count() > 10, "{text}");
    assert!(std::fs::metadata(&pipe).unwrap().file_type().is_fifo());
    assert_eq!(listing(folder.path()), ["p"]);
}

#[cfg(unix)]
#[test]
fn a_link_is_followed_a_mode_kept_and_a_read_only_file_refused() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("file.toml"), "old").unwrap();
    std::fs::set_permissions(at("file.toml"), std::fs::Permissions::from_mode(0o600)).unwrap();
    std::fs::hard_link(at("file.toml"), at("other.toml")).unwrap();
    symlink("file.toml", at("link.toml")).unwrap();
    good(folder.path(), &["missions", "pico", "--resolved", "--out", "link.toml"]);
    assert!(std::fs::symlink_metadata(at("link.toml")).unwrap().file_type().is_symlink());
    for name in ["file.toml", "other.toml"] {
        assert!(std::fs::read_to_string(at(name)).unwrap().contains("PICO"), "{name}");
        assert_eq!(std::fs::metadata(at(name)).unwrap().permissions().mode() & 0o777, 0o600);
    }
    std::fs::set_permissions(at("file.toml"), std::fs::Permissions::from_mode(0o444)).unwrap();
    refused(folder.path(), &["missions", "pico", "--out", "file.toml"], &["it is read-only"]);
}

#[cfg(unix)]
#[test]
fn a_signal_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["pointing", "--step", "0.01", "--duration", "3y", "--out", "f.csv"];
    for signal in ["-TERM", "-INT"] {
        let mut child = command(folder.path(), &arguments).spawn().unwrap();
        for _ in 0..600 {
            if !listing(folder.path()).is_empty() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
        assert_eq!(listing(folder.path()).len(), 1);
        Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130));
        assert_eq!(listing(folder.path()), [""; 0], "{signal}");
    }
}

#[cfg(unix)]
#[test]
fn a_limit_on_file_sizes_is_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let script = format!(
        "ulimit -f 8; exec {} pointing --step 0.1 --duration 1d --out f.csv",
        env!("CARGO_BIN_EXE_gyrfalcon")
    );
    let output =
        Command::new("sh").args(["-c", &script]).current_dir(folder.path()).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("cannot write f.csv"), "{error}");
    assert_eq!(listing(folder.path()), [""; 0]);
}

#[cfg(unix)]
#[test]
fn a_path_that_is_no_text_is_told_all_the_same() {
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let name = std::ffi::OsStr::from_bytes(b"\xffv.csv");
    let mut command = command(folder.path(), &[&VECTORS[..], &["--json", "--out"]].concat());
    let output = command.arg(name).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("v.csv"));
}

#[test]
fn every_detector_has_a_file_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let mission = data("abuse/perdetector-collision.toml");
    let survey = ["survey", "--mission", &mission, "--detector", "all", "--per-detector"];
    let short = ["--duration", "100s", "--set", "scan.spin_period_min=1", "--rate", "1"];
    let out = ["--nside", "4", "--quiet", "--out", "m.fits"];
    good(folder.path(), &[&survey[..], &short[..], &out[..]].concat());
    assert_eq!(listing(folder.path()).len(), 7, "{:?}", listing(folder.path()));
}

#[test]
fn names_that_no_table_can_carry_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    refused(folder.path(), &["missions", &data("abuse/hash-name.toml")], &["#T", "begin with #"]);
    for name in ["=1+1", "a\u{202e}b", "@x", ""] {
        let setting = format!("telescope.0.name={name}");
        refused(folder.path(), &["missions", "litebird", "--set", &setting], &["telescope"]);
    }
}

#[test]
fn messages_are_escaped_and_bounded() {
    let folder = tempfile::tempdir().unwrap();
    let (code, error) = run(folder.path(), &["plan", "--set", "scan.alpha_deg=\u{1b}[31mx"]);
    assert_eq!(code, 2);
    assert!(!error.contains('\u{1b}') && error.contains("\\u{1b}[31mx"), "{error}");
    let long = format!("scan.alpha_deg={}", "9".repeat(100_000));
    let (code, error) = run(folder.path(), &["plan", "--set", &long]);
    assert!(code == 2 && error.len() < 1000, "{code} {}", error.len());
    let keys: Vec<String> = (0..2000).map(|key| format!("key{key} = 1\n")).collect();
    let keys = keys.concat();
    std::fs::write(folder.path().join("m.toml"), format!("base = \"pico\"\n{keys}")).unwrap();
    let (code, error) = run(folder.path(), &["missions", "m.toml"]);
    assert!(code == 2 && error.lines().count() == 11, "{error}");
    assert!(error.contains("and 1990 faults more"), "{error}");
}

#[test]
fn what_cannot_be_is_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    refused(here, &["survey", "--duration", "1d", "--rate", "1e20"], &["--rate 1e20", "1e9 Hz"]);
    refused(here, &["pointing", "--format", "aem", "--duration", "1ns"], &["1 ms or more"]);
    refused(here, &["plan", "--duration", "1ns", "--aem-span", "all"], &["1 ms or more"]);
    refused(here, &["table", "build", "--error", "0mas"], &["--error 0mas", "above 0"]);
    refused(here, &["constraints", "--format", "csv"], &["--format"]);
    refused(here, &["pointing", "--at", "0", "--out", "p.dat"], &["--out p.dat", "ending .dat"]);
    refused(here, &["missions", "--set", "span.start=2031-12-31T23:59:60Z", "litebird"], &["leap"]);
    refused(here, &["plan", "--start", "2032-02-30T00:00:00Z"], &["day 30: legal is 1 to 29"]);
    refused(here, &["plan", "--start", "2032-02-28T00:00Z"], &["no seconds"]);
    assert_eq!(listing(here), [""; 0]);
}

#[test]
fn too_many_threads_are_as_many_as_are_of_use() {
    let folder = tempfile::tempdir().unwrap();
    let short = ["survey", "--duration", "1h", "--rate", "1", "--nside", "4"];
    let (code, error) = run(folder.path(), &[&short[..], &["--threads", "100000"]].concat());
    assert!(code == 0 && error.contains("--threads 100000: "), "{error}");
}

#[test]
fn half_a_turn_of_the_plate_is_zero_where_it_begins_anew() {
    use formats::fits::{ColumnChoice, Frames, MapFrame, read_map};
    let folder = tempfile::tempdir().unwrap();
    let day = ["survey", "--telescope", "HFT", "--duration", "1d", "--rate", "19"];
    let map = ["--moment", "0,0.5", "--nside", "64", "--quiet", "--out", "m.fits"];
    good(folder.path(), &[&day[..], &map[..]].concat());
    let column = |name| {
        let frames = Frames { accepted: &[MapFrame::Ecliptic], unsaid: None };
        read_map(&folder.path().join("m.fits"), ColumnChoice::Name(name), frames).unwrap().values
    };
    let (hits, re) = (column("HITS"), column("H_0_0P5_RE"));
    let seen = hits.iter().zip(&re).filter(|it| *it.0 > 0.0);
    let sum: f64 = seen.map(|(hits, re)| hits * re).sum();
    // 1440 times 1140 samples, over each of which cos(phi / 2) adds up to 1.
    assert!((sum - 1440.0).abs() < 0.1, "{sum}");
}

#[test]
fn files_of_two_plans_are_known() {
    let folder = tempfile::tempdir().unwrap();
    let short = ["--duration", "2d", "--mission", "litebird"];
    let plan = |name: &str, more: &[&str]| {
        good(folder.path(), &[&["plan"][..], &short, more, &["--out", name]].concat());
    };
    plan("a", &[]);
    plan("b", &["--sequence", "7"]);
    let at = |path: &str| -> PathBuf { folder.path().join(path) };
    let sums = std::fs::read_to_string(at("a/SHA256SUMS")).unwrap();
    assert!(sums.contains("  uplink.tbl\n") && sums.contains("  timeline.json\n"), "{sums}");
    let report = |name: &str| {
        run(folder.path(), &[&["report", name][..], &short, &["--out", "r.html"]].concat())
    };
    assert_eq!(report("a").0, 0);
    std::fs::copy(at("b/uplink.tbl"), at("a/uplink.tbl")).unwrap();
    let (code, error) = report("a");
    assert!(code == 2 && error.contains("more than one plan"), "{error}");
    // What is left of a plan that was cut short is overwritten without asking.
    std::fs::remove_file(at("a/timeline.json")).unwrap();
    std::fs::write(at("a/.gyrfalcon-abc"), "x").unwrap();
    plan("a", &[]);
    assert_eq!(report("a").0, 0);
    assert!(!listing(&at("a")).iter().any(|it| it.starts_with('.')));
    // A changed timeline is not what the mission gives.
    let json = std::fs::read_to_string(at("a/timeline.json")).unwrap();
    std::fs::remove_file(at("a/SHA256SUMS")).unwrap();
    let start = json.find("\"start_tai_ns\": ").map(|_| json.rfind("\"end_tai_ns\": ").unwrap());
    let end = start.unwrap() + "\"end_tai_ns\": ".len();
    let digits = json[end..].find(|c: char| !c.is_ascii_digit()).unwrap();
    let forged = format!("{}0{}", &json[..end], &json[end + digits..]);
    std::fs::write(at("a/timeline.json"), forged).unwrap();
    let (code, error) = report("a");
    assert!(code == 2 && error.contains("the timeline was changed"), "{code} {error}");
}

#[test]
fn the_files_that_a_mission_names_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let write = |name: &str, text: &str| std::fs::write(here.join(name), text).unwrap();
    let schedule = "base = \"litebird\"\n[calibration.schedule]\n";
    write("m.toml", &format!("{schedule}blackouts = \"b.ics\"\n"));
    refused(here, &["missions", "m.toml"], &["b.ics"]);
    write("b.ics", "BEGIN:VCALENDAR\nBEGIN:VEVENT\nEND:VEVENT\nEND:VCALENDAR\n");
    refused(here, &["missions", "m.toml"], &["b.ics", "no DTSTART"]);
    let data = "data = { rate_bit_s = 1e6, memory_bit = 1e12, contacts = \"c.csv\" }\n";
    write("m.toml", &format!("{schedule}{data}"));
    write("c.csv", "start_utc,end_utc,bit_s\n");
    refused(here, &["missions", "m.toml"], &["c.csv", "memory could never be emptied"]);
    write("c.csv", "start_utc,end_utc,bit_s\n2032-04-01T00:00:00Z,2032-04-01T01:00:00Z,1e6\n");
    good(here, &["missions", "m.toml"]);
}

#[test]
fn results_go_where_they_are_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let printed = good(here, &["constraints", "--quiet"]);
    assert!(String::from_utf8_lossy(&printed).contains("omega_max"), "quiet silences no result");
    for arguments in [&["constraints"][..], &["constraints", "--json"], &["missions", "--json"]] {
        let printed = good(here, arguments);
        assert!(good(here, &[arguments, &["--out", "answer"]].concat()).is_empty());
        assert_eq!(std::fs::read(here.join("answer")).unwrap(), printed, "{arguments:?}");
    }
    good(here, &["pointing", "--at", "0", "--duration", "2w", "--out", "p.parquet"]);
    assert!(std::fs::read(here.join("p.parquet")).unwrap().starts_with(b"PAR1"));
    let names = ["transits", "--duration", "1 days", "--target", "MARS", "--telescope", "hft"];
    good(here, &[&names[..], &["--out", "t.csv"]].concat());
    refused(here, &["transits", "--target", "jupyter"], &["did you mean jupiter?"]);
    refused(here, &["transits", "--telescope", "HFTT"], &["did you mean HFT?"]);
    refused(here, &["transits", "--set", "calibration.targets=marz"], &["did you mean mars?"]);
}

#[test]
fn trajectories_and_histories_of_the_field_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let oem = data("histories/ten_decimals_tdb.oem");
    let at = ["--start", "2032-04-01T01:00:00Z", "--duration", "1h", "--at", "0"];
    good(here, &[&["pointing", "--trajectory", &oem][..], &at].concat());
    let at = ["--start", "2032-04-01T01:00:00.1234567890Z", "--duration", "1h", "--at", "0"];
    good(here, &[&["pointing", "--trajectory", &oem][..], &at].concat());
    let at = ["--start", "2032-092T01:00:00Z", "--duration", "1h", "--at", "0"];
    good(here, &[&["pointing", "--trajectory", &oem][..], &at].concat());
    let metres = std::fs::read_to_string(&oem).unwrap().lines().map(in_metres).collect::<String>();
    std::fs::write(here.join("metres.oem"), metres).unwrap();
    let (code, error) = run(here, &[&["pointing", "--trajectory", "metres.oem"][..], &at].concat());
    assert!(code != 0 || error.contains("au from the Earth"), "{code} {error}");
    for file in ["gcrf.aem", "icrf_lower.aem"] {
        let history = data(&format!("histories/{file}"));
        let span = ["--start", "2032-04-01T00:00:00 TDB", "--duration", "3h"];
        good(here, &[&["verify", &history][..], &span].concat());
    }
}

/// A line of an OEM with its positions a thousand times as large.
fn in_metres(line: &str) -> String {
    let fields: Vec<&str> = line.split_whitespace().collect();
    match fields[..] {
        [epoch, x, y, z, vx, vy, vz] if epoch.starts_with("20") => {
            let [x, y, z] = [x, y, z].map(|it| it.parse::<f64>().unwrap() * 1000.0);
            format!("{epoch} {x} {y} {z} {vx} {vy} {vz}\n")
        }
        _ => format!("{line}\n"),
    }
}

#[test]
fn periods_that_beat_everywhere_take_bounded_work() {
    let folder = tempfile::tempdir().unwrap();
    let periods = |[precession, spin]: [&str; 2]| {
        let precession = format!("--set=scan.precession_period_min={precession}");
        [precession, format!("--set=scan.spin_period_min={spin}")]
    };
    let [precession, spin] = periods(["1e7", "1e6"]);
    let told = &["beat at", "pairs of frequencies"];
    refused(folder.path(), &["resonance", &precession, &spin], told);
    // Judged, but no other periods are sought.
    let [precession, spin] = periods(["1000", "500"]);
    let output =
        command(folder.path(), &["resonance", "--json", &precession, &spin]).output().unwrap();
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(answer["verdict"].is_string() && answer["recommended"].is_null(), "{answer}");
}
