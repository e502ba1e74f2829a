//! When does the line of sight visit a place on the sky, and how long until it comes back.
//!
//! A visit is a maximal interval inside a circle about a target, or inside a HEALPix pixel's true
//! boundary. Revisit is the next entry less this entry, gap the next entry less this exit.
//!
//! Frames: pixels are ecliptic or galactic, fixed directions ecliptic, both geometric, as a map's pixels
//! are: the line of sight itself, without aberration. Instants are TAI.
//!
//! Method: circles by the flight core's certified search ([`transits`]); pixels by that search on a
//! circle that holds the pixel ([`Boundary`]), then by steps that provably cross no edge
//! ([`LineOfSight::pixel_visits`]); from them sampled counting ([`sampled`]), statistics and histograms.
//!
//! Limits: those of `onboard_core::transit`, and [`DEPTH_TOLERANCE_RAD`] for pixels.

mod visit;
mod fixed;
mod line_of_sight;
mod boundary;
mod arc;
mod crossing;
mod counting;
mod histogram;
mod statistics;

pub use boundary::{Boundary, pixel_at};
pub use counting::{Counting, Sampling, Wait, sampled, waits};
pub use crossing::DEPTH_TOLERANCE_RAD;
pub use histogram::{BINS_PER_DECADE, Histogram, MOST_LINEAR_BINS};
pub use line_of_sight::{LineOfSight, Sun, VisitsError};
pub use statistics::{Gap, LONGEST_GAPS, Spans, Spread, VisitStatistics};
pub use visit::{Visit, transits};
