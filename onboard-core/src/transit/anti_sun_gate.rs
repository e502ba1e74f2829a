//! Days without a crossing: the target's angle from the anti-Sun axis keeps it out of the field.
//!
//! | equation | bound |
//! |---|---|
//! | the field's points lie at angles from the anti-Sun axis from `abs(alpha - beta) - r` to `pi - abs(pi - alpha - beta) + r` | with gamma outside by d, no crossing for `d / V` |
//!
//! Proof: the spin axis lies at alpha from the anti-Sun axis and the field's centre at beta from the
//! spin axis, so by the triangle's rule the centre lies at `abs(alpha - beta)` or more and at the
//! smaller of `alpha + beta` and `2 pi - alpha - beta` or less. All other points are within r of it.
//! Gamma is the target's angle from a fixed axis of its frame, so it moves at V at most.
//!
//! Requirements: REQ-TRANSIT-2.

use super::edge::ROUNDING;
use super::sight::Sight;
use core::f64::consts::PI;

/// The angles from the anti-Sun axis that the scan reaches, in radians.
#[derive(Debug, Clone, Copy)]
pub(super) struct AntiSunGate {
    least: f64,
    greatest: f64,
}

impl AntiSunGate {
    /// Before a field of view is known.
    pub(super) const NOTHING: Self = Self { least: 0.0, greatest: 0.0 };

    /// For a field within `reach` of its centre, which lies at `beta` from the spin axis.
    pub(super) fn new(alpha: f64, beta: f64, reach: f64) -> Self {
        Self {
            least: libm::fabs(alpha - beta) - reach - ROUNDING,
            greatest: PI - libm::fabs(PI - alpha - beta) + reach + ROUNDING,
        }
    }

    /// Seconds without an entry for a target that moves at `rate` rad/s at most; 0 within reach.
    pub(super) fn seconds(&self, sight: &Sight, rate: f64) -> f64 {
        let gamma = libm::atan2(sight.sin_gamma, sight.cos_gamma);
        let short = libm::fmax(self.least - gamma, gamma - self.greatest);
        if short > 0.0 { short / rate } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::cases::{Case, noise};
    use super::*;

    #[test]
    fn angles_from_the_anti_sun_axis_move_within_the_targets_rate() {
        let mut largest = 0.0_f64;
        for case in Case::many(400) {
            for k in 0..20 {
                let t = noise(k) * 50.0;
                let gamma = |t: f64| {
                    let sight = case.sight(t);
                    libm::atan2(sight.sin_gamma, sight.cos_gamma)
                };
                let rate = (gamma(t + 1e-6) - gamma(t - 1e-6)).abs() / 2e-6;
                largest = largest.max(rate / case.bounds().rate);
            }
        }
        assert!(largest > 0.9 && largest < 1.0 + 1e-6, "{largest}");
    }

    #[test]
    // REQ-TRANSIT-2.
    fn nothing_enters_while_the_gate_is_shut() {
        let (mut shut, mut tight) = (0, f64::INFINITY);
        for case in Case::many(3_000) {
            let reach = case.reach();
            let gate = AntiSunGate::new(case.alpha(), case.beta, case.field.reach_rad());
            let t = noise(3) * 50.0;
            let seconds = gate.seconds(&case.sight(t), case.bounds().rate);
            if seconds > 0.0 {
                shut += 1;
                for k in 0..200 {
                    let sight = case.sight(t + seconds * f64::from(k) / 200.0);
                    assert!(!reach.inside(&sight), "{case:?} at {t} for {seconds}");
                    let gamma = libm::atan2(sight.sin_gamma, sight.cos_gamma);
                    tight = tight.min(libm::fmax(gate.least - gamma, gamma - gate.greatest));
                }
            }
        }
        assert!(shut > 300 && tight > -1e-9 && tight < 0.05, "{shut} {tight}");
    }

    #[test]
    fn what_the_scan_reaches_is_not_shut_out() {
        // The field's centre itself, at every phase, is never outside the gate.
        for case in Case::many(500) {
            let gate = AntiSunGate::new(case.alpha(), case.beta, case.field.reach_rad());
            let (least, greatest) = ((case.alpha() - case.beta).abs(), case.alpha() + case.beta);
            let reach = case.field.reach_rad();
            assert!((gate.least - (least - reach)).abs() < 1e-11);
            assert!((gate.greatest - (greatest.min(2.0 * PI - greatest) + reach)).abs() < 1e-11);
        }
    }
}
