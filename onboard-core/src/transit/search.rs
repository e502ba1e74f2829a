//! The search for one field of view as a resumable state, apart from the tables that it looks up.

use super::Transit;
use super::reach::Reach;
use super::sight::{Motion, Seen, Sight};
use crate::ephemeris::{BodyTable, EphemerisError};
use crate::field_of_view::FieldOfView;
use crate::scan::ScanStrategy;
use crate::sun::{RelativeBounds, SunModel};
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// Most evaluations (Sun, target and phases at one instant) that one step of the search makes.
pub const MAX_EVALUATIONS_PER_STEP: u32 = 13;

/// Evaluations spent on one closest approach.
const REFINEMENTS: u32 = MAX_EVALUATIONS_PER_STEP - 1;
/// Newton's correction of an entry or exit never exceeds this, in seconds.
const LONGEST_CORRECTION_S: f64 = 1e-3;

/// All that a search must remember to go on with the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SearchState {
    /// Next instant to evaluate; no entry before it is unknown.
    at: Instant,
    end: Instant,
    previous: Option<Approach>,
    stage: Stage,
}

/// How close the target was at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Approach {
    at: Instant,
    closeness: f64,
    rate: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
enum Stage {
    Outside,
    Inside(Visit),
    Found(Transit),
    Done,
}

/// A transit in progress.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Visit {
    entry: Instant,
    clipped: bool,
    best: Approach,
}

/// One evaluation, and what it certifies.
#[derive(Debug, Clone, Copy)]
struct Survey {
    now: Approach,
    inside: bool,
    /// Seconds back to the entry or exit, where the boundary was crossed.
    since_s: f64,
    /// Seconds ahead without another crossing.
    stays_s: f64,
    /// Largest second derivative of the closeness, 1/s^2.
    curvature: f64,
}

/// The tables that a search looks up; the same at each of its steps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lookup<'t, 'a> {
    pub(crate) sun: &'t SunModel<'a>,
    pub(crate) target: BodyTable<'a>,
}

/// A search through one field of view, which borrows nothing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Search {
    motion: Motion,
    reach: Reach,
    state: SearchState,
    evaluations: u64,
}

impl Search {
    /// A search of nothing: it is over.
    pub(crate) const NOTHING: Self = Self {
        motion: Motion::NOTHING,
        reach: Reach::NOTHING,
        state: SearchState {
            at: Instant::from_tai_ns(0),
            end: Instant::from_tai_ns(0),
            previous: None,
            stage: Stage::Done,
        },
        evaluations: 0,
    };

    /// A search from `start` to `end`, both included.
    #[inline]
    pub(super) fn new(
        scan: &ScanStrategy,
        lookup: &Lookup<'_, '_>,
        field: &FieldOfView,
        ends: (Instant, Instant),
    ) -> Self {
        let mut search = Self::NOTHING;
        search.set(scan, lookup, field, ends);
        search
    }

    /// Becomes a search from `start` to `end`, both included; in place, to spare the stack.
    #[inline(never)]
    pub(crate) fn set(
        &mut self,
        scan: &ScanStrategy,
        lookup: &Lookup<'_, '_>,
        field: &FieldOfView,
        (start, end): (Instant, Instant),
    ) {
        self.motion.set(scan);
        let bounds = RelativeBounds::new(&lookup.sun.bounds(), &lookup.target.bounds());
        self.reach.set(&self.motion, field, bounds);
        self.state = SearchState { at: start, end, previous: None, stage: Stage::Outside };
        self.evaluations = 0;
    }

    /// What to save, so that [`Self::resume`] goes on with the same bits.
    pub(super) const fn state(&self) -> SearchState {
        self.state
    }

    /// Goes on from a saved state of the same search.
    pub(super) const fn resume(&mut self, state: SearchState) {
        self.state = state;
    }

    /// Evaluations (Sun, target and phases at one instant) made so far; not part of the state.
    pub(crate) const fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// No transit that is still to come from this channel begins before this instant.
    pub(crate) const fn frontier(&self) -> Option<Instant> {
        match self.state.stage {
            Stage::Outside => Some(self.state.at),
            Stage::Inside(visit) => Some(visit.entry),
            Stage::Found(transit) => Some(transit.entry),
            Stage::Done => None,
        }
    }

    /// Whether a whole transit waits to be taken.
    pub(super) const fn has_found(&self) -> bool {
        matches!(self.state.stage, Stage::Found(_))
    }

    /// Takes the transit that waits.
    pub(crate) fn take(&mut self) -> Option<Transit> {
        let Stage::Found(transit) = self.state.stage else { return None };
        self.state.stage = if transit.exit_clipped { Stage::Done } else { Stage::Outside };
        Some(transit)
    }

    /// Searches on by one certified span: at most [`MAX_EVALUATIONS_PER_STEP`] evaluations.
    ///
    /// In three parts, so that no frame of one lies below the evaluations of another; `seen` is
    /// their working memory, lent for the same reason.
    #[inline(never)]
    pub(crate) fn advance(
        &mut self,
        lookup: &Lookup<'_, '_>,
        seen: &mut Seen,
    ) -> Result<(), EphemerisError> {
        let at = self.state.at;
        self.see(at, lookup, seen)?;
        let survey = self.survey(at, seen);
        let summit = self.summit(&survey, lookup, seen)?;
        self.conclude(&survey, summit);
        Ok(())
    }

    /// What follows, in this stage, from what is seen.
    #[inline(never)]
    fn survey(&self, at: Instant, seen: &Seen) -> Survey {
        let sight = Sight::new(&self.motion, seen);
        let (closeness, rate) = self.reach.closeness(&sight);
        let now = Approach { at, closeness, rate };
        let inside = self.reach.inside(&sight);
        let was_inside = matches!(self.state.stage, Stage::Inside(_));
        let since_s = match (was_inside, inside) {
            (false, true) => self.reach.since_entry(&sight),
            (true, false) => self.reach.since_exit(&sight),
            _ => 0.0,
        };
        let stays_s = match (was_inside, inside) {
            (_, true) => self.reach.stays_inside(&self.motion, &sight),
            (false, false) => self.reach.stays_outside(&self.motion, &sight),
            (true, false) => 0.0,
        };
        let curvature = self.reach.closeness_curvature(&self.motion, &sight);
        Survey { now, inside, since_s, stays_s, curvature }
    }

    /// The visit that the survey finds in progress, before any summit is known.
    #[inline(never)]
    fn visit(&self, seen: &Survey) -> Option<Visit> {
        let now = seen.now;
        match self.state.stage {
            Stage::Inside(visit) => Some(visit),
            Stage::Outside if seen.inside => {
                let entry = match self.state.previous {
                    Some(before) => back(now.at, seen.since_s, before.at),
                    None => now.at,
                };
                let clipped = self.state.previous.is_none();
                Some(Visit { entry, clipped, best: Approach { at: entry, ..now } })
            }
            Stage::Outside | Stage::Found(_) | Stage::Done => None,
        }
    }

    /// The previous evaluation, where an approach closer than the best may lie since then.
    #[inline(never)]
    fn rising(&self, seen: &Survey) -> Option<Approach> {
        let (now, best) = (seen.now, self.visit(seen)?.best);
        let before = self.state.previous?;
        if !(before.rate > 0.0 && now.rate <= 0.0) {
            return None;
        }
        let span = now.at.since(before.at).seconds();
        let ceiling =
            libm::fmax(before.closeness, now.closeness) + 0.125 * seen.curvature * span * span;
        (ceiling > best.closeness).then_some(before)
    }

    /// Moves the state on by what was seen.
    #[inline(never)]
    fn conclude(&mut self, seen: &Survey, summit: Option<Approach>) {
        let now = seen.now;
        let Some(mut visit) = self.visit(seen) else {
            if self.state.stage == Stage::Outside {
                if now.at >= self.state.end {
                    self.state.stage = Stage::Done;
                } else {
                    self.move_on(now, seen.stays_s);
                }
            }
            return;
        };
        if let Some(summit) = summit
            && summit.closeness > visit.best.closeness
        {
            visit.best = summit;
        }
        if !seen.inside {
            let inside_until = self.state.previous.map_or(now.at, |before| before.at);
            let exit = back(now.at, seen.since_s, inside_until);
            self.finish(visit, visit.best, exit, false);
            self.state.previous = Some(now);
            return;
        }
        if now.closeness > visit.best.closeness {
            visit.best = now;
        }
        if now.at >= self.state.end {
            self.finish(visit, visit.best, now.at, true);
        } else {
            self.state.stage = Stage::Inside(visit);
            self.move_on(now, seen.stays_s);
        }
    }

    /// The one place where the search evaluates, so that the count is whole.
    fn see(
        &mut self,
        at: Instant,
        lookup: &Lookup<'_, '_>,
        seen: &mut Seen,
    ) -> Result<(), EphemerisError> {
        self.count();
        seen.look(at, &self.motion, lookup.sun, lookup.target)
    }

    /// Counts an evaluation.
    pub(super) const fn count(&mut self) {
        self.evaluations = self.evaluations.wrapping_add(1);
    }

    /// The target at any instant; not counted.
    #[inline(never)]
    pub(super) fn sight_at(
        &self,
        at: Instant,
        lookup: &Lookup<'_, '_>,
    ) -> Result<Sight, EphemerisError> {
        let mut seen = Seen::NOTHING;
        seen.look(at, &self.motion, lookup.sun, lookup.target)?;
        Ok(Sight::new(&self.motion, &seen))
    }

    pub(super) const fn motion(&self) -> &Motion {
        &self.motion
    }

    pub(super) const fn reach(&self) -> &Reach {
        &self.reach
    }

    /// How close the target is at `at`.
    #[inline(never)]
    fn approach(&self, at: Instant, seen: &Seen) -> Approach {
        let (closeness, rate) = self.reach.closeness(&Sight::new(&self.motion, seen));
        Approach { at, closeness, rate }
    }

    fn move_on(&mut self, now: Approach, seconds: f64) {
        let whole_ns = Duration::from_seconds_floor(seconds).ns();
        let next = now.at.plus(Duration::from_ns(if whole_ns < 1 { 1 } else { whole_ns }));
        self.state.at = if next < self.state.end { next } else { self.state.end };
        self.state.previous = Some(now);
    }

    fn finish(&mut self, visit: Visit, best: Approach, exit: Instant, exit_clipped: bool) {
        let last = if best.at < exit { best.at } else { exit };
        self.state.stage = Stage::Found(Transit {
            channel: 0,
            entry: visit.entry,
            exit,
            closest: if last < visit.entry { visit.entry } else { last },
            min_separation_rad: self.reach.separation_rad(best.closeness),
            entry_clipped: visit.clipped,
            exit_clipped,
        });
    }

    /// The maximum of closeness since the previous evaluation, where that may be a new best: by false
    /// position on its rate (Illinois).
    #[inline(never)]
    fn summit(
        &mut self,
        survey: &Survey,
        lookup: &Lookup<'_, '_>,
        seen: &mut Seen,
    ) -> Result<Option<Approach>, EphemerisError> {
        let after = survey.now;
        let Some(before) = self.rising(survey) else { return Ok(None) };
        let (mut low, mut high) = (before, after);
        let mut best = if before.closeness > after.closeness { before } else { after };
        let mut kept_low = 0_i8;
        for _ in 0..REFINEMENTS {
            let width = high.at.since(low.at).ns();
            if width <= 1 {
                break;
            }
            let share = low.rate / (low.rate - high.rate);
            let offset = Duration::from_seconds(high.at.since(low.at).seconds() * share).ns();
            let at = low.at.plus(Duration::from_ns(within(offset, width)));
            self.see(at, lookup, seen)?;
            let here = self.approach(at, seen);
            let moved = at.since(best.at).ns().saturating_abs();
            if here.closeness >= best.closeness {
                best = here;
            }
            if here.rate > 0.0 {
                low = here;
                if kept_low > 0 {
                    high.rate *= 0.5;
                }
                kept_low = 1;
            } else {
                high = here;
                if kept_low < 0 {
                    low.rate *= 0.5;
                }
                kept_low = -1;
            }
            if moved <= 1 {
                break;
            }
        }
        Ok(Some(best))
    }
}

/// `offset` kept strictly inside (0, width).
const fn within(offset: i64, width: i64) -> i64 {
    let last = width.saturating_sub(1);
    if offset < 1 {
        1
    } else if offset > last {
        last
    } else {
        offset
    }
}

/// `seconds` before `at`, but neither beyond the longest correction nor before `earliest`.
fn back(at: Instant, seconds: f64, earliest: Instant) -> Instant {
    if seconds > LONGEST_CORRECTION_S {
        return at;
    }
    let corrected = at.plus(Duration::from_seconds(-seconds));
    if corrected < earliest { earliest } else { corrected }
}
