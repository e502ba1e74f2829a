//! Which chances to calibrate does a mission offer.
//!
//! A [`Pass`] is one transit of a target through a detector or a telescope's field of view. An
//! [`Opportunity`] is passes of one target over one telescope that belong together as
//! [`Sessions`] says: those of a precession turn, counted in completed turns since the
//! mission's start at the pass's entry, or those with short pauses between them (`bursts.rs`).
//!
//! Method: one sort by target, telescope and entry; the dwell of a telescope is the length of
//! the union of its passes, so that detectors seeing the target together count once. Integers only.
//!
//! Limits: a pass belongs to the turn of its entry. Where passes of two turns overlap in time (two
//! detectors at the change of turn) each of the two opportunities holds its own dwell. A number that
//! pauses decide changes where the first entry moves over a multiple of the longest pause.
//!
//! # Example
//! Two detectors see a target together, in a turn of 2^43 ns (2.4 h):
//! ```
//! use mission::sessions::Sessions;
//! use onboard_core::phase::{Phase, Rotor, TurnRate};
//! use onboard_core::scan::{ScanParameters, ScanStrategy};
//! use onboard_core::time::{Duration, Instant};
//! use planner::opportunities::{Opportunities, Pass};
//!
//! let at = |seconds| Instant::from_tai_ns(0).plus(Duration::from_seconds(seconds));
//! let start = Phase::from_bits(0);
//! let rotor = |bits| Rotor { rate: TurnRate::from_bits(1_u128 << (128 - bits)), start };
//! let (precession, spin, alpha_rad, beta_rad) = (rotor(43), rotor(40), 0.79, 0.87);
//! let scan = ScanParameters { start: at(0.0), alpha_rad, beta_rad, precession, spin };
//! let pass = |detector, entry, exit| {
//!     let (entry_clipped, exit_clipped, closest) = (false, false, entry);
//!     Pass { target: 0, telescope: 0, detector, entry, exit, closest, entry_clipped, exit_clipped }
//! };
//! let passes = [pass(0, at(60.0), at(90.0)), pass(1, at(80.0), at(120.0))];
//! let scan = ScanStrategy::new(scan).expect("a legal scan");
//! let found = Opportunities::group(&passes, &scan, Sessions::ByTurn)?;
//! assert_eq!((found.list().len(), found.list()[0].dwell), (1, Duration::from_seconds(60.0)));
//! # Ok::<(), planner::opportunities::OpportunityError>(())
//! ```

use super::bursts;
use super::pass::Pass;
use mission::sessions::Sessions;
use onboard_core::scan::ScanStrategy;
use onboard_core::time::{Duration, Instant};
use std::ops::Range;
use thiserror::Error;

/// Passes of one target over one telescope that belong together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Opportunity {
    /// Index of the target.
    pub target: usize,
    /// Index of the telescope.
    pub telescope: usize,
    /// Completed precession turns since the mission's start, or the number that its place on the scan
    /// clock gives; no other of its target and telescope has it.
    pub number: u64,
    /// Entry of the earliest pass.
    pub first_entry: Instant,
    /// Latest exit of any pass.
    pub last_exit: Instant,
    /// Time with the target inside any detector.
    pub dwell: Duration,
    /// Where its passes stand in [`Opportunities::passes`].
    members: Range<usize>,
}

/// The opportunities of a mission, by first entry, then target, then telescope.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Opportunities {
    list: Vec<Opportunity>,
    order: Vec<usize>,
}

/// Why passes cannot be grouped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum OpportunityError {
    /// A pass ends before it begins.
    #[error("pass {index} ends at {exit_tai_ns} ns TAI, before its entry at {entry_tai_ns} ns TAI")]
    Reversed {
        /// Index of the pass.
        index: usize,
        /// Its entry.
        entry_tai_ns: i64,
        /// Its exit.
        exit_tai_ns: i64,
    },
    /// A pass begins before the mission, where turns are not counted.
    #[error(
        "pass {index} begins at {entry_tai_ns} ns TAI, before the mission's start at \
         {start_tai_ns} ns TAI"
    )]
    BeforeStart {
        /// Index of the pass.
        index: usize,
        /// Its entry.
        entry_tai_ns: i64,
        /// Start of the mission.
        start_tai_ns: i64,
    },
}

impl Opportunities {
    /// Groups passes, given in any order.
    ///
    /// # Errors
    /// [`OpportunityError`] names the pass that cannot be placed.
    pub fn group(
        passes: &[Pass],
        scan: &ScanStrategy,
        sessions: Sessions,
    ) -> Result<Self, OpportunityError> {
        let start = scan.parameters().start;
        for (index, pass) in passes.iter().enumerate() {
            let (entry_tai_ns, exit_tai_ns) = (pass.entry.tai_ns(), pass.exit.tai_ns());
            if pass.exit < pass.entry {
                return Err(OpportunityError::Reversed { index, entry_tai_ns, exit_tai_ns });
            }
            if pass.entry < start {
                let start_tai_ns = start.tai_ns();
                return Err(OpportunityError::BeforeStart { index, entry_tai_ns, start_tai_ns });
            }
        }
        let mut order: Vec<usize> = (0..passes.len()).collect();
        order.sort_unstable_by_key(|&index| {
            let it = &passes[index];
            (it.target, it.telescope, it.entry, it.detector, index)
        });
        let mut list = Vec::new();
        let mut first = 0;
        let seen_by = |index: &usize| (passes[*index].target, passes[*index].telescope);
        for of_one in order.chunk_by(|a, b| seen_by(a) == seen_by(b)) {
            let times: Vec<&Pass> = of_one.iter().map(|&index| &passes[index]).collect();
            let groups = match sessions {
                Sessions::ByTurn => by_turn(&times, scan),
                Sessions::ByPause { .. } => bursts::by_pause(&times, start, sessions),
            };
            for (number, members) in groups {
                let (dwell, last_exit) = union(times[members.clone()].iter().copied());
                let members = first + members.start..first + members.end;
                let Pass { target, telescope, entry: first_entry, .. } =
                    passes[order[members.start]];
                list.push(Opportunity {
                    target,
                    telescope,
                    number,
                    first_entry,
                    last_exit,
                    dwell,
                    members,
                });
            }
            first += of_one.len();
        }
        list.sort_unstable_by_key(|it: &Opportunity| (it.first_entry, it.target, it.telescope));
        Ok(Self { list, order })
    }

    /// The opportunities, by first entry, then target, then telescope.
    #[must_use]
    pub fn list(&self) -> &[Opportunity] {
        &self.list
    }

    /// Keeps those that lie within a span; the passes that are theirs, ascending, which from then on are all
    /// that there are.
    pub(super) fn keep_within(&mut self, (from, until): (Instant, Instant)) -> Vec<usize> {
        self.list.retain(|it| it.first_entry >= from && it.last_exit <= until);
        let mut kept: Vec<usize> = self
            .list
            .iter()
            .flat_map(|it| self.order[it.members.clone()].iter().copied())
            .collect();
        kept.sort_unstable();
        let mut order = Vec::with_capacity(kept.len());
        for it in &mut self.list {
            let first = order.len();
            let places = self.order[it.members.clone()].iter();
            order.extend(places.filter_map(|pass| kept.binary_search(pass).ok()));
            it.members = first..order.len();
        }
        self.order = order;
        kept
    }

    /// Indices of an opportunity's passes in the slice that was grouped, by entry, then detector.
    #[must_use]
    pub fn passes(&self, opportunity: &Opportunity) -> &[usize] {
        &self.order[opportunity.members.clone()]
    }
}

/// Passes of one target over one telescope, by entry, grouped by the turn of their entry.
fn by_turn(passes: &[&Pass], scan: &ScanStrategy) -> Vec<(u64, Range<usize>)> {
    let turns: Vec<u64> = passes.iter().map(|it| scan.turns(it.entry).0).collect();
    let mut first = 0;
    let group = |group: &[u64]| {
        let members = first..first + group.len();
        first = members.end;
        (group[0], members)
    };
    turns.chunk_by(|a, b| a == b).map(group).collect()
}

/// Length of the union of intervals that come ordered by entry, and the latest exit.
fn union<'a>(passes: impl Iterator<Item = &'a Pass>) -> (Duration, Instant) {
    let (mut covered_to, mut dwell_ns) = (Instant::from_tai_ns(i64::MIN), 0_i64);
    for pass in passes {
        let fresh = pass.entry.max(covered_to);
        if pass.exit > fresh {
            dwell_ns = dwell_ns.saturating_add(pass.exit.since(fresh).ns());
        }
        covered_to = covered_to.max(pass.exit);
    }
    (Duration::from_ns(dwell_ns), covered_to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use onboard_core::phase::{Phase, Rotor, TurnRate};
    use onboard_core::scan::ScanParameters;

    const TURN_NS: i64 = 1 << 40;

    fn scan(start: i64) -> ScanStrategy {
        let rotor =
            |bits| Rotor { rate: TurnRate::from_bits(1_u128 << bits), start: Phase::from_bits(7) };
        ScanStrategy::new(ScanParameters {
            start: Instant::from_tai_ns(start),
            alpha_rad: 0.7,
            beta_rad: 0.8,
            precession: rotor(128 - 40),
            spin: rotor(128 - 37),
        })
        .unwrap()
    }

    fn pass(target: usize, telescope: usize, detector: usize, (entry, exit): (i64, i64)) -> Pass {
        Pass {
            target,
            telescope,
            detector,
            entry: Instant::from_tai_ns(entry),
            exit: Instant::from_tai_ns(exit),
            closest: Instant::from_tai_ns(entry),
            entry_clipped: false,
            exit_clipped: false,
        }
    }

    #[test]
    fn passes_group_by_target_telescope_and_turn() {
        let passes = [
            pass(1, 0, 0, (TURN_NS - 5, TURN_NS + 5)),
            pass(0, 0, 0, (TURN_NS, TURN_NS + 3)),
            pass(1, 0, 0, (10, 20)),
            pass(1, 1, 0, (10, 20)),
            pass(1, 0, 0, (TURN_NS, TURN_NS + 9)),
        ];
        let found = Opportunities::group(&passes, &scan(0), Sessions::ByTurn).unwrap();
        let seen: Vec<_> = found
            .list()
            .iter()
            .map(|o| (o.target, o.telescope, o.number, o.dwell.ns(), found.passes(o).to_vec()))
            .collect();
        assert_eq!(
            seen,
            [
                (1, 0, 0, 20, vec![2, 0]),
                (1, 1, 0, 10, vec![3]),
                (0, 0, 1, 3, vec![1]),
                (1, 0, 1, 9, vec![4]),
            ]
        );
        assert_eq!(found.list()[0].last_exit.tai_ns(), TURN_NS + 5);
    }

    #[test]
    fn detectors_that_see_the_target_together_count_once() {
        // Overlapping, contained, touching, apart, and of no length.
        let times = [(10, 30), (20, 40), (22, 25), (40, 50), (60, 70), (65, 65)];
        let passes: Vec<_> =
            times.iter().enumerate().map(|(detector, &time)| pass(0, 0, detector, time)).collect();
        let found = Opportunities::group(&passes, &scan(0), Sessions::ByTurn).unwrap();
        assert_eq!(found.list().len(), 1);
        assert_eq!(found.list()[0].dwell.ns(), 50);
        assert_eq!(found.list()[0].last_exit.tai_ns(), 70);
    }

    #[test]
    fn turns_count_from_the_start_and_not_from_the_phase() {
        let found = Opportunities::group(
            &[pass(0, 0, 0, (1_000 + TURN_NS, 2_000 + TURN_NS))],
            &scan(1_001),
            Sessions::ByTurn,
        );
        assert_eq!(found.unwrap().list()[0].number, 0);
    }

    #[test]
    fn a_span_keeps_what_lies_within_it() {
        let times = [(5, 8), (TURN_NS + 1, TURN_NS + 4), (2 * TURN_NS, 2 * TURN_NS + 9), (10, 20)];
        let passes: Vec<_> =
            times.iter().enumerate().map(|(detector, &time)| pass(0, 0, detector, time)).collect();
        let mut found = Opportunities::group(&passes, &scan(0), Sessions::ByTurn).unwrap();
        let at = Instant::from_tai_ns;
        assert_eq!(found.keep_within((at(5), at(2 * TURN_NS + 8))), [0, 1, 3]);
        let seen: Vec<_> = found.list().iter().map(|it| found.passes(it).to_vec()).collect();
        assert_eq!(seen, [vec![0, 2], vec![1]]);
    }

    #[test]
    fn impossible_passes_are_named() {
        let reversed = Opportunities::group(&[pass(0, 0, 0, (20, 10))], &scan(0), Sessions::ByTurn);
        assert!(matches!(reversed, Err(OpportunityError::Reversed { index: 0, .. })));
        let early = Opportunities::group(&[pass(0, 0, 0, (-20, 10))], &scan(0), Sessions::ByTurn);
        assert!(matches!(early, Err(OpportunityError::BeforeStart { index: 0, .. })));
        assert!(Opportunities::group(&[], &scan(0), Sessions::ByTurn).unwrap().list().is_empty());
    }
}
