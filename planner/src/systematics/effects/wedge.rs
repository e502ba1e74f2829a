//! Wedge of the half-wave plate: the line of sight turns with the plate.
//!
//! A pointing offset whose direction is `psi + phi - chi`: that of [`super::Pointing`] with chi less by
//! phi, hence `S_(-1,-1)`, `S_(-3,3)` and `S_(-1,5)`.
//!
//! Limits: those of [`super::Pointing`].

use super::super::signal::{Effect, Term};
use super::Pointing;

/// An offset that turns with the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wedge {
    /// Its size in radians.
    pub rho_rad: f64,
    /// Its direction for a plate at angle 0, against the sense of psi.
    pub chi_rad: f64,
}

impl Effect for Wedge {
    fn terms(&self) -> Vec<Term> {
        let fixed = Pointing { rho_rad: self.rho_rad, chi_rad: self.chi_rad }.terms();
        // e^(i chi) and e^(-i chi) with chi - phi.
        fixed
            .into_iter()
            .zip([-1, -1, 1])
            .map(|(term, turn)| Term { m: term.m + turn, ..term })
            .collect()
    }
}
