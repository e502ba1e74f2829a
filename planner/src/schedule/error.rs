//! Why a problem has no schedule: it is ill posed, its rules contradict each other, or none was found.

use super::conflict::Conflict;
use super::problem::MAX_CANDIDATES;
use super::violation::Violation;
use thiserror::Error;

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
    /// The program's own bound is below its own schedule.
    #[error("internal: the schedule is worth {objective}, but the bound is {upper_bound}")]
    BoundBelow {
        /// Worth of the schedule.
        objective: f64,
        /// The bound.
        upper_bound: f64,
    },
}
