//! A far sidelobe that sees the dipole.
//!
//! A sidelobe of gain g at the angle `theta_s` from the line of sight, in the direction `chi_s` from the
//! detector's x axis, sees of a dipole `D . n_s = cos(theta_s) I + sin(theta_s) d_chi I`, exactly:
//! `S_00 = g cos(theta_s) I`, `S_(-1,0) = (g/2) sin(theta_s) i e^(-i chi_s) eth I`. Behind the plate it may
//! be modulated at four times its rate, `cos(4 phi)` times the same.
//!
//! Limits: skies of l = 1. A monopole is left to the caller.

use super::super::signal::{Effect, SkyField, Term};
use crate::harmonics::Complex64;

/// A sidelobe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sidelobe {
    /// Its share g of the response.
    pub gain: f64,
    /// Its angle from the line of sight.
    pub polar_rad: f64,
    /// Its direction.
    pub azimuth_rad: f64,
    /// Whether the plate modulates it.
    pub modulated: bool,
}

impl Effect for Sidelobe {
    fn terms(&self) -> Vec<Term> {
        let (sin, cos) = self.polar_rad.sin_cos();
        // Of I, real: half of it, for a term stands for its conjugate too.
        let along = Complex64::from(0.5 * self.gain * cos);
        let across = Complex64::from_polar(0.5 * self.gain * sin, -self.azimuth_rad) * Complex64::I;
        let (i, gradient) = (SkyField::I, SkyField::Temperature(1));
        if !self.modulated {
            return vec![
                Term { n: 0, m: 0, field: i, factor: along },
                Term { n: -1, m: 0, field: gradient, factor: across },
            ];
        }
        // cos(4 phi) 2 Re[f X e^(-i psi)] has both signs of m.
        vec![
            Term { n: 0, m: 4, field: i, factor: along },
            Term { n: -1, m: 4, field: gradient, factor: across * 0.5 },
            Term { n: -1, m: -4, field: gradient, factor: across * 0.5 },
        ]
    }
}
