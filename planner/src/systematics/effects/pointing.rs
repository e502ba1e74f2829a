//! Absolute pointing offset: the detector looks beside where it is taken to look.
//!
//! `d = S(n - Delta)`, `Delta = rho [cos(psi - chi) E + sin(psi - chi) N]`: chi = 0 is away from the spin
//! axis, along the scan +-90 deg. This is [Takase2024, appendix A.2], whose psi runs from north to east.
//!
//! To first order, with covariant derivatives, `S_(-1,0) = -(rho/2) i e^(i chi) eth I`,
//! `S_(-3,4) = (rho/4) i e^(i chi) eth P`, `S_(-1,4) = -(rho/4) i e^(-i chi) ethbar P`.
//!
//! Limits: small against the beam. True re-pointing differs: see `docs/systematics.md`.

use super::super::signal::{Effect, SkyField, Term};
use crate::harmonics::Complex64;

/// A pointing offset of a detector behind a half-wave plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pointing {
    /// Its size in radians.
    pub rho_rad: f64,
    /// Its direction, against the sense of psi.
    pub chi_rad: f64,
}

impl Effect for Pointing {
    fn terms(&self) -> Vec<Term> {
        let along = Complex64::from_polar(self.rho_rad, self.chi_rad) * Complex64::I;
        let against = Complex64::from_polar(self.rho_rad, -self.chi_rad) * Complex64::I;
        vec![
            Term { n: -1, m: 0, field: SkyField::Temperature(1), factor: along * -0.5 },
            Term { n: -3, m: 4, field: SkyField::Polarisation(1), factor: along * 0.25 },
            Term { n: -1, m: 4, field: SkyField::Polarisation(-1), factor: against * -0.25 },
        ]
    }
}
