//! What the spacecraft would do with a plan, found out by its own code.
//!
//! [`mission_section`] writes the mission as it goes on board; [`Judge`] decides which opportunities
//! are allowed sessions, by the flight core's one definition; [`fly`] carries a container's plan out
//! in a simulated clock and names every session that is not begun.

mod section;
mod record;
mod judge;
mod flight;

pub use flight::{AHEAD, NotFlown, TICK, fly, longest_checks};
pub use judge::{Judge, JudgeError};
pub use record::{BeyondRecord, record};
pub use section::{TooMany, mission_section};
