//! Rules that contradict each other: an infeasible subset of them, and the least change that ends it.

use super::rule::RuleName;
use onboard_core::time::Instant;
use std::fmt;

/// What cannot be met together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Conflict {
    /// Rules that contradict each other; without any one of them the rest do not.
    pub rules: Vec<RuleName>,
    /// Sessions that the demands ask for.
    pub wanted: usize,
    /// The most that can be met: asking for no more is the least change.
    pub possible: usize,
    /// The season that cannot be met, where one alone cannot: target, telescope and start.
    pub season: Option<(usize, usize, Instant)>,
}

impl fmt::Display for Conflict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<String> = self.rules.iter().map(ToString::to_string).collect();
        write!(
            f,
            "no schedule meets {} together: of {} sessions asked for",
            names.join(", "),
            self.wanted
        )?;
        if let Some((target, telescope, from)) = self.season {
            write!(
                f,
                " of target {target} on telescope {telescope} in the season from {} ns TAI",
                from.tai_ns()
            )?;
        }
        write!(f, ", at most {} can be had", self.possible)
    }
}
