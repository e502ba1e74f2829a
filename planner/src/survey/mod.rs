//! How often, and at which angles, is each pixel of the sky seen.
//!
//! A [`Survey`] is a strategy sampled at a constant rate, the detectors that look, the map's
//! resolution and frame, and the averages to take; [`Survey::run`] gives its [`SurveyMaps`]. A
//! [`Collector`] does the same span by span, for maps on the way.
//!
//! Angles: crossing angle psi zero at east, half-wave plate phi, as in the conventions; in galactic
//! maps psi is counted from galactic east. Rates and periods are exact rationals, rounded once.
//!
//! Method: `kernel` (fast, any instruction set, one pass over blocks of samples with nothing stored
//! per sample) and `plain` (the flight core, sample by sample), which agree on every pixel and, to
//! 1e-10, on every h.
//!
//! Limits: nside up to 2048; the memory is that of the maps, once per thread.
//!
//! # Example
//! LiteBIRD's strategy for a day at 5 Hz:
//! ```
//! use onboard_core::{phase::Phase, time::Instant};
//! use planner::{healpix::Nside, progress::Quietly, survey::*};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let turn = |seconds: BigRational| ExactRotor::with_period(&seconds, Phase::ZERO).ok_or("zero");
//! let scan = SampledScan {
//!     start: Instant::from_tai_ns(0),
//!     sampling_hz: BigRational::from_integer(5.into()),
//!     alpha_rad: 45_f64.to_radians(),
//!     beta_rad: 50_f64.to_radians(),
//!     precession: turn(BigRational::new(1_154_088.into(), 100.into()))?,
//!     spin: turn(BigRational::from_integer(1200.into()))?,
//! };
//! let (sun, detectors) = (SurveySun::circular(Phase::ZERO), vec![SurveyDetector::BORESIGHT]);
//! let (nside, frame) = (Nside::new(32)?, MapFrame::Ecliptic);
//! let moments = vec![Moment::new(2.0, 0.0)?];
//! let survey = Survey { scan, sun, detectors, nside, frame, moments };
//! let maps = survey.run(0..5 * 86_400, 0, &Quietly)?;
//! assert_eq!(maps.hits_map().iter().sum::<u64>(), 5 * 86_400);
//! assert!(SurveyStatistics::of(&maps).sigma_hits > 0.0);
//! # Ok(())
//! # }
//! ```

#![expect(
    clippy::inline_always,
    reason = "one function per instruction set holds all that it calls"
)]
#![expect(
    clippy::similar_names,
    clippy::many_single_char_names,
    reason = "sines and cosines, components"
)]

mod rates;
mod clock;
mod scan;
mod sun;
mod frame;
mod mount;
mod detector;
pub mod input;
mod moment;
mod definition;
mod sampled;
mod runs;
mod isa;
mod maps;
mod sums;
mod plain;
mod kernel;
mod threads;
mod collector;
mod statistics;
mod scan_beam;

pub use collector::Collector;
pub use definition::{Survey, SurveyError};
pub use detector::SurveyDetector;
pub use frame::{Galactic, MapFrame};
pub use isa::{Isa, IsaError};
pub use maps::{SurveyMaps, map_bytes};
pub use moment::{MAX_ORDER, MOST_MOMENTS, Moment, MomentError};
pub use num_rational::BigRational;
pub use rates::ExactRotor;
pub use scan::{SampledScan, SamplingError};
pub use scan_beam::Sweeping;
pub use statistics::{MomentStatistics, SurveyStatistics};
pub use sun::{SunSource, SunTable, SurveySun};

pub(crate) use kernel::{BLOCK, Block, Job, Phasors, Stream};
pub(crate) use sampled::{Pixels, Sampled};
pub(crate) use threads::pool;
