//! A planned session against the spacecraft's own prediction, a bounded piece at a time.
//!
//! The prediction searches the session's target through every field that calibrates the telescope,
//! from two tolerances before the planned first entry to two after the planned last exit. Nothing
//! is borrowed between two pieces: the search goes on from its saved state with the same bits, on
//! the strategy that it began with.

use super::{Settings, SkipReason};
use crate::scan::ScanStrategy;
use crate::time::{Duration, Instant};
use crate::transit::{Channel, SearchState, Step, Transit, TransitFinder};
use crate::uplink::{SessionRecord, Tables};

/// The prediction for one session, as far as it has come.
#[derive(Debug, Clone, Copy)]
pub(super) struct Check {
    strategy: ScanStrategy,
    stage: Stage,
    first_entry: Option<Instant>,
    last_exit: Option<Instant>,
    passes: u16,
}

#[derive(Debug, Clone, Copy)]
enum Stage {
    /// Searching through the field of this index.
    Field(u16, Option<SearchState>),
    Done(Result<(), SkipReason>),
}

/// What a piece of the prediction runs on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ground<'t, 'a> {
    pub(super) session: &'t SessionRecord,
    pub(super) tables: &'t Tables<'a>,
    pub(super) settings: &'t Settings,
}

impl Check {
    pub(super) const fn new(strategy: ScanStrategy) -> Self {
        let stage = Stage::Field(0, None);
        Self { strategy, stage, first_entry: None, last_exit: None, passes: 0 }
    }

    /// The outcome, once it is known.
    pub(super) const fn verdict(&self) -> Option<Result<(), SkipReason>> {
        match self.stage {
            Stage::Done(verdict) => Some(verdict),
            Stage::Field(..) => None,
        }
    }

    /// Goes on by at most the settings' number of search steps; returns the evaluations made.
    pub(super) fn advance(&mut self, ground: &Ground<'_, '_>) -> u32 {
        let Stage::Field(index, saved) = self.stage else { return 0 };
        match self.search(ground, index, saved) {
            Ok((evaluations, stage)) => {
                self.stage = stage;
                evaluations
            }
            Err(reason) => {
                self.stage = Stage::Done(Err(reason));
                0
            }
        }
    }

    fn search(
        &mut self,
        ground: &Ground<'_, '_>,
        index: u16,
        saved: Option<SearchState>,
    ) -> Result<(u32, Stage), SkipReason> {
        let (session, tables) = (ground.session, ground.tables);
        let Some(field) = tables.mission().calibration_field(session.telescope, index) else {
            return Ok((0, Stage::Done(self.compare(ground))));
        };
        let body = tables.ephemeris().body(session.body).map_err(SkipReason::Ephemeris)?;
        let span = window(ground);
        let mut channel = Channel::new(&self.strategy, tables.sun(), body, &field, span);
        if let Some(state) = saved {
            channel.resume(state);
        }
        let mut finder = TransitFinder::new(core::slice::from_mut(&mut channel));
        let mut next = None;
        for _ in 0..ground.settings.steps_per_tick {
            match finder.step() {
                Step::Transit(transit) => self.note(&transit),
                Step::Searched(_) => {}
                Step::Done => {
                    next = Some(Stage::Field(index.saturating_add(1), None));
                    break;
                }
                Step::Failed { error, .. } => return Err(SkipReason::Ephemeris(error)),
            }
        }
        let evaluations = u32::try_from(channel.evaluations()).unwrap_or(u32::MAX);
        Ok((evaluations, next.unwrap_or(Stage::Field(index, Some(channel.state())))))
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
