//! Spherical harmonics of spin-weighted fields on HEALPix pixels.
//!
//! A field of spin s is `F = sum_lm a_lm sY_lm`, held as the two real sets E and B with
//! `a_lm = -(E_lm + i B_lm)` for m of both signs, whatever the spin ([`SpinAlm`]). Spin 2 is `Q + iU` of
//! the COSMO sense, theta grows southwards and phi eastwards; eth is
//! `d_N - i d_E`, the operator that raises the spin.
//!
//! Method: Wigner functions by recurrence in l ([`wigner_d`]) on pairs of mirrored rings, Fourier
//! transforms along them; `sY_lm = (-1)^s sqrt((2l + 1) / 4 pi) d^l_(m,-s)(theta) exp(i m phi)`
//! \[Goldberg1967\].
//!
//! Limits: degrees to [`MAX_DEGREE`], spins to [`MAX_SPIN`]. Maps and coefficients within 1e-12 of
//! healpy's, relative to their largest value (test `maps_and_coefficients_are_those_of_healpy`).
//!
//! # Example
//! A dipole along x, its gradient, and the coefficients that come back:
//! ```
//! use planner::harmonics::*;
//! use planner::healpix::Nside;
//!
//! let mut dipole = Alm::zero(1);
//! dipole.set(1, 1, Complex64::new(-(2.0 * std::f64::consts::PI / 3.0).sqrt(), 0.0));
//! let rings = Rings::new(Nside::new(16)?);
//! let map = rings.scalar_map(&dipole)?;
//! // Pixel 0 of RING order is near the pole, where a dipole along x is small.
//! assert!(map[0].abs() < 0.06);
//! let gradient = rings.map(&SpinAlm::scalar(&dipole).raised())?;
//! assert!((gradient[0].norm() - 1.0).abs() < 0.01);
//! let back = rings.scalar_alm(&map, 1, 3)?;
//! assert!((back.at(1, 1) - dipole.at(1, 1)).norm() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub(crate) mod wigner;
pub(crate) mod quadrature;
mod alm;
mod spin;
mod spectra;
mod ring;
mod ladder;
mod lanes;
mod zonal;
mod circle;
mod fourier;
mod transform;
#[cfg(test)]
mod against_healpy;

pub use alm::Alm;
pub use ring::Rings;
pub use rustfft::num_complex::Complex64;
pub use spectra::{Spectra, cross_spectrum, gaussian_beam};
pub use spin::SpinAlm;
pub(crate) use spin::raising;
pub use transform::{MAX_DEGREE, MAX_SPIN, TransformError};
pub use wigner::wigner_d;
pub(crate) use zonal::{Place, zonal_sums};
