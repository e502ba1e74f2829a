//! How strong is a calibrator in a telescope's beam, and how well does a plate modulate it.
//!
//! [`Strength`] is the peak antenna temperature of a source at the centre of a Gaussian beam, in the
//! Rayleigh-Jeans sense: power per bandwidth over k (`beam.rs`). [`phase_coverage`] says how evenly the
//! time in view spreads over the phase 4 phi of a half-wave plate (`coverage.rs`).
//!
//! Limits: one frequency stands for the band; the beam is a circular Gaussian. Numbers of sources and
//! their limits: [`table`].
//!
//! # Example
//! Jupiter at 5.2 au and the Crab in LiteBIRD's beam at 140 GHz:
//! ```
//! use planner::worth::strength::Beam;
//!
//! let fwhm_rad = (23.7_f64 / 60.0).to_radians();
//! let beam = Beam { fwhm_rad, frequency_ghz: Some(140.0) };
//! let jupiter = beam.strength_of("jupiter", Some(5.2 * 149_597_870.7));
//! let crab = beam.strength_of("tau_a", None);
//! let mk = |kelvin: Option<f64>| (kelvin.unwrap_or(0.0) * 1e3).round() as i32;
//! assert_eq!((mk(jupiter.antenna_k), mk(crab.antenna_k)), (79, 6));
//! assert!(crab.polarised_k < crab.antenna_k && jupiter.polarised_k.is_none());
//! ```

pub mod table;
mod beam;
mod coverage;

pub use beam::{Beam, Flux, Strength};
pub use coverage::{Turning, phase_coverage};
