//! Is a planned session allowed: the one definition, for the spacecraft and for the plan.
//!
//! A [`SessionCheck`] first searches the session's target through every field that calibrates the
//! telescope, from two tolerances before the planned first entry to two after the planned last exit:
//! first entry, last exit and number of passes must be the plan's. Then, for every avoidance limit and
//! every such field, it searches the whole session, setup and cooldown included, for an instant at
//! which the body is nearer than the limit to the nearest point of the field.
//!
//! It goes on a bounded piece at a time and borrows nothing between two pieces: the sequencer takes
//! one per tick, the planner one after the other, both on the same bytes of mission and ephemeris.
//!
//! Method: certified searches (`transit/search.rs`). An edge moves by `slope . dx` for errors dx of
//! precession phase, alpha and spin phase; the slopes of the first entry and of the last exit stay, so
//! that any covariance gives their standard deviations at once.
//!
//! Limits: an outcome holds for the strategy that the check began with. Violations shallower than
//! [`SEPARATION_TOLERANCE_RAD`](crate::transit::SEPARATION_TOLERANCE_RAD) may go either way. What is
//! decided is the session by itself: overlaps and the time for the check are the sequencer's.

use super::estimate::ScanEstimate;
use super::reason::SkipReason;
use crate::convert::uncounted;
use crate::ephemeris::{EphemerisError, EphemerisTable};
use crate::field_of_view::FieldOfView;
use crate::scan::ScanStrategy;
use crate::time::{Duration, Instant};
use crate::transit::{Lookup, Search, Seen, Transit};
use crate::uncertainty::ScanCovariance;
use crate::uplink::{MissionTable, SessionRecord};

/// Most search steps in one piece.
pub const MAX_STEPS_PER_TICK: u16 = 8;
/// Standard deviations that hold 95 % of a normal distribution between them.
const TWO_SIDED_95: f64 = 1.959_963_984_540_054;

/// What is to be decided, and on what; the same for every piece of a check.
#[derive(Debug, Clone, Copy)]
pub struct Question<'t, 'a> {
    /// The session.
    pub session: &'t SessionRecord,
    /// Sun model, fields and avoidance limits.
    pub mission: &'t MissionTable<'a>,
    /// Directions of the target, the Sun and the bodies to avoid.
    pub ephemeris: EphemerisTable<'a>,
    /// First and last instant that the tables are valid at.
    pub validity: (Instant, Instant),
    /// How far predicted and planned first entry and last exit may differ.
    pub tolerance: Duration,
    /// How far predicted and planned number of passes may differ.
    pub passes_tolerance: u16,
}

/// The prediction for one session, as far as it has come.
#[derive(Debug, Clone, Copy)]
pub struct SessionCheck {
    strategy: ScanStrategy,
    stage: Stage,
    search: Search,
    /// Working memory of a search step.
    seen: Seen,
    first_entry: Option<Edge>,
    last_exit: Option<Edge>,
    passes: u16,
    pieces: u32,
}

/// An entry or exit.
#[derive(Debug, Clone, Copy)]
struct Edge {
    at: Instant,
    /// How many seconds it moves per radian of error in precession phase, alpha and spin phase; `None`
    /// until that is worked out.
    slopes_s: Option<[f64; 3]>,
}

impl Edge {
    /// One that the search's own end cut off does not move.
    fn new(at: Instant, clipped: bool) -> Self {
        Self { at, slopes_s: clipped.then_some([0.0; 3]) }
    }

    /// Its standard deviation in seconds; infinite where that is not a number: not known at all.
    #[inline(never)]
    fn sigma_s(&self, covariance: &ScanCovariance) -> f64 {
        let variance = covariance.along(self.slopes_s.unwrap_or([0.0; 3]));
        if variance.is_nan() { f64::INFINITY } else { libm::sqrt(variance) }
    }
}

#[derive(Debug, Clone, Copy)]
enum Stage {
    /// Not begun.
    Waiting,
    /// This search is next.
    Next(Part),
    /// This search is under way.
    Searching(Part),
    /// So it is, and edges that it found are to be looked at.
    Sloping(Part),
    Done(Result<(), SkipReason>),
}

/// What is searched: the target, or the body of the avoidance limit of this index, through the field
/// of the other index.
#[derive(Debug, Clone, Copy)]
enum Part {
    Target(u16),
    Limit(u16, u16),
}

impl Part {
    const fn following(self) -> Self {
        match self {
            Self::Target(field) => Self::Target(field.saturating_add(1)),
            Self::Limit(limit, field) => Self::Limit(limit, field.saturating_add(1)),
        }
    }
}

impl SessionCheck {
    /// A check of nothing yet.
    pub const WAITING: Self = Self::waiting();

    /// The same, written by code: as a constant it would stand among the read-only data once more.
    pub(super) const fn waiting() -> Self {
        Self {
            strategy: ScanStrategy::STILL,
            stage: Stage::Waiting,
            search: Search::nothing(),
            seen: Seen::NOTHING,
            first_entry: None,
            last_exit: None,
            passes: 0,
            pieces: 0,
        }
    }

    /// Forgets all, for another session or another strategy.
    pub const fn reset(&mut self) {
        self.stage = Stage::Waiting;
    }

    /// Begins, unless it has begun.
    #[inline(never)]
    pub fn start(&mut self, strategy: &ScanStrategy) {
        self.start_at(strategy, Part::Target(0));
    }

    /// Begins, unless it has begun, after the target: the avoidance limits alone are decided.
    #[inline(never)]
    pub fn start_with_avoidance(&mut self, strategy: &ScanStrategy) {
        self.start_at(strategy, Part::Limit(0, 0));
    }

    fn start_at(&mut self, strategy: &ScanStrategy, part: Part) {
        if self.is_waiting() {
            self.strategy = *strategy;
            self.stage = Stage::Next(part);
            (self.first_entry, self.last_exit, self.passes) = (None, None, 0);
            self.pieces = 0;
        }
    }

    /// Whether it has not begun.
    #[must_use]
    pub const fn is_waiting(&self) -> bool {
        matches!(self.stage, Stage::Waiting)
    }

    /// The strategy that it began with.
    #[must_use]
    pub const fn strategy(&self) -> &ScanStrategy {
        &self.strategy
    }

    /// The outcome, once it is known.
    #[must_use]
    pub const fn verdict(&self) -> Option<Result<(), SkipReason>> {
        match self.stage {
            Stage::Done(verdict) => Some(verdict),
            Stage::Waiting | Stage::Next(_) | Stage::Searching(_) | Stage::Sloping(_) => None,
        }
    }

    /// Pieces that it has taken; stays at its largest value.
    #[must_use]
    pub const fn pieces(&self) -> u32 {
        self.pieces
    }

    /// Half the 95 % interval of the predicted first entry or last exit, the larger of the two, where
    /// the angles of its strategy are known as well as `scan` says.
    ///
    /// An edge that the search's own end cut off is certain; before the target was searched nothing
    /// is uncertain.
    #[must_use]
    #[inline(never)]
    // REQ-SEQ-8.
    pub fn uncertainty(&self, scan: &ScanEstimate<'_>) -> Duration {
        let mut largest = 0.0;
        for edge in [&self.first_entry, &self.last_exit].into_iter().flatten() {
            largest = libm::fmax(largest, edge.sigma_s(&scan.covariance_at(edge.at)));
        }
        Duration::from_seconds(TWO_SIDED_95 * largest)
    }

    /// Goes on by at most so many search steps; returns the evaluations made.
    #[inline(never)]
    // REQ-SEQ-12.
    pub fn advance(&mut self, question: &Question<'_, '_>, steps: u16) -> u32 {
        let part = match self.stage {
            Stage::Waiting | Stage::Done(_) => return 0,
            Stage::Next(part) => {
                self.pieces = self.pieces.saturating_add(1);
                self.stage = self
                    .begin(question, part)
                    .unwrap_or_else(|error| Stage::Done(Err(SkipReason::Ephemeris(error))));
                return 0;
            }
            Stage::Searching(part) | Stage::Sloping(part) => part,
        };
        self.pieces = self.pieces.saturating_add(1);
        let before = self.search.evaluations();
        let went_on = match self.stage {
            Stage::Sloping(_) => self.slope(question).map(|()| Some(Stage::Searching(part))),
            _ => self.go_on(question, part, steps.min(MAX_STEPS_PER_TICK)),
        };
        match went_on {
            Ok(None) => {}
            Ok(Some(next)) => self.stage = next,
            Err(error) => self.stage = Stage::Done(Err(SkipReason::Ephemeris(error))),
        }
        let after = self.search.evaluations();
        u32::try_from(after.wrapping_sub(before)).unwrap_or(u32::MAX)
    }

    /// Lays out the search of one part; where the part is not there, what follows.
    #[inline(never)]
    // REQ-SEQ-6.
    fn begin(&mut self, question: &Question<'_, '_>, part: Part) -> Result<Stage, EphemerisError> {
        let (session, mission) = (question.session, question.mission);
        // Fields are borrowed, not moved out of their options: each copy would lie on the stack.
        match part {
            Part::Target(index) => {
                let field = mission.calibration_field(session.telescope, index);
                let Some(field) = &field else {
                    return Ok(match self.compare(question) {
                        Ok(()) => Stage::Next(Part::Limit(0, 0)),
                        disagreement => Stage::Done(disagreement),
                    });
                };
                self.lay_out(question, session.body, field, window(question))?;
            }
            Part::Limit(limit, index) => {
                let Some(record) = mission.avoidance_limit(limit) else {
                    return Ok(Stage::Done(Ok(())));
                };
                let field = mission.calibration_field(session.telescope, index);
                let Some(field) = &field else {
                    return Ok(Stage::Next(Part::Limit(limit.saturating_add(1), 0)));
                };
                let zone = field.enlarged(record.angle_rad);
                let Some(zone) = &zone else {
                    // The zone is the whole sky.
                    return Ok(Stage::Done(Err(SkipReason::Avoidance(record.body))));
                };
                self.lay_out(question, record.body, zone, (session.start, session.end))?;
            }
        }
        Ok(Stage::Searching(part))
    }

    /// The search of a body through a field.
    #[inline(never)]
    fn lay_out(
        &mut self,
        question: &Question<'_, '_>,
        body: i32,
        field: &FieldOfView,
        span: (Instant, Instant),
    ) -> Result<(), EphemerisError> {
        let sun = question.mission.sun(question.ephemeris)?;
        let lookup = Lookup { sun: &sun, target: question.ephemeris.body(body)? };
        self.search.set(&self.strategy, &lookup, field, span);
        Ok(())
    }

    /// At most so many steps of the search; what follows, when it is over.
    #[inline(never)]
    fn go_on(
        &mut self,
        question: &Question<'_, '_>,
        part: Part,
        steps: u16,
    ) -> Result<Option<Stage>, EphemerisError> {
        let limit = match part {
            Part::Target(_) => None,
            Part::Limit(limit, _) => question.mission.avoidance_limit(limit),
        };
        let body = limit.map_or(question.session.body, |record| record.body);
        let sun = question.mission.sun(question.ephemeris)?;
        let lookup = Lookup { sun: &sun, target: question.ephemeris.body(body)? };
        for _ in 0..uncounted(usize::from(steps)) {
            if self.search.has_found() {
                if let Some(next) = self.found(part, body) {
                    return Ok(Some(next));
                }
            } else if self.search.frontier().is_none() {
                return Ok(Some(Stage::Next(part.following())));
            } else {
                self.search.advance(&lookup, &mut self.seen)?;
            }
        }
        Ok(None)
    }

    /// What follows from a pass of the target, or of a limit's body; nothing where the search goes on.
    #[inline(never)]
    fn found(&mut self, part: Part, body: i32) -> Option<Stage> {
        let transit = self.search.take()?;
        match part {
            Part::Target(_) => self.note(&transit).then_some(Stage::Sloping(part)),
            Part::Limit(..) => Some(Stage::Done(Err(SkipReason::Avoidance(body)))),
        }
    }

    /// Takes a pass in; whether an edge of it is now the first or the last and not looked at yet.
    fn note(&mut self, transit: &Transit) -> bool {
        self.passes = self.passes.saturating_add(1);
        if self.first_entry.is_none_or(|edge| transit.entry < edge.at) {
            self.first_entry = Some(Edge::new(transit.entry, transit.entry_clipped));
        }
        if self.last_exit.is_none_or(|edge| transit.exit > edge.at) {
            self.last_exit = Some(Edge::new(transit.exit, transit.exit_clipped));
        }
        let edges = [&self.first_entry, &self.last_exit];
        edges.into_iter().flatten().any(|edge| edge.slopes_s.is_none())
    }

    /// Works out how the edges found last move: at most two evaluations.
    #[inline(never)]
    fn slope(&mut self, question: &Question<'_, '_>) -> Result<(), EphemerisError> {
        let sun = question.mission.sun(question.ephemeris)?;
        let target = question.ephemeris.body(question.session.body)?;
        let lookup = Lookup { sun: &sun, target };
        for (edge, sense) in [(&mut self.first_entry, 1.0), (&mut self.last_exit, -1.0)] {
            if let Some(edge) = edge
                && edge.slopes_s.is_none()
            {
                edge.slopes_s = Some(self.search.edge_slopes_s(edge.at, &lookup, sense)?);
            }
        }
        Ok(())
    }

    // REQ-SEQ-5.
    fn compare(&self, question: &Question<'_, '_>) -> Result<(), SkipReason> {
        let session = question.session;
        let (Some(entry), Some(exit)) = (self.first_entry, self.last_exit) else {
            return Err(SkipReason::NoPass);
        };
        let off = |predicted: Instant, planned: Instant| {
            let difference = predicted.since(planned);
            (difference.ns().saturating_abs() > question.tolerance.ns()).then_some(difference)
        };
        if let Some(difference) = off(entry.at, session.first_entry) {
            return Err(SkipReason::Entry(difference));
        }
        if let Some(difference) = off(exit.at, session.last_exit) {
            return Err(SkipReason::Exit(difference));
        }
        let full = session.passes == u16::MAX && self.passes == u16::MAX;
        if full || self.passes.abs_diff(session.passes) <= question.passes_tolerance {
            Ok(())
        } else {
            Err(SkipReason::Passes(self.passes))
        }
    }
}

/// What the prediction searches: beyond the planned times by two tolerances, so that a transit cut
/// off at its edge is seen to disagree.
fn window(question: &Question<'_, '_>) -> (Instant, Instant) {
    let (valid_from, valid_until) = question.validity;
    let margin = question.tolerance.ns().saturating_mul(2);
    let from = question.session.first_entry.plus(Duration::from_ns(margin.saturating_neg()));
    let until = question.session.last_exit.plus(Duration::from_ns(margin));
    (from.max(valid_from), until.min(valid_until))
}

#[cfg(test)]
mod tests {
    use super::super::trial::{Board, SECOND, later, sessions, strategy, turned};
    use super::*;
    use crate::uplink::Tables;

    fn session() -> SessionRecord {
        *sessions().first().expect("a session")
    }

    fn with_question<R>(session: &SessionRecord, then: impl FnOnce(&Question<'_, '_>) -> R) -> R {
        asked(&Board::default(), session, then)
    }

    fn asked<R>(
        board: &Board,
        session: &SessionRecord,
        then: impl FnOnce(&Question<'_, '_>) -> R,
    ) -> R {
        let bytes = board.uplink(1, &[]);
        let tables = Tables::load(&bytes).unwrap();
        then(&Question {
            session,
            mission: tables.mission(),
            ephemeris: tables.ephemeris(),
            validity: (tables.header().valid_from, tables.header().valid_until),
            tolerance: Duration::from_ns(SECOND),
            passes_tolerance: 1,
        })
    }

    /// The check at its end, and how many calls that took.
    fn checked(mut check: SessionCheck, question: &Question<'_, '_>) -> (SessionCheck, u32) {
        let mut calls = 0;
        while check.verdict().is_none() {
            check.advance(question, 3);
            calls += 1;
        }
        (check, calls)
    }

    fn pass(entry_s: i64, exit_s: i64) -> Transit {
        let at = |seconds| later(Instant::from_tai_ns(0), seconds);
        Transit {
            channel: 0,
            entry: at(entry_s),
            exit: at(exit_s),
            closest: at(entry_s),
            min_separation_rad: 0.0,
            entry_clipped: false,
            exit_clipped: false,
        }
    }

    /// A check that has seen one pass from 10 s to 20 s, the slopes of its edges known.
    fn noted() -> SessionCheck {
        let mut check = SessionCheck::WAITING;
        assert!(check.note(&pass(10, 20)));
        for edge in [&mut check.first_entry, &mut check.last_exit].into_iter().flatten() {
            edge.slopes_s = Some([1.0; 3]);
        }
        check
    }

    fn edges_s(check: &SessionCheck) -> [i64; 2] {
        [check.first_entry, check.last_exit].map(|edge| edge.unwrap().at.tai_ns() / SECOND)
    }

    #[test]
    // REQ-SEQ-5.
    fn the_first_entry_and_the_last_exit_count() {
        for (entry, exit, expected) in
            [(5, 15, [5, 20]), (15, 25, [10, 25]), (5, 25, [5, 25]), (12, 18, [10, 20])]
        {
            let mut check = noted();
            let moved = check.note(&pass(entry, exit));
            assert_eq!(edges_s(&check), expected);
            assert_eq!(moved, expected != [10, 20], "{entry} to {exit}");
            assert_eq!(check.passes, 2);
        }
        // The same edges once more are looked at once.
        assert!(!noted().note(&pass(10, 20)));
    }

    #[test]
    // REQ-SEQ-5.
    fn edges_may_differ_by_the_tolerance_and_no_more() {
        let planned = SessionRecord {
            first_entry: later(Instant::from_tai_ns(0), 10),
            last_exit: later(Instant::from_tai_ns(0), 20),
            ..session()
        };
        let verdict = |entry_ns: i64, exit_ns: i64| {
            let mut check = noted();
            let moved = |edge: &mut Option<Edge>, ns| {
                let edge = edge.as_mut().unwrap();
                edge.at = edge.at.plus(Duration::from_ns(ns));
            };
            moved(&mut check.first_entry, entry_ns);
            moved(&mut check.last_exit, exit_ns);
            with_question(&planned, |question| check.compare(question))
        };
        for by in [SECOND, -SECOND] {
            assert_eq!(verdict(by, 0), Ok(()));
            assert_eq!(verdict(0, by), Ok(()));
            let more = by + by.signum();
            assert_eq!(verdict(more, 0), Err(SkipReason::Entry(Duration::from_ns(more))));
            assert_eq!(verdict(0, more), Err(SkipReason::Exit(Duration::from_ns(more))));
        }
    }

    #[test]
    // REQ-SEQ-5.
    fn as_many_passes_as_can_be_counted_are_no_other_number() {
        let verdict = |planned: u16, predicted: u16| {
            let check = SessionCheck { passes: predicted, ..noted() };
            let session = SessionRecord {
                first_entry: later(Instant::from_tai_ns(0), 10),
                last_exit: later(Instant::from_tai_ns(0), 20),
                passes: planned,
                ..session()
            };
            with_question(&session, |question| check.compare(question))
        };
        assert_eq!(verdict(u16::MAX, u16::MAX), Ok(()));
        assert_eq!(verdict(3, u16::MAX), Err(SkipReason::Passes(u16::MAX)));
        assert_eq!(verdict(u16::MAX, 3), Err(SkipReason::Passes(3)));
        assert_eq!(verdict(3, 2), Ok(()));
        assert_eq!(verdict(3, 5), Err(SkipReason::Passes(5)));
    }

    #[test]
    // REQ-SEQ-12.
    fn every_piece_is_counted() {
        let session = session();
        let mut check = SessionCheck::WAITING;
        check.start(&strategy());
        assert_eq!(check.pieces(), 0);
        with_question(&session, |question| {
            let (mut check, calls) = checked(check, question);
            assert_eq!(check.verdict(), Some(Ok(())));
            assert!(calls > 5);
            assert_eq!(check.pieces(), calls);
            // Once it is over nothing is done.
            assert_eq!(check.advance(question, 3), 0);
            assert_eq!(check.pieces(), calls);
        });
    }

    #[test]
    fn a_check_of_avoidance_alone_leaves_the_target_out() {
        let elsewhen = session();
        let elsewhen = SessionRecord {
            first_entry: later(elsewhen.last_exit, 60),
            last_exit: later(elsewhen.last_exit, 90),
            ..elsewhen
        };
        let verdict = |start: fn(&mut SessionCheck, &ScanStrategy)| {
            let mut check = SessionCheck::WAITING;
            start(&mut check, &strategy());
            assert!(!check.is_waiting());
            with_question(&elsewhen, |question| checked(check, question).0.verdict())
        };
        assert_eq!(verdict(SessionCheck::start), Some(Err(SkipReason::NoPass)));
        assert_eq!(verdict(SessionCheck::start_with_avoidance), Some(Ok(())));
    }

    #[test]
    // REQ-SEQ-8.
    fn edges_move_by_their_slopes() {
        let step_rad = 1e-4;
        let (mut passes, mut worst) = (0, 0.0_f64);
        for (rectangle, session) in [false, true]
            .into_iter()
            .flat_map(|it| sessions().into_iter().map(move |own| (it, own)))
        {
            let board = Board { rectangle, ..Board::default() };
            let after = |by_rad: f64| {
                let mut check = SessionCheck::WAITING;
                check.start(&turned(by_rad));
                asked(&board, &session, |question| {
                    let check = checked(check, question).0;
                    [check.first_entry, check.last_exit]
                })
            };
            let (before, own, later) = (after(-step_rad), after(0.0), after(step_rad));
            for ((before, own), later) in before.iter().zip(own).zip(later) {
                let (Some(before), Some(own), Some(later)) = (before, own, later) else { continue };
                let moved_s = later.at.since(before.at).seconds() / (2.0 * step_rad);
                let [_, _, spin_s] = own.slopes_s.unwrap();
                worst = worst.max((moved_s.abs() / spin_s.abs() - 1.0).abs());
                passes += 1;
            }
        }
        assert!(passes > 20 && worst < 0.01, "{passes} {worst}");
    }
}
