//! The continuously rotating half-wave plate.
//!
//! Angle `phi = 2 pi f_phi t + phi_0` with a sign, +1 in the sense of the crossing angle, on the scan
//! clock; a [`Rotor`] gives it exactly.

use crate::phase::{Phase, Rotor};
use crate::scan::ScanStrategy;
use crate::time::Instant;

/// The half-wave plate's angle at `at`.
#[must_use]
// REQ-ATT-1.
pub const fn hwp_phase(scan: &ScanStrategy, plate: Rotor, at: Instant) -> Phase {
    plate.phase(scan.elapsed(at))
}
