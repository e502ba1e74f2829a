//! Mission files as users write them: bases, overrides, every key, every fault with its sentence.

use mission::calibration::SourceDirection;
use mission::number::Number;
use mission::orbit::{Observer, Sun, Trajectory};
use mission::schedule::Weight;
use mission::sessions::Sessions;
use mission::{Mission, Override};
use onboard_core::direction::Direction;
use onboard_core::phase::Phase;
use onboard_core::time::{Duration, Instant};
use std::fs;
use std::path::Path;

/// The text of a weight that is a number.
fn plain(weight: &Weight) -> &str {
    let Weight::Plain(number) = weight else { panic!("{weight:?} has purposes") };
    number.text()
}

/// A mission file with every key of the format.
const EVERY_KEY: &str = include_str!("data/every_key.toml");
/// A small mission of its own.
const SMALL: &str = r#"
name = "small"
[span]
start = 2032-04-01T00:00:00Z
duration_days = 10
[scan]
alpha_deg = 45.0
beta_deg = 50.0
precession_period_min = 192.348
spin_period_min = 20.0
"#;

fn read(text: &str) -> Result<Mission, String> {
    Mission::from_toml(text, "mission.toml", Path::new(""), &[]).map_err(|e| e.to_string())
}

/// The sentence for a text over litebird.
fn fault(text: &str) -> String {
    read(&format!("base = \"litebird\"\n{text}")).expect_err("a fault")
}

fn set(mission: &str, changes: &[&str]) -> Result<Mission, String> {
    let changes: Result<Vec<Override>, _> =
        changes.iter().map(|text| Override::set(text)).collect();
    changes.and_then(|changes| Mission::load(mission, &changes)).map_err(|e| e.to_string())
}

fn set_fault(change: &str) -> String {
    set("litebird", &[change]).expect_err("a fault")
}

#[test]
fn a_small_file_gets_the_defaults() {
    let mission = read(SMALL).unwrap();
    assert_eq!(mission.span.start.text(), "2032-04-01T00:00:00Z");
    assert_eq!(mission.span.duration, Duration::from_ns(864_000_000_000_000));
    assert_eq!(mission.scan.sampling_rate_hz.text(), "19.0");
    assert_eq!(mission.orbit.sun, Sun::Ephemeris);
    assert_eq!(mission.orbit.trajectory, Trajectory::L2);
    assert!(mission.orbit.aberration && mission.telescopes.is_empty());
    assert_eq!(mission.calibration.targets, ["mars", "jupiter", "saturn", "uranus", "neptune"]);
    assert_eq!(mission.calibration.schedule.max_minutes_per_day, None);
    assert_eq!(mission.product.object_name, "small");
}

#[test]
fn a_mission_scans_with_the_exact_rates() {
    let mission =
        set("litebird", &["scan.spin_sign=-1", "scan.spin_phase_deg=180", "scan.alpha_deg=47.5"])
            .unwrap();
    let start = Instant::from_tai_ns(1_017_921_637_000_000_000);
    let strategy = mission.scan_strategy(start).unwrap();
    let parameters = strategy.parameters();
    // Integers computed apart: 2^128 / (192.348 min in ns), 2^128 / (20 min in ns).
    assert_eq!(parameters.precession.rate.bits(), 29_484_958_419_196_669_878_152_672);
    assert_eq!(parameters.spin.rate.reversed().bits(), 283_568_639_100_782_052_886_145_506);
    assert_eq!(parameters.spin.start, Phase::from_bits(1 << 63));
    assert_eq!(parameters.alpha_rad.to_bits(), 0x3fea_876c_d8f2_a161);
    assert_eq!(parameters.start, start);
}

#[test]
fn the_circular_sun_turns_once_in_a_julian_year() {
    let real = Phase::from_bits(77);
    assert_eq!(set("litebird", &[]).unwrap().orbit.circular_sun(real), None);
    let bare = set("litebird", &["orbit.sun=circular"]).unwrap();
    assert_eq!(bare.orbit.circular_sun(real).unwrap().start, real);
    let given =
        set("pico", &["orbit.sun=circular", "orbit.start_longitude_deg=191.37579428901796"])
            .unwrap();
    let rotor = given.orbit.circular_sun(real).unwrap();
    assert_eq!(rotor.start.bits(), 9_806_278_608_756_667_519);
    let year = rotor.rate.after(Duration::from_ns(31_557_600_000_000_000));
    assert!(year.radians().abs() < 1e-18, "{year:?}");
}

#[test]
fn a_mission_file_has_every_key() {
    let mission = Mission::from_toml(EVERY_KEY, "m.toml", Path::new("some/where"), &[]).unwrap();
    assert_eq!(mission.orbit.observer, Observer::Sun);
    let Trajectory::File(file) = &mission.orbit.trajectory else { panic!() };
    assert_eq!(mission.path(file), Path::new("some/where/orbits/l2.oem"));
    let SourceDirection::Table(file) = &mission.calibration.sources[2].direction else { panic!() };
    assert_eq!(mission.path(file), Path::new("some/where/horizons.csv"));

    let hft = &mission.telescopes[0];
    assert_eq!(hft.hwp.unwrap().start, Phase::from_bits(1 << 62));
    assert!(hft.hwp.unwrap().rate.is_negative());
    // About y by 2 asin 0.6: z goes to (sin, 0, cos) of 73.74 deg; the detector only turns about z.
    let [x, y, z] = hft.detectors[0].rotation.apply(Direction::Z).xyz();
    assert!((x - 0.96).abs() < 1e-15 && y.abs() < 1e-15 && (z - 0.28).abs() < 1e-15);
    let [x, y, z] = hft.detectors[0].rotation.apply(Direction::new(1.0, 0.0, 0.0).unwrap()).xyz();
    // Detector x is (0.28, 0.96, 0) in the telescope, then about y.
    assert!((x - 0.28 * 0.28).abs() < 1e-15 && (y - 0.96).abs() < 1e-15);
    assert!((z + 0.28 * 0.96).abs() < 1e-15);

    let Sessions::ByPause { gap, longest, .. } = mission.sessions() else { panic!() };
    assert_eq!([gap, longest], [3600.0, 14_400.0].map(Duration::from_seconds));

    let text = |number: &Option<Number>| number.as_ref().map(|it| it.text().to_owned());
    let (own, other) = (&hft.detectors[0].receiver, &hft.detectors[1].receiver);
    assert_eq!(
        [text(&own.net_uk_rts), text(&other.net_uk_rts)],
        [Some("80".into()), Some("385.69".into())]
    );
    assert_eq!(
        [text(&own.fwhm_arcmin), text(&other.fwhm_arcmin)],
        [Some("28.6".into()), Some("17.9".into())]
    );
    assert_eq!(text(&own.time_constant_ms), Some("3.5".into()));
    let level = &mission.calibration.requirements[1];
    assert!((level.sigma() - 1e-3).abs() < 1e-18);
    assert!(level.concerns("HFT", None, Some("d1")) && !level.concerns("HFT", None, Some("d2")));

    let lft = &mission.telescopes[1];
    assert_eq!(lft.detector_grid_deg.as_ref().unwrap().text(), "2.0");
    assert_eq!(lft.detectors.len(), 13);

    let schedule = &mission.calibration.schedule;
    assert_eq!(schedule.max_per_day(), Some(Duration::from_ns(172_800_000_000_000)));
    assert_eq!(schedule.setup(), Duration::from_ns(1_000_000_000));
    assert_eq!(schedule.min_sessions.as_ref().unwrap().window().ns(), 7_889_400_000_000_000);
    let weights: Vec<_> =
        schedule.weights.iter().map(|(name, weight)| (name.as_str(), plain(weight))).collect();
    assert_eq!(
        weights,
        [
            ("moon", "0.5"),
            ("tau_a", "1.0"),
            ("my_source", "1.0"),
            ("moving", "1.0"),
            ("jupiter", "0")
        ]
    );
    assert!(schedule.weight("moon") < 0.6 && schedule.weight("tau_a") > 0.9);

    let warnings: Vec<String> = mission.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings, Vec::<String>::new());

    let again =
        Mission::from_toml(mission.resolved_toml(), "r", Path::new("some/where"), &[]).unwrap();
    assert_eq!(format!("{again:?}"), format!("{mission:?}"));
}

#[test]
fn an_override_is_typed_like_the_file() {
    let hft = |changes: &[&str]| set("litebird", changes).unwrap().telescopes[2].clone();
    assert_eq!(hft(&["telescope.HFT.fwhm_arcmin=20"]).fwhm_arcmin.text(), "20");
    assert_eq!(hft(&["telescope.2.hwp_rate_rpm = 61.50"]).hwp_rate_rpm.unwrap().text(), "61.50");
    assert!(hft(&["telescope.HFT.hwp_rate_rpm=none"]).hwp.is_none());
    assert!(hft(&["telescope.HFT.field_of_view=none"]).field_of_view.is_none());
    let reach = hft(&["telescope.HFT.field_of_view.radius_deg=3"]).field_of_view.unwrap();
    assert!((reach.reach_rad() - 3.0_f64.to_radians()).abs() < 1e-15);
    for targets in
        ["[\"mars\", \"tau_a\"]", "mars,tau_a", "mars, tau_a", "[mars,tau_a]", "['mars','tau_a']"]
    {
        let mission = set("litebird", &[&format!("calibration.targets={targets}")]).unwrap();
        assert_eq!(mission.calibration.targets, ["mars", "tau_a"], "{targets}");
    }
    let one = set("litebird", &["calibration.targets=mars"]).unwrap();
    assert_eq!(one.calibration.targets, ["mars"]);
    for start in ["2033-01-01T00:00:00 TDB", "\"2033-01-01T00:00:00 TDB\"", "2033-01-01T00:00:00Z"]
    {
        let mission = set("litebird", &[&format!("span.start={start}")]).unwrap();
        assert_eq!(mission.span.start.year, 2033);
    }
    let rate = set("litebird", &["scan.sampling_rate_hz=20e6/1048576"]).unwrap();
    assert_eq!(rate.scan.sampling_rate_hz.text(), "20e6/1048576");
    let schedule = set(
        "litebird",
        &[
            "calibration.schedule.max_minutes_per_day=none",
            "calibration.schedule.max_sessions.count=7",
            "calibration.schedule.weights.mars=.5",
            "orbit.aberration=false",
            "name=2032",
        ],
    )
    .unwrap();
    assert_eq!(schedule.calibration.schedule.max_minutes_per_day, None);
    assert_eq!(schedule.calibration.schedule.max_sessions.as_ref().unwrap().count, 7);
    assert_eq!(
        schedule.calibration.schedule.weights[0].1.clone(),
        Weight::Plain(Number::parse(".5").unwrap())
    );
    assert_eq!((schedule.orbit.aberration, schedule.name.as_str()), (false, "2032"));
    let last = set("litebird", &["scan.alpha_deg=40", "scan.alpha_deg=50"]).unwrap();
    assert_eq!(last.scan.alpha_deg.text(), "50");
}

#[test]
fn a_base_gives_what_the_file_leaves_out() {
    let mission = read(
        "base = \"litebird\"\nname = \"mine\"\n[scan]\nalpha_deg = 47.50\n\
         [calibration.schedule]\nmax_sessions = { count = 9 }\n\
         [[telescope]]\nname = \"X\"\nfwhm_arcmin = 5\n",
    )
    .unwrap();
    assert_eq!(mission.name, "mine");
    assert_eq!((mission.scan.alpha_deg.text(), mission.scan.beta_deg.text()), ("47.50", "50.0"));
    let sessions = mission.calibration.schedule.max_sessions.as_ref().unwrap();
    assert_eq!((sessions.count, sessions.days.text()), (9, "1.0"));
    assert_eq!(mission.telescopes.len(), 1);
    assert!(!mission.resolved_toml().contains("base"));
}

#[test]
fn files_have_bases_in_other_folders() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("shared/deep")).unwrap();
    fs::write(
        at("shared/base.toml"),
        "base = \"deep/deeper.toml\"\n[orbit]\ntrajectory = \"l2.oem\"\n",
    )
    .unwrap();
    fs::write(
        at("shared/deep/deeper.toml"),
        "base = \"pico\"\n[calibration.schedule]\nblackouts = \"out.csv\"\n",
    )
    .unwrap();
    fs::write(at("mine.toml"), "base = \"shared/base.toml\"\nname = \"mine\"\n").unwrap();
    let path = at("mine.toml");
    let mission = set(path.to_str().unwrap(), &[]).unwrap();
    let Trajectory::File(file) = &mission.orbit.trajectory else { panic!() };
    assert_eq!(file.text(), "shared/l2.oem");
    assert_eq!(mission.path(file), at("shared/l2.oem"));
    let blackouts = mission.calibration.schedule.blackouts.as_ref().unwrap();
    assert_eq!(mission.path(blackouts), at("shared/deep/out.csv"));
    assert_eq!(mission.telescopes[0].name, "PICO");

    fs::write(at("shared/base.toml"), "base = \"../mine.toml\"\n").unwrap();
    let sentence = set(path.to_str().unwrap(), &[]).unwrap_err();
    assert!(sentence.ends_with("leads back to a file already read"), "{sentence}");
    fs::write(at("shared/base.toml"), "base = \"absent.toml\"\n").unwrap();
    assert_eq!(
        set(path.to_str().unwrap(), &[]).unwrap_err(),
        "shared/base.toml, line 1: absent.toml is neither a preset (litebird, pico, planck, wmap, \
         epic, core) nor a file"
    );
    fs::write(at("shared/base.toml"), "base = \"pico\"\n[scan]\nalpha_deg = 200\n").unwrap();
    assert_eq!(
        set(path.to_str().unwrap(), &[]).unwrap_err(),
        "shared/base.toml, line 3: scan.alpha_deg = 200 is out of range: an angle from 0 to 180 deg \
         is needed"
    );
    fs::write(at("mine.toml"), [0xff, 0xfe, b'a']).unwrap();
    assert!(set(path.to_str().unwrap(), &[]).unwrap_err().ends_with("it is not UTF-8 text"));
    assert!(set(folder.path().to_str().unwrap(), &[]).unwrap_err().contains("cannot read it"));
    assert_eq!(
        set("litebrid", &[]).unwrap_err(),
        "--mission: litebrid is neither a preset (litebird, pico, planck, wmap, epic, core) nor a file"
    );
}

#[test]
fn angles_out_of_range_are_errors() {
    assert_eq!(
        fault("[scan]\nalpha_deg = 181\n"),
        "mission.toml, line 3: scan.alpha_deg = 181 is out of range: an angle from 0 to 180 deg is \
         needed"
    );
    assert_eq!(
        fault("[scan]\nbeta_deg = -0.5\n"),
        "mission.toml, line 3: scan.beta_deg = -0.5 is out of range: an angle from 0 to 180 deg is \
         needed"
    );
    assert_eq!(
        fault("[scan]\nbeta_deg = 135.0000000000000000001\n"),
        "mission.toml, line 3: scan.alpha_deg + scan.beta_deg = 180.0000000000000000001 is out of \
         range: a sum from 0 to 180 deg is needed"
    );
    assert!(read(&format!("{SMALL}\n[orbit]\n").replace("45.0", "130")).is_ok());
    assert_eq!(
        set_fault("scan.alpha_deg=nan"),
        "--set: scan.alpha_deg = nan is out of range: an angle from 0 to 180 deg is needed"
    );
    assert_eq!(
        set_fault("scan.alpha_deg=45deg"),
        "--set: scan.alpha_deg = 45deg is not legal: an angle from 0 to 180 deg is needed"
    );
    assert_eq!(
        set_fault("scan.alpha_deg="),
        "--set: scan.alpha_deg =  is not legal: an angle from 0 to 180 deg is needed"
    );
}

#[test]
fn periods_must_be_positive_and_finite() {
    let need = "a period from 1e-6 to 1e12 min";
    for (value, hint) in [
        ("nan", ""),
        ("inf", ""),
        ("-inf", ""),
        ("0", ""),
        ("0.0", ""),
        ("1e-7", ""),
        ("1e13", ""),
        ("-20", "; spin_sign = -1 reverses the spin"),
    ] {
        assert_eq!(
            fault(&format!("[scan]\nspin_period_min = {value}\n")),
            format!(
                "mission.toml, line 3: scan.spin_period_min = {value} is out of range: {need} is \
                 needed{hint}"
            )
        );
    }
    assert_eq!(
        set_fault("scan.precession_period_min=-192.348"),
        format!(
            "--set: scan.precession_period_min = -192.348 is out of range: {need} is needed; \
             precession_sign = -1 reverses the precession"
        )
    );
    assert_eq!(
        set_fault("scan.spin_period_min=1/0"),
        format!("--set: scan.spin_period_min = 1/0 is not legal: {need} is needed")
    );
    assert_eq!(
        set_fault("scan.spin_sign=0"),
        "--set: scan.spin_sign = 0 is not legal: 1 or -1 is needed"
    );
}

#[test]
fn unknown_keys_name_the_nearest() {
    for (text, sentence) in [
        ("[scan]\nalpa_deg = 1", "line 3: unknown key scan.alpa_deg; did you mean scan.alpha_deg?"),
        ("[scna]\nalpha_deg = 1", "line 2: unknown key scna; did you mean scan?"),
        (
            "[orbit]\nalpha_deg = 1",
            "line 3: unknown key orbit.alpha_deg; did you mean scan.alpha_deg?",
        ),
        (
            "[calibration.schedule]\nmax_session = { count = 1, days = 1 }",
            "line 3: unknown key calibration.schedule.max_session; did you mean \
             calibration.schedule.max_sessions?",
        ),
        (
            "[calibration.schedule.max_sessions]\nday = 2",
            "line 3: unknown key calibration.schedule.max_sessions.day; did you mean \
             calibration.schedule.max_sessions.days?",
        ),
        (
            "[[telescope]]\nname = \"A\"\nfwhm_deg = 1\nfwhm_arcmin = 2",
            "line 4: unknown key telescope.A.fwhm_deg; did you mean telescope.A.fwhm_arcmin?",
        ),
        (
            "[[telescope]]\nname = \"A\"\nfwhm_arcmin = 2\nfield_of_view = { radius = 2 }",
            "line 5: telescope.A.field_of_view.radius_deg is missing: an angle above 0 and at most \
             180 deg is needed\nmission.toml, line 5: unknown key telescope.A.field_of_view.radius; \
             did you mean telescope.A.field_of_view.radius_deg?",
        ),
        (
            "[calibration.schedule.weights]\njupitr = 2",
            "line 3: unknown key calibration.schedule.weights.jupitr; did you mean \
             calibration.schedule.weights.jupiter?",
        ),
    ] {
        assert_eq!(fault(text), format!("mission.toml, {sentence}"));
    }
    assert_eq!(
        set_fault("scan.alpa_deg=1"),
        "--set: unknown key scan.alpa_deg; did you mean scan.alpha_deg?"
    );
    assert_eq!(
        set_fault("telescope.XFT.fwhm_arcmin=1"),
        "--set: telescope.XFT does not exist: one of LFT, MFT, HFT is needed"
    );
    assert_eq!(
        set_fault("scan.alpha_deg"),
        "--set: scan.alpha_deg is not an override: key=value is needed, such as scan.alpha_deg=47.5"
    );
    assert_eq!(
        set_fault("base=pico"),
        "--set: base = pico is not legal: --mission, to start from another mission, is needed"
    );
}

#[test]
fn radii_and_fields_of_view_have_a_range() {
    for value in ["0", "180.1", "-1", "nan"] {
        assert_eq!(
            set_fault(&format!("calibration.radius_deg={value}")),
            format!(
                "--set: calibration.radius_deg = {value} is out of range: an angle above 0 and at most \
                 180 deg is needed"
            )
        );
    }
    assert_eq!(
        set_fault("telescope.LFT.field_of_view.width_deg=180"),
        "--set: telescope.LFT.field_of_view.width_deg = 180 is out of range: an angle above 0 and \
         below 180 deg is needed"
    );
    assert_eq!(
        set_fault("telescope.LFT.field_of_view.radius_deg=3"),
        "--set: telescope.LFT.field_of_view.radius_deg and telescope.LFT.field_of_view.width_deg \
         exclude each other: one of them is needed"
    );
}

#[test]
fn telescopes_are_checked() {
    for (change, sentence) in [
        (
            "telescope.HFT.hwp_rate_rpm=0",
            "telescope.HFT.hwp_rate_rpm = 0 is out of range: a rate above 0 and at most 1000000 rpm is \
             needed",
        ),
        (
            "telescope.HFT.fwhm_arcmin=0",
            "telescope.HFT.fwhm_arcmin = 0 is out of range: an angle above 0 and at most 10800 arcmin \
             is needed",
        ),
        (
            "telescope.HFT.boresight_quaternion_xyzw=[0,0,0.5,0.5]",
            "the norm of telescope.HFT.boresight_quaternion_xyzw = 0.7071067811865476 is out of range: \
             a unit quaternion [x, y, z, w] to 1e-6 is needed",
        ),
        (
            "telescope.HFT.boresight_quaternion_xyzw=[0,0,1]",
            "telescope.HFT.boresight_quaternion_xyzw = [0, 0, 1] is not legal: a list of 4 numbers is \
             needed",
        ),
        (
            "telescope.HFT.name=LFT",
            "telescope.2.name = LFT is there twice: a name of its own is needed",
        ),
        ("telescope=[]", ""),
    ] {
        match set("litebird", &[change]) {
            Ok(mission) => {
                assert!(sentence.is_empty() && mission.telescopes.is_empty(), "{change}");
            }
            // The place of a duplicate is its table's.
            Err(error) => assert!(error.ends_with(&format!(": {sentence}")), "{error}"),
        }
    }
    assert_eq!(
        fault("[[telescope]]\nname = \"a/b\"\nfwhm_arcmin = 1\n[[telescope.detector]]\n"),
        "mission.toml, line 3: telescope.a/b.name = \"a/b\" is not legal: a name of 1 to 64 printable \
         characters that does not begin with # = + or @, neither \"-\", \"all\" nor \"none\", without , / and quotes is needed\n\
         mission.toml, line 5: telescope.a/b.detector.0.name is missing: a name of 1 to 64 printable \
         characters that does not begin with # = + or @, neither \"-\", \"all\" nor \"none\", without , / and quotes is needed"
    );
}

#[test]
fn spans_are_checked() {
    let need = "a time from 1900 to 2200 as YYYY-MM-DDThh:mm:ss[.fffffffff] followed by TDB, TT, TAI, \
                UTC or Z";
    for (value, why) in [
        ("2032-04-01T00:00:00", "names no time scale"),
        ("2032-02-30T00:00:00 TDB", "day 30: legal is 1 to 29"),
        ("tomorrow", "names no time scale"),
        ("5", "names no time scale"),
    ] {
        let told = set_fault(&format!("span.start={value}"));
        assert!(told.starts_with(&format!("--set: span.start = {value} is not legal: time '")));
        assert!(told.contains(why) && told.ends_with(&format!("; {need} is needed")), "{told}");
    }
    for value in ["0", "-1", "36526", "nan"] {
        assert_eq!(
            set_fault(&format!("span.duration_days={value}")),
            format!(
                "--set: span.duration_days = {value} is out of range: a duration above 0 and at most \
                 36525 days is needed"
            )
        );
    }
    let missing = read("name = \"x\"\n[scan]\n").unwrap_err();
    let keys: Vec<&str> = missing.lines().map(|l| l.split_whitespace().nth(1).unwrap()).collect();
    assert!(keys.contains(&"span.start") && keys.contains(&"span.duration_days"), "{missing}");
    assert!(missing.contains("mission.toml, line 2: scan.alpha_deg is missing"), "{missing}");
}

#[test]
fn targets_sources_and_the_schedule_are_checked() {
    let known = "one of mercury, venus, mars, jupiter, saturn, uranus, neptune, moon, tau_a, cas_a, \
                 cen_a";
    for (change, sentence) in [
        (
            "calibration.targets=pluto",
            format!("calibration.targets = pluto is not legal: {known} is needed"),
        ),
        (
            "calibration.targets=mars,mars",
            "calibration.targets = mars is there twice: a name of its own is needed".to_owned(),
        ),
        (
            "calibration.source=[{ name = \"mars\", directions = \"x.csv\" }]",
            "calibration.source.mars.name = mars is there twice: a name of its own is needed".to_owned(),
        ),
        (
            "calibration.source=[{ name = \"s\", directions = \"x.csv\", declination_deg = 1 }]",
            "calibration.source.s.declination_deg and calibration.source.s.directions exclude each \
             other: one of them is needed"
                .to_owned(),
        ),
        (
            "calibration.source=[{ name = \"s\", right_ascension_deg = 1 }]",
            "calibration.source.s.declination_deg is missing: an angle from -90 to 90 deg is needed"
                .to_owned(),
        ),
        (
            "calibration.schedule.max_minutes_per_day=4321",
            "calibration.schedule.max_minutes_per_day = 4321 is out of range: a duration above 0 and at \
             most 4320 min is needed"
                .to_owned(),
        ),
        (
            "calibration.schedule.max_sessions.count=0",
            "calibration.schedule.max_sessions.count = 0 is out of range: a whole number from 1 to \
             1000000 is needed"
                .to_owned(),
        ),
        (
            "calibration.schedule.max_sessions.count=1.5",
            "calibration.schedule.max_sessions.count = 1.5 is not legal: a whole number from 1 to \
             1000000 is needed"
                .to_owned(),
        ),
        (
            "calibration.schedule.setup_s=-1",
            "calibration.schedule.setup_s = -1 is out of range: a duration from 0 to 3.15576e7 s is \
             needed"
                .to_owned(),
        ),
        (
            "calibration.schedule.weights.mars=-1",
            "calibration.schedule.weights.mars = -1 is out of range: a weight from 0 to 1e12 is needed"
                .to_owned(),
        ),
        (
            "calibration.schedule.weights.mars=inf",
            "calibration.schedule.weights.mars = inf is out of range: a weight from 0 to 1e12 is needed"
                .to_owned(),
        ),
        (
            "calibration.schedule.exclusive=none",
            "calibration.schedule.exclusive = none is not legal: \"telescope\" or \"all\" is needed"
                .to_owned(),
        ),
        (
            "calibration.schedule.avoidance=[{ body = \"pluto\", angle_deg = 1 }]",
            format!(
                "calibration.schedule.avoidance.0.body = \"pluto\" is not legal: {} is needed",
                known.replace("one of ", "one of sun, earth, ")
            ),
        ),
        (
            "orbit.observer=moon",
            "orbit.observer = moon is not legal: \"spacecraft\" or \"earth\" or \"sun\" is needed"
                .to_owned(),
        ),
    ] {
        assert_eq!(set_fault(change), format!("--set: {sentence}"));
    }
}

#[test]
fn every_fault_is_reported_in_the_order_of_lines() {
    let sentences = fault("[scan]\nspin_period_min = 0\nalpha_deg = 200\nbeta = 3\n");
    let lines: Vec<&str> = sentences.lines().map(|l| l.split(": ").next().unwrap()).collect();
    assert_eq!(lines, ["mission.toml, line 3", "mission.toml, line 4", "mission.toml, line 5"]);
}

#[test]
fn text_that_is_not_toml_names_its_line() {
    assert!(fault("[scan]\nalpha_deg = 45,5\n").starts_with("mission.toml, line 3: not TOML: "));
    assert!(fault("[scan\n").starts_with("mission.toml, line 2: not TOML: "));
}
