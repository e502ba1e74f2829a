//! The search for one field of view as a resumable state, apart from the tables that it looks up.

use super::Transit;
use super::reach::Reach;
use super::sight::{Motion, Seen, Sight};
use crate::ephemeris::{BodyTable, EphemerisError};
use crate::field_of_view::FieldOfView;
use crate::scan::ScanStrategy;
use crate::sun::{RelativeBounds, SunModel};
use crate::time::{Duration, Instant};

/// Most evaluations (Sun, target and phases at one instant) that one step of the search makes.
pub const MAX_EVALUATIONS_PER_STEP: u32 = 13;

/// Evaluations spent on one closest approach.
const REFINEMENTS: u32 = MAX_EVALUATIONS_PER_STEP - 1;
/// Newton's correction of an entry or exit never exceeds this, in ns.
const LONGEST_CORRECTION_NS: i64 = 1_000_000;

/// All that a search must remember to go on with the same bits: [`SearchState::to_le_bytes`] saves it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchState {
    /// Next instant to evaluate; no entry before it is unknown.
    pub(super) at: Instant,
    pub(super) end: Instant,
    pub(super) previous: Option<Approach>,
    pub(super) stage: Stage,
}

/// How close the target was at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Approach {
    pub(super) at: Instant,
    pub(super) closeness: f64,
    pub(super) rate: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Stage {
    Outside,
    Inside(Visit),
    Found(Transit),
    Done,
}

/// A transit in progress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Visit {
    pub(super) entry: Instant,
    pub(super) clipped: bool,
    pub(super) best: Approach,
}

/// One evaluation, and what it certifies.
#[derive(Debug, Clone, Copy)]
struct Certificate {
    now: Approach,
    inside: bool,
    /// The entry or exit, where the boundary was crossed since the previous evaluation.
    crossing: Option<Instant>,
    /// Seconds ahead without another crossing, as long as the motion has no joint.
    stays_s: f64,
    /// Where the next evaluation must lie at the latest: no joint is passed unseen.
    latest: Instant,
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
    pub(crate) const fn nothing() -> Self {
        Self {
            motion: Motion::NOTHING,
            reach: Reach::NOTHING,
            state: SearchState {
                at: Instant::from_tai_ns(0),
                end: Instant::from_tai_ns(0),
                previous: None,
                stage: Stage::Done,
            },
            evaluations: 0,
        }
    }

    /// A search from `start` to `end`, both included.
    #[inline]
    pub(super) fn new(
        scan: &ScanStrategy,
        lookup: &Lookup<'_, '_>,
        field: &FieldOfView,
        ends: (Instant, Instant),
    ) -> Self {
        let mut search = Self::nothing();
        search.set(scan, lookup, field, ends);
        search
    }

    /// Becomes a search from `start` to `end`, both included; in place, to spare the stack.
    #[cfg_attr(target_os = "none", inline(never))]
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
    #[inline(never)]
    pub(super) const fn resume(&mut self, state: SearchState) {
        self.state = state;
    }

    /// Evaluations (Sun, target and phases at one instant) made so far; not part of the state.
    pub(crate) const fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// No transit that is still to come from this channel begins before this instant.
    ///
    /// An entry seen at the next instant may be corrected back ([`earliest`]).
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) const fn frontier(&self) -> Option<Instant> {
        match self.state.stage {
            Stage::Outside => Some(match self.state.previous {
                Some(before) => earliest(self.state.at, before.at),
                None => self.state.at,
            }),
            Stage::Inside(visit) => Some(visit.entry),
            Stage::Found(transit) => Some(transit.entry),
            Stage::Done => None,
        }
    }

    /// Whether a whole transit waits to be taken.
    pub(crate) const fn has_found(&self) -> bool {
        matches!(self.state.stage, Stage::Found(_))
    }

    /// Takes the transit that waits.
    pub(crate) fn take(&mut self) -> Option<Transit> {
        let Stage::Found(transit) = self.state.stage else { return None };
        self.state.stage = if transit.exit_clipped { Stage::Done } else { Stage::Outside };
        Some(transit)
    }

    /// Takes back a transit that was taken just before, to be taken again.
    pub(super) const fn take_back(&mut self, transit: Transit) {
        self.state.stage = Stage::Found(transit);
    }

    /// Searches on by one certified span: at most [`MAX_EVALUATIONS_PER_STEP`] evaluations.
    ///
    /// In three parts, so that no frame of one lies below the evaluations of another; `seen` is
    /// their working memory, lent for the same reason.
    #[cfg_attr(target_os = "none", inline(never))]
    // REQ-TRANSIT-1.
    pub(crate) fn advance(
        &mut self,
        lookup: &Lookup<'_, '_>,
        seen: &mut Seen,
    ) -> Result<(), EphemerisError> {
        let at = self.state.at;
        self.see(at, lookup, seen)?;
        let certificate = self.certify(at, seen);
        let summit = self.summit(&certificate, lookup, seen)?;
        self.conclude(&certificate, summit);
        Ok(())
    }

    /// What follows, in this stage, from what is seen.
    #[cfg_attr(target_os = "none", inline(never))]
    // REQ-TRANSIT-1.
    fn certify(&self, at: Instant, seen: &Seen) -> Certificate {
        let sight = Sight::new(&self.motion, seen);
        let (closeness, rate) = self.reach.closeness(&sight);
        let now = Approach { at, closeness, rate };
        let inside = self.reach.inside(&sight);
        let was_inside = matches!(self.state.stage, Stage::Inside(_));
        let crossing = self.state.previous.and_then(|before| match (was_inside, inside) {
            (false, true) => {
                let seconds = self.reach.since_entry(&sight);
                // Outside a ns ago and inside for longer, as from here it seems: it jumped in.
                let jumped = at.since(before.at).ns() == 1 && seconds > 1.5e-9;
                Some(if jumped { at } else { back(at, seconds, before.at) })
            }
            (true, false) => Some(back(at, self.reach.since_exit(&sight), before.at)),
            _ => None,
        });
        let stays_s = match (was_inside, inside) {
            (_, true) => self.reach.stays_inside(&self.motion, &sight),
            (false, false) => self.reach.stays_outside(&self.motion, &sight),
            (true, false) => 0.0,
        };
        let curvature = self.reach.closeness_curvature(&self.motion, &sight);
        Certificate { now, inside, crossing, stays_s, latest: seen.latest_step(at), curvature }
    }

    /// The visit that the evaluation finds in progress, before any summit is known.
    #[cfg_attr(target_os = "none", inline(never))]
    fn visit(&self, seen: &Certificate) -> Option<Visit> {
        match self.state.stage {
            Stage::Inside(visit) => Some(visit),
            Stage::Outside if seen.inside => Some(Visit {
                entry: seen.crossing.unwrap_or(seen.now.at),
                clipped: seen.crossing.is_none(),
                best: seen.now,
            }),
            Stage::Outside | Stage::Found(_) | Stage::Done => None,
        }
    }

    /// The entry or exit since the previous evaluation, where the closest approach may lie there: in
    /// a rectangle the target may come closer to the centre up to an exit, or go away from an entry
    /// on. Elsewhere an edge is the farthest part of a transit.
    #[cfg_attr(target_os = "none", inline(never))]
    // REQ-TRANSIT-5.
    fn closest_at_the_edge(&self, seen: &Certificate) -> Option<Instant> {
        let (crossing, before) = (seen.crossing?, self.state.previous?);
        let closer = if seen.inside {
            seen.now.rate <= 0.0
        } else {
            seen.now.rate > 0.0 || before.rate > 0.0
        };
        (self.reach.has_sides() && closer).then_some(crossing)
    }

    /// Whether an approach closer than the best may lie between two instants.
    fn rises(&self, seen: &Certificate, (low, high): (&Approach, &Approach)) -> bool {
        let Some(visit) = self.visit(seen) else { return false };
        if !(low.rate > 0.0 && high.rate <= 0.0) {
            return false;
        }
        let span = high.at.since(low.at).seconds();
        let ceiling =
            libm::fmax(low.closeness, high.closeness) + 0.125 * seen.curvature * span * span;
        ceiling > visit.best.closeness
    }

    /// Moves the state on by what was seen.
    #[cfg_attr(target_os = "none", inline(never))]
    fn conclude(&mut self, seen: &Certificate, summit: Option<Approach>) {
        let now = seen.now;
        let Some(mut visit) = self.visit(seen) else {
            if self.state.stage == Stage::Outside {
                if now.at >= self.state.end {
                    self.state.stage = Stage::Done;
                } else {
                    self.move_on(seen);
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
            self.finish(visit, visit.best, seen.crossing.unwrap_or(now.at), false);
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
            self.move_on(seen);
        }
    }

    /// The one place where the search evaluates, so that the count is whole.
    #[cfg_attr(target_os = "none", inline(never))]
    fn see(
        &mut self,
        at: Instant,
        lookup: &Lookup<'_, '_>,
        seen: &mut Seen,
    ) -> Result<(), EphemerisError> {
        self.count();
        seen.evaluate(at, &self.motion, lookup.sun, lookup.target)
    }

    /// Counts an evaluation.
    pub(super) const fn count(&mut self) {
        self.evaluations = self.evaluations.wrapping_add(1);
    }

    /// The target at any instant; not counted.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn sight_at(
        &self,
        at: Instant,
        lookup: &Lookup<'_, '_>,
    ) -> Result<Sight, EphemerisError> {
        let mut seen = Seen::NOTHING;
        seen.evaluate(at, &self.motion, lookup.sun, lookup.target)?;
        Ok(Sight::new(&self.motion, &seen))
    }

    pub(super) const fn motion(&self) -> &Motion {
        &self.motion
    }

    pub(super) const fn reach(&self) -> &Reach {
        &self.reach
    }

    /// How close the target is at `at`.
    #[cfg_attr(target_os = "none", inline(never))]
    fn approach(&self, at: Instant, seen: &Seen) -> Approach {
        let (closeness, rate) = self.reach.closeness(&Sight::new(&self.motion, seen));
        Approach { at, closeness, rate }
    }

    #[cfg_attr(target_os = "none", inline(never))]
    // REQ-TRANSIT-3.
    fn move_on(&mut self, seen: &Certificate) {
        let whole_ns = Duration::from_seconds_floor(seen.stays_s).ns();
        let next = seen.now.at.plus(Duration::from_ns(whole_ns.max(1)));
        self.state.at = next.min(seen.latest).min(self.state.end);
        self.state.previous = Some(seen.now);
    }

    #[cfg_attr(target_os = "none", inline(never))]
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

    /// The maximum of closeness since the previous evaluation, within the visit, where that may be a
    /// new best: at an edge, or by false position on its rate (Illinois).
    #[cfg_attr(target_os = "none", inline(never))]
    // REQ-TRANSIT-6.
    fn summit(
        &mut self,
        certificate: &Certificate,
        lookup: &Lookup<'_, '_>,
        seen: &mut Seen,
    ) -> Result<Option<Approach>, EphemerisError> {
        let Some(mut low) = self.state.previous else { return Ok(None) };
        let mut high = certificate.now;
        let mut best = None;
        let mut evaluated = 0;
        if let Some(edge) = self.closest_at_the_edge(certificate) {
            let mut there = high;
            if edge < high.at {
                self.see(edge, lookup, seen)?;
                evaluated = 1;
                there = self.approach(edge, seen);
            }
            *(if certificate.inside { &mut low } else { &mut high }) = there;
            best = Some(there);
        }
        if !self.rises(certificate, (&low, &high)) {
            return Ok(best);
        }
        let mut best = if low.closeness > high.closeness { low } else { high };
        let mut kept_low = 0_i8;
        for _ in evaluated..REFINEMENTS {
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

/// The earliest instant to which [`back`] corrects from `at`.
// REQ-TRANSIT-4.
const fn earliest(at: Instant, certified: Instant) -> Instant {
    let corrected = at.plus(Duration::from_ns(-LONGEST_CORRECTION_NS));
    if corrected.tai_ns() < certified.tai_ns() { certified } else { corrected }
}

/// `seconds` before `at`, but neither beyond the longest correction nor before `certified`, up to
/// which no crossing was possible.
#[cfg_attr(target_os = "none", inline(never))]
fn back(at: Instant, seconds: f64, certified: Instant) -> Instant {
    if seconds > Duration::from_ns(LONGEST_CORRECTION_NS).seconds() {
        return at;
    }
    let corrected = at.plus(Duration::from_seconds(-seconds));
    if corrected < certified { certified } else { corrected }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    fn at(ns: i64) -> Instant {
        Instant::from_tai_ns(ns)
    }

    #[test]
    fn an_offset_is_kept_strictly_inside() {
        let kept = [-5, 0, 1, 2, 8, 9, 10, 11].map(|offset| within(offset, 10));
        assert_eq!(kept, [1, 1, 1, 2, 8, 9, 9, 9]);
    }

    #[test]
    // REQ-TRANSIT-4.
    fn a_correction_reaches_back_a_millisecond_and_not_before_what_is_certified() {
        assert_eq!(back(at(5 * MS), 0.4e-3, at(0)), at(5 * MS - 400_000));
        assert_eq!(back(at(5 * MS), 1e-3, at(0)), at(4 * MS), "the longest");
        assert_eq!(back(at(5 * MS), 1.000_001e-3, at(0)), at(5 * MS), "none beyond");
        assert_eq!(back(at(5 * MS), 0.4e-3, at(5 * MS - 400_000)), at(5 * MS - 400_000));
        assert_eq!(back(at(5 * MS), 0.4e-3, at(5 * MS - 399_999)), at(5 * MS - 399_999));
        assert_eq!(earliest(at(5 * MS), at(0)), at(4 * MS));
        assert_eq!(earliest(at(5 * MS), at(4 * MS)), at(4 * MS));
        assert_eq!(earliest(at(5 * MS), at(4 * MS + 1)), at(4 * MS + 1));
    }

    #[test]
    // REQ-TRANSIT-4.
    fn the_frontier_is_the_earliest_entry_that_can_still_come() {
        let seen = Approach { at: at(2 * MS), closeness: -1.0, rate: 0.0 };
        let frontier = |previous, stage| {
            let state = SearchState { at: at(9 * MS), end: at(99 * MS), previous, stage };
            Search { state, ..Search::nothing() }.frontier()
        };
        assert_eq!(frontier(None, Stage::Outside), Some(at(9 * MS)));
        assert_eq!(frontier(Some(seen), Stage::Outside), Some(at(8 * MS)));
        let near = Approach { at: at(9 * MS - 5), ..seen };
        assert_eq!(frontier(Some(near), Stage::Outside), Some(at(9 * MS - 5)));
        let visit = Visit { entry: at(3 * MS), clipped: false, best: seen };
        assert_eq!(frontier(Some(seen), Stage::Inside(visit)), Some(at(3 * MS)));
        assert_eq!(frontier(Some(seen), Stage::Done), None);
    }

    #[test]
    // REQ-TRANSIT-6.
    fn only_a_summit_that_may_be_the_best_is_looked_for() {
        let approach =
            |ns: i64, closeness: f64, rate: f64| Approach { at: at(ns), closeness, rate };
        let best = approach(0, -0.1, 0.0);
        let stage = Stage::Inside(Visit { entry: at(0), clipped: false, best });
        let mut search = Search::nothing();
        search.state = SearchState { at: at(0), end: at(99), previous: None, stage };
        let certificate = Certificate {
            now: best,
            inside: true,
            crossing: None,
            stays_s: 0.0,
            latest: at(99),
            curvature: 0.8,
        };
        let rises = |low: Approach, high: Approach| search.rises(&certificate, (&low, &high));
        // Over a second a curvature of 0.8 lifts by 0.1 above the higher end.
        let second = 1_000 * MS;
        assert!(rises(approach(0, -0.3, 1.0), approach(second, -0.199, -1.0)));
        assert!(!rises(approach(0, -0.3, 1.0), approach(second, -0.201, -1.0)));
        assert!(rises(approach(0, -0.199, 1.0), approach(second, -0.3, -1.0)));
        assert!(rises(approach(0, -0.599, 1.0), approach(2 * second, -0.499, -1.0)));
        assert!(!rises(approach(0, -0.599, 1.0), approach(2 * second, -0.501, -1.0)));
        // Only where closeness rises first and falls then.
        for (first, then, expected) in
            [(1.0, 1.0, false), (-1.0, -1.0, false), (0.0, -1.0, false), (1.0, 0.0, true)]
        {
            let own = rises(approach(0, -0.15, first), approach(second, -0.15, then));
            assert_eq!(own, expected, "{first} {then}");
        }
    }

    #[test]
    // REQ-TRANSIT-3.
    fn a_step_is_as_long_as_certified_and_at_least_a_nanosecond() {
        let now = Approach { at: at(100), closeness: -1.0, rate: 0.0 };
        let moved = |stays_s: f64, latest: i64, end: i64| {
            let state =
                SearchState { at: at(100), end: at(end), previous: None, stage: Stage::Outside };
            let mut search = Search { state, ..Search::nothing() };
            search.move_on(&Certificate {
                now,
                inside: false,
                crossing: None,
                stays_s,
                latest: at(latest),
                curvature: 0.0,
            });
            assert_eq!(search.state.previous, Some(now));
            search.state.at
        };
        assert_eq!(moved(50.9e-9, 1_000, 1_000), at(150));
        assert_eq!(moved(0.0, 1_000, 1_000), at(101));
        assert_eq!(moved(1.0, 700, 1_000), at(700));
        assert_eq!(moved(1.0, 1_000, 600), at(600));
    }
}
