//! Which opportunities are allowed sessions.
//!
//! Method: the flight core's [`SessionCheck`], the same that the sequencer takes a piece of per tick,
//! driven to its end on the mission section and the ephemeris table that go on board. The session is
//! the reserved time, setup and cooldown included.
//!
//! Limits: the sequencer also needs time to check; [`Judge::ticks`] says how much.

use super::section::TooMany;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::scan::ScanStrategy;
use onboard_core::sequencer::{MAX_STEPS_PER_TICK, Question, SessionCheck, SkipReason};
use onboard_core::time::{Duration, Instant};
use onboard_core::uplink::{MissionError, MissionTable, SessionRecord, Tables};
use thiserror::Error;

/// Why nothing can be judged.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum JudgeError {
    /// The mission cannot go on board.
    #[error(transparent)]
    TooMany(#[from] TooMany),
    /// The flight core refuses the mission section.
    #[error("the flight core refuses the mission: {0:?}")]
    Mission(MissionError),
}

/// The mission and the ephemeris as they go on board.
#[derive(Debug)]
pub struct Judge<'t> {
    mission: MissionTable<'t>,
    ephemeris: EphemerisTable<'t>,
    strategy: ScanStrategy,
    validity: (Instant, Instant),
}

impl<'t> Judge<'t> {
    /// A judge on the bytes of a [`mission_section`](super::mission_section) and the fitted table.
    ///
    /// # Errors
    /// [`JudgeError::Mission`].
    pub fn new(
        section: &'t [u8],
        ephemeris: EphemerisTable<'t>,
        validity: (Instant, Instant),
    ) -> Result<Self, JudgeError> {
        let mission = MissionTable::parse(section).map_err(JudgeError::Mission)?;
        Ok(Self { mission, ephemeris, strategy: mission.strategy(), validity })
    }

    /// Whether a session keeps all avoidance limits.
    ///
    /// # Errors
    /// [`SkipReason`]: why the spacecraft would not begin it.
    pub fn avoidance(&self, session: &SessionRecord) -> Result<(), SkipReason> {
        let mut check = SessionCheck::WAITING;
        check.start_with_avoidance(&self.strategy);
        self.decide(check, session).0
    }

    /// Ticks that the sequencer takes to check a session.
    #[must_use]
    pub fn ticks(&self, session: &SessionRecord) -> u32 {
        let mut check = SessionCheck::WAITING;
        check.start(&self.strategy);
        self.decide(check, session).1
    }

    fn decide(
        &self,
        mut check: SessionCheck,
        session: &SessionRecord,
    ) -> (Result<(), SkipReason>, u32) {
        let question = Question {
            session,
            mission: &self.mission,
            ephemeris: self.ephemeris,
            validity: self.validity,
            tolerance: TOLERANCE,
            passes_tolerance: 0,
        };
        let verdict = decide(&mut check, &question);
        (verdict, check.pieces())
    }
}

fn decide(check: &mut SessionCheck, question: &Question<'_, '_>) -> Result<(), SkipReason> {
    loop {
        if let Some(verdict) = check.verdict() {
            return verdict;
        }
        check.advance(question, MAX_STEPS_PER_TICK);
    }
}

/// Ticks that the sequencer takes to check a session of the tables on board.
pub(super) fn ticks(tables: &Tables<'_>, session: &SessionRecord) -> u32 {
    let mission = tables.mission();
    let header = tables.header();
    let question = Question {
        session,
        mission,
        ephemeris: tables.ephemeris(),
        validity: (header.valid_from, header.valid_until),
        tolerance: TOLERANCE,
        passes_tolerance: 0,
    };
    let mut check = SessionCheck::WAITING;
    check.start(&mission.strategy());
    let _ = decide(&mut check, &question);
    check.pieces()
}

/// How far the spacecraft's first entry and last exit may differ from the plan's, which are made of
/// the same tables by the same search.
pub(super) const TOLERANCE: Duration = Duration::from_ns(1_000_000);
