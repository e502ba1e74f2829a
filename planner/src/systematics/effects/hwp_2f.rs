//! Half-wave plate synchronous signal at twice its rate, proportional to I.
//!
//! `d = eps cos(2 phi + phase) I`: `S_(0,2) = (eps/2) e^(i phase) I`.

use super::super::signal::{Effect, SkyField, Term};
use crate::harmonics::Complex64;

/// A signal at twice the plate's rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HwpTwoF {
    /// Its amplitude.
    pub epsilon: f64,
    /// Its phase.
    pub phase_rad: f64,
}

impl Effect for HwpTwoF {
    fn terms(&self) -> Vec<Term> {
        let factor = Complex64::from_polar(0.5 * self.epsilon, self.phase_rad);
        vec![Term { n: 0, m: 2, field: SkyField::I, factor }]
    }
}
