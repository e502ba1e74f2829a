//! How fast, at most, the target moves as the spinning spacecraft sees it.
//!
//! Frames: [`AntiSun`](crate::frame::AntiSun) for the target's own motion, [`Spin`](crate::frame::Spin)
//! for the field's points n, each at an angle of sine `sin_beta` from the spin axis.
//!
//! | equation | bound |
//! |---|---|
//! | `delta`, the target's angle from the spin axis | `abs(delta') <= abs(w_a) sin alpha + V` |
//! | `f = n . w - cos r`, w the target's direction | `abs(f'') <= M`, [`Rates::curvature`] |
//!
//! Proof of the first: the spin axis moves at `w_a sin alpha` about the anti-Sun axis z, the target
//! at V at most, and an angle between two directions changes at most at the sum of their speeds.
//!
//! Proof of the second, seen from the anti-Sun frame where `n' = w_a z x n + w_b s x n`: the spin axis
//! s itself turns about z, so `n'' = w_a^2 z x (z x n) + 2 w_a w_b z x (s x n) + w_b^2 s x (s x n)`.
//! Projected on the target p these are at most `w_a^2 sin gamma`, `2 abs(w_a w_b) sin gamma sin beta`
//! and `w_b^2 sin delta sin beta`, for `(z x a) . p = a . (p x z)` and `abs(p x z) = sin gamma`.
//! The target's own motion adds `2 n' . p' + n . p''`, at most `2 (abs(w_b) sin beta + abs(w_a)) V + A`.
//! Over the longest step gamma and delta move by their rates, which widens both sines.

use super::sight::{Motion, Sight};
use crate::sun::RelativeBounds;
use core::f64::consts::TAU;

/// Relative inflation of the bound on f'' for rounding.
const CURVATURE_ROUNDING: f64 = 1.0 + 1e-9;

/// Bounds on the motion, for one strategy and one target.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rates {
    /// Of the target in the anti-Sun frame: V and A.
    pub(super) target: RelativeBounds,
    /// Largest rate of the target's angle from the spin axis, rad/s.
    pub(super) delta_rad_s: f64,
    /// Longest time over which a bound on f'' is used, s: a sixteenth of a turn.
    pub(super) longest_step_s: f64,
}

impl Rates {
    /// Before a strategy is known.
    pub(super) const NOTHING: Self = Self {
        target: RelativeBounds { rate: 0.0, acceleration: 0.0 },
        delta_rad_s: 0.0,
        longest_step_s: 0.0,
    };

    pub(super) fn new(motion: &Motion, target: RelativeBounds) -> Self {
        Self {
            target,
            delta_rad_s: libm::fabs(motion.precession) * motion.sin_alpha + target.rate,
            longest_step_s: TAU / 16.0 / (libm::fabs(motion.precession) + libm::fabs(motion.spin)),
        }
    }

    /// Bound on |f''| for a point at `sin_beta` from the spin axis, over the longest step.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn curvature(&self, motion: &Motion, sight: &Sight, sin_beta: f64) -> f64 {
        let (a, b) = (libm::fabs(motion.precession), libm::fabs(motion.spin));
        let sin_gamma = libm::fmin(sight.sin_gamma + self.target.rate * self.longest_step_s, 1.0);
        let sin_delta = libm::fmin(sight.sin_delta + self.delta_rad_s * self.longest_step_s, 1.0);
        let scan =
            a * a * sin_gamma + 2.0 * a * b * sin_gamma * sin_beta + b * b * sin_delta * sin_beta;
        let drift = 2.0 * (b * sin_beta + a) * self.target.rate + self.target.acceleration;
        (scan + drift) * CURVATURE_ROUNDING
    }
}

#[cfg(test)]
mod tests {
    use super::super::cases::{Case, angle, noise};
    use core::f64::consts::TAU;
    use nalgebra::Vector3;

    #[test]
    fn angles_from_the_spin_axis_move_within_their_rate() {
        let mut largest = 0.0_f64;
        for case in Case::many(400) {
            for k in 0..20 {
                let t = noise(k) * 50.0;
                let delta = |t: f64| angle(&case.sight(t).direction, &Vector3::z());
                let rate = (delta(t + 1e-6) - delta(t - 1e-6)).abs() / 2e-6;
                largest = largest.max(rate / case.rates().delta_rad_s);
            }
        }
        assert!(largest > 0.9 && largest < 1.0 + 1e-7, "{largest}");
    }

    #[test]
    fn second_derivatives_stay_within_the_curvature() {
        let mut largest = 0.0_f64;
        for case in Case::many(4_000) {
            let rates = case.rates();
            let (t, azimuth) = (noise(1) * 50.0, TAU * noise(2));
            let sight = case.sight(t);
            // A point of the field in the spin frame.
            let beta = case.beta;
            let n =
                Vector3::new(beta.sin() * azimuth.cos(), beta.sin() * azimuth.sin(), beta.cos());
            let bound = rates.curvature(&case.motion, &sight, beta.sin());
            let f = |t: f64| n.dot(&case.sight(t).direction);
            let h = 1e-3 * rates.longest_step_s;
            for share in [0.0, 0.3, 0.7, 0.99] {
                let at = t + share * rates.longest_step_s;
                let second = (f(at + h) - 2.0 * f(at) + f(at - h)) / (h * h);
                largest = largest.max(second.abs() / bound);
            }
        }
        assert!(largest > 0.8 && largest < 1.0 + 1e-6, "{largest}");
    }
}
