//! A schedule, how good it is, and why the search for a better one ended.

use super::reason::Rejection;
use super::rule::ConstraintUse;
use std::fmt;

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
