//! One test for each rule of the sequencer, by the names of the table in `docs/onboard.md`.

extern crate std;

use super::trial::{
    Board, CLOCK, DAY, Flight, SECOND, SETTINGS, TILT_RAD, all_over, beside_track, later,
    least_angles_rad, sessions, strategy, turned,
};
use super::{AbortReason, Event, SafeReason, ScanEstimate, Sequencer, Settings, SkipReason, State};
use crate::clock::{ClockCorrelation, ClockError};
use crate::direction::Direction;
use crate::frame::Ecliptic;
use crate::time::{Duration, Instant};
use crate::tracking::{Tracker, TrackerSettings};
use crate::uplink::{SessionRecord, Tables};
use std::vec;
use std::vec::Vec;

pub(super) fn session() -> SessionRecord {
    *sessions().first().expect("a session")
}

pub(super) fn ns(at: Instant, by: i64) -> Instant {
    at.plus(Duration::from_ns(by))
}

/// Flies a session from its check on to its end.
fn fly(flight: &mut Flight<'_>, session: &SessionRecord) {
    flight.run(later(session.start, -3600), later(session.end, 10));
}

#[test]
// REQ-SEQ-1.
fn boot_is_safe_until_resumed() {
    let (board, session) = (Board::default(), session());
    let bytes = board.uplink(1, &[session]);
    let mut flight = Flight::new(&bytes);
    flight.sequencer = Sequencer::new(SETTINGS).unwrap();
    assert_eq!(flight.sequencer.state(), State::Safe(SafeReason::Boot));
    fly(&mut flight, &session);
    assert_eq!(flight.log, [Event::Safe(SafeReason::Boot)], "nothing begins by itself");
    flight.sequencer.resume();
    assert_eq!(flight.tick(later(session.end, 20)), State::Idle);
}

#[test]
// REQ-SEQ-2.
fn damaged_tables_are_safe() {
    let session = session();
    let bytes = Board::default().uplink(1, &[session]);
    let mut flight = Flight::new(&bytes);
    flight.run(later(session.start, -3600), later(session.start, 10));
    assert_eq!(flight.tick(later(session.start, 20)), State::Setup(0));
    flight.damaged = true;
    let safe = State::Safe(SafeReason::TablesDamaged);
    assert_eq!(flight.tick(later(session.start, 30)), safe);
    assert_eq!(flight.aborts(), [AbortReason::Safe]);
    flight.sequencer.resume();
    assert_eq!(flight.tick(later(session.start, 40)), safe, "as long as they are damaged");
    flight.damaged = false;
    assert_eq!(flight.tick(later(session.start, 50)), State::Idle);
}

#[test]
// REQ-SEQ-2.
fn validity_holds_at_its_ends_and_not_beyond() {
    let bytes = Board::default().uplink(1, &[]);
    let header = *Tables::load(&bytes).unwrap().header();
    let (from, until) = (header.valid_from, header.valid_until);
    let at = |instant: Instant| Flight::new(&bytes).tick(instant);
    assert_eq!(at(from), State::Idle);
    assert_eq!(at(until), State::Idle);
    let state_after = |instant: Instant| {
        let mut flight = Flight::new(&bytes);
        flight.tick(later(from, 60));
        flight.sequencer.stop();
        flight.tick(later(from, 60));
        flight.sequencer.resume();
        flight.tick(instant)
    };
    assert_eq!(state_after(until), State::Idle);
    assert_eq!(state_after(ns(until, 1)), State::Safe(SafeReason::Commanded));
    let mut flight = Flight::new(&bytes);
    flight.tick(until);
    assert_eq!(flight.tick(ns(until, 1)), State::Safe(SafeReason::TablesExpired(until)));
    let early = Board::default().uplink_valid(1, &[], (later(from, 100), until));
    let mut flight = Flight::new(&bytes);
    flight.tick(later(from, 90));
    flight.tables = Some(Tables::load(&early).unwrap());
    let not_yet = State::Safe(SafeReason::TablesNotYetValid(later(from, 100)));
    assert_eq!(flight.tick(ns(later(from, 100), -1)), not_yet);
    flight.sequencer.resume();
    assert_eq!(flight.tick(later(from, 100)), State::Idle);
}

#[test]
// REQ-SEQ-2.
fn without_clock_tables_or_telescope_it_is_safe() {
    let bytes = Board::default().uplink(1, &[]);
    let now = Instant::from_tai_ns(DAY);
    let mut flight = Flight::new(&bytes);
    flight.tick(now);
    flight.clock = None;
    assert_eq!(flight.tick(now), State::Safe(SafeReason::NoClock));
    let mut flight = Flight::new(&bytes);
    flight.tick(now);
    flight.clock = Some(ClockCorrelation { valid_until: now, ..CLOCK });
    let expired = State::Safe(SafeReason::Clock(ClockError::Expired(now)));
    assert_eq!(flight.tick(later(now, 1)), expired);
    let mut flight = Flight::new(&bytes);
    flight.tick(now);
    flight.tables = None;
    assert_eq!(flight.tick(now), State::Safe(SafeReason::NoTables));
    let mut flight = Flight::with(Settings { telescope: 1, ..SETTINGS }, &bytes);
    flight.tick(now);
    assert_eq!(flight.sequencer.state(), State::Safe(SafeReason::Boot));
    let telescopes = Flight::new(&bytes).tick(now);
    assert_eq!(telescopes, State::Idle);
}

#[test]
// REQ-SEQ-2.
fn another_spacecrafts_clock_is_safe() {
    let session = session();
    let bytes = Board::default().uplink(1, &[session]);
    let mut flight = Flight::new(&bytes);
    flight.run(later(session.start, -3600), later(session.start, 20));
    flight.clock = Some(ClockCorrelation { spacecraft: 2, ..CLOCK });
    let other = SafeReason::Clock(ClockError::OtherSpacecraft { record: 2, flown: 1 });
    assert_eq!(flight.tick(later(session.start, 30)), State::Safe(other));
    flight.sequencer.resume();
    assert_eq!(flight.tick(later(session.start, 40)), State::Safe(other), "as long as it lasts");
    flight.clock = Some(CLOCK);
    assert_eq!(flight.tick(later(session.start, 50)), State::Idle);
}

#[test]
// REQ-SEQ-3.
fn time_may_run_back_by_the_longest_gap_and_no_more() {
    let bytes = Board::default().uplink(1, &[]);
    let now = Instant::from_tai_ns(DAY);
    let gap = SETTINGS.longest_gap;
    let back = |by: i64| {
        let mut flight = Flight::new(&bytes);
        flight.tick(now);
        flight.tick(ns(now, -by))
    };
    assert_eq!(back(gap.ns()), State::Idle);
    let further = Duration::from_ns(gap.ns() + 1);
    assert_eq!(back(further.ns()), State::Safe(SafeReason::TimeReversed(further)));
}

#[test]
// REQ-SEQ-3.
fn time_stands_still_until_the_counter_has_caught_up() {
    let session = session();
    let bytes = Board::default().uplink(1, &[session]);
    let mut flight = Flight::new(&bytes);
    flight.run(later(session.start, -3600), session.start);
    assert_eq!(flight.tick(session.first_entry.min(later(session.start, 10))), State::Setup(0));
    // Before its start again, and yet it goes on.
    assert_eq!(flight.tick(later(session.start, -5)), State::Setup(0));
    assert_eq!(flight.started(), 1);
}

#[test]
// REQ-SEQ-3.
fn a_jump_gives_the_session_up_beyond_the_longest_gap_only() {
    let session = session();
    let bytes = Board::default().uplink(1, &[session]);
    let gap = SETTINGS.longest_gap.ns();
    let jumped = |by: i64| {
        let mut flight = Flight::new(&bytes);
        flight.run(later(session.start, -3600), session.start);
        flight.tick(session.start);
        flight.tick(ns(session.start, by));
        flight.aborts()
    };
    assert_eq!(jumped(gap), []);
    assert_eq!(jumped(gap + 1), [AbortReason::TimeJumped]);
}

#[test]
// REQ-SEQ-4.
fn a_start_is_missed_beyond_the_longest_gap_only() {
    let session = session();
    let bytes = Board::default().uplink(1, &[session]);
    let gap = SETTINGS.longest_gap.ns();
    let arrived = |after: i64| {
        let mut flight = Flight::new(&bytes);
        flight.run(later(session.start, -3600), session.start);
        flight.tick(ns(session.start, after));
        (flight.started(), flight.skips())
    };
    assert_eq!(arrived(gap), (1, vec![]));
    assert_eq!(arrived(gap + 1), (0, vec![SkipReason::Missed]));
}

#[test]
// REQ-SEQ-10.
fn states_change_at_the_planned_instants() {
    let session = session();
    let bytes = Board::default().uplink(1, &[session]);
    let mut flight = Flight::new(&bytes);
    flight.run(later(session.start, -3600), session.start);
    let expected = [
        (session.start, State::Idle, State::Setup(0)),
        (session.first_entry, State::Setup(0), State::Calibrating(0)),
        (session.last_exit, State::Calibrating(0), State::Cooldown(0)),
        (session.end, State::Cooldown(0), State::Idle),
    ];
    let mut before = later(session.start, -10);
    for (at, until, from) in expected {
        flight.run(before, at);
        assert_eq!(flight.tick(ns(at, -1)), until);
        assert_eq!(flight.tick(at), from);
        before = at;
    }
    assert_eq!(flight.log.last(), Some(&Event::Entered(State::Idle)));
    assert!(flight.log.contains(&Event::Ended(0)));
}

#[test]
// REQ-SEQ-4.
fn one_session_at_a_time() {
    let session = session();
    let after = SessionRecord { start: session.end, ..session };
    let after = SessionRecord {
        end: later(session.end, 900),
        first_entry: later(session.end, 10),
        last_exit: later(session.end, 20),
        ..after
    };
    let overlapping = SessionRecord { start: ns(session.end, -1), ..after };
    let reasons = |second: SessionRecord| {
        let bytes = Board::default().uplink(1, &[session, second]);
        let mut flight = Flight::new(&bytes);
        fly(&mut flight, &session);
        flight.skips()
    };
    assert_eq!(reasons(overlapping), [SkipReason::NoPass]);
    // Ticks fall on both starts.
    let bytes = Board::default().uplink(1, &[session, session]);
    let mut flight = Flight::new(&bytes);
    fly(&mut flight, &session);
    assert_eq!(flight.skips(), [SkipReason::Overlap]);
    assert_eq!(reasons(after), [SkipReason::NoPass], "the first is over by then");
}

#[test]
fn a_session_that_begins_now_is_taken_up() {
    let session = session();
    let bytes = Board::default().uplink(1, &[session]);
    let mut flight = Flight::new(&bytes);
    flight.tick(session.start);
    assert_eq!(flight.skips(), [SkipReason::NotChecked]);
    let mut flight = Flight::new(&bytes);
    flight.tick(ns(session.start, 1));
    assert_eq!(flight.skips(), [], "one that began before is not looked at");
}

#[test]
fn a_check_begins_so_long_before_the_start() {
    let session = session();
    let bytes = Board::default().uplink(1, &[session]);
    let mut flight = Flight::new(&bytes);
    let ahead = ns(session.start, -SETTINGS.check_ahead.ns());
    assert_eq!(flight.told(ns(ahead, -1).tai_ns()).check, super::Progress::Waiting);
    assert_eq!(flight.told(ahead.tai_ns()).check, super::Progress::UnderWay);
}

#[test]
// REQ-SEQ-7.
fn other_tables_ask_for_another_check() {
    let session = session();
    let wrong = SessionRecord { first_entry: later(session.first_entry, -5), ..session };
    let (right, newer) =
        (Board::default().uplink(1, &[session]), Board::default().uplink(2, &[wrong]));
    let mut flight = Flight::new(&right);
    flight.run(later(session.start, -3600), later(session.start, -600));
    assert_eq!(flight.told(later(session.start, -600).tai_ns()).check, super::Progress::Done);
    flight.tables = Some(Tables::load(&newer).unwrap());
    flight.run(later(session.start, -590), session.end);
    assert!(matches!(flight.skips()[..], [SkipReason::Entry(_)]), "{:?}", flight.skips());
    // And a running session is given up.
    let mut flight = Flight::new(&right);
    flight.run(later(session.start, -3600), later(session.start, 20));
    flight.tables = Some(Tables::load(&newer).unwrap());
    assert_eq!(flight.tick(later(session.start, 20)), State::Idle);
    assert_eq!(flight.aborts(), [AbortReason::Tables]);
}

#[test]
// REQ-SEQ-7.
fn a_turned_strategy_asks_for_another_check() {
    let session = session();
    let bytes = Board::default().uplink(1, &[session]);
    let other = turned(1.5);
    let mut flight = Flight::new(&bytes);
    flight.run(later(session.start, -3600), later(session.start, -600));
    assert_eq!(flight.told(later(session.start, -600).tai_ns()).check, super::Progress::Done);
    flight.scan = ScanEstimate::Strategy(&other);
    flight.run(later(session.start, -590), session.end);
    assert_eq!(flight.skips(), [SkipReason::NoPass]);
    assert_eq!(flight.started(), 0);
    // Turned at the last moment: there is no time to check again.
    let mut flight = Flight::new(&bytes);
    flight.run(later(session.start, -3600), session.start);
    flight.scan = ScanEstimate::Strategy(&other);
    flight.tick(session.start);
    assert_eq!(flight.skips(), [SkipReason::NotChecked]);
    // And back from a corrected strategy to the mission's.
    let mut flight = Flight::new(&bytes);
    flight.scan = ScanEstimate::Strategy(&other);
    flight.run(later(session.start, -3600), later(session.start, -600));
    flight.scan = ScanEstimate::Mission;
    flight.run(later(session.start, -600), later(session.start, 10));
    assert_eq!(flight.started(), 1);
}

#[test]
// REQ-SEQ-7.
fn a_verdict_stands_within_the_angle_of_a_new_check() {
    let session = session();
    let bytes = Board::default().uplink(1, &[session]);
    let checked_again = |by_rad: f64| {
        let other = turned(by_rad);
        let mut flight = Flight::new(&bytes);
        flight.run(later(session.start, -3600), later(session.start, -600));
        flight.scan = ScanEstimate::Strategy(&other);
        flight.told(later(session.start, -600).tai_ns()).check != super::Progress::Done
    };
    assert!(!checked_again(0.99 * SETTINGS.recheck_rad));
    assert!(checked_again(1.01 * SETTINGS.recheck_rad));
    // A rate that is off turns the attitude at the end further than at the start.
    let mut parameters = *strategy().parameters();
    let (start, end) = (strategy().elapsed(session.start), strategy().elapsed(session.end));
    let faster = crate::phase::TurnRate::from_radians_per_second(
        1.001 * SETTINGS.recheck_rad / session.end.since(session.start).seconds(),
    );
    parameters.spin.rate = parameters.spin.rate.plus(faster);
    let own = strategy().parameters().spin.phase(start);
    let shift = own.plus(parameters.spin.phase(start).negated());
    parameters.spin.start = parameters.spin.start.plus(shift);
    let drifting = crate::scan::ScanStrategy::new(parameters).unwrap();
    assert!(end > start);
    let mut flight = Flight::new(&bytes);
    flight.run(later(session.start, -3600), later(session.start, -600));
    flight.scan = ScanEstimate::Strategy(&drifting);
    let check = flight.told(later(session.start, -600).tai_ns()).check;
    assert_ne!(check, super::Progress::Done);
}

fn tracker(sigma_rad: f64, epoch: Instant) -> Tracker {
    let settings = TrackerSettings {
        angle_sigmas_rad: [1e-9, 1e-9, sigma_rad],
        rate_sigmas: [0.0; 2],
        angle_walks: [0.0; 3],
        rate_walks: [0.0; 2],
        max_age: Duration::from_ns(60 * SECOND),
        max_lead: Duration::from_ns(SECOND),
        gate: 100.0,
        limits_rad: [0.1; 3],
    };
    Tracker::new(&strategy(), &settings, epoch).unwrap()
}

#[test]
// REQ-SEQ-8.
fn a_session_begins_only_while_its_times_are_known_well_enough() {
    let session = session();
    let bytes = Board::default().uplink(1, &[session]);
    let epoch = later(session.start, -3600);
    let flown = |settings: Settings, sigma_rad: f64| {
        let tracker = tracker(sigma_rad, epoch);
        let mut flight = Flight::with(settings, &bytes);
        flight.scan = ScanEstimate::Tracked(&tracker);
        fly(&mut flight, &session);
        (flight.started(), flight.skips())
    };
    // The spin turns by 5.2e-3 rad/s, the target crosses the edges at that rate or slower.
    assert_eq!(flown(SETTINGS, 1e-3), (1, vec![]));
    let (started, skips) = flown(SETTINGS, 1e-2);
    let [SkipReason::Uncertain(within)] = skips[..] else { panic!("{skips:?}") };
    assert_eq!(started, 0);
    let least_s = 1.96 * 1e-2 / 5.236e-3;
    assert!(within.seconds() > 0.9 * least_s && within.seconds() < 3.0 * least_s, "{within:?}");
    // It grows with the tolerance: exactly the tolerance is within it.
    assert_eq!(flown(Settings { tolerance: within, ..SETTINGS }, 1e-2).0, 1);
    let shorter = Duration::from_ns(within.ns() - 1_000);
    assert_eq!(flown(Settings { tolerance: shorter, ..SETTINGS }, 1e-2).0, 0);
}

/// A direction that the field of this tilt comes nearer to in one part of the session (setup,
/// calibrating, cooldown) than in the others and than the other field ever; and an angle between.
fn only_in(session: &SessionRecord, part: usize, tilt_rad: f64) -> (Direction<Ecliptic>, f64) {
    let other = TILT_RAD - tilt_rad;
    let angle_between = |it: &Direction<Ecliptic>| {
        let own = least_angles_rad(session, *it, tilt_rad);
        let parts = own.into_iter().enumerate().filter(|it| it.0 != part).map(|it| it.1);
        let rest = parts.chain(least_angles_rad(session, *it, other)).fold(9.0, f64::min);
        (rest - own[part] > 0.01).then_some((*it, 0.5 * (rest + own[part])))
    };
    beside_track(session, tilt_rad).iter().find_map(angle_between).expect("no such direction")
}

/// A direction that neither field comes near to.
pub(super) fn nowhere(session: &SessionRecord) -> Direction<Ecliptic> {
    let least = |it: Direction<Ecliptic>, tilt: f64| {
        least_angles_rad(session, it, tilt).into_iter().fold(9.0, f64::min)
    };
    let far = |it: &Direction<Ecliptic>| least(*it, 0.0) > 0.4 && least(*it, TILT_RAD) > 0.4;
    all_over().into_iter().find(far).expect("no such direction")
}

#[test]
// REQ-SEQ-6.
fn avoidance_counts_in_setup_calibrating_and_cooldown() {
    let session = session();
    for part in 0..3 {
        let (near, angle) = only_in(&session, part, 0.0);
        let board = Board { bodies: vec![near], limits: vec![(0, angle)], ..Board::default() };
        let bytes = board.uplink(1, &[session]);
        let mut flight = Flight::new(&bytes);
        fly(&mut flight, &session);
        assert_eq!(flight.skips(), [SkipReason::Avoidance(Board::number(0))], "part {part}");
    }
    let board =
        Board { bodies: vec![nowhere(&session)], limits: vec![(0, 0.2)], ..Board::default() };
    let bytes = board.uplink(1, &[session]);
    let mut flight = Flight::new(&bytes);
    fly(&mut flight, &session);
    assert_eq!((flight.started(), flight.skips(), flight.aborts()), (1, vec![], vec![]));
}

#[test]
// REQ-SEQ-6.
fn every_limit_counts_and_every_field_of_it() {
    let session = session();
    let (first, first_rad) = only_in(&session, 0, 0.0);
    let (second, second_rad) = only_in(&session, 2, TILT_RAD);
    let far = nowhere(&session);
    let (far, first, second) = ((far, 0.2), (first, first_rad), (second, second_rad));
    let reasons = |placed: Vec<(Direction<Ecliptic>, f64)>| {
        let bodies = placed.iter().map(|it| it.0).collect();
        let limits = placed.iter().map(|it| it.1).enumerate().collect();
        let board = Board { bodies, limits, detectors: true, ..Board::default() };
        let bytes = board.uplink(1, &[session]);
        let mut flight = Flight::new(&bytes);
        fly(&mut flight, &session);
        (flight.started(), flight.skips())
    };
    let avoided = |index| (0, vec![SkipReason::Avoidance(Board::number(index))]);
    assert_eq!(reasons(vec![far, far, far]), (1, vec![]));
    assert_eq!(reasons(vec![far, far, first]), avoided(2), "the last limit");
    assert_eq!(reasons(vec![second]), avoided(0), "the second field");
    assert_eq!(reasons(vec![far, second, far]), avoided(1), "both");
    // A limit that no field can keep.
    let board = Board { bodies: vec![far.0], limits: vec![(0, 3.1)], ..Board::default() };
    let bytes = board.uplink(1, &[session]);
    let mut flight = Flight::new(&bytes);
    fly(&mut flight, &session);
    assert_eq!(flight.skips(), [SkipReason::Avoidance(Board::number(0))]);
}

/// Checked on a strategy that keeps the limit, flown on the mission's, which does not: the angle of a
/// new check is large, so that the verdict stands.
fn watched(session: &SessionRecord, board: &Board) -> (usize, Vec<AbortReason>, Option<State>) {
    let bytes = board.uplink(1, &[*session]);
    let settings = Settings { recheck_rad: 4.0, ..SETTINGS };
    let free = Board { limits: vec![], ..board.clone() }.uplink(1, &[*session]);
    let mut flight = Flight::with(settings, &free);
    flight.run(later(session.start, -3600), later(session.start, -10));
    // The same plan with limits, taken as the tables that were checked.
    flight.sequencer.tables = Some({
        let tables = Tables::load(&bytes).unwrap();
        (tables.header().sequence, tables.set_digest())
    });
    flight.tables = Some(Tables::load(&bytes).unwrap());
    let mut at = later(session.start, -10);
    let mut before = None;
    while flight.aborts().is_empty() && at < later(session.end, 10) {
        before = Some(flight.sequencer.state());
        flight.tick(at);
        at = later(at, 1);
    }
    (flight.started(), flight.aborts(), before)
}

#[test]
// REQ-SEQ-9.
fn avoidance_is_watched_in_every_part_of_a_running_session() {
    let session = session();
    let avoided = vec![AbortReason::Avoidance(Board::number(0))];
    for part in 0..3 {
        let (near, angle) = only_in(&session, part, 0.0);
        let board = Board { bodies: vec![near], limits: vec![(0, angle)], ..Board::default() };
        let (started, aborts, before) = watched(&session, &board);
        assert_eq!((started, &aborts), (1, &avoided), "part {part}");
        match part {
            0 => assert!(matches!(before, Some(State::Setup(0) | State::Idle)), "{before:?}"),
            1 => {
                let seen = matches!(before, Some(State::Setup(0) | State::Calibrating(0)));
                assert!(seen, "{before:?}");
            }
            _ => {
                let seen = matches!(before, Some(State::Calibrating(0) | State::Cooldown(0)));
                assert!(seen, "{before:?}");
            }
        }
    }
    let far = Board {
        bodies: vec![nowhere(&session)],
        limits: vec![(0, 0.2)],
        detectors: true,
        ..Board::default()
    };
    let (started, aborts, _) = watched(&session, &far);
    assert_eq!((started, aborts), (1, vec![]));
}

#[test]
// REQ-SEQ-9.
fn every_limit_and_field_has_its_turn_in_the_watch() {
    let session = session();
    let (near, angle) = only_in(&session, 2, TILT_RAD);
    let far = nowhere(&session);
    // Twelve pairs at four looks a tick: the last limit's second field, then the first limit's.
    for place in [0, 5] {
        let mut bodies = vec![far; 6];
        bodies[place] = near;
        let limits = (0..6).map(|it| (it, angle)).collect();
        let (started, aborts, _) =
            watched(&session, &Board { bodies, limits, detectors: true, ..Board::default() });
        assert_eq!(
            (started, aborts),
            (1, vec![AbortReason::Avoidance(Board::number(place))]),
            "limit {place}"
        );
    }
}

#[test]
// REQ-SEQ-13.
fn the_watch_looks_at_no_more_than_its_bound() {
    let session = session();
    let far = nowhere(&session);
    let board =
        Board { bodies: vec![far], limits: vec![(0, 0.2); 9], detectors: true, ..Board::default() };
    let bytes = board.uplink(1, &[session]);
    let mut flight = Flight::new(&bytes);
    flight.run(later(session.start, -3600), session.start);
    let evaluations = flight.told(session.start.tai_ns()).evaluations;
    assert_eq!(evaluations, super::MAX_LOOKS_PER_TICK);
}

#[test]
// REQ-SEQ-5.
fn passes_may_differ_by_their_tolerance_only() {
    let session = session();
    let told = SessionRecord { passes: 3, ..session };
    let bytes = Board::default().uplink(1, &[told]);
    let started = |passes_tolerance: u16| {
        let mut flight = Flight::with(Settings { passes_tolerance, ..SETTINGS }, &bytes);
        fly(&mut flight, &session);
        (flight.started(), flight.skips())
    };
    assert_eq!(started(1), (0, vec![SkipReason::Passes(1)]));
    assert_eq!(started(2), (1, vec![]));
}
