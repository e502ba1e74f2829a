//! The sequencer carries out a plan, refuses what disagrees with its own prediction, and holds its
//! rules whatever the clock does.

use onboard_core::clock::{ClockCorrelation, ClockError};
use onboard_core::phase::{Phase, Rotor};
use onboard_core::scan::{ScanParameters, ScanStrategy};
use onboard_core::sequencer::{
    AbortReason, Event, EventQueue, Lost, MAX_EVALUATIONS_PER_TICK, SafeReason, ScanEstimate,
    Sequencer, Situation, SkipReason, State,
};
use onboard_core::time::{Duration, Instant};
use onboard_core::uplink::{Header, SectionKind, SessionRecord, Tables};
use tests::campaign::{
    CLOCK, DAY, SECOND, SETTINGS, ephemeris, sessions, sun, telescope, ticks_at, uplink,
};
use tests::uplink::{container, mission, plan};
use tests::{Noise, Plain};

struct Flight<'a> {
    sequencer: Sequencer,
    events: EventQueue<64>,
    tables: Option<Tables<'a>>,
    damaged: bool,
    clock: Option<ClockCorrelation>,
    strategy: Option<ScanStrategy>,
    log: Vec<Event>,
}

impl<'a> Flight<'a> {
    fn new(uplink: &'a [u8]) -> Self {
        let mut sequencer = Sequencer::new(SETTINGS).unwrap();
        sequencer.resume();
        Self {
            sequencer,
            events: EventQueue::new(),
            tables: Some(Tables::load(uplink).unwrap()),
            damaged: false,
            clock: Some(CLOCK),
            strategy: None,
            log: Vec::new(),
        }
    }

    fn tick(&mut self, ns: i64) -> State {
        let situation = Situation {
            ticks: ticks_at(ns),
            clock: self.clock.as_ref(),
            tables: self.tables.as_ref(),
            tables_damaged: self.damaged,
            scan: self.strategy.as_ref().map_or(ScanEstimate::Mission, ScanEstimate::Strategy),
        };
        let tick = self.sequencer.tick(&situation, &mut self.events);
        assert!(tick.evaluations <= MAX_EVALUATIONS_PER_TICK, "{}", tick.evaluations);
        assert_eq!(tick.state, self.sequencer.state());
        while let Some(stamped) = self.events.pop() {
            assert_eq!(stamped.ticks, ticks_at(ns));
            self.log.push(stamped.event);
        }
        tick.state
    }

    fn run(&mut self, from: i64, to: i64) {
        let mut ns = from;
        while ns <= to {
            self.tick(ns);
            ns += 10 * SECOND;
        }
    }

    fn count(&self, pick: impl Fn(&Event) -> bool) -> usize {
        self.log.iter().filter(|event| pick(event)).count()
    }

    fn skips(&self) -> Vec<SkipReason> {
        let reason = |event: &Event| match event {
            Event::Skipped(_, reason) => Some(*reason),
            _ => None,
        };
        self.log.iter().filter_map(reason).collect()
    }
}

#[test]
// REQ-SEQ-12.
fn every_session_of_a_sound_plan_is_carried_out_at_its_times() {
    let sessions = sessions(20);
    assert!(sessions.len() >= 20, "{}", sessions.len());
    let bytes = uplink(1, &sessions);
    let mut flight = Flight::new(&bytes);
    let mut ns = 0;
    while ns <= 21 * DAY - 10 * SECOND {
        let state = flight.tick(ns);
        let now = Instant::from_tai_ns(ns);
        let expected = (0_u32..)
            .zip(&sessions)
            .find(|(_, it)| it.start <= now && now < it.end)
            .map_or(State::Idle, |(index, it)| {
                if now < it.first_entry {
                    State::Setup(index)
                } else if now < it.last_exit {
                    State::Calibrating(index)
                } else {
                    State::Cooldown(index)
                }
            });
        assert_eq!(state, expected, "at {ns}");
        ns += 10 * SECOND;
    }
    assert_eq!(flight.count(|it| matches!(it, Event::Started(..))), sessions.len());
    assert_eq!(flight.count(|it| matches!(it, Event::Ended(_))), sessions.len());
    assert_eq!(flight.skips(), []);
    assert_eq!(flight.events.lost(), Lost::NONE);
    flight.tick(21 * DAY + SECOND);
    let expired = SafeReason::TablesExpired(Instant::from_tai_ns(21 * DAY));
    assert_eq!(flight.sequencer.state(), State::Safe(expired));
}

#[test]
// REQ-SEQ-5.
fn sessions_that_disagree_with_the_prediction_are_skipped_with_the_reason() {
    let good = sessions(20)[3];
    let run = |session: SessionRecord| {
        let bytes = uplink(1, &[session]);
        let mut flight = Flight::new(&bytes);
        flight.run(session.start.tai_ns() - 2 * 3600 * SECOND, session.end.tai_ns());
        flight.skips()
    };
    let moved = |at: Instant, seconds: i64| at.plus(Duration::from_ns(seconds * SECOND));
    assert_eq!(run(good), []);
    let entry = run(SessionRecord { first_entry: moved(good.first_entry, -3), ..good });
    assert!(matches!(entry[..], [SkipReason::Entry(by)] if by == Duration::from_ns(3 * SECOND)));
    let exit = run(SessionRecord { last_exit: moved(good.last_exit, 4), ..good });
    assert!(matches!(exit[..], [SkipReason::Exit(by)] if by == Duration::from_ns(-4 * SECOND)));
    // An entry that the plan puts into the middle of a pass is seen as cut off.
    let inside = run(SessionRecord { first_entry: moved(good.first_entry, 3), ..good });
    assert!(matches!(inside[..], [SkipReason::Entry(by)] if by.ns() < 0), "{inside:?}");
    let passes = run(SessionRecord { passes: good.passes + 1, ..good });
    assert_eq!(passes, [SkipReason::Passes(good.passes)]);
    let elsewhere = SessionRecord {
        first_entry: moved(good.last_exit, 30),
        last_exit: moved(good.last_exit, 60),
        ..good
    };
    assert_eq!(run(elsewhere), [SkipReason::NoPass]);
}

#[test]
fn the_measured_attitude_decides() {
    let good = sessions(20)[3];
    let bytes = uplink(1, &[good]);
    let mut flight = Flight::new(&bytes);
    // The spin is found a hundredth of a turn behind: 12 s of a turn of 20 min.
    let nominal = Plain::LITEBIRD.strategy();
    let behind = Phase::from_radians(-std::f64::consts::TAU / 100.0);
    let spin =
        Rotor { start: nominal.parameters().spin.start.plus(behind), ..nominal.parameters().spin };
    let parameters = ScanParameters { spin, ..*nominal.parameters() };
    flight.strategy = Some(ScanStrategy::new(parameters).unwrap());
    flight.run(good.start.tai_ns() - 3600 * SECOND, good.end.tai_ns());
    let skips = flight.skips();
    assert!(
        matches!(skips[..], [SkipReason::Entry(by)] if (by.seconds() - 12.0).abs() < 3.0),
        "{skips:?}"
    );
}

#[test]
// REQ-SEQ-4.
fn without_time_for_the_check_nothing_is_begun() {
    let good = sessions(20)[3];
    let bytes = uplink(1, &[good]);
    let mut flight = Flight::new(&bytes);
    flight.run(good.start.tai_ns() - 10 * SECOND, good.end.tai_ns());
    assert_eq!(flight.skips(), [SkipReason::NotChecked]);
    // A start that lies before the first tick is not looked at.
    let mut flight = Flight::new(&bytes);
    flight.run(good.start.tai_ns() + SECOND, good.end.tai_ns());
    assert_eq!(flight.skips(), []);
    assert_eq!(flight.count(|it| matches!(it, Event::Started(..))), 0);
}

#[test]
fn without_clock_or_tables_it_is_safe_until_resumed() {
    let good = sessions(20)[3];
    let bytes = uplink(1, &[good]);
    let middle = good.first_entry.tai_ns() + SECOND;
    for lose in 0..4 {
        let mut flight = Flight::new(&bytes);
        flight.run(good.start.tai_ns() - 3600 * SECOND, middle - 10 * SECOND);
        assert_eq!(flight.tick(middle), State::Calibrating(0));
        let expected = match lose {
            0 => {
                flight.clock = None;
                SafeReason::NoClock
            }
            1 => {
                flight.tables = None;
                SafeReason::NoTables
            }
            2 => {
                let until = Instant::from_tai_ns(middle);
                flight.clock = Some(ClockCorrelation { valid_until: until, ..CLOCK });
                SafeReason::Clock(ClockError::Expired(until))
            }
            _ => {
                flight.sequencer.stop();
                SafeReason::Commanded
            }
        };
        assert_eq!(flight.tick(middle + SECOND), State::Safe(expected));
        let aborted = Event::Aborted(0, AbortReason::Safe);
        assert_eq!(flight.count(|it| *it == aborted), 1);
        // It stays safe when clock and tables are back, and resumes only when told to.
        flight.clock = Some(CLOCK);
        flight.tables = Some(Tables::load(&bytes).unwrap());
        assert_eq!(flight.tick(middle + 2 * SECOND), State::Safe(expected));
        flight.sequencer.resume();
        assert_eq!(flight.tick(middle + 3 * SECOND), State::Idle);
        assert_eq!(flight.count(|it| matches!(it, Event::Started(..))), 1, "not begun again");
    }
}

#[test]
// REQ-SEQ-2.
fn an_order_to_resume_from_before_does_not_lead_out_of_safe() {
    let bytes = uplink(1, &[]);
    let mut flight = Flight::new(&bytes);
    flight.tick(0);
    flight.sequencer.resume();
    flight.clock = None;
    let safe = State::Safe(SafeReason::NoClock);
    assert_eq!(flight.tick(SECOND), safe);
    flight.clock = Some(CLOCK);
    assert_eq!(flight.tick(2 * SECOND), safe);
    flight.sequencer.resume();
    assert_eq!(flight.tick(3 * SECOND), State::Idle);
}

#[test]
fn jumps_of_the_clock_and_other_tables_give_up_the_session() {
    let all = sessions(20);
    let (good, later) = (all[3], all[4]);
    let bytes = uplink(1, &[good, later]);
    let newer = uplink(2, &[later]);
    let middle = good.first_entry.tai_ns() + SECOND;
    let calibrating = || {
        let mut flight = Flight::new(&bytes);
        flight.run(good.start.tai_ns() - 3600 * SECOND, middle - 10 * SECOND);
        assert_eq!(flight.tick(middle), State::Calibrating(0));
        flight
    };
    // Back by less than the longest gap: time stands still. By more: safe.
    let mut flight = calibrating();
    assert_eq!(flight.tick(middle - 15 * SECOND), State::Calibrating(0));
    let back = Duration::from_ns(25 * SECOND);
    let state = flight.tick(middle - 25 * SECOND);
    assert_eq!(state, State::Safe(SafeReason::TimeReversed(back)));
    // Forwards by more than the longest gap.
    let mut flight = calibrating();
    assert_eq!(flight.tick(middle + 25 * SECOND), State::Idle);
    assert_eq!(flight.count(|it| *it == Event::Aborted(0, AbortReason::TimeJumped)), 1);
    // Over the next session's start.
    flight.tick(later.start.tai_ns() + 21 * SECOND);
    assert_eq!(flight.skips(), [SkipReason::Missed]);
    // Other tables.
    let mut flight = calibrating();
    flight.tables = Some(Tables::load(&newer).unwrap());
    assert_eq!(flight.tick(middle + SECOND), State::Idle);
    assert_eq!(flight.count(|it| *it == Event::Aborted(0, AbortReason::Tables)), 1);
    flight.run(middle + 2 * SECOND, later.end.tai_ns());
    assert_eq!(flight.count(|it| matches!(it, Event::Started(0, _))), 2, "then the new plan's");
}

#[test]
fn sessions_of_other_telescopes_and_overlaps_are_left_out() {
    let good = sessions(20)[3];
    let other = SessionRecord { telescope: 1, ..good };
    let header = Header {
        sequence: 1,
        valid_from: Instant::from_tai_ns(0),
        valid_until: Instant::from_tai_ns(21 * DAY),
        mission_digest: [0; 16],
        spacecraft: 1,
    };
    let two = mission(&Plain::LITEBIRD, sun(), &[telescope(), telescope()]);
    let bytes = container(
        &header,
        &[
            (SectionKind::Ephemeris, &ephemeris()),
            (SectionKind::Mission, &two),
            (SectionKind::Plan, &plan(&[other, good, good])),
        ],
    );
    let mut flight = Flight::new(&bytes);
    flight.run(good.start.tai_ns() - 3600 * SECOND, good.end.tai_ns());
    assert_eq!(flight.count(|it| matches!(it, Event::Started(1, _))), 1);
    assert_eq!(flight.skips(), [SkipReason::Overlap]);
}

/// Whatever the clock, the tables and the commands do: a session is only ever under way at its own
/// times, after a check, with a valid clock and valid tables.
#[test]
// REQ-SEQ-13.
fn the_rules_hold_under_arbitrary_jumps() {
    let sessions = sessions(20);
    let (first, second) = (uplink(1, &sessions), uplink(2, &sessions[5..]));
    for seed in 0..60 {
        let mut noise = Noise::new(seed);
        let mut flight = Flight::new(&first);
        let mut ns = 0_i64;
        for _ in 0..20_000 {
            ns += match noise.bits() % 1000 {
                0 => (noise.signed() * DAY as f64) as i64,
                1..=3 => (noise.signed() * 60e9) as i64,
                _ => (noise.unit() * 20e9) as i64,
            };
            ns = ns.clamp(-DAY, 25 * DAY);
            match noise.bits() % 2000 {
                0 => flight.clock = None,
                1 => flight.tables = None,
                2 => flight.sequencer.stop(),
                3 => flight.tables = Some(Tables::load(&second).unwrap()),
                4..=12 => {
                    flight.clock = Some(CLOCK);
                    flight.tables = Some(Tables::load(&first).unwrap());
                    flight.sequencer.resume();
                }
                _ => {}
            }
            let usable = flight.clock.is_some() && flight.tables.is_some();
            let state = flight.tick(ns);
            let (State::Setup(index) | State::Calibrating(index) | State::Cooldown(index)) = state
            else {
                continue;
            };
            assert!(usable);
            let tables = flight.tables.unwrap();
            let session = tables.plan().session(index).unwrap();
            // A small step back lets time stand still, so the session may be ahead of the counter.
            let now = Instant::from_tai_ns(ns);
            let ahead = SETTINGS.longest_gap.ns();
            assert!(session.start <= now.plus(Duration::from_ns(ahead)) && now < session.end);
            assert!(tables.header().valid_from <= now && now <= tables.header().valid_until);
            if matches!(state, State::Calibrating(_)) {
                assert!(session.first_entry <= now.plus(Duration::from_ns(ahead)));
                assert!(now < session.last_exit);
            }
        }
        let started = flight.count(|it| matches!(it, Event::Started(..)));
        let over = flight.count(|it| matches!(it, Event::Ended(_) | Event::Aborted(..)));
        assert!(started == over || started == over + 1, "{started} {over}");
    }
}
