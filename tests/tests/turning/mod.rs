//! Rotations of whole periods, as a survey takes them.

use onboard_core::phase::Phase;
use planner::survey::{BigRational, ExactRotor};

/// A rotation of one turn in `above / below` seconds, reversed where that is negative.
pub(crate) fn turning((above, below): (i64, i64), start_rad: f64) -> ExactRotor {
    let period_s = BigRational::new(above.into(), below.into());
    ExactRotor::with_period(&period_s, Phase::from_radians(start_rad)).expect("a period")
}
