//! A plan carried out by the flight core's sequencer, in a simulated clock.
//!
//! Method: the container's own bytes, one sequencer per telescope, ticks [`TICK`] apart from the first
//! tick after the validity's start. While nothing is near, whole ticks are left out: the sequencer
//! does nothing in them. The scan is the mission section's, and exact.
//!
//! Limits: of a telescope with so many detectors, or sessions of so many passes, that a check takes longer
//! than [`AHEAD`], the checks are given the time that they need; whoever flies it must choose `check_ahead`
//! accordingly ([`longest_checks`]).

use super::judge::{TOLERANCE, ticks};
use onboard_core::clock::ClockCorrelation;
use onboard_core::sequencer::{
    AbortReason, Event, EventQueue, MAX_STEPS_PER_TICK, Progress, ScanEstimate, Sequencer,
    Settings, SettingsError, Situation, SkipReason, State,
};
use onboard_core::time::{Duration, Instant};
use onboard_core::uplink::{SessionRecord, Tables};
use rayon::prelude::*;

/// Time between two ticks: a spacecraft that ticks as often or more often checks what is checked here.
pub const TICK: Duration = Duration::from_ns(20_000_000_000);
/// How long before its start a session is checked.
pub const AHEAD: Duration = Duration::from_ns(3_600_000_000_000);
/// Angle in radians of a new check; the strategy does not change.
const RECHECK_RAD: f64 = 1e-6;

/// Why a planned session was not carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NotFlown {
    /// It was not begun.
    Skipped(SkipReason),
    /// It was given up.
    Aborted(AbortReason),
}

/// The sessions (their index in the plan) that the spacecraft would not carry out, by index.
///
/// # Errors
/// [`SettingsError`]: none, the settings are legal.
pub fn fly(tables: &Tables<'_>) -> Result<Vec<(u32, NotFlown)>, SettingsError> {
    let mut by_telescope: Vec<Vec<(u32, SessionRecord)>> = Vec::new();
    for (index, session) in (0_u32..).zip(tables.plan().sessions()) {
        let telescope = usize::from(session.telescope);
        if by_telescope.len() <= telescope {
            by_telescope.resize_with(telescope + 1, Vec::new);
        }
        by_telescope[telescope].push((index, session));
    }
    let flights: Result<Vec<_>, SettingsError> = by_telescope
        .par_iter()
        .filter_map(|sessions| Some((sessions.first()?.1.telescope, sessions)))
        .map(|(telescope, sessions)| Ok(Flight::new(tables, telescope, sessions)?.fly(sessions)))
        .collect();
    let mut all = flights?.concat();
    all.sort_by_key(|it| it.0);
    Ok(all)
}

struct Flight<'t, 'a> {
    tables: &'t Tables<'a>,
    sequencer: Sequencer,
    events: EventQueue<64>,
    clock: ClockCorrelation,
    /// Whether checks are given the time that they need.
    unhurried: bool,
    /// Whether each session was started, and what else befell it.
    started: Vec<u32>,
    not_flown: Vec<(u32, NotFlown)>,
}

impl<'t, 'a> Flight<'t, 'a> {
    fn new(
        tables: &'t Tables<'a>,
        telescope: u16,
        sessions: &[(u32, SessionRecord)],
    ) -> Result<Self, SettingsError> {
        let header = tables.header();
        let clock = ClockCorrelation {
            spacecraft: header.spacecraft,
            sequence: 1,
            uncertainty_ns: 0,
            ticks: 0,
            at: header.valid_from,
            tick_bits: ClockCorrelation::tick_of(1, 0),
            valid_from: header.valid_from,
            valid_until: header.valid_until,
        };
        let settings = Settings {
            telescope,
            tolerance: TOLERANCE,
            passes_tolerance: 0,
            longest_gap: AHEAD,
            check_ahead: AHEAD,
            recheck_rad: RECHECK_RAD,
            steps_per_tick: MAX_STEPS_PER_TICK,
        };
        let mut sequencer = Sequencer::new(settings)?;
        sequencer.resume();
        let checked = checked(tables, sessions.iter().map(|it| &it.1));
        let unhurried = least_ticks(tables, telescope).max(checked) > AHEAD.ns() / TICK.ns();
        let (events, started, not_flown) = (EventQueue::new(), Vec::new(), Vec::new());
        Ok(Self { tables, sequencer, events, clock, unhurried, started, not_flown })
    }

    fn fly(mut self, sessions: &[(u32, SessionRecord)]) -> Vec<(u32, NotFlown)> {
        let header = self.tables.header();
        let mut now = header.valid_from.plus(TICK);
        // What starts before the first tick is not looked at.
        let mut next = sessions.partition_point(|(_, it)| it.start < now);
        while next < sessions.len() && now <= header.valid_until {
            let mut check = self.tick(now);
            while self.unhurried && check == Progress::UnderWay && !self.is_safe() {
                check = self.tick(now);
            }
            next += sessions[next..].partition_point(|(_, it)| it.start <= now);
            let Some((_, session)) = sessions.get(next) else { break };
            let near = session.start.plus(Duration::from_ns(-AHEAD.ns()));
            let until = match check {
                Progress::Done => session.start,
                Progress::Waiting if now < near => near,
                Progress::Waiting | Progress::UnderWay => now.plus(TICK),
            };
            now = self.following(now, until);
        }
        let begun = |index: &u32| self.started.binary_search(index).is_ok();
        let told: Vec<u32> = self.not_flown.iter().map(|it| it.0).collect();
        let unseen = sessions.iter().map(|it| it.0).filter(|it| !begun(it) && !told.contains(it));
        let unseen: Vec<_> =
            unseen.map(|it| (it, NotFlown::Skipped(SkipReason::NotChecked))).collect();
        self.not_flown.extend(unseen);
        self.not_flown
    }

    /// The first tick at or after `until`; no running session is left alone for the longest gap.
    fn following(&self, now: Instant, until: Instant) -> Instant {
        let running = self.sequencer.state() != State::Idle;
        let ahead = until.since(now).ns();
        let ahead = if running { ahead.min(AHEAD.ns()) } else { ahead };
        let ticks = (ahead + TICK.ns() - 1).div_euclid(TICK.ns()).max(1);
        now.plus(Duration::from_ns(ticks * TICK.ns()))
    }

    /// Whether nothing goes on, a check neither.
    const fn is_safe(&self) -> bool {
        matches!(self.sequencer.state(), State::Safe(_))
    }

    fn tick(&mut self, now: Instant) -> Progress {
        let ns = now.since(self.clock.at).ns();
        let situation = Situation {
            ticks: u64::try_from(ns).unwrap_or(0),
            clock: Some(&self.clock),
            tables: Some(self.tables),
            tables_damaged: false,
            scan: ScanEstimate::Mission,
        };
        let tick = self.sequencer.tick(&situation, &mut self.events);
        while let Some(stamped) = self.events.pop() {
            match stamped.event {
                Event::Started(index, _) => self.started.push(index),
                Event::Skipped(index, reason) => {
                    self.not_flown.push((index, NotFlown::Skipped(reason)));
                }
                Event::Aborted(index, reason) => {
                    self.not_flown.push((index, NotFlown::Aborted(reason)));
                }
                _ => {}
            }
        }
        tick.check
    }
}

/// Ticks that the check of the session with most passes takes.
fn checked<'s>(tables: &Tables<'_>, sessions: impl Iterator<Item = &'s SessionRecord>) -> i64 {
    let most = sessions.max_by_key(|it| (it.passes, it.last_exit.since(it.first_entry).ns()));
    most.map_or(0, |it| ticks(tables, it).into())
}

/// Telescopes of which the check of the session with most passes takes longer than [`AHEAD`], and the ticks
/// that it takes.
#[must_use]
pub fn longest_checks(tables: &Tables<'_>) -> Vec<(u16, i64)> {
    let sessions: Vec<SessionRecord> = tables.plan().sessions().collect();
    let mut telescopes: Vec<u16> = sessions.iter().map(|it| it.telescope).collect();
    telescopes.sort_unstable();
    telescopes.dedup();
    let of_one = |telescope| {
        let own = sessions.iter().filter(move |it| it.telescope == telescope);
        (telescope, checked(tables, own))
    };
    telescopes.into_iter().map(of_one).filter(|it| it.1 > AHEAD.ns() / TICK.ns()).collect()
}

/// Fewest ticks of a check: one to lay out each search, one to make it.
fn least_ticks(tables: &Tables<'_>, telescope: u16) -> i64 {
    let mission = tables.mission();
    let fields = (0_u16..).take_while(|it| mission.calibration_field(telescope, *it).is_some());
    let searches = 1 + mission.avoidance().count();
    i64::try_from(2 * searches * fields.count()).unwrap_or(i64::MAX)
}
