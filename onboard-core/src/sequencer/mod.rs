//! What is to be done now: idle, setup, calibrating, cooldown, safe.
//!
//! A [`Sequencer`] carries out one telescope's sessions of the loaded plan. It is driven by
//! [`Sequencer::tick`], with the on-board counter, the clock correlation and the active tables, and
//! borrows nothing between two ticks. Sessions run at their planned times; each is checked
//! beforehand against the spacecraft's own prediction and the avoidance limits (`check.rs`) and
//! skipped with a reason when they disagree, or when the check could not be finished in time.
//!
//! Rules:
//! - Without a valid clock, or tables that are valid now, the state is safe. It is left only by
//!   [`Sequencer::resume`], ordered since it was entered, and only when both are there.
//! - Time that runs backwards by more than the longest gap between ticks leads to safe; by less, it
//!   stands still until the counter has caught up. A jump forwards by more than the longest gap
//!   gives up the running session and skips the sessions whose start it passed.
//! - Other tables give up the running session; sessions that began before them are not looked at.
//!
//! Work: one tick makes at most `steps_per_tick` steps of one search, hence at most
//! [`MAX_EVALUATIONS_PER_TICK`] evaluations, looks at no more than [`MAX_SESSIONS_PER_TICK`]
//! sessions, and emits at most that many events and five more.
//!
//! Limits: commands to instruments are the caller's, from the state and the events.

mod check;
mod event;

pub use event::{Event, EventQueue, Stamped};

use crate::clock::{ClockCorrelation, ClockError};
use crate::ephemeris::EphemerisError;
use crate::scan::ScanStrategy;
use crate::time::{Duration, Instant};
use crate::uplink::{SessionRecord, Tables};
use check::{Check, Ground};
use event::Log;

/// Most search steps in one tick.
pub const MAX_STEPS_PER_TICK: u16 = 8;
/// Most evaluations (Sun, target and phases at one instant) in one tick: those of its steps.
pub const MAX_EVALUATIONS_PER_TICK: u32 = 104;
/// Most sessions of the plan looked at in one tick.
pub const MAX_SESSIONS_PER_TICK: u32 = 32;

/// What the spacecraft does now; the number is the session's index in the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum State {
    /// Surveying; no session runs.
    Idle,
    /// Before the target's first entry.
    Setup(u32),
    /// Between first entry and last exit.
    Calibrating(u32),
    /// After the last exit.
    Cooldown(u32),
    /// Nothing is done until [`Sequencer::resume`].
    Safe(SafeReason),
}

/// Why the state is safe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SafeReason {
    /// [`Sequencer::stop`].
    Commanded,
    /// There is no clock correlation.
    NoClock,
    /// The clock correlation has no answer now.
    Clock(ClockError),
    /// Neither slot holds tables.
    NoTables,
    /// The tables' validity begins at this instant.
    TablesNotYetValid(Instant),
    /// The tables' validity ended at this instant.
    TablesExpired(Instant),
    /// The tables' mission does not have the sequencer's telescope.
    NoSuchTelescope,
    /// Time ran backwards by this much.
    TimeReversed(Duration),
}

/// Why a session is not begun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SkipReason {
    /// Its start had passed by more than the longest gap.
    Missed,
    /// Another session was still running at its start.
    Overlap,
    /// The prediction was not finished at its start.
    NotChecked,
    /// The prediction finds no pass.
    NoPass,
    /// The predicted first entry is off by this much; minus two tolerances stand for that or more.
    Entry(Duration),
    /// The predicted last exit is off by this much; two tolerances stand for that or more.
    Exit(Duration),
    /// The prediction finds this number of passes instead.
    Passes(u16),
    /// A field of view would come too close to this body during the session.
    Avoidance(i32),
    /// The tables have no answer.
    Ephemeris(EphemerisError),
}

/// Why a running session is given up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AbortReason {
    /// The state became safe.
    Safe,
    /// Other tables were loaded.
    Tables,
    /// Time moved on by more than the longest gap.
    TimeJumped,
}

/// How a sequencer behaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Index of its telescope in the mission section.
    pub telescope: u16,
    /// How far predicted and planned first entry and last exit may differ.
    pub tolerance: Duration,
    /// How far predicted and planned number of passes may differ.
    pub passes_tolerance: u16,
    /// Longest time between two ticks, and latest start of a session after its planned one.
    pub longest_gap: Duration,
    /// How long before its start a session is checked.
    pub check_ahead: Duration,
    /// Search steps per tick, 1 to [`MAX_STEPS_PER_TICK`].
    pub steps_per_tick: u16,
}

/// Which setting is illegal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SettingsError {
    /// The tolerance is negative.
    Tolerance(Duration),
    /// The longest gap is not above zero.
    LongestGap(Duration),
    /// Sessions are checked less than the longest gap ahead.
    CheckAhead(Duration),
    /// The steps per tick are zero or too many.
    StepsPerTick(u16),
}

/// What a tick is given.
#[derive(Debug, Clone, Copy)]
pub struct Situation<'t, 'a> {
    /// The on-board counter.
    pub ticks: u64,
    /// The clock correlation, if there is one.
    pub clock: Option<&'t ClockCorrelation>,
    /// The active tables, if there are any.
    pub tables: Option<&'t Tables<'a>>,
    /// The strategy as measured attitudes have corrected it; `None` takes the mission section's.
    pub strategy: Option<&'t ScanStrategy>,
}

/// What a tick brought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tick {
    /// The state now.
    pub state: State,
    /// Evaluations made.
    pub evaluations: u32,
}

/// One telescope's sessions, carried out.
#[derive(Debug, Clone)]
pub struct Sequencer {
    settings: Settings,
    state: State,
    running: Option<(u32, SessionRecord)>,
    /// Index of the next session to look at.
    next: u32,
    /// The check of that session.
    check: Check,
    /// Sequence number and digest of the tables that `next` belongs to.
    tables: Option<(u32, u64)>,
    last: Option<Instant>,
    resume: bool,
    stop: bool,
}

impl Sequencer {
    /// A sequencer that is idle.
    ///
    /// # Errors
    /// [`SettingsError`] names the setting that is illegal.
    pub const fn new(settings: Settings) -> Result<Self, SettingsError> {
        if settings.tolerance.ns() < 0 {
            return Err(SettingsError::Tolerance(settings.tolerance));
        }
        if settings.longest_gap.ns() <= 0 {
            return Err(SettingsError::LongestGap(settings.longest_gap));
        }
        if settings.check_ahead.ns() < settings.longest_gap.ns() {
            return Err(SettingsError::CheckAhead(settings.check_ahead));
        }
        if settings.steps_per_tick == 0 || settings.steps_per_tick > MAX_STEPS_PER_TICK {
            return Err(SettingsError::StepsPerTick(settings.steps_per_tick));
        }
        Ok(Self {
            settings,
            state: State::Idle,
            running: None,
            next: 0,
            check: Check::WAITING,
            tables: None,
            last: None,
            resume: false,
            stop: false,
        })
    }

    /// What the spacecraft does now.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// Orders safe at the next tick.
    pub const fn stop(&mut self) {
        self.stop = true;
        self.resume = false;
    }

    /// Orders safe to be left at the next tick that has a valid clock and valid tables.
    pub const fn resume(&mut self) {
        self.resume = true;
        self.stop = false;
    }

    /// Moves on to the time of the on-board counter.
    pub fn tick<const N: usize>(
        &mut self,
        situation: &Situation<'_, '_>,
        events: &mut EventQueue<N>,
    ) -> Tick {
        self.move_on(situation, &mut events.log(situation.ticks))
    }

    #[inline(never)]
    fn move_on(&mut self, situation: &Situation<'_, '_>, log: &mut Log<'_>) -> Tick {
        let mut evaluations = 0;
        match self.conditions(situation) {
            Err(reason) => self.enter_safe(reason, log),
            Ok((now, tables)) => {
                if matches!(self.state, State::Safe(_)) && self.resume {
                    self.resume = false;
                    self.tables = None;
                    self.last = None;
                    self.enter(State::Idle, log);
                }
                if matches!(self.state, State::Safe(_)) {
                    self.last = Some(now);
                } else {
                    self.follow_time(now, log);
                    self.follow_tables(now, tables, log);
                    self.follow_session(now, log);
                    if let Some(session) = self.look_ahead(now, tables, log) {
                        evaluations = self.look_into(&session, tables, situation.strategy);
                    }
                    self.follow_session(now, log);
                }
            }
        }
        Tick { state: self.state, evaluations }
    }

    /// The time and the tables, when both may be acted on.
    #[inline(never)]
    fn conditions<'t, 'a>(
        &mut self,
        situation: &Situation<'t, 'a>,
    ) -> Result<(Instant, &'t Tables<'a>), SafeReason> {
        if self.stop {
            self.stop = false;
            return Err(SafeReason::Commanded);
        }
        let clock = situation.clock.ok_or(SafeReason::NoClock)?;
        let now = clock.instant(situation.ticks).map_err(SafeReason::Clock)?;
        let tables = situation.tables.ok_or(SafeReason::NoTables)?;
        let header = tables.header();
        if now < header.valid_from {
            return Err(SafeReason::TablesNotYetValid(header.valid_from));
        }
        if now > header.valid_until {
            return Err(SafeReason::TablesExpired(header.valid_until));
        }
        if tables.mission().telescope(self.settings.telescope).is_none() {
            return Err(SafeReason::NoSuchTelescope);
        }
        let Some(last) = self.last else { return Ok((now, tables)) };
        let back = last.since(now);
        if back > self.settings.longest_gap && !matches!(self.state, State::Safe(_)) {
            self.last = Some(now);
            return Err(SafeReason::TimeReversed(back));
        }
        let safe = matches!(self.state, State::Safe(_));
        Ok((if safe { now } else { now.max(last) }, tables))
    }

    fn enter(&mut self, state: State, log: &mut Log<'_>) {
        if state != self.state {
            self.state = state;
            log.add(Event::Entered(state));
        }
    }

    #[inline(never)]
    fn enter_safe(&mut self, reason: SafeReason, log: &mut Log<'_>) {
        if matches!(self.state, State::Safe(_)) {
            return;
        }
        // An order from before does not lead out of what it could not know.
        self.resume = false;
        self.abort(AbortReason::Safe, log);
        log.add(Event::Safe(reason));
        self.enter(State::Safe(reason), log);
    }

    fn abort(&mut self, reason: AbortReason, log: &mut Log<'_>) {
        if let Some((index, _)) = self.running.take() {
            log.add(Event::Aborted(index, reason));
        }
    }

    #[inline(never)]
    fn follow_time(&mut self, now: Instant, log: &mut Log<'_>) {
        if let Some(from) = self.last
            && now.since(from) > self.settings.longest_gap
        {
            log.add(Event::TimeJumped { from, to: now });
            if self.running.is_some() {
                self.abort(AbortReason::TimeJumped, log);
                self.enter(State::Idle, log);
            }
        }
        self.last = Some(now);
    }

    /// Starts over where other tables are in use.
    #[inline(never)]
    fn follow_tables(&mut self, now: Instant, tables: &Tables<'_>, log: &mut Log<'_>) {
        let own = Some((tables.header().sequence, tables.set_digest()));
        if self.tables == own {
            return;
        }
        if self.running.is_some() {
            self.abort(AbortReason::Tables, log);
            self.enter(State::Idle, log);
        }
        log.add(Event::Tables(tables.header().sequence));
        self.tables = own;
        self.check.reset();
        self.next = tables.plan().first_from(now);
    }

    /// The running session's state at this time.
    #[inline(never)]
    fn follow_session(&mut self, now: Instant, log: &mut Log<'_>) {
        let Some((index, session)) = self.running else { return };
        let state = if now >= session.end {
            self.running = None;
            log.add(Event::Ended(index));
            State::Idle
        } else if now >= session.last_exit {
            State::Cooldown(index)
        } else if now >= session.first_entry {
            State::Calibrating(index)
        } else {
            State::Setup(index)
        };
        self.enter(state, log);
    }

    /// Begins or skips sessions that are due; the next one, when it is time to check it.
    #[inline(never)]
    fn look_ahead(
        &mut self,
        now: Instant,
        tables: &Tables<'_>,
        log: &mut Log<'_>,
    ) -> Option<SessionRecord> {
        for _ in 0..MAX_SESSIONS_PER_TICK {
            let session = tables.plan().session(self.next)?;
            if session.telescope == self.settings.telescope {
                let ahead = session.start.since(now);
                if ahead > self.settings.check_ahead {
                    return None;
                }
                if ahead > Duration::ZERO {
                    return Some(session);
                }
                match self.due(&session, now) {
                    Ok(()) => {
                        log.add(Event::Started(self.next, session));
                        self.running = Some((self.next, session));
                    }
                    Err(reason) => log.add(Event::Skipped(self.next, reason)),
                }
                self.check.reset();
            }
            self.next = self.next.saturating_add(1);
        }
        None
    }

    /// A piece of the next session's check; returns the evaluations made.
    fn look_into(
        &mut self,
        session: &SessionRecord,
        tables: &Tables<'_>,
        strategy: Option<&ScanStrategy>,
    ) -> u32 {
        self.check.start(strategy, tables);
        self.check.advance(&Ground { session, tables, settings: &self.settings })
    }

    /// Whether a session whose start has come may begin.
    fn due(&self, session: &SessionRecord, now: Instant) -> Result<(), SkipReason> {
        if now.since(session.start) > self.settings.longest_gap {
            return Err(SkipReason::Missed);
        }
        if self.running.is_some() {
            return Err(SkipReason::Overlap);
        }
        self.check.verdict().unwrap_or(Err(SkipReason::NotChecked))
    }
}
