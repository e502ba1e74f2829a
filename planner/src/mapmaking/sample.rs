//! What one sample of one detector sees: the sky, and the angles under which it sees it.
//!
//! Angles are those of the sky's frame, as (cosine, sine): the polarisation angle `psi_pol`, COSMO
//! sense, the plate's angle `phi`, and the modulation `4 phi - 2 psi_pol`.

/// One sample of one detector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Index of the detector in the survey.
    pub detector: usize,
    /// Number of the sample.
    pub number: u64,
    /// NESTED pixel of the sky that it sees.
    pub pixel: u32,
    /// I, Q, U (COSMO) of the sky.
    pub stokes: [f64; 3],
    /// Cosine and sine of the polarisation angle.
    pub polarisation: (f64, f64),
    /// Cosine and sine of the plate's angle; (1, 0) without a plate.
    pub plate: (f64, f64),
    /// Cosine and sine of `4 phi - 2 psi_pol`.
    pub modulation: (f64, f64),
}

impl Sample {
    /// What an ideal detector measures: `I + Q cos(4 phi - 2 psi_pol) - U sin(4 phi - 2 psi_pol)`.
    #[must_use]
    pub fn signal(&self) -> f64 {
        let [i, q, u] = self.stokes;
        i + q * self.modulation.0 - u * self.modulation.1
    }

    /// The polarisation angle in radians, in [-pi, pi].
    #[must_use]
    pub fn polarisation_angle_rad(&self) -> f64 {
        self.polarisation.1.atan2(self.polarisation.0)
    }

    /// The plate's angle in radians, in [-pi, pi]; 0 without a plate.
    #[must_use]
    pub fn plate_angle_rad(&self) -> f64 {
        self.plate.1.atan2(self.plate.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(stokes: [f64; 3], psi: f64, phi: f64) -> Sample {
        let pair = |angle: f64| (angle.cos(), angle.sin());
        Sample {
            detector: 0,
            number: 0,
            pixel: 0,
            stokes,
            polarisation: pair(psi),
            plate: pair(phi),
            modulation: pair(4.0 * phi - 2.0 * psi),
        }
    }

    #[test]
    fn a_detector_along_the_polarisation_sees_all_of_it() {
        // COSMO: Q = 1 is polarised along south (psi_pol = 0), U = 1 half-way from south to east.
        let along = |stokes, psi: f64| sample(stokes, psi.to_radians(), 0.0).signal();
        assert!((along([1.0, 1.0, 0.0], 0.0) - 2.0).abs() < 1e-15);
        assert!(along([1.0, 1.0, 0.0], 90.0).abs() < 1e-15);
        assert!((along([1.0, 0.0, 1.0], 45.0) - 2.0).abs() < 1e-15);
        assert!(along([1.0, 0.0, 1.0], 135.0).abs() < 1e-15);
    }

    #[test]
    fn a_plate_at_45_degrees_crosses_the_polarisation() {
        let crossed = sample([0.0, 1.0, 0.0], 0.3, std::f64::consts::FRAC_PI_4);
        let parallel = sample([0.0, 1.0, 0.0], 0.3, 0.0);
        assert!((crossed.signal() + parallel.signal()).abs() < 1e-15);
        assert!((crossed.plate_angle_rad() - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
        assert!((crossed.polarisation_angle_rad() - 0.3).abs() < 1e-15);
    }
}
