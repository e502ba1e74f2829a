//! Instrumental polarisation of the half-wave plate: part of I appears at four times its rate.
//!
//! `d = eps cos(4 phi - 4 k psi + phi_QI) I`. k = 1 is [Takase2024, eq. A.25] to the letter, phi the
//! plate's angle: `S_(-4,4) = (eps/2) e^(i phi_QI) I`, a residual of about `-eps e^(i phi_QI) I h_20`.
//! k = 0 is a plate whose angle is that against the detector: `S_(0,4)`, about
//! `-eps e^(i phi_QI) I conj h_20`, a spin-2 field.
//!
//! Limits: I is what the sky has, the dipole in most cases; the monopole is left to the caller.

use super::super::signal::{Effect, SkyField, Term};
use crate::harmonics::Complex64;

/// How the plate's angle is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IpForm {
    /// As the paper's equation has it, k = 1.
    Literal,
    /// Against the detector, k = 0.
    Physical,
}

/// Instrumental polarisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HwpIp {
    /// Its amplitude eps.
    pub epsilon: f64,
    /// Its phase.
    pub phi_qi_rad: f64,
    /// k.
    pub form: IpForm,
}

impl Effect for HwpIp {
    fn terms(&self) -> Vec<Term> {
        let n = match self.form {
            IpForm::Literal => -4,
            IpForm::Physical => 0,
        };
        let factor = Complex64::from_polar(0.5 * self.epsilon, self.phi_qi_rad);
        vec![Term { n, m: 4, field: SkyField::I, factor }]
    }
}
