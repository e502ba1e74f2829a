//! How evenly does the time in view spread over the phase of a half-wave plate.
//!
//! The signal of linear polarisation is modulated by 4 phi, phi the plate's angle in radians.
//!
//! Method: the modulus of the mean of exp(4 i phi), in closed form per stretch of time.
//!
//! Limits: the plate turns at one rate.

/// Time in view: the plate's angle at its middle and its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turning {
    /// Plate's angle at the middle in radians.
    pub middle_rad: f64,
    /// Length in seconds.
    pub length_s: f64,
}

/// `1 - |<exp(4 i phi)>|` over times in view, the plate turning at `rate_rad_s`: 1 where every phase
/// has its share, 0 where there is but one. `None` where no time is in view.
///
/// Over a length T about its middle, `int exp(4 i phi) dt = exp(4 i phi_m) sin(2 w T) / (2 w)`.
#[must_use]
pub fn phase_coverage(times: impl IntoIterator<Item = Turning>, rate_rad_s: f64) -> Option<f64> {
    let (mut total_s, mut cos, mut sin) = (0.0, 0.0, 0.0);
    for Turning { middle_rad, length_s } in times {
        let half = 2.0 * rate_rad_s * length_s;
        let weight = length_s * if half.abs() < 1e-8 { 1.0 } else { half.sin() / half };
        total_s += length_s;
        cos += weight * (4.0 * middle_rad).cos();
        sin += weight * (4.0 * middle_rad).sin();
    }
    (total_s > 0.0).then(|| (1.0 - cos.hypot(sin) / total_s).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn coverage_agrees_with_a_sum_over_time() {
        let times = [(0.3, 0.9), (2.0, 0.35), (5.5, 1e-12)]
            .map(|(middle_rad, length_s)| Turning { middle_rad, length_s });
        let rate = 0.8;
        let (mut cos, mut sin, mut total) = (0.0, 0.0, 0.0);
        for it in times {
            let steps = 20_000;
            for step in 0..steps {
                let at = it.length_s * ((f64::from(step) + 0.5) / f64::from(steps) - 0.5);
                let share = it.length_s / f64::from(steps);
                let phase = 4.0 * (it.middle_rad + rate * at);
                cos += share * phase.cos();
                sin += share * phase.sin();
                total += share;
            }
        }
        let summed = 1.0 - f64::hypot(cos, sin) / total;
        assert!((phase_coverage(times, rate).unwrap() - summed).abs() < 1e-8);
    }

    #[test]
    fn a_quarter_turn_covers_all_and_an_instant_one_phase() {
        let one = |length_s| phase_coverage([Turning { middle_rad: 1.0, length_s }], PI / 2.0);
        assert!((one(1.0).unwrap() - 1.0).abs() < 1e-15);
        assert!(one(1e-9).unwrap() < 1e-15);
        assert_eq!(one(0.0), None);
        assert_eq!(phase_coverage([], 1.0), None);
    }
}
