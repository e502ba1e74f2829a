//! What `plan` uplinks is what the flight core carries out: every session, at its times, none
//! skipped.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use ephem::fit::FitOptions;
use ephem::source::SUN_AS_TARGET;
use formats::uplink::Contents;
use mission::{Mission, Override};
use onboard_core::clock::ClockCorrelation;
use onboard_core::sequencer::{
    Event, EventQueue, Lost, MAX_EVALUATIONS_PER_TICK, ScanEstimate, Sequencer, Settings,
    Situation, SkipReason,
};
use onboard_core::time::Duration;
use onboard_core::uplink::{SessionRecord, Tables};
use planner::world::World;
use std::path::Path;
use std::process::Command;

const SECOND: i64 = 1_000_000_000;

/// Sessions planned, and the events of flying through the whole validity in ticks of 10 s, each session
/// checked so many hours ahead.
fn fly(tables: &Tables<'_>, telescope: u16, ahead_h: i64) -> (usize, Vec<Event>) {
    let header = tables.header();
    let clock = ClockCorrelation {
        sequence: 1,
        spacecraft: header.spacecraft,
        uncertainty_ns: 0,
        ticks: 0,
        at: header.valid_from,
        tick_bits: ClockCorrelation::tick_of(1, 0),
        valid_from: header.valid_from,
        valid_until: header.valid_until,
    };
    let settings = Settings {
        telescope,
        tolerance: Duration::from_ns(1_000_000),
        passes_tolerance: 0,
        longest_gap: Duration::from_ns(20 * SECOND),
        check_ahead: Duration::from_ns(ahead_h * 3600 * SECOND),
        recheck_rad: 1e-6,
        steps_per_tick: 8,
    };
    let mut sequencer = Sequencer::new(settings).unwrap();
    sequencer.resume();
    let mut queue = EventQueue::<16>::new();
    let mut events = Vec::new();
    let mut at = Duration::ZERO;
    while header.valid_from.plus(at) <= header.valid_until {
        let ticks = u64::try_from(at.ns()).unwrap();
        let situation = Situation {
            ticks,
            clock: Some(&clock),
            tables: Some(tables),
            tables_damaged: false,
            scan: ScanEstimate::Mission,
        };
        let tick = sequencer.tick(&situation, &mut queue);
        assert!(tick.evaluations <= MAX_EVALUATIONS_PER_TICK);
        events.extend(std::iter::from_fn(|| queue.pop()).map(|it| it.event));
        at = Duration::from_ns(at.ns() + 10 * SECOND);
    }
    assert_eq!(queue.lost(), Lost::NONE);
    // The last session may end with the mission, where no tick follows.
    let planned = tables.plan().sessions().filter(|it| it.telescope == telescope).count();
    (planned, events)
}

/// Every session of a telescope is started, and none given up; how many there are.
fn carried_out(tables: &Tables<'_>, telescope: u16, arguments: &[&str]) -> usize {
    checked(tables, (telescope, 1), arguments)
}

/// The same, each session checked so many hours ahead.
fn checked(tables: &Tables<'_>, (telescope, ahead_h): (u16, i64), arguments: &[&str]) -> usize {
    let (planned, events) = fly(tables, telescope, ahead_h);
    let lost = |it: &&Event| matches!(it, Event::Skipped(..) | Event::Aborted(..));
    let lost: Vec<_> = events.iter().filter(lost).collect();
    assert!(lost.is_empty(), "{arguments:?}, telescope {telescope}: {lost:?}");
    let started = events.iter().filter(|it| matches!(it, Event::Started(..))).count();
    assert_eq!(started, planned, "{arguments:?}, telescope {telescope}");
    started
}

fn plan(folder: &Path, arguments: &[&str]) -> Vec<u8> {
    let out = folder.join("plan");
    let out = out.to_str().unwrap();
    let run = [&["plan", "--quiet", "--force", "--out", out], arguments].concat();
    let done = Command::new(env!("CARGO_BIN_EXE_gyrfalcon")).args(run).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    std::fs::read(folder.join("plan/uplink.tbl")).unwrap()
}

#[test]
fn the_plan_on_board_is_carried_out() {
    let folder = tempfile::tempdir().unwrap();
    let focal_plane = folder.path().join("focal_plane.toml");
    let detector = |name: &str, angle: f64| {
        format!(
            "[[telescope.detector]]\nname = \"{name}\"\nquaternion_xyzw = [{}, 0.0, 0.0, {}]\n",
            (angle / 2.0).sin(),
            (angle / 2.0).cos()
        )
    };
    let telescope = "[[telescope]]\nname = \"T\"\nfwhm_arcmin = 30.0\n";
    let own = [
        "name = \"own\"\nbase = \"pico\"\n",
        telescope,
        &detector("a", 0.05),
        &detector("b", -0.1),
    ];
    std::fs::write(&focal_plane, own.concat()).unwrap();
    let own = focal_plane.to_str().unwrap();
    let limits = "calibration.schedule.avoidance=[{ body = \"earth\", angle_deg = 30.0 }, \
                  { body = \"sun\", angle_deg = 60.0 }, { body = \"moon\", angle_deg = 20.0 }]";
    let cases: [&[&str]; 5] = [
        &["--duration", "45d"],
        // The line of sight keeps 85 deg from the Sun, the fields' edges 71 deg.
        &["--duration", "20d", "--set", limits],
        &["--duration", "20d", "--set", "scan.spin_sign=-1", "--sun", "circular"],
        &["--duration", "60d", "--mission", "epic"],
        &["--duration", "30d", "--mission", own],
    ];
    for arguments in cases {
        let bytes = plan(folder.path(), arguments);
        let tables = Tables::load(&bytes).unwrap();
        let telescopes = u16::try_from(tables.mission().telescopes().count()).unwrap();
        let mut all = 0;
        for telescope in 0..telescopes {
            all += carried_out(&tables, telescope, arguments);
        }
        assert!(all >= 3, "{arguments:?}: {all} sessions");
    }
}

/// The `[calibration.schedule]` key of some limits.
fn avoidance(limits: &[(&str, u32)]) -> String {
    let limit =
        |(body, angle): &(&str, u32)| format!("{{ body = \"{body}\", angle_deg = {angle}.0 }}");
    let limits: Vec<String> = limits.iter().map(limit).collect();
    format!("calibration.schedule.avoidance=[{}]", limits.join(", "))
}

/// Ten days of a preset under each of some sets of limits: sessions started equal sessions planned; how many.
fn fly_preset(preset: &str, limits: &[Vec<(&str, u32)>]) -> usize {
    let folder = tempfile::tempdir().unwrap();
    let under = |limits: &Vec<(&str, u32)>| {
        let key = avoidance(limits);
        let arguments = ["--duration", "10d", "--mission", preset, "--set", &key];
        let bytes = plan(folder.path(), &arguments);
        let tables = Tables::load(&bytes).unwrap();
        let telescopes = u16::try_from(tables.mission().telescopes().count()).unwrap();
        (0..telescopes).map(|it| carried_out(&tables, it, &arguments)).sum::<usize>()
    };
    limits.iter().map(under).sum()
}

#[test]
// REQ-SEQ-12.
fn what_is_planned_under_limits_is_flown() {
    let limits = [("sun", 80), ("moon", 70), ("earth", 60)].map(|it| vec![it]);
    assert!(fly_preset("litebird", &limits) > 50);
}

/// Hundreds of passes each, in a window of the mission; a check of Planck's takes 90 min of such ticks.
#[test]
fn sessions_of_slow_precession_are_flown() {
    let folder = tempfile::tempdir().unwrap();
    for (preset, from, least) in [("planck", "+31d", 3), ("core", "+30d", 2), ("pico", "+30d", 2)] {
        let arguments = ["--mission", preset, "--from", from, "--until", "+8d"];
        let bytes = plan(folder.path(), &arguments);
        let tables = Tables::load(&bytes).unwrap();
        let flown = checked(&tables, (0, 3), &arguments);
        assert!(flown >= least, "{preset}: {flown} sessions");
    }
}

/// Every preset under limits from 40 to 100 deg.
#[test]
#[ignore = "minutes: cargo test --test onboard -- --ignored"]
fn what_every_preset_plans_under_limits_is_flown() {
    let presets = ["litebird", "pico", "planck", "wmap", "epic", "core"];
    let bodies = ["sun", "earth", "moon"];
    let mut limits: Vec<Vec<(&str, u32)>> = bodies
        .iter()
        .flat_map(|body| [40, 70, 80, 100].map(|angle| vec![(*body, angle)]))
        .collect();
    limits.push(bodies.map(|body| (body, 60)).to_vec());
    let flown: Vec<usize> = std::thread::scope(|scope| {
        let limits = &limits;
        let flights = presets.map(|preset| scope.spawn(move || fly_preset(preset, limits)));
        flights.into_iter().map(|it| it.join().unwrap()).collect()
    });
    // The others plan no session in these ten days.
    assert!(flown[0] > 200 && flown[4] > 50, "{flown:?}");
}

/// A plan that was made without a limit, on board together with it.
#[test]
fn sessions_that_come_too_close_to_the_sun_are_skipped() {
    let folder = tempfile::tempdir().unwrap();
    let planned = plan(folder.path(), &["--duration", "20d"]);
    let sessions: Vec<SessionRecord> = Tables::load(&planned).unwrap().plan().sessions().collect();
    let limit = "calibration.schedule.avoidance=[{ body = \"sun\", angle_deg = 90.0 }]";
    let overrides = ["span.duration_days=20", limit].map(|it| Override::set(it).unwrap());
    let world = World::open(Mission::load("litebird", &overrides).unwrap(), None).unwrap();
    let fitted = world.tables(&FitOptions::UPLINK).unwrap().fitted;
    let contents = Contents {
        world: &world,
        ephemeris: &fitted.bytes,
        sessions: Some(&sessions),
        sequence: 7,
    };
    let bytes = contents.to_bytes().unwrap();
    let tables = Tables::load(&bytes).unwrap();
    assert_eq!(tables.header().sequence, 7);
    let avoided = SkipReason::Avoidance(SUN_AS_TARGET);
    let (mut planned, mut skipped) = (0, 0);
    for telescope in 0..3 {
        let (sessions, events) = fly(&tables, telescope, 1);
        let reasons = events.iter().filter_map(|event| match event {
            Event::Skipped(_, reason) => Some(*reason),
            _ => None,
        });
        planned += sessions;
        skipped += reasons.filter(|reason| *reason == avoided).count();
    }
    assert!(planned > 20 && skipped > planned / 2, "{skipped} of {planned}");
}
