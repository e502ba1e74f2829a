//! Offset of the polarisation angle: the detector is sensitive along another direction than assumed.
//!
//! `d = Re[P (e^(-2i delta) - 1) z*]`: `S_(-2,4) = -(P/2)(e^(-2i delta) - 1)`. E turns into B,
//! `C_BB = sin^2(2 delta) C_EE`, whatever the scan.

use super::super::signal::{Effect, SkyField, Term};
use crate::harmonics::Complex64;

/// An offset of the polarisation angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolarisationAngle {
    /// True angle less the assumed one.
    pub delta_rad: f64,
}

impl Effect for PolarisationAngle {
    fn terms(&self) -> Vec<Term> {
        // e^(-2i delta) - 1 = -2i sin(delta) e^(-i delta)
        let change =
            Complex64::from_polar(2.0 * self.delta_rad.sin(), -self.delta_rad) * -Complex64::I;
        vec![Term { n: -2, m: 4, field: SkyField::P, factor: change * -0.5 }]
    }
}
