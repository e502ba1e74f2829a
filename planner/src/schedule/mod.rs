//! Which opportunities to take, and how much better could any other choice be.
//!
//! A candidate is taken or not. A taken one is a **session**: it reserves the half-open interval
//! from its first entry less the setup to its last exit plus the cooldown. The objective is the sum
//! of weight times dwell in seconds; [`Rules`] say which sessions may stand together.
//!
//! Method: candidates that no schedule can hold are set aside (`model.rs`). Prices for the rules come
//! from the linear relaxation (`relaxation.rs`, Clarabel). An upper bound on every schedule follows
//! from them (`bound.rs`), and a sharper one by searching each day exactly with what joins the days
//! priced (`split.rs`, `search.rs`). Schedules, one by rounding the relaxation, others joined from
//! the days' best sets under different prices (`assemble.rs`), are improved by exchanges
//! (`improve.rs`), mixed and improved again; the integer programme (`whole.rs`) goes on from there. The result is checked by `check.rs`, which shares no code with the rest, and each
//! candidate left out gets the rule that excludes it (`explain.rs`). All arithmetic on time is in
//! integer nanoseconds, on value in integers.
//!
//! Limits: effort is bounded by counts of work, never by a clock, so equal input gives equal
//! output. The schedule need not be the best one; the bound holds for any prices, whatever the
//! solver did. Gaps reached are stated and held by `tests/schedule.rs`.

mod model;
mod price;
mod bound;
mod relaxation;
mod fill;
mod search;
mod split;
mod descent;
mod draft;
mod assemble;
mod improve;
mod explain;
mod demands;
mod families;
mod rows;
mod conflict;
mod whole;
mod fulfil;
mod loosen;
mod check;

pub use check::{Violation, check};
pub use conflict::{Conflict, RuleName};
pub use demands::{Contact, Data, Demands, Diversity, Log, LongestGap, Previous, Thermal};
pub use explain::{Because, ConstraintUse, Rejection, Rule};
pub use loosen::{Give, Loosening, loosen};
pub use whole::Stop;

use draft::Draft;
use improve::Priced;
use model::Model;
use onboard_core::time::{Duration, Instant};
use rayon::prelude::*;
use relaxation::Relaxed;
use std::fmt;
use thiserror::Error;

/// Most candidates in one problem.
pub const MAX_CANDIDATES: usize = 1 << 21;

/// A schedule within one part in this many of the bound is good enough.
const CLOSE: i128 = 100_000;
/// Most passes of exchanges over a schedule that was assembled, and over the mixture of all.
const PASSES: (usize, usize) = (1, 6);

/// One opportunity, as far as scheduling is concerned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Candidate {
    /// Index of the target, into [`Problem::weights`].
    pub target: usize,
    /// Index of the telescope.
    pub telescope: usize,
    /// First entry of its passes.
    pub first_entry: Instant,
    /// Last exit of its passes.
    pub last_exit: Instant,
    /// Time with the target in view.
    pub dwell: Duration,
}

/// Which sessions must not overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exclusive {
    /// Any may.
    None,
    /// No two on one telescope.
    Telescope,
    /// No two at all.
    All,
}

/// At most `count` sessions start in any half-open window of length `window`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SessionCount {
    /// Most sessions.
    pub count: u32,
    /// Length of the sliding window, positive.
    pub window: Duration,
}

/// What a schedule must respect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rules {
    /// Reserved before the first entry.
    pub setup: Duration,
    /// Reserved after the last exit.
    pub cooldown: Duration,
    /// Overlap of reserved intervals; intervals that touch do not overlap.
    pub exclusive: Exclusive,
    /// Most reserved time of all sessions together in each day; each day counts its own part.
    pub max_per_day: Option<Duration>,
    /// Most sessions per sliding window, by the start of the reserved interval.
    pub max_sessions: Option<SessionCount>,
    /// UTC midnights, ascending, from the mission's start or before to its end or after. Needed with
    /// `max_per_day`; days may differ in length.
    pub day_boundaries: Vec<Instant>,
}

/// A scheduling problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// Start and end of the mission; every reserved interval lies within.
    pub span: (Instant, Instant),
    /// The candidates.
    pub candidates: Vec<Candidate>,
    /// Weight of each target, finite and not negative.
    pub weights: Vec<f64>,
    /// The rules.
    pub rules: Rules,
    /// What else is asked for.
    pub demands: Demands,
}

/// Why the search for a better schedule ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stopped {
    /// The schedule reaches the bound: no other is better.
    Optimal,
    /// The schedule is within a hundred-thousandth of the bound.
    Close,
    /// No exchange within a day improves the schedule.
    LocalOptimum,
    /// The limit on the work was reached.
    WorkLimit,
    /// The caller asked to stop.
    Interrupted,
    /// The relaxation could not be solved: bound and schedule do without its prices.
    NoRelaxation,
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Optimal => "optimal: no schedule is better",
            Self::Close => "the schedule is within a hundred-thousandth of the bound",
            Self::LocalOptimum => "no exchange within a day improves the schedule",
            Self::WorkLimit => "the limit on the search's work was reached",
            Self::Interrupted => "stopped before the search's end: the best schedule so far",
            Self::NoRelaxation => {
                "the relaxation could not be solved, so bound and schedule do without its prices"
            }
        })
    }
}

/// A schedule, and how good it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// Indices of the taken candidates, by the start of their sessions.
    pub chosen: Vec<usize>,
    /// Sum of weight times dwell in seconds, or what the demands value instead.
    pub objective: f64,
    /// No schedule has a larger objective.
    pub upper_bound: f64,
    /// `(upper_bound - objective) / upper_bound`, 0 where the bound is 0.
    pub gap: f64,
    /// Why the search ended.
    pub stopped: Stopped,
    /// Every candidate that was not taken, by index.
    pub rejected: Vec<Rejection>,
    /// How far the rules are used.
    pub constraints: Vec<ConstraintUse>,
    /// Sessions added to or dropped from the earlier plan.
    pub changes: usize,
}

/// Why a problem has no schedule.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ScheduleError {
    /// A weight is not a number to optimise with.
    #[error("the weight of target {target} is {weight}, but must be finite and not negative")]
    Weight {
        /// Index of the target.
        target: usize,
        /// Its weight.
        weight: f64,
    },
    /// Weight times dwell is beyond the range of numbers.
    #[error("candidate {candidate}: weight times dwell exceeds the largest number")]
    Value {
        /// Index of the candidate.
        candidate: usize,
    },
    /// A candidate's target has no weight.
    #[error("candidate {candidate} has target {target}, but only {targets} targets have weights")]
    Target {
        /// Index of the candidate.
        candidate: usize,
        /// Its target.
        target: usize,
        /// Number of weights.
        targets: usize,
    },
    /// A candidate's times are impossible.
    #[error(
        "candidate {candidate} lasts {length_ns} ns and dwells {dwell_ns} ns, but the dwell must lie \
         from zero to the length"
    )]
    Dwell {
        /// Index of the candidate.
        candidate: usize,
        /// Last exit less first entry.
        length_ns: i64,
        /// Its dwell.
        dwell_ns: i64,
    },
    /// A rule's duration is out of range.
    #[error("{name} is {ns} ns, but must {must}")]
    Duration {
        /// Which duration.
        name: &'static str,
        /// Its value.
        ns: i64,
        /// What it must be.
        must: &'static str,
    },
    /// The mission ends before it starts.
    #[error("the mission ends {0} ns before it starts")]
    Span(i64),
    /// Day boundaries are out of order.
    #[error("day boundary {0} is not after the one before it")]
    DayOrder(usize),
    /// Day boundaries do not cover the mission.
    #[error("minutes per day are limited, but the day boundaries do not cover the mission")]
    DayCover,
    /// More candidates than [`MAX_CANDIDATES`].
    #[error("there are {0} candidates, but at most {MAX_CANDIDATES} can be scheduled")]
    TooMany(usize),
    /// A list of a demand has not one entry per candidate.
    #[error("{name} has {entries} entries for {candidates} candidates")]
    Entries {
        /// Which demand.
        name: &'static str,
        /// Its entries.
        entries: usize,
        /// Number of candidates.
        candidates: usize,
    },
    /// A demand names a candidate that does not exist.
    #[error("{name} names candidate {candidate}, which does not exist")]
    Candidate {
        /// Which demand.
        name: &'static str,
        /// The candidate.
        candidate: usize,
    },
    /// A number of a demand is out of range.
    #[error("{name} is {number}, but must {must}")]
    Number {
        /// Which number.
        name: &'static str,
        /// Its value.
        number: f64,
        /// What it must be.
        must: &'static str,
    },
    /// Contacts overlap or end before they start.
    #[error("ground contact {0} does not come after the one before it, or ends before it starts")]
    Contacts(usize),
    /// The rules contradict each other.
    #[error("{0}")]
    Infeasible(Conflict),
    /// The search found no schedule, and no proof that there is none.
    #[error("the search found no schedule that meets all rules, nor a proof that there is none")]
    NotFound,
    /// The program's own schedule broke a rule.
    #[error("internal: the schedule found breaks a rule: {0}")]
    Unsound(Violation),
}

impl Problem {
    /// The interval that a candidate's session reserves, half-open.
    #[must_use]
    pub fn reserved(&self, candidate: usize) -> (Instant, Instant) {
        let it = &self.candidates[candidate];
        let setup = Duration::from_ns(self.rules.setup.ns().saturating_neg());
        (it.first_entry.plus(setup), it.last_exit.plus(self.rules.cooldown))
    }

    /// What taking a candidate adds to the objective.
    #[must_use]
    pub fn value(&self, candidate: usize) -> f64 {
        let it = &self.candidates[candidate];
        let own = self.demands.values.get(candidate).copied();
        own.unwrap_or_else(|| self.weights[it.target] * it.dwell.seconds())
    }

    fn validate(&self) -> Result<(), ScheduleError> {
        let rules = &self.rules;
        let at_least = |name, ns, least: i64, must| {
            if ns < least { Err(ScheduleError::Duration { name, ns, must }) } else { Ok(()) }
        };
        at_least("the setup", rules.setup.ns(), 0, "not be negative")?;
        at_least("the cooldown", rules.cooldown.ns(), 0, "not be negative")?;
        if let Some(limit) = rules.max_per_day {
            at_least("the reserved time per day", limit.ns(), 0, "not be negative")?;
        }
        if let Some(sessions) = rules.max_sessions {
            at_least("the window of max_sessions", sessions.window.ns(), 1, "be positive")?;
        }
        let (start, end) = self.span;
        if end < start {
            return Err(ScheduleError::Span(start.since(end).ns()));
        }
        if let Some(at) = rules.day_boundaries.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(ScheduleError::DayOrder(at + 1));
        }
        if rules.max_per_day.is_some() {
            let covered = rules.day_boundaries.first().is_some_and(|first| *first <= start)
                && rules.day_boundaries.last().is_some_and(|last| *last >= end);
            if !covered {
                return Err(ScheduleError::DayCover);
            }
        }
        for (target, &weight) in self.weights.iter().enumerate() {
            if !(weight.is_finite() && weight >= 0.0) {
                return Err(ScheduleError::Weight { target, weight });
            }
        }
        if self.candidates.len() > MAX_CANDIDATES {
            return Err(ScheduleError::TooMany(self.candidates.len()));
        }
        self.validate_candidates()
    }

    fn validate_candidates(&self) -> Result<(), ScheduleError> {
        for (candidate, it) in self.candidates.iter().enumerate() {
            let targets = self.weights.len();
            if it.target >= targets {
                return Err(ScheduleError::Target { candidate, target: it.target, targets });
            }
            let length_ns = it.last_exit.since(it.first_entry).ns();
            let dwell_ns = it.dwell.ns();
            if dwell_ns < 0 || dwell_ns > length_ns {
                return Err(ScheduleError::Dwell { candidate, length_ns, dwell_ns });
            }
            if !self.value(candidate).is_finite() {
                return Err(ScheduleError::Value { candidate });
            }
        }
        self.demands.validate(self.candidates.len())
    }
}

/// Finds a good schedule and a bound on all schedules.
///
/// # Errors
/// [`ScheduleError`] when the problem is not well posed, or its rules contradict each other.
pub fn schedule(problem: &Problem) -> Result<Schedule, ScheduleError> {
    schedule_until(problem, None)
}

/// As [`schedule`], until `stop` says to stop: then the best schedule so far, its bound still safe.
/// Asked between steps of the search, and not while a relaxation is solved.
///
/// # Errors
/// As [`schedule`]; [`ScheduleError::NotFound`] where nothing was found in time.
pub fn schedule_until(problem: &Problem, stop: Stop<'_>) -> Result<Schedule, ScheduleError> {
    problem.validate()?;
    whole::schedule(problem, stop)
}

/// The best schedule found, a bound on all schedules in units, and why the search ended.
fn best<'a>(model: &'a Model, relaxed: &Relaxed, stop: Stop<'_>) -> (Draft<'a>, i128, Stopped) {
    let prices = &relaxed.prices;
    let mut bound = bound::priced(model, prices);
    let rounded = improve::round(model, relaxed);
    if let Some(stopped) = close(&rounded, bound) {
        return (rounded, bound, stopped);
    }
    let reduced = Priced::new(model, prices);
    let scale = relaxed.typical_value(model);
    let enough = i128::from(rounded.value());
    let sharpened = split::sharpen(model, prices, (scale, enough), stop);
    bound = bound.min(sharpened.bound);
    if let Some(stopped) = close(&rounded, bound) {
        return (rounded, bound, stopped);
    }
    if asked(stop) {
        return (rounded, bound, Stopped::Interrupted);
    }
    let mut drafts: Vec<Draft<'a>> = sharpened
        .splits
        .par_iter()
        .map(|split| {
            let mut draft = assemble::assemble(split, &sharpened.patterns, scale);
            improve::improve(&mut draft, model, &reduced, (PASSES.0, stop));
            draft
        })
        .collect();
    drafts.push(rounded);
    let settled = sharpened.splits.last().is_some_and(|split| {
        let mut mixed = assemble::splice(split, &drafts);
        let settled = improve::improve(&mut mixed, model, &reduced, (PASSES.1, stop));
        drafts.insert(0, mixed);
        settled
    });
    // The first of equals.
    let draft =
        drafts.into_iter().rev().max_by_key(Draft::value).unwrap_or_else(|| Draft::new(model));
    let stopped = match (relaxed.solved, settled) {
        (false, _) => Stopped::NoRelaxation,
        (true, true) => Stopped::LocalOptimum,
        (true, false) => Stopped::WorkLimit,
    };
    let stopped = close(&draft, bound).unwrap_or(stopped);
    (draft, bound, stopped)
}

/// A better schedule by exchanges within a few days; `None` where there is none.
fn improved(
    model: &Model,
    relaxed: &Relaxed,
    taken: &[usize],
    stop: Stop<'_>,
) -> Option<Vec<usize>> {
    let mut draft = Draft::new(model);
    for &id in taken {
        draft.add(id);
    }
    let before = draft.value();
    improve::improve(&mut draft, model, &Priced::new(model, &relaxed.prices), (PASSES.1, stop));
    (draft.value() > before).then(|| draft.chosen().collect())
}

/// Whether the caller asks to stop.
fn asked(stop: Stop<'_>) -> bool {
    stop.is_some_and(|stop| stop())
}

/// Whether a schedule is so close to the bound that the search may end.
fn close(draft: &Draft<'_>, bound: i128) -> Option<Stopped> {
    let missing = bound - i128::from(draft.value());
    if missing <= 0 {
        Some(Stopped::Optimal)
    } else {
        (missing <= bound / CLOSE).then_some(Stopped::Close)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_relaxation_schedule_and_bound_still_hold() {
        let at = Instant::from_tai_ns;
        let times = [(0, 30), (20, 60), (55, 90), (95, 130), (100, 190)];
        let candidates = times.map(|(entry, exit)| Candidate {
            target: 0,
            telescope: 0,
            first_entry: at(entry),
            last_exit: at(exit),
            dwell: Duration::from_ns(exit - entry),
        });
        let problem = Problem {
            span: (at(0), at(200)),
            candidates: candidates.to_vec(),
            weights: vec![1.0],
            rules: Rules {
                setup: Duration::ZERO,
                cooldown: Duration::ZERO,
                exclusive: Exclusive::All,
                max_per_day: Some(Duration::from_ns(95)),
                max_sessions: None,
                day_boundaries: vec![at(0), at(100), at(200)],
            },
            demands: Demands::default(),
        };
        let (model, _) = Model::new(&problem);
        let relaxed =
            Relaxed { prices: price::Prices::none(&model), shares: vec![0.0; 5], solved: false };
        let (draft, bound, stopped) = best(&model, &relaxed, None);
        let chosen: Vec<usize> = draft.chosen().map(|id| model.sessions[id].candidate).collect();
        assert_eq!(check(&problem, &chosen), Ok(()));
        // 0 to 30, 55 to 90 and 100 to 190 is the best: 155 ns.
        assert_eq!(chosen, [0, 2, 4]);
        let objective: f64 = chosen.iter().map(|&index| problem.value(index)).sum();
        assert!(model.value_from_units(bound) >= objective);
        assert!(matches!(stopped, Stopped::NoRelaxation | Stopped::Optimal | Stopped::Close));
    }
}
