//! Do precession, spin and orbit beat on the sky.
//!
//! Where `T_alpha / T_beta` is close to a fraction `p / q`, every q-th precession repeats the same
//! scans, slowly displaced by the orbit, and the hit map carries Moire stripes. The map's harmonics
//! are sums in closed form, so that neither finding nor excluding a resonance needs a simulation.
//!
//! Angles and phases as in the conventions; rates carry the sign of the rotation. Maps are in
//! ecliptic coordinates, hits relative to their mean.
//!
//! Method: `docs/resonance.md`. A [`Predictor`] gives the variance of hits ([`Predictor::predict`]),
//! each half of the sky ([`Predictor::hemispheres`]), the means of the crossing angles' moments
//! ([`Predictor::crosslinks`]), bounds over tolerances ([`Predictor::certify`]) and periods to fly
//! ([`Predictor::recommend`]).
//!
//! Limits: predictions are those of a circular orbit; certificates follow the real one. One detector
//! on the boresight.
//!
//! # Example
//! LiteBIRD's periods pass within their tolerances; at 192 min every fifth precession repeats itself.
//! ```
//! use planner::{healpix::Nside, resonance::*};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let window = Window::pixel(Nside::new(64)?)?;
//! let mut predictor = Predictor::new(45_f64.to_radians(), 50_f64.to_radians(), window);
//! let motion = Motion::year(192.348 * 60.0, 1200.0);
//! let tolerance = Tolerance { precession_s: 0.6, spin_s: 0.06 };
//! let floor = predictor.floor(&motion);
//! let check = predictor.certify(&motion, tolerance, &Orbit::CIRCULAR, [floor, 0.01])?;
//! assert!(check.passes && check.sigma_bound >= check.sigma_predicted);
//!
//! let resonant = predictor.predict(&Motion::year(192.0 * 60.0, 1200.0));
//! assert_eq!(resonant.resonances[0].fraction(), [48, 5]);
//! assert!(resonant.sigma() > 1.01 * floor);
//! # Ok(())
//! # }
//! ```

mod motion;
mod coefficients;
mod window;
mod local_window;
mod orbit;
mod predictor;
mod power;
mod hemisphere;
mod ring_sums;
mod crosslink;
mod box_coefficients;
mod bound;
mod certificate;
mod actuator;
mod recommendation;
pub mod check;

pub use crate::harmonics::wigner::{MAX_L, wigner_d};
pub use actuator::{Actuator, MOST_PERIODS, time_within, tolerance_after};
pub use certificate::{Certificate, CertificateError, MOST_SLICES, Worst};
pub use crosslink::{Crosslink, LEAST_HITS, MAX_ORDER, mean_of_d};
pub use hemisphere::Hemispheres;
pub use motion::{Motion, MotionError, Tolerance, YEAR_S};
pub use orbit::Orbit;
pub use power::{NEGLIGIBLE, Prediction, Resonance};
pub use predictor::Predictor;
pub use recommendation::{Choice, Demand, MOST_TOLERANCES, Recommendation, SHORTLIST};
pub use window::{DEGREES_PER_NSIDE, Window, WindowError};
