//! What is to be done now: idle, setup, calibrating, cooldown, safe.
//!
//! A [`Sequencer`] carries out one telescope's sessions of the loaded plan. It is driven by
//! [`Sequencer::tick`], with the on-board counter, the clock correlation, the active tables and the
//! scan as it is known, and borrows nothing between two ticks. Sessions run at their planned times;
//! each is checked beforehand against the spacecraft's own prediction and the avoidance limits
//! (`check.rs`) and skipped with a reason when they disagree, or when the check could not be finished
//! in time.
//!
//! Rules:
//! - A new sequencer is safe. Without a valid clock of the tables' spacecraft, or sound tables that are
//!   valid now, the state is safe. It is left only by [`Sequencer::resume`], ordered since it was entered, and only when both
//!   are there.
//! - Time that runs backwards by more than the longest gap between ticks leads to safe; by less, it
//!   stands still until the counter has caught up. A jump forwards by more than the longest gap
//!   gives up the running session and skips the sessions whose start it passed.
//! - Other tables give up the running session; sessions that began before them are not looked at.
//! - A verdict holds for the tables and the strategy it was made with: where the strategy turns the
//!   attitude of the session's start or end by more than a setting, the session is checked again. A
//!   session begins only while the predicted times are known within the tolerance.
//! - Avoidance is watched while a session runs (`watch.rs`); a violation gives it up.
//!
//! Work: one tick makes at most `steps_per_tick` steps of one search and [`MAX_LOOKS_PER_TICK`]
//! looks, hence at most [`MAX_EVALUATIONS_PER_TICK`] evaluations, looks at no more than
//! [`MAX_SESSIONS_PER_TICK`] sessions, and emits at most that many events and [`MAX_OTHER_EVENTS_PER_TICK`] more.
//!
//! Limits: commands to instruments are the caller's, from the state and the events.

mod reason;
mod check;
mod settings;
mod estimate;
mod watch;
mod event;
#[cfg(test)]
mod trial;
#[cfg(test)]
mod rules;
#[cfg(test)]
mod table_rules;

pub use check::{MAX_STEPS_PER_TICK, Question, SessionCheck};
pub use estimate::ScanEstimate;
pub use event::{Event, EventKind, EventQueue, Lost, Stamped};
pub use reason::{AbortReason, SafeReason, SkipReason, State};
pub use settings::{Settings, SettingsError};
pub use watch::MAX_LOOKS_PER_TICK;

use crate::clock::{ClockCorrelation, ClockError};
use crate::scan::ScanStrategy;
use crate::time::{Duration, Instant};
use crate::uplink::{SessionRecord, Tables};
use estimate::turned_rad;
use event::Log;
use watch::Watch;

/// Most evaluations (Sun, body and phases at one instant) in one tick: those of its steps and looks.
pub const MAX_EVALUATIONS_PER_TICK: u32 = 108;
/// Most sessions of the plan looked at in one tick.
pub const MAX_SESSIONS_PER_TICK: u32 = 32;
/// Most events of one tick beside those of the sessions looked at.
pub const MAX_OTHER_EVENTS_PER_TICK: u32 = 5;

/// What a tick is given.
#[derive(Debug, Clone, Copy)]
pub struct Situation<'t, 'a> {
    /// The on-board counter.
    pub ticks: u64,
    /// The clock correlation, if there is one.
    pub clock: Option<&'t ClockCorrelation>,
    /// The active tables, if there are any.
    pub tables: Option<&'t Tables<'a>>,
    /// The active tables' bytes were found damaged after they had been loaded.
    pub tables_damaged: bool,
    /// The scan as it is known.
    pub scan: ScanEstimate<'t>,
}

/// What a tick brought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tick {
    /// The state now.
    pub state: State,
    /// Evaluations made.
    pub evaluations: u32,
    /// How far the check of the next session has come.
    pub check: Progress,
}

/// How far the check of the next session has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// No session is near enough to be checked, or none was reached yet.
    Waiting,
    /// It goes on at the next tick.
    UnderWay,
    /// Its outcome is known.
    Done,
}

/// What is ordered and not yet carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    Stop,
    Resume,
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
    check: SessionCheck,
    /// Whether it is made with the mission section's strategy.
    of_mission: bool,
    watch: Watch,
    /// Sequence number and digest of the tables that `next` belongs to.
    tables: Option<(u32, u64)>,
    last: Option<Instant>,
    order: Option<Order>,
    /// Whether the first tick has reported that the state is safe.
    booted: bool,
}

impl Sequencer {
    /// A sequencer that is safe, until [`Self::resume`].
    ///
    /// # Errors
    /// [`SettingsError`] names the setting that is illegal.
    pub const fn new(settings: Settings) -> Result<Self, SettingsError> {
        if let Err(error) = settings.check() {
            return Err(error);
        }
        Ok(Self {
            settings,
            state: State::Safe(SafeReason::Boot),
            running: None,
            next: 0,
            check: SessionCheck::waiting(),
            of_mission: true,
            watch: Watch::FIRST,
            tables: None,
            last: None,
            order: None,
            booted: false,
        })
    }

    /// What the spacecraft does now.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// Orders safe at the next tick.
    pub const fn stop(&mut self) {
        self.order = Some(Order::Stop);
    }

    /// Orders safe to be left at the next tick that has a valid clock and valid tables.
    // REQ-SEQ-1.
    pub const fn resume(&mut self) {
        self.order = Some(Order::Resume);
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
        let mut evaluations = 0_u32;
        if !self.booted {
            self.booted = true;
            log.add(Event::Safe(SafeReason::Boot));
        }
        match self.conditions(situation) {
            Err(reason) => self.enter_safe(reason, log),
            Ok((now, tables)) => {
                if matches!(self.state, State::Safe(_)) && self.order == Some(Order::Resume) {
                    self.order = None;
                    self.tables = None;
                    self.last = None;
                    self.enter(State::Idle, log);
                }
                if matches!(self.state, State::Safe(_)) {
                    self.last = Some(now);
                } else {
                    self.follow_time(now, log);
                    self.follow_tables(now, tables, log);
                    self.follow_strategy(&situation.scan, tables);
                    self.follow_session(now, log);
                    if let Some(session) = &self.look_ahead(now, (tables, &situation.scan), log) {
                        evaluations = self.look_into(session, tables, &situation.scan);
                    }
                    self.follow_session(now, log);
                    let looks = self.follow_avoidance(now, tables, &situation.scan, log);
                    evaluations = evaluations.saturating_add(looks);
                }
            }
        }
        let check = match self.check.verdict() {
            Some(_) => Progress::Done,
            None if self.check.is_waiting() => Progress::Waiting,
            None => Progress::UnderWay,
        };
        Tick { state: self.state, evaluations, check }
    }

    /// The time and the tables, when both may be acted on.
    #[inline(never)]
    // REQ-SEQ-2.
    fn conditions<'t, 'a>(
        &mut self,
        situation: &Situation<'t, 'a>,
    ) -> Result<(Instant, &'t Tables<'a>), SafeReason> {
        if self.order == Some(Order::Stop) {
            self.order = None;
            return Err(SafeReason::Commanded);
        }
        let clock = situation.clock.ok_or(SafeReason::NoClock)?;
        if let Some(tables) = situation.tables
            && clock.spacecraft != tables.header().spacecraft
        {
            let flown = tables.header().spacecraft;
            let other = ClockError::OtherSpacecraft { record: clock.spacecraft, flown };
            return Err(SafeReason::Clock(other));
        }
        let now = clock.instant(situation.ticks).map_err(SafeReason::Clock)?;
        let tables = situation.tables.ok_or(SafeReason::NoTables)?;
        if situation.tables_damaged {
            return Err(SafeReason::TablesDamaged);
        }
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
        self.order = None;
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
    // REQ-SEQ-3.
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
    // REQ-SEQ-7.
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

    /// Forgets the check of the next session where the strategy has turned away from its own.
    #[inline(never)]
    // REQ-SEQ-7.
    fn follow_strategy(&mut self, scan: &ScanEstimate<'_>, tables: &Tables<'_>) {
        if self.check.is_waiting() {
            return;
        }
        match scan.strategy() {
            Some(strategy) => self.compare_strategy(strategy, tables),
            None if self.of_mission => {}
            None => self.compare_strategy(&tables.mission().strategy(), tables),
        }
    }

    #[inline(never)]
    fn compare_strategy(&mut self, strategy: &ScanStrategy, tables: &Tables<'_>) {
        let own = self.check.strategy();
        if strategy.parameters() == own.parameters() {
            return;
        }
        let Some(session) = tables.plan().session(self.next) else { return };
        let turned = |at| turned_rad(own, strategy, at) > self.settings.recheck_rad;
        if turned(session.start) || turned(session.end) {
            self.check.reset();
        }
    }

    /// Gives the running session up where a field is too close to a body; returns the looks made.
    #[inline(never)]
    // REQ-SEQ-9.
    fn follow_avoidance(
        &mut self,
        now: Instant,
        tables: &Tables<'_>,
        scan: &ScanEstimate<'_>,
        log: &mut Log<'_>,
    ) -> u32 {
        if self.running.is_none() {
            return 0;
        }
        let telescope = self.settings.telescope;
        let (looks, violation) = match scan.strategy() {
            Some(strategy) => self.watch.look(strategy, tables, telescope, now),
            None => self.watch.look(&tables.mission().strategy(), tables, telescope, now),
        };
        if let Some(reason) = violation {
            self.abort(reason, log);
            self.enter(State::Idle, log);
        }
        looks
    }

    /// The running session's state at this time.
    #[inline(never)]
    // REQ-SEQ-10.
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
    // REQ-SEQ-13.
    fn look_ahead(
        &mut self,
        now: Instant,
        (tables, scan): (&Tables<'_>, &ScanEstimate<'_>),
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
                match self.due(&session, scan, now) {
                    Ok(()) => {
                        log.add(Event::Started(self.next, session));
                        self.running = Some((self.next, session));
                        self.watch = Watch::FIRST;
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
        scan: &ScanEstimate<'_>,
    ) -> u32 {
        self.begin_check(tables, scan);
        let header = tables.header();
        let question = Question {
            session,
            mission: tables.mission(),
            ephemeris: tables.ephemeris(),
            validity: (header.valid_from, header.valid_until),
            tolerance: self.settings.tolerance,
            passes_tolerance: self.settings.passes_tolerance,
        };
        self.check.advance(&question, self.settings.steps_per_tick)
    }

    /// Begins the check, unless it has begun; apart, so that its strategy lies below no evaluation.
    #[inline(never)]
    fn begin_check(&mut self, tables: &Tables<'_>, scan: &ScanEstimate<'_>) {
        if self.check.is_waiting() {
            match scan.strategy() {
                Some(strategy) => self.check.start(strategy),
                None => self.check.start(&tables.mission().strategy()),
            }
            self.of_mission = scan.strategy().is_none();
        }
    }

    /// Whether a session whose start has come may begin.
    #[inline(never)]
    // REQ-SEQ-4.
    fn due(
        &self,
        session: &SessionRecord,
        scan: &ScanEstimate<'_>,
        now: Instant,
    ) -> Result<(), SkipReason> {
        if now.since(session.start) > self.settings.longest_gap {
            return Err(SkipReason::Missed);
        }
        if self.running.is_some() {
            return Err(SkipReason::Overlap);
        }
        self.check.verdict().unwrap_or(Err(SkipReason::NotChecked))?;
        let uncertainty = self.check.uncertainty(scan);
        if uncertainty > self.settings.tolerance {
            return Err(SkipReason::Uncertain(uncertainty));
        }
        Ok(())
    }
}
