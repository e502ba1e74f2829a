//! Time constant of the detector that is not deconvolved.
//!
//! A response `1 / (1 + i omega tau)` turns and shrinks what the plate modulates,
//! `S_(-2,4) = -(P/2) [1 / (1 + 4i w tau) - 1]` with the plate's rate w, and shifts everything along the
//! scan by `tau` times its speed: a [`super::Pointing`] with chi = -90 deg, y being along the scan.
//!
//! Limits: the speed is the spin's, `2 pi sin(beta) / T_beta`: orbit and precession are left aside, some
//! 10 % of the shift, as is what the turning of psi adds to w.

use super::super::signal::{Effect, SkyField, Term};
use super::Pointing;
use crate::harmonics::Complex64;
use std::f64::consts::FRAC_PI_2;

/// A time constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeConstant {
    /// tau in seconds.
    pub tau_s: f64,
    /// Rate of the plate, its sign included.
    pub plate_rad_s: f64,
    /// Speed of the line of sight along the detector's y axis.
    pub sweep_rad_s: f64,
}

impl Effect for TimeConstant {
    fn terms(&self) -> Vec<Term> {
        let lag = Complex64::new(0.0, 4.0 * self.plate_rad_s * self.tau_s);
        let change = -lag / (1.0 + lag);
        let shift = Pointing { rho_rad: self.tau_s * self.sweep_rad_s, chi_rad: -FRAC_PI_2 };
        let mut terms = shift.terms();
        terms.push(Term { n: -2, m: 4, field: SkyField::P, factor: change * -0.5 });
        terms
    }
}
