//! Detectors of a telescope: instrument models of both layouts, grids, and what is wrong with them.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use mission::telescope::{NamedDetector, Telescope};
use mission::{Mission, Override};
use onboard_core::direction::Direction;
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Made for these tests; quaternions to 8 decimals, pairs of L1-040 turned by 90 deg.
const ORIGINAL: &str = include_str!("data/imo_original.json");

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data")
}

fn telescope_text(detectors: &str) -> String {
    format!(
        "base = \"litebird\"\n[[telescope]]\nname = \"T\"\nfwhm_arcmin = 20.0\ndetectors = {detectors}\n"
    )
}

fn load_in(folder: &Path, detectors: &str) -> Result<Mission, String> {
    Mission::from_toml(&telescope_text(detectors), "m.toml", folder, &[]).map_err(|e| e.to_string())
}

fn load(detectors: &str) -> Result<Mission, String> {
    load_in(&data(), detectors)
}

fn fault(detectors: &str) -> String {
    load(detectors).unwrap_err()
}

fn plane(detectors: &str) -> Telescope {
    load(detectors).unwrap().telescopes[0].clone()
}

fn names(telescope: &Telescope) -> Vec<&str> {
    telescope.detectors.iter().map(|it| it.name.as_str()).collect()
}

/// Radial offset, position angle and polarisation angle in degrees, from the axes.
fn mounted(detector: &NamedDetector) -> [f64; 3] {
    let [x, y, z] = detector.rotation.apply(Direction::Z).xyz();
    let (offset, place) = (x.hypot(y).atan2(z), y.atan2(x));
    let [ux, uy, uz] = detector.rotation.apply(Direction::new(1.0, 0.0, 0.0).unwrap()).xyz();
    // The x axis of polarisation angle g lies g - a from the outward direction.
    let outward =
        ux * offset.cos() * place.cos() + uy * offset.cos() * place.sin() - uz * offset.sin();
    let sideward = uy * place.cos() - ux * place.sin();
    [offset, place, sideward.atan2(outward) + place].map(f64::to_degrees)
}

fn near(detector: &NamedDetector, expected: [f64; 3]) {
    for (found, expected) in mounted(detector).into_iter().zip(expected) {
        assert!((found - expected).abs() < 2e-5, "{}: {found} {expected}", detector.name);
    }
}

#[test]
fn the_original_layout_is_read_by_channel_telescope_and_name() {
    let lft = plane("{ file = \"imo_original.json\", channel = \"L1-040\", release = \"v2\" }");
    let expected = ["L00_003_QA_040T", "L00_003_QA_040B", "L00_005_UA_040T", "L00_005_UA_040B"];
    assert_eq!(names(&lft), expected);
    near(&lft.detectors[0], [9.0, 72.5, 0.0]);
    near(&lft.detectors[1], [9.0, 72.5, 90.0]);
    near(&lft.detectors[2], [6.4, 43.0, 45.0]);
    near(&lft.detectors[3], [6.4, 43.0, 135.0]);
    assert_eq!(lft.detectors[3].polarisation_angle_deg.text(), "0");

    let hft = plane("{ file = \"imo_original.json\", telescope = \"HFT\" }");
    assert_eq!(
        names(&hft),
        ["H00_001_Q_119T", "H00_001_Q_119B", "H00_002_U_119T", "H00_002_U_119B"]
    );
    near(&hft.detectors[0], [12.0, -30.0, 0.0]);
    let two = "names = [\"H00_002_U_119B\", \"L00_005_UA_040B\"]";
    let two = plane(&format!("{{ file = \"imo_original.json\", {two} }}"));
    assert_eq!(names(&two), ["L00_005_UA_040B", "H00_002_U_119B"]);
}

#[test]
fn the_reformed_layout_has_polarisation_angles() {
    let mission = load("{ file = \"imo_reformed.json\" }").unwrap();
    let mft = &mission.telescopes[0];
    assert_eq!(names(mft), ["M00_000_100T", "M00_000_100B", "M00_001_100T", "M00_001_100B"]);
    near(&mft.detectors[3], [5.0, 120.0, 0.0]);
    let angle = &mft.detectors[3];
    let expected = std::f64::consts::FRAC_PI_2 + 0.01;
    assert!((angle.polarisation_angle_rad - expected).abs() < 1e-15);
    assert!((angle.polarisation_angle_deg.to_f64() - expected.to_degrees()).abs() < 1e-13);
    assert!(mission.warnings.is_empty());
}

#[test]
fn a_pair_without_an_angle_of_its_own_is_a_warning() {
    let mission = load("{ file = \"imo_original.json\", channel = \"H1-119\" }").unwrap();
    let warnings: Vec<String> = mission.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        warnings,
        [
            "telescope.T.detectors: 2 pairs of detectors, the first H00_001_Q_119T and H00_001_Q_119B, \
          differ in pol but neither in quat nor in pol_angle_rad: both of a pair get the same \
          polarisation angle"
        ]
    );
    let turned = load("{ file = \"imo_original.json\", channel = \"L1-040\", release = \"v2\" }");
    assert!(turned.unwrap().warnings.is_empty());
}

#[test]
fn the_telescopes_own_rotation_comes_after() {
    let text = telescope_text("{ file = \"imo_original.json\", channel = \"H1-119\" }")
        .replace("fwhm", "boresight_quaternion_xyzw = [0, 0, 0.6, 0.8]\nfwhm");
    let mission = Mission::from_toml(&text, "m.toml", &data(), &[]).unwrap();
    let turn = (2.0 * 0.6_f64.asin()).to_degrees();
    near(&mission.telescopes[0].detectors[0], [12.0, turn - 30.0, turn]);
}

#[test]
fn the_resolved_mission_holds_the_file_to_its_contents() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("imo.json");
    fs::write(&file, ORIGINAL).unwrap();
    let source = "{ file = \"imo.json\", names = [\"H00_001_Q_119T\"] }";
    let mission = load_in(folder.path(), source).unwrap();
    let mut hex = String::new();
    for byte in Sha256::digest(ORIGINAL) {
        write!(hex, "{byte:02x}").unwrap();
    }
    let line = format!(
        "detectors = {{ file = \"imo.json\", release = \"none\", channel = \"none\", telescope = \
         \"none\", names = [\"H00_001_Q_119T\"], sha256 = \"{hex}\" }}"
    );
    assert!(mission.resolved_toml().contains(&line), "{}", mission.resolved_toml());
    let again = |text: &str| {
        Mission::from_toml(text, "r.toml", folder.path(), &[]).map_err(|e| e.to_string())
    };
    let same = again(mission.resolved_toml()).unwrap();
    assert_eq!(format!("{same:?}"), format!("{mission:?}"));

    fs::write(&file, ORIGINAL.replace("v2", "v3")).unwrap();
    let sentence = again(mission.resolved_toml()).unwrap_err();
    assert!(
        sentence.contains(&format!("detectors.sha256 = \"{hex}\" is not legal: ")),
        "{sentence}"
    );
    assert!(sentence.ends_with("the SHA-256 of imo.json as it is now, is needed"), "{sentence}");
    assert_ne!(load_in(folder.path(), source).unwrap().digest(), mission.digest());
}

#[test]
fn the_path_counts_from_the_file_that_names_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("shared")).unwrap();
    fs::write(folder.path().join("shared/imo.json"), ORIGINAL).unwrap();
    let base = telescope_text("{ file = \"imo.json\", telescope = \"HFT\" }");
    fs::write(folder.path().join("shared/base.toml"), base).unwrap();
    let mine = folder.path().join("mine.toml");
    fs::write(&mine, "base = \"shared/base.toml\"\n").unwrap();
    let mission = Mission::load(mine.to_str().unwrap(), &[]).unwrap();
    assert_eq!(mission.telescopes[0].detectors.len(), 4);
    let channel = Override::set("telescope.T.detectors.channel=L1-040").unwrap();
    let sentence = Mission::load(mine.to_str().unwrap(), &[channel]).unwrap_err().to_string();
    assert_eq!(
        sentence,
        "shared/base.toml, line 5: telescope.T.detectors.telescope = \"HFT\" is not legal: a \
         telescope of shared/imo.json in channel L1-040 (LFT) is needed"
    );
}

#[test]
fn what_the_model_does_not_have_is_named_with_what_it_has() {
    let of = |rest: &str| fault(&format!("{{ file = \"imo_original.json\", {rest} }}"));
    let line = |sentence: &str| format!("m.toml, line 5: telescope.T.detectors.{sentence}");
    assert_eq!(
        of("channel = \"H1-191\""),
        line(
            "channel = \"H1-191\" is not legal: a channel of imo_original.json (H1-119, L1-040) is \
             needed"
        )
    );
    assert_eq!(
        of("telescope = \"MFT\""),
        line(
            "telescope = \"MFT\" is not legal: a telescope of imo_original.json (HFT, LFT) is needed"
        )
    );
    assert_eq!(
        of("channel = \"H1-119\", names = [\"H00_001_Q_119T\", \"L00_003_QA_040B\"]"),
        line(
            "names = \"L00_003_QA_040B\" is not legal: a detector of imo_original.json in channel \
             H1-119 (H00_001_Q_119B, H00_001_Q_119T, H00_002_U_119B, H00_002_U_119T) is needed"
        )
    );
    for (release, known) in [("v9", "v0, v1, v2"), ("v0", "v0, v1, v2")] {
        assert_eq!(
            of(&format!("release = \"{release}\", channel = \"L1-040\"")),
            line(&format!(
                "release = \"{release}\" is not legal: a release of imo_original.json with \
                 detectors ({known}) is needed"
            ))
        );
    }
    assert_eq!(
        fault("{ file = \"imo_reformed.json\", release = \"v1\" }"),
        line(
            "release = \"v1\" is not legal: a release of imo_reformed.json with detectors, which has \
             none, is needed"
        )
    );
    assert_eq!(
        of("channel = \"L1-040\""),
        "imo_original.json: data_files.11.metadata.name = L00_003_QA_040T is there twice: a name of \
         its own is needed"
    );
}

#[test]
fn keys_that_do_not_belong_together_are_refused() {
    let line = |sentence: &str| format!("m.toml, line 5: {sentence}");
    let key = "telescope.T.detectors";
    assert_eq!(
        fault("{ channel = \"L1-040\" }"),
        line(&format!("{key}.file is missing: a file, or grid_deg, is needed"))
    );
    assert_eq!(
        fault("{ file = \"imo_reformed.json\", grid_deg = 2 }"),
        line(&format!("{key}.file and {key}.grid_deg exclude each other: one of them is needed"))
    );
    assert_eq!(
        fault("{ file = \"imo_reformed.json\", chanel = \"M1-100\" }"),
        line(&format!("unknown key {key}.chanel; did you mean {key}.channel?"))
    );
    for names in ["[]", "[1]", "[\"a\", \"a\"]", "\"a\""] {
        assert_eq!(
            fault(&format!("{{ file = \"imo_reformed.json\", names = {names} }}")),
            line(&format!(
                "{key}.names = {names} is not legal: a list of detectors' names, each once, or \
                 \"none\" is needed"
            ))
        );
    }
    assert_eq!(
        fault("{ file = \"imo_reformed.json\", channel = 40 }"),
        line(&format!("{key}.channel = 40 is not legal: a channel's name or \"none\" is needed"))
    );
    let both = telescope_text("{ file = \"imo_reformed.json\" }")
        + "[[telescope.detector]]\nname = \"d\"\n";
    let sentence = Mission::from_toml(&both, "m.toml", &data(), &[]).unwrap_err().to_string();
    assert_eq!(
        sentence,
        line(
            "telescope.T.detector and telescope.T.detectors exclude each other: one of them is needed"
        )
    );
}

#[test]
fn faulty_files_are_told_with_their_entries() {
    let folder = tempfile::tempdir().unwrap();
    let told = |text: &str| {
        fs::write(folder.path().join("imo.json"), text).unwrap();
        load_in(folder.path(), "{ file = \"imo.json\" }").unwrap_err()
    };
    let absent = load_in(folder.path(), "{ file = \"absent.json\" }").unwrap_err();
    let start = "m.toml, line 5: telescope.T.detectors.file = \"absent.json\" cannot be read: ";
    assert!(absent.starts_with(start), "{absent}");
    assert_eq!(told("not json"), "imo.json: not JSON: expected ident at line 1 column 2");
    let bad = |quat: &str, name: &str| {
        format!(
            "{{\"metadata\": {{\"pixtype\": \"HP1\", \"name\": \"{name}\", \"quat\": {quat}}}}}"
        )
    };
    let list = |entries: &[String]| format!("{{\"data_files\": [{}]}}", entries.join(", "));
    assert_eq!(
        told(&list(&[bad("[0, 0, 0, 1]", "a"), bad("[0, 0, 1, 1]", "b"), bad("[0, 1]", "c")])),
        "imo.json: the norm of b.quat = 1.4142135623730951 is out of range: a unit quaternion x, y, \
         z, w to 1e-6 is needed\n\
         imo.json: c.quat = [0,1] is not legal: a list of 4 numbers x, y, z, w is needed"
    );
    let many: Vec<String> = (0..20).map(|index| bad("null", &format!("d{index}"))).collect();
    let sentences = told(&list(&many));
    assert_eq!(sentences.lines().count(), 9);
    assert!(sentences.ends_with("imo.json: 12 more entries are faulty"), "{sentences}");

    fs::write(folder.path().join("m.toml"), telescope_text("{ file = \"imo.json\" }")).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .args(["missions", folder.path().join("m.toml").to_str().unwrap()])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("imo.json: d0.quat is missing: a list of 4 numbers"), "{error}");
}

#[test]
fn a_grid_covers_the_field_of_view() {
    let grid = |field: &str, spacing: &str| {
        let text = telescope_text(&format!("{{ grid_deg = {spacing} }}")) + field;
        Mission::from_toml(&text, "m.toml", Path::new(""), &[]).map_err(|e| e.to_string())
    };
    let mission = grid("field_of_view = { width_deg = 18.0, height_deg = 8.0 }", "2.0").unwrap();
    let lft = &mission.telescopes[0];
    assert_eq!(lft.detectors.len(), 45);
    assert_eq!((names(lft)[0], names(lft)[44]), ("g000", "g044"));
    near(&lft.detectors[22], [0.0, 0.0, 0.0]);
    // The next is 2 deg along y, the width.
    near(&lft.detectors[23], [2.0, 90.0, 0.0]);
    near(&lft.detectors[31], [2.0, 0.0, 0.0]);
    assert!(mission.warnings.is_empty());
    let again = Mission::from_toml(mission.resolved_toml(), "r", Path::new(""), &[]).unwrap();
    assert_eq!(format!("{again:?}"), format!("{mission:?}"));
    let many = grid("field_of_view = { radius_deg = 14 }", "0.5").unwrap();
    assert_eq!(names(&many.telescopes[0])[7], "g0007");

    assert_eq!(
        grid("", "2").unwrap_err(),
        "m.toml, line 5: telescope.T.field_of_view is missing: the circle or rectangle that \
         detectors.grid_deg is to cover is needed"
    );
    assert_eq!(
        grid("field_of_view = { radius_deg = 14 }", "0.1").unwrap_err(),
        "m.toml, line 5: telescope.T.detectors.grid_deg = 0.1 is out of range: a spacing of at most \
         10000 detectors, not about 61575 is needed"
    );
    assert_eq!(
        grid("field_of_view = { radius_deg = 14 }", "-1").unwrap_err(),
        "m.toml, line 5: telescope.T.detectors.grid_deg = -1 is out of range: an angle above 0 and \
         at most 180 deg is needed"
    );
    assert_eq!(
        fault("{ grid_deg = 1, channel = \"L1-040\" }").lines().next().unwrap(),
        "m.toml, line 5: telescope.T.detectors.grid_deg and telescope.T.detectors.channel exclude \
         each other: one of them is needed"
    );
}

#[test]
fn verbs_see_the_detectors() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("imo.json"), ORIGINAL).unwrap();
    let text = telescope_text("{ file = \"imo.json\", telescope = \"HFT\" }");
    let mission = folder.path().join("m.toml");
    fs::write(&mission, text).unwrap();
    let run = |verb: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
            .args(verb)
            .args(["--mission", mission.to_str().unwrap(), "--duration", "20d", "--quiet"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let summary: serde_json::Value =
        serde_json::from_str(&run(&["transits", "--detector", "all", "--json"])).unwrap();
    let hours = |name: &str| summary["integrated_hours"][format!("T/{name}")]["total"].as_f64();
    assert!(hours("H00_001_Q_119T").unwrap() > 0.0);
    assert_eq!(hours("H00_001_Q_119T"), hours("H00_001_Q_119B"));
    let rows = run(&["pointing", "--detector", "T/H00_002_U_119T", "--at", "0"]);
    let bore = run(&["pointing", "--at", "0"]);
    let psi = |text: &str| -> f64 {
        let rows: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
        let column = rows[0].split(',').position(|key| key == "psi_deg").unwrap();
        rows[1].split(',').nth(column).unwrap().parse().unwrap()
    };
    let turned = (psi(&rows) - psi(&bore)).rem_euclid(360.0);
    assert!((turned - 45.0).abs() < 1e-5, "{turned}");
    let out = folder.path().join("plan");
    run(&["plan", "--out", out.to_str().unwrap()]);
    let table = ground_table(&out.join("uplink.tbl"));
    assert_eq!(table, 4);
}

/// The number of detectors in an uplink table.
fn ground_table(path: &Path) -> u64 {
    let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
        .args(["table", "inspect", path.to_str().unwrap(), "--json"])
        .output()
        .unwrap();
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    told["detectors"].as_u64().unwrap()
}

#[test]
fn many_detectors_on_board_are_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let mission = folder.path().join("m.toml");
    let out = folder.path().join("uplink.tbl");
    let build = |spacing: &str| {
        let text = telescope_text(&format!("{{ grid_deg = {spacing} }}"));
        fs::write(&mission, text + "field_of_view = { radius_deg = 14 }\n").unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
            .args(["table", "build", "--mission", mission.to_str().unwrap()])
            .args(["--duration", "5d", "--out", out.to_str().unwrap()])
            .output()
            .unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{error}");
        (error, ground_table(&out))
    };
    assert_eq!(build("2"), (String::new(), 149));
    let (warning, detectors) = build("1");
    assert_eq!(detectors, 613);
    let start = "warning: telescope T has 613 detectors, all of which go on board: the sequencer's \
                 check of one of its sessions takes at least 1226 ticks";
    assert!(warning.starts_with(start), "{warning}");
}
