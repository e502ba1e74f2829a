//! Elliptical Gaussian beam, the map being that of a circular one of the mean variance.
//!
//! With variances along two axes, x turned by `major_rad` from the detector's, the beam adds
//! `(sx^2 - sy^2) / 4 (d_x^2 - d_y^2)`: `S_(-2,0) = -(sx^2 - sy^2)/8 e^(-2i major) eth^2 I`,
//! `S_(-4,4) = (sx^2 - sy^2)/16 e^(-2i major) eth^2 P`, `S_(0,4)` the same with `e^(2i major) ethbar^2 P`.
//!
//! Limits: first order in the ellipticity; fields smoothed by the beam are the caller's.

use super::super::signal::{Effect, SkyField, Term};
use crate::harmonics::Complex64;

/// An elliptical beam behind a half-wave plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipticity {
    /// `sx^2 - sy^2` in square radians.
    pub difference_rad2: f64,
    /// Angle of the axis x of the beam.
    pub major_rad: f64,
}

impl Effect for Ellipticity {
    fn terms(&self) -> Vec<Term> {
        let turned = |sign: f64| {
            Complex64::from_polar(self.difference_rad2 / 16.0, sign * 2.0 * self.major_rad)
        };
        vec![
            Term { n: -2, m: 0, field: SkyField::Temperature(2), factor: turned(-1.0) * -2.0 },
            Term { n: -4, m: 4, field: SkyField::Polarisation(2), factor: turned(-1.0) },
            Term { n: 0, m: 4, field: SkyField::Polarisation(-2), factor: turned(1.0) },
        ]
    }
}
