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
//!
//! # Example
//! How often does LiteBIRD's boresight visit the pixel at the ecliptic's north pole in a day?
//! ```
//! use onboard_core::phase::{Phase, Rotor, TurnRate};
//! use onboard_core::scan::{ScanParameters, ScanStrategy};
//! use onboard_core::{rotation::Rotation, time::{Duration, Instant}};
//! use planner::{healpix::Nside, visits::*};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let rate = |period_s| TurnRate::from_radians_per_second(std::f64::consts::TAU / period_s);
//! let turn = |period_s: f64| Rotor { rate: rate(period_s), start: Phase::ZERO };
//! let (start, day) = (Instant::from_tai_ns(0), Duration::from_seconds(86_400.0));
//! let (alpha_rad, beta_rad) = (45_f64.to_radians(), 50_f64.to_radians());
//! let (precession, spin) = (turn(11_540.88), turn(1200.0));
//! let scan = ScanStrategy::new(ScanParameters { start, alpha_rad, beta_rad, precession, spin })
//!     .map_err(|error| format!("{error:?}"))?;
//! let (sun, detector) = (Sun::Circular(turn(31_557_600.0)), Rotation::IDENTITY);
//! let line = LineOfSight { scan, sun, detector, ends: (start, start.plus(day)) };
//! let nside = Nside::new(16)?;
//! let visits = line.pixel_visits(&Boundary::new(nside, pixel_at(nside, 0.0, 0.0)))?;
//! let found = VisitStatistics::of(&visits, Counting::Crossings, day);
//! assert!(found.per_day > 1.0 && found.revisit.spread.is_some());
//! # Ok(())
//! # }
//! ```

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
