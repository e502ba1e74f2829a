//! Does a schedule meet every rule.
//!
//! Method: straight from the problem's own words, in wide integers, with nothing from the modules
//! that build schedules: overlap by a sweep over sorted intervals, minutes per day by clipping each
//! interval to each day, starts per window by counting from every start.

use super::{Exclusive, Problem, fulfil};
use onboard_core::time::{Duration, Instant};
use std::collections::BTreeMap;
use thiserror::Error;

/// A rule that a schedule breaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum Violation {
    /// No such candidate.
    #[error("candidate {0} does not exist")]
    Unknown(usize),
    /// Taken twice.
    #[error("candidate {0} is taken twice")]
    Twice(usize),
    /// A session reaches outside the mission.
    #[error("the session of candidate {0} reaches outside the mission")]
    Outside(usize),
    /// Two sessions overlap that must not.
    #[error("the sessions of candidates {0} and {1} overlap")]
    Overlap(usize, usize),
    /// A day is overfull.
    #[error("day {day} has {used_ns} ns reserved, more than {limit_ns} ns")]
    Day {
        /// Index of the day, from the first boundary.
        day: usize,
        /// Reserved time.
        used_ns: i128,
        /// The limit.
        limit_ns: i64,
    },
    /// A window holds too many starts.
    #[error("{starts} sessions start in the window from {from_tai_ns} ns TAI, more than {count}")]
    Count {
        /// Start of the window.
        from_tai_ns: i128,
        /// Starts in it.
        starts: usize,
        /// Most allowed.
        count: u32,
    },
    /// A forbidden session stands.
    #[error("candidate {0} is forbidden")]
    Forbidden(usize),
    /// A session too near to a body to avoid stands.
    #[error("candidate {0} comes too near to a body to avoid")]
    Avoided(usize),
    /// A session touches a blackout.
    #[error("the session of candidate {0} touches a blackout")]
    Blackout(usize),
    /// A session that must stand does not.
    #[error("candidate {0} must stand and does not")]
    Fixed(usize),
    /// A window holds too much reserved time.
    #[error("{used_ns} ns are reserved in the thermal window from {from_tai_ns} ns TAI")]
    Thermal {
        /// Start of the window.
        from_tai_ns: i128,
        /// Reserved time in it.
        used_ns: i128,
    },
    /// The memory overflows.
    #[error("the memory would hold {held_bit} bits at {at_tai_ns} ns TAI")]
    Memory {
        /// When.
        at_tai_ns: i128,
        /// What it would hold.
        held_bit: i128,
    },
    /// Scan angles are too alike.
    #[error("scan angles of target {target} on telescope {telescope} are too alike at n = {n}")]
    ScanAngle {
        /// Multiple of the crossing angle.
        n: u32,
        /// Index of the target.
        target: usize,
        /// Index of the telescope.
        telescope: usize,
    },
    /// A season holds too few sessions.
    #[error(
        "a season of target {target} on telescope {telescope} holds {held} sessions, fewer than \
         {wanted}"
    )]
    Season {
        /// Index of the target.
        target: usize,
        /// Index of the telescope.
        telescope: usize,
        /// Sessions in it.
        held: i128,
        /// Fewest allowed.
        wanted: i128,
    },
}

/// A reserved interval.
#[derive(Debug, Clone, Copy)]
struct Interval {
    candidate: usize,
    from: i128,
    until: i128,
}

/// Checks a set of candidates against every rule of its problem.
///
/// # Errors
/// The first [`Violation`] found.
pub fn check(problem: &Problem, chosen: &[usize]) -> Result<(), Violation> {
    let rules = &problem.rules;
    let ns = |at: Instant| i128::from(at.tai_ns());
    let length = |span: Duration| i128::from(span.ns());
    let mut all = Vec::with_capacity(chosen.len());
    for &candidate in chosen {
        let it = problem.candidates.get(candidate).ok_or(Violation::Unknown(candidate))?;
        let from = ns(it.first_entry) - length(rules.setup);
        let until = ns(it.last_exit) + length(rules.cooldown);
        if from < ns(problem.span.0) || until > ns(problem.span.1) {
            return Err(Violation::Outside(candidate));
        }
        all.push(Interval { candidate, from, until });
    }
    let mut sorted = chosen.to_vec();
    sorted.sort_unstable();
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Violation::Twice(pair[0]));
    }
    check_overlap(problem, &all)?;
    check_days(problem, &all)?;
    check_counts(problem, &all)?;
    fulfil::demands(problem, chosen)
}

fn check_overlap(problem: &Problem, all: &[Interval]) -> Result<(), Violation> {
    let mut groups: BTreeMap<usize, Vec<Interval>> = BTreeMap::new();
    for interval in all {
        let group = match problem.rules.exclusive {
            Exclusive::None => return Ok(()),
            Exclusive::Telescope => problem.candidates[interval.candidate].telescope,
            Exclusive::All => 0,
        };
        groups.entry(group).or_default().push(*interval);
    }
    for group in groups.values_mut() {
        group.sort_unstable_by_key(|it| (it.from, it.until, it.candidate));
        for pair in group.windows(2) {
            if pair[1].from < pair[0].until {
                return Err(Violation::Overlap(pair[0].candidate, pair[1].candidate));
            }
        }
    }
    Ok(())
}

fn check_days(problem: &Problem, all: &[Interval]) -> Result<(), Violation> {
    let Some(limit) = problem.rules.max_per_day else { return Ok(()) };
    let mut ordered = all.to_vec();
    ordered.sort_unstable_by_key(|it| it.from);
    let longest = ordered.iter().map(|it| it.until - it.from).max().unwrap_or(0);
    for (day, pair) in problem.rules.day_boundaries.windows(2).enumerate() {
        let (from, until) = (i128::from(pair[0].tai_ns()), i128::from(pair[1].tai_ns()));
        let first = ordered.partition_point(|it| it.from < from - longest);
        let used_ns: i128 = ordered[first..]
            .iter()
            .take_while(|it| it.from < until)
            .map(|it| (it.until.min(until) - it.from.max(from)).max(0))
            .sum();
        if used_ns > i128::from(limit.ns()) {
            return Err(Violation::Day { day, used_ns, limit_ns: limit.ns() });
        }
    }
    Ok(())
}

fn check_counts(problem: &Problem, all: &[Interval]) -> Result<(), Violation> {
    let Some(rule) = problem.rules.max_sessions else { return Ok(()) };
    let mut starts: Vec<i128> = all.iter().map(|it| it.from).collect();
    starts.sort_unstable();
    let mut last = 0;
    for (first, &from_tai_ns) in starts.iter().enumerate() {
        while last < starts.len() && starts[last] < from_tai_ns + i128::from(rule.window.ns()) {
            last += 1;
        }
        let inside = last - first;
        if u32::try_from(inside).map_or(true, |inside| inside > rule.count) {
            return Err(Violation::Count { from_tai_ns, starts: inside, count: rule.count });
        }
    }
    Ok(())
}
