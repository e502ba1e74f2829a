//! A scheduling problem: which sessions could stand, what they are worth, what they must respect.
//!
//! A candidate is one opportunity. Taken, it is a **session**, which reserves the half-open interval
//! from its first entry less the setup to its last exit plus the cooldown. Times are instants of TAI,
//! durations nanoseconds, values in the objective's unit: weight times seconds in view.

use super::demands::Demands;
use super::rule::Rules;
use onboard_core::time::{Duration, Instant};

/// Most candidates in one problem.
pub const MAX_CANDIDATES: usize = 1 << 21;

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
}
