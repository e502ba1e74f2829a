//! The calibration timeline: sessions, what was left out and why, how far the rules are used.
//!
//! Built from a plan; written as JSON and as rows. Ids name telescope, target and precession turn, so
//! they survive replanning.

mod types;
mod of_plan;
mod words;
mod table;
mod difference;

pub use difference::{Difference, Entry, Moved};
pub use of_plan::timeline;
pub use types::{
    Against, Constraint, Loosened, Rejected, Session, SessionTransit, Signal, Timeline,
    TimelineError, Unit,
};
pub use words::date;
