//! What instrumental systematics leave in the maps, and what that does to r.
//!
//! An [`Effect`] is a list of fields with spins; a survey's orientation functions
//! `h_nm = <exp(-i (n psi + m phi))>` couple them into I and P = Q + iU of each pixel
//! ([`Coupling`]), without a timestream. From the residual's B follows the bias on r
//! ([`Likelihood`]).
//!
//! Angles are those of the conventions: psi zero at east, `psi_pol = psi + 90 deg`, P in the COSMO
//! sense, eth = `d_N - i d_E`. Temperatures are uK of the CMB.
//!
//! Method: \[Takase2024, section 3 and appendix A\] in these conventions; `docs/systematics.md` has the
//! equations. CMB effects need no random sky: [`mean_spectra`]. [`DipoleLeak`] is the closed form of
//! instrumental polarisation, [`timestream`] the same signal sample by sample.
//!
//! Limits: first order in each effect, derivatives at pixel centres.
//!
//! # Example
//! Instrumental polarisation of 1e-5 on the solar dipole, LiteBIRD's angles, in closed form:
//! ```
//! use planner::survey::MapFrame;
//! use planner::systematics::*;
//!
//! let leak = DipoleLeak {
//!     alpha_rad: 45_f64.to_radians(),
//!     beta_rad: 50_f64.to_radians(),
//!     epsilon: 1e-5,
//!     phi_qi_rad: 0.0,
//!     dipole: solar_dipole_uk(MapFrame::Ecliptic),
//! };
//! let cmb = CmbSpectra::embedded(TensorTilt::Scaleless)?;
//! let [_, bb] = leak.spectra(191);
//! let bias = Likelihood::new(&cmb.tensor_bb, &cmb.bb).bias(&bb)?;
//! assert!((bias.delta_r - 4.80e-4).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![expect(clippy::many_single_char_names, reason = "angles, degrees and orders")]

mod signal;
pub mod effects;
mod sky;
mod cmb;
mod realisation;
mod orientation;
mod solve;
mod residual;
mod expectation;
mod closed_form;
mod likelihood;
mod study;
pub mod timestream;
#[cfg(test)]
mod references;

pub use closed_form::{DipoleLeak, smooth_h2};
pub use cmb::{CmbSpectra, SpectraError, TensorTilt};
pub use expectation::{MeanSpectra, mean_spectra};
pub use likelihood::{Bias, DEGREES, Likelihood, LikelihoodError, white_noise};
pub use orientation::{OrientationError, Orientations, Polarimeter, Spin, moments};
pub use realisation::realisation;
pub use residual::{Coupling, Residual, SystematicsError};
pub use signal::{Effect, SkyField, Term};
pub use sky::{
    AlmTableError, DIPOLE_LATITUDE_DEG, DIPOLE_LONGITUDE_DEG, DIPOLE_UK, Dipole, SkyAlms,
    solar_dipole_uk,
};
pub use study::{Asked, Found, StudyError, StudySky};
