//! A planned session against the spacecraft's own prediction, a bounded piece at a time.
//!
//! The prediction searches the session's target through every field that calibrates the telescope,
//! from two tolerances before the planned first entry to two after the planned last exit, on the
//! strategy that was the best known when it began. Then, for every avoidance limit and every such
//! field, it searches the whole session, setup and cooldown included, for a violation. Nothing is
//! borrowed between two pieces.

use super::{Settings, SkipReason};
use crate::ephemeris::EphemerisError;
use crate::scan::ScanStrategy;
use crate::time::{Duration, Instant};
use crate::transit::{Lookup, Search, Seen, Transit};
use crate::uplink::{SessionRecord, Tables};

/// The prediction for one session, as far as it has come.
#[derive(Debug, Clone, Copy)]
pub(super) struct Check {
    strategy: Option<ScanStrategy>,
    stage: Stage,
    search: Search,
    /// Working memory of a search step.
    seen: Seen,
    first_entry: Option<Instant>,
    last_exit: Option<Instant>,
    passes: u16,
}

#[derive(Debug, Clone, Copy)]
enum Stage {
    /// Not begun.
    Waiting,
    /// This search is next.
    Next(Part),
    /// This search is under way.
    Searching(Part),
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

/// What a piece of the prediction runs on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ground<'t, 'a> {
    pub(super) session: &'t SessionRecord,
    pub(super) tables: &'t Tables<'a>,
    pub(super) settings: &'t Settings,
}

impl Check {
    /// A check of nothing yet.
    pub(super) const WAITING: Self = Self {
        strategy: None,
        stage: Stage::Waiting,
        search: Search::NOTHING,
        seen: Seen::NOTHING,
        first_entry: None,
        last_exit: None,
        passes: 0,
    };

    /// Forgets all, for another session.
    pub(super) const fn reset(&mut self) {
        self.stage = Stage::Waiting;
    }

    /// Begins, unless it has begun, on this strategy or else the mission section's.
    #[inline(never)]
    pub(super) fn start(&mut self, strategy: Option<&ScanStrategy>, tables: &Tables<'_>) {
        if matches!(self.stage, Stage::Waiting) {
            self.strategy =
                Some(strategy.map_or_else(|| tables.mission().strategy(), |known| *known));
            self.stage = Stage::Next(Part::Target(0));
            (self.first_entry, self.last_exit, self.passes) = (None, None, 0);
        }
    }

    /// The outcome, once it is known.
    pub(super) const fn verdict(&self) -> Option<Result<(), SkipReason>> {
        match self.stage {
            Stage::Done(verdict) => Some(verdict),
            Stage::Waiting | Stage::Next(_) | Stage::Searching(_) => None,
        }
    }

    /// Goes on by at most the settings' number of search steps; returns the evaluations made.
    #[inline(never)]
    pub(super) fn advance(&mut self, ground: &Ground<'_, '_>) -> u32 {
        let part = match self.stage {
            Stage::Waiting | Stage::Done(_) => return 0,
            Stage::Next(part) => {
                self.stage = self
                    .begin(ground, part)
                    .unwrap_or_else(|error| Stage::Done(Err(SkipReason::Ephemeris(error))));
                return 0;
            }
            Stage::Searching(part) => part,
        };
        let before = self.search.evaluations();
        match self.go_on(ground, part) {
            Ok(None) => {}
            Ok(Some(next)) => self.stage = next,
            Err(error) => self.stage = Stage::Done(Err(SkipReason::Ephemeris(error))),
        }
        let after = self.search.evaluations();
        u32::try_from(after.wrapping_sub(before)).unwrap_or(u32::MAX)
    }

    /// Lays out the search of one part; where the part is not there, what follows.
    #[inline(never)]
    fn begin(&mut self, ground: &Ground<'_, '_>, part: Part) -> Result<Stage, EphemerisError> {
        let (session, mission) = (ground.session, ground.tables.mission());
        let Some(strategy) = &self.strategy else { return Ok(Stage::Waiting) };
        let (body, field, span) = match part {
            Part::Target(index) => match mission.calibration_field(session.telescope, index) {
                Some(field) => (session.body, field, window(ground)),
                None => {
                    return Ok(match self.compare(ground) {
                        Ok(()) => Stage::Next(Part::Limit(0, 0)),
                        disagreement => Stage::Done(disagreement),
                    });
                }
            },
            Part::Limit(limit, index) => {
                let Some(record) = mission.avoidance_limit(limit) else {
                    return Ok(Stage::Done(Ok(())));
                };
                let Some(field) = mission.calibration_field(session.telescope, index) else {
                    return Ok(Stage::Next(Part::Limit(limit.saturating_add(1), 0)));
                };
                match field.enlarged(record.angle_rad) {
                    Some(zone) => (record.body, zone, (session.start, session.end)),
                    // The zone is the whole sky.
                    None => return Ok(Stage::Done(Err(SkipReason::Avoidance(record.body)))),
                }
            }
        };
        let sun = ground.tables.sun()?;
        let lookup = Lookup { sun: &sun, target: ground.tables.ephemeris().body(body)? };
        self.search.set(strategy, &lookup, &field, span);
        Ok(Stage::Searching(part))
    }

    /// At most the settings' number of steps of the search; what follows, when it is over.
    #[inline(never)]
    fn go_on(
        &mut self,
        ground: &Ground<'_, '_>,
        part: Part,
    ) -> Result<Option<Stage>, EphemerisError> {
        let limit = match part {
            Part::Target(_) => None,
            Part::Limit(limit, _) => ground.tables.mission().avoidance_limit(limit),
        };
        let body = limit.map_or(ground.session.body, |record| record.body);
        let sun = ground.tables.sun()?;
        let lookup = Lookup { sun: &sun, target: ground.tables.ephemeris().body(body)? };
        for _ in 0..ground.settings.steps_per_tick {
            if let Some(transit) = self.search.take() {
                if limit.is_some() {
                    return Ok(Some(Stage::Done(Err(SkipReason::Avoidance(body)))));
                }
                self.note(&transit);
            } else if self.search.frontier().is_none() {
                return Ok(Some(Stage::Next(part.following())));
            } else {
                self.search.advance(&lookup, &mut self.seen)?;
            }
        }
        Ok(None)
    }

    fn note(&mut self, transit: &Transit) {
        self.passes = self.passes.saturating_add(1);
        self.first_entry =
            Some(self.first_entry.map_or(transit.entry, |entry| entry.min(transit.entry)));
        self.last_exit = Some(self.last_exit.map_or(transit.exit, |exit| exit.max(transit.exit)));
    }

    fn compare(&self, ground: &Ground<'_, '_>) -> Result<(), SkipReason> {
        let (session, settings) = (ground.session, ground.settings);
        let (Some(entry), Some(exit)) = (self.first_entry, self.last_exit) else {
            return Err(SkipReason::NoPass);
        };
        let off = |predicted: Instant, planned: Instant| {
            let difference = predicted.since(planned);
            (difference.ns().saturating_abs() > settings.tolerance.ns()).then_some(difference)
        };
        if let Some(difference) = off(entry, session.first_entry) {
            return Err(SkipReason::Entry(difference));
        }
        if let Some(difference) = off(exit, session.last_exit) {
            return Err(SkipReason::Exit(difference));
        }
        let full = session.passes == u16::MAX && self.passes == u16::MAX;
        if full || self.passes.abs_diff(session.passes) <= settings.passes_tolerance {
            Ok(())
        } else {
            Err(SkipReason::Passes(self.passes))
        }
    }
}

/// What the prediction searches: beyond the planned times by two tolerances, so that a transit cut
/// off at its edge is seen to disagree.
fn window(ground: &Ground<'_, '_>) -> (Instant, Instant) {
    let header = ground.tables.header();
    let margin = ground.settings.tolerance.ns().saturating_mul(2);
    let from = ground.session.first_entry.plus(Duration::from_ns(margin.saturating_neg()));
    let until = ground.session.last_exit.plus(Duration::from_ns(margin));
    (from.max(header.valid_from), until.min(header.valid_until))
}
