//! Do precession, spin and orbit beat on the sky.
//!
//! Where `T_alpha / T_beta` is close to a fraction `p / q`, every q-th precession repeats the same
//! scans, slowly displaced by the orbit, and the hit map carries Moire stripes. The map's harmonics
//! are sums in closed form, so that neither finding nor excluding a resonance needs a simulation.
//!
//! Angles and phases as in the conventions; rates carry the sign of the rotation. Maps are in
//! ecliptic coordinates, hits relative to their mean.
//!
//! Method: `docs/resonance.md`; functions in [`wigner`], pixels and beams in [`window`], the sums in
//! [`power`], [`hemisphere`] for each half of the sky, [`crosslink`] for the means of the crossing angles'
//! moments, bounds over tolerances in [`certificate`].
//!
//! Limits: predictions are those of a circular orbit; certificates follow the real one. One detector
//! on the boresight.

pub mod wigner;
mod quadrature;
pub mod window;
pub mod motion;
mod pairs;
pub mod power;
pub mod hemisphere;
mod local_window;
mod ring_sums;
pub mod crosslink;
pub mod orbit;
mod bound;
pub mod certificate;
pub mod actuator;
pub mod recommendation;
pub mod check;

pub use actuator::Actuator;
pub use certificate::{Certificate, CertificateError, Tolerance, Worst};
pub use crosslink::Crosslink;
pub use hemisphere::Hemispheres;
pub use motion::{Motion, MotionError};
pub use orbit::Orbit;
pub use power::{Prediction, Predictor, Resonance};
pub use recommendation::{Choice, Demand, Recommendation};
pub use window::{Window, WindowError};
