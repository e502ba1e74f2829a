//! Which sky does a survey give back: I, Q and U per pixel from a timestream of a given sky.
//!
//! Data model, for a sample with the polarisation angle `psi_pol` and the plate's angle `phi`:
//!
//! `d = I + Q cos(4 phi - 2 psi_pol) - U sin(4 phi - 2 psi_pol)`
//!
//! with Q and U in the COSMO sense and `psi_pol = psi + 90 deg +` the angle from the detector's x axis
//! to its sensitive direction; without a plate phi = 0. This is [Takase2024, section 3.2], whose U is
//! the IAU's: `-psi_pol` grows from north to east. It is what makes a sky the same sky in every frame.
//!
//! Method: [`MapMaker`] adds up the normal matrix `A^T A` and `A^T d` of each pixel; [`BinnedMaps`]
//! solves. What a sample measures is a function of [`Sample`]: [`Sample::signal`] is the plain sky, and
//! systematic effects are other functions. The angle in a `Sample` is that of the sky's frame, the one
//! in the normal matrix that of the map's, so Q and U turn with the frame as they should.
//!
//! Limits: the sky is constant within each of its pixels, its beam a point; the memory is that of the
//! map (64 bytes per pixel) and of a few jobs per thread.
//!
//! # Example
//! A uniform sky comes back from a day of a [`Survey`](crate::survey::Survey), made as there:
//! ```
//! # use onboard_core::{phase::Phase, time::Instant};
//! # use planner::survey::*;
//! use planner::{healpix::{Nside, Ordering}, mapmaking::*, progress::Quietly};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let turn = |seconds: i64| {
//! #     ExactRotor::with_period(&BigRational::from_integer(seconds.into()), Phase::ZERO)
//! # };
//! # let scan = SampledScan {
//! #     start: Instant::from_tai_ns(0),
//! #     sampling_hz: BigRational::from_integer(1.into()),
//! #     alpha_rad: 45_f64.to_radians(),
//! #     beta_rad: 50_f64.to_radians(),
//! #     precession: turn(11_541).ok_or("zero")?,
//! #     spin: turn(1200).ok_or("zero")?,
//! # };
//! # let (sun, detectors) = (SurveySun::circular(Phase::ZERO), vec![SurveyDetector::BORESIGHT]);
//! # let (nside, frame, moments) = (Nside::new(8)?, MapFrame::Ecliptic, Vec::new());
//! # let survey = Survey { scan, sun, detectors, nside, frame, moments };
//! let (one, none) = (vec![1.0; 768], vec![0.0; 768]);
//! let sky = Sky::new(&SkyMap {
//!     nside: Nside::new(8)?,
//!     ordering: Ordering::Ring,
//!     frame: MapFrame::Ecliptic,
//!     convention: PolarisationConvention::Cosmo,
//!     stokes: [&one, &one, &none],
//! })?;
//! let mut maker = MapMaker::new(survey, sky.into(), Isa::best())?;
//! maker.collect(0..86_400, 0, &Quietly, &Sample::signal)?;
//! let maps = maker.maps().stokes(CONDITION_LIMIT);
//! let [_, q, _] = maps.iqu();
//! assert!(q.iter().all(|q| q.is_nan() || (q - 1.0).abs() < 1e-6));
//! assert!(maps.unsolved() < 768);
//! # Ok(())
//! # }
//! ```

mod sky;
mod sample;
mod binned;
mod maker;

pub use binned::{BinnedMaps, CONDITION_LIMIT, Solution, StokesMaps, map_bytes};
pub use maker::MapMaker;
pub use sample::Sample;
pub use sky::{PolarisationConvention, Sky, SkyError, SkyMap};
