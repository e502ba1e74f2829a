//! How well are the scan's angles known.
//!
//! [`ScanCovariance`] is the covariance of the errors in precession phase, alpha and spin phase at
//! one instant. The tracker makes it from measured attitudes; predictions turn it into an
//! uncertainty of time.
//!
//! Limits: first order; good while the errors are small against the angles they shift.

use serde::{Deserialize, Serialize};

/// Covariance in rad^2 of the errors (true minus modelled) in precession phase, alpha and spin
/// phase, in this order; symmetric.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ScanCovariance {
    /// Variances.
    pub variances: [f64; 3],
    /// Precession phase with alpha, precession phase with spin phase, alpha with spin phase.
    pub covariances: [f64; 3],
}

impl ScanCovariance {
    /// Everything known exactly.
    pub const ZERO: Self = Self { variances: [0.0; 3], covariances: [0.0; 3] };

    /// Variance of `g . error`, for a gradient in the same order; never negative.
    #[must_use]
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn along(&self, gradient: [f64; 3]) -> f64 {
        let [a, b, c] = gradient;
        let [aa, bb, cc] = self.variances;
        let [ab, ac, bc] = self.covariances;
        let own = aa * a * a + bb * b * b + cc * c * c;
        libm::fmax(own + 2.0 * (ab * a * b + ac * a * c + bc * b * c), 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_of_equal_errors_is_certain() {
        let together = ScanCovariance { variances: [4.0, 1.0, 4.0], covariances: [0.0, 4.0, 0.0] };
        assert!(together.along([1.0, 0.0, -1.0]).abs() < 1e-15);
        assert!((together.along([1.0, 0.0, 1.0]) - 16.0).abs() < 1e-15);
        assert!((together.along([0.0, 2.0, 0.0]) - 4.0).abs() < 1e-15);
    }
}
