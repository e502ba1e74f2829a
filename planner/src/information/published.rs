//! Whole missions: three scanning strategies under one made-up signal, and sums against their parts.

use super::*;
use crate::opportunities::{boresight, search};
use crate::progress::Quietly;
use crate::world::{World, body};
use crate::worth::impact_rad;
use mission::{Mission, Override};
use onboard_core::attitude::sweep;
use onboard_core::time::Duration;
use std::f64::consts::PI;

const ARCSEC: f64 = PI / 648_000.0;

fn world(preset: &str, days: Option<&str>, target: &str) -> World {
    let days = days.map(|days| Override::set(&format!("span.duration_days={days}")).unwrap());
    let changes: Vec<Override> = days.into_iter().collect();
    let mut world = World::open(Mission::load(preset, &changes).unwrap(), None).unwrap();
    world.keep_targets(&[target.to_owned()]).unwrap();
    world
}

/// Jupiter of 50 mK through a beam of 17.9 arcmin on the boresight, noise 300 uK sqrt(s).
fn made_up(preset: &str) -> Errors {
    let world = world(preset, None, "jupiter");
    let tables = world.tables(&world.ground_options()).unwrap();
    let table = tables.parse().unwrap();
    let line = boresight(&world.mission).unwrap();
    let sun = world.sun(table).unwrap();
    let place = body(table, world.targets[0].body()).unwrap();
    let mut sum = Fisher::default();
    for it in search(&world, table, std::slice::from_ref(&line)).unwrap() {
        let at = it.transit.closest;
        let seen = sweep(&world.scan, &sun, line.rotation, at).unwrap();
        let crossing = Crossing {
            signal_k: 0.05,
            noise_k_rts: 3e-4,
            beam_sigma_rad: (17.9_f64 / 60.0).to_radians() * SIGMA_PER_FWHM,
            speed_rad_s: seen.speed_rad_s,
            impact_rad: impact_rad(&seen, place.state(at).unwrap().direction),
            scan_beam_angle_rad: seen.scan_beam_angle_rad,
            modulation: Modulation::default(),
        };
        sum.add(&crossing.fisher());
    }
    Errors::of(&sum)
}

#[test]
fn three_strategies_have_the_errors_of_a_separate_prototype() {
    // Offset along the scan in arcsec, time constant in ms, offset across the scan in arcsec: of LiteBIRD and
    // PICO, and across the scan, from one prototype; of Planck along the scan, where 219,729 arcsec mean a
    // condition of 1e11, from arithmetic with 40 digits on the rows of `transits`.
    for (preset, along, delay, across) in [
        ("litebird", 4.7, 5.4, 0.32),
        ("pico", 721.0, 36.0, 0.42),
        ("planck", 219_729.0, 10_211.5, 0.44),
    ] {
        let errors = made_up(preset);
        let told = [
            errors.of_parameter(Parameter::OffsetY).unwrap() / ARCSEC,
            1e3 * errors.of_parameter(Parameter::TimeConstant).unwrap(),
            errors.of_parameter(Parameter::OffsetX).unwrap() / ARCSEC,
        ];
        for (found, expected) in told.into_iter().zip([along, delay, across]) {
            assert!((found / expected - 1.0).abs() < 0.02, "{preset}: {told:?}");
        }
        let gain = errors.of_parameter(Parameter::Gain).unwrap();
        assert!((0.0006..0.00105).contains(&gain), "{preset}: {gain}");
        let strongest = errors.degeneracies[0];
        assert_eq!(
            (strongest.one, strongest.other),
            (Parameter::OffsetY, Parameter::TimeConstant),
            "{preset}"
        );
    }
}

#[test]
fn windows_and_sessions_are_parts_of_the_whole() {
    let world = world("litebird", Some("40"), "jupiter");
    let tables = world.tables(&world.ground_options()).unwrap();
    let table = tables.parse().unwrap();
    let looks = looks(&world.mission, Some("HFT"), None).unwrap();
    assert_eq!(looks.len(), 5);
    let ten = Duration::from_seconds(864_000.0);
    let windows = Windows::new((world.start, world.end), &[None, Some(ten)]);
    let question = Question { looks: &looks, windows: &windows, sessions: None };
    let found = forecast(&world, table, &question, &Quietly).unwrap();
    assert_eq!(found.left, []);
    for look in 0..looks.len() {
        let whole = found.lesson(look, 0, 0);
        let mut parts = Lesson::default();
        windows.of_kind(1).for_each(|window| parts.add(found.lesson(look, 0, window)));
        assert!(whole.passes > 0 && parts.passes == whole.passes);
        let gain = |it: &Lesson| it.fisher.entry(Parameter::Gain, Parameter::Gain);
        assert!((gain(&parts) / gain(whole) - 1.0).abs() < 1e-12);
    }
    let telescope = looks[0].line.telescope.unwrap();
    let (from, until) = windows.span(2);
    let session = Session { target: 0, telescope, from, until };
    let question = Question { sessions: Some(std::slice::from_ref(&session)), ..question };
    let planned = forecast(&world, table, &question, &Quietly).unwrap();
    assert_eq!(planned.lesson(0, 0, 0), found.lesson(0, 0, 2));
}

#[test]
fn requirements_are_met_or_not_by_all_targets_together() {
    let text = "base = \"litebird\"\n[span]\nduration_days = 30\n[calibration]\ntargets = [\"jupiter\"]\n\
                [[calibration.requirement]]\nquantity = \"gain\"\nsigma = \"50 %\"\nevery_days = 15\n\
                telescope = \"MFT\"\n\
                [[calibration.requirement]]\nquantity = \"offset\"\nsigma = \"1e-6 arcsec\"\n\
                telescope = \"M1-100\"\n\
                [[calibration.requirement]]\nquantity = \"beam_level\"\nsigma = \"-1 dB\"\n\
                radius_arcmin = 5\ntelescope = \"M1-100\"\n";
    let mission = Mission::from_toml(text, "m.toml", std::path::Path::new(""), &[]).unwrap();
    let world = World::open(mission, None).unwrap();
    let tables = world.tables(&world.ground_options()).unwrap();
    let looks = looks(&world.mission, Some("MFT"), None).unwrap();
    let requirements = &world.mission.calibration.requirements;
    let lengths = windows_of(None, requirements);
    let windows = Windows::new((world.start, world.end), &lengths);
    let question = Question { looks: &looks, windows: &windows, sessions: None };
    let found = forecast(&world, tables.parse().unwrap(), &question, &Quietly).unwrap();
    let told = rows(&found, &looks, &windows, 1, requirements);
    let verdicts: Vec<Verdict> = verdicts(&told, 3).into_iter().map(Option::unwrap).collect();
    assert_eq!([verdicts[0].of, verdicts[1].of, verdicts[2].of], [2 * looks.len(), 2, 1]);
    assert_eq!(verdicts[0].met, verdicts[0].of);
    assert_eq!(verdicts[1].met, 0);
    assert_eq!(verdicts[2].met, 1);
    let worst = verdicts[1].worst;
    assert_eq!((worst.quantity().as_str(), worst.met()), ("offset_y", Some(false)));
    assert_eq!(worst.told(ARCSEC).0, "arcsec");
    let plain = told.iter().filter(|it| it.requirement.is_none());
    assert_eq!(plain.count(), looks.len() * 2 * (COUNT + 3));
}

#[test]
fn a_miss_is_for_geometry_noise_or_budget() {
    // 30 days teach the gain to 0.011 %; Jupiter is not polarised.
    let requirement = |quantity: &str, sigma: &str| {
        format!(
            "[[calibration.requirement]]\nquantity = \"{quantity}\"\nsigma = \"{sigma}\"\n\
             telescope = \"H3-402\"\n"
        )
    };
    let text = format!(
        "base = \"litebird\"\n[span]\nduration_days = 30\n[calibration]\ntargets = [\"jupiter\"]\n\
         {}{}{}{}",
        requirement("gain", "100 %"),
        requirement("gain", "1e-6 %"),
        requirement("gain", "0.5 %"),
        requirement("polarisation_angle", "1 deg"),
    );
    let mission = Mission::from_toml(&text, "m.toml", std::path::Path::new(""), &[]).unwrap();
    let world = World::open(mission, None).unwrap();
    let tables = world.tables(&world.ground_options()).unwrap();
    let table = tables.parse().unwrap();
    let looks = looks(&world.mission, Some("HFT"), Some("H3-402")).unwrap();
    let of = |sessions: Option<Vec<Session>>| {
        Teaching::of(&world, table, looks.clone(), (None, sessions), &Quietly).unwrap()
    };
    let telescope = looks[0].line.telescope.unwrap();
    let all = of(None);
    let gain = all.errors(0).of_parameter(Parameter::Gain).unwrap();
    assert!(gain < 0.005, "{gain}");
    let whys = |it: &Teaching| -> Vec<Option<Why>> {
        it.verdicts().into_iter().map(|it| it.unwrap().worst.why).collect()
    };
    assert_eq!(whys(&all), [None, Some(Why::Noise), None, Some(Why::Geometry)]);
    // No session at all: what all passes would give is a question of the budget.
    let (from, until) = (world.start, world.start);
    let none = of(Some(vec![Session { target: 0, telescope, from, until }]));
    let reasons = [Some(Why::Budget), Some(Why::Noise), Some(Why::Budget), Some(Why::Geometry)];
    assert_eq!(whys(&none), reasons);
    assert_eq!(none.verdicts()[0].unwrap().missed, [0, 0, 1]);
}

#[test]
fn of_each_channel_the_middle_one_is_judged() {
    // Turns of 6 and -6 deg about y, and of 0.1 deg.
    let detectors = "telescope.MFT.detector=[\
        { name = \"west\", quaternion_xyzw = [0.0, -0.052336, 0.0, 0.998630], channel = \"M1-100\" }, \
        { name = \"middle\", quaternion_xyzw = [0.0, 0.0008727, 0.0, 0.9999996], channel = \"M1-100\" }, \
        { name = \"east\", quaternion_xyzw = [0.0, 0.052336, 0.0, 0.998630], channel = \"M1-100\" }, \
        { name = \"other\", quaternion_xyzw = [0.0, 0.0, 0.0, 1.0], channel = \"M2-119\" }]";
    let change = Override::set(detectors).unwrap();
    let mission = Mission::load("litebird", &[change]).unwrap();
    let kept = one_of_each(looks(&mission, Some("MFT"), None).unwrap());
    let names: Vec<&str> = kept.iter().map(Look::name).collect();
    assert_eq!(names, ["middle", "other"]);
}

#[test]
fn a_map_of_cells_holds_what_annuli_hold() {
    let world = world("litebird", Some("20"), "jupiter");
    let tables = world.tables(&world.ground_options()).unwrap();
    let looks = looks(&world.mission, Some("MFT"), Some("M1-100")).unwrap();
    let windows = Windows::new((world.start, world.end), &[None]);
    let question = Question { looks: &looks, windows: &windows, sessions: None };
    let table = tables.parse().unwrap();
    let profile = forecast(&world, table, &question, &Quietly).unwrap().lesson(0, 0, 0).profile;
    let map = beam_map(&world, table, &looks[0], None).unwrap();
    let in_annuli: f64 = (0..ANNULI).map(|annulus| profile.seconds(annulus)).sum();
    let mut in_cells = 0.0;
    for row in 0..SIDE {
        for column in 0..SIDE {
            let radius = BeamMap::middle_fwhm(row).hypot(BeamMap::middle_fwhm(column));
            if radius < REACH {
                in_cells += map.seconds(column, row);
            }
        }
    }
    assert!(
        in_annuli > 10.0 && (in_cells / in_annuli - 1.0).abs() < 0.03,
        "{in_cells} {in_annuli}"
    );
}

#[test]
fn what_is_not_known_is_told_or_left_out() {
    let told = |changes: &[&str], target: &str| {
        let mut all = vec![Override::set("span.duration_days=5").unwrap()];
        all.extend(changes.iter().map(|it| Override::set(it).unwrap()));
        let mut world = World::open(Mission::load("litebird", &all).unwrap(), None).unwrap();
        world.keep_targets(&[target.to_owned()]).unwrap();
        let tables = world.tables(&world.ground_options()).unwrap();
        let looks = looks(&world.mission, Some("LFT"), None).unwrap();
        let windows = Windows::new((world.start, world.end), &[None]);
        let question = Question { looks: &looks, windows: &windows, sessions: None };
        forecast(&world, tables.parse().unwrap(), &question, &Quietly)
    };
    // Mars is known from 100 GHz on: nine of LFT's channels are left out.
    let left = told(&[], "mars").unwrap().left;
    assert_eq!(left.len(), 9);
    assert!(left.iter().all(|it| it.target == Some(0)));
    let bare = ["telescope.LFT.channel=[]", "telescope.LFT.net_uk_rts=none"];
    let sentence = told(&bare, "mars").unwrap_err().to_string();
    assert!(sentence.starts_with("net_uk_rts of LFT/- is needed"), "{sentence}");
    let low = ["telescope.LFT.channel=[]", "telescope.LFT.frequency_ghz=60"];
    let sentence = told(&low, "mars").unwrap_err().to_string();
    assert!(sentence.starts_with("mars has no known strength in the band of LFT/-"), "{sentence}");
}
