//! Most of a spin turn without a crossing: the field's azimuth about the spin axis is not the target's.
//!
//! | equation | bound |
//! |---|---|
//! | the field lies within `u = asin(sin r / sin beta)` of its centre's azimuth | with the azimuths apart by d > u, no crossing for `(d - u) / (abs(m) + e)`, `m = w_b + w_a cos alpha`, `e = (abs(w_a) sin alpha abs(cos delta) + V) / sin delta`, for at most a turn |
//!
//! Proof: a circle of radius r at beta from a pole is seen from it within u, and contains the field.
//! In the spin frame the sky turns at `-w_b` about the spin axis and at `-w_a` about the anti-Sun axis,
//! which is at alpha from it: of that, `w_a cos alpha` is about the spin axis, the rest across it. An
//! angular velocity w across the axis moves the azimuth at delta at up to `w cos delta / sin delta`, a
//! motion at V at up to `V / sin delta`. Over the span delta comes no closer to a pole than half way,
//! and e, which only grows towards the pole, is taken there.
//!
//! Requirements: REQ-TRANSIT-2.

use super::edge::ROUNDING;
use super::rates::Rates;
use super::sight::{Motion, Sight};
use crate::trigonometry;
use core::f64::consts::{PI, TAU};
use nalgebra::Vector3;

/// Half of the field's width in azimuth about the spin axis; none where the field holds the axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpinGate(Option<f64>);

impl SpinGate {
    /// Before a field of view is known.
    pub(super) const NOTHING: Self = Self(None);

    /// For a field within `reach` of its centre, which lies at `beta` from the spin axis.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn new((sin_beta, beta): (f64, f64), reach: f64) -> Self {
        let holds_axis = reach + ROUNDING >= beta || reach + ROUNDING >= PI - beta;
        Self(
            (!holds_axis).then(|| {
                libm::asin(libm::fmin(trigonometry::sin(reach) / sin_beta, 1.0)) + ROUNDING
            }),
        )
    }

    /// Seconds until the azimuth of the field, its `centre` given, can match the target's.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn seconds(
        &self,
        motion: &Motion,
        sight: &Sight,
        (centre, rates): (&Vector3<f64>, &Rates),
    ) -> f64 {
        let Some(half_width) = self.0 else { return 0.0 };
        let (e, w) = (centre, sight.direction);
        let azimuth = libm::atan2(e.x * w.y - e.y * w.x, e.x * w.x + e.y * w.y);
        if libm::fabs(azimuth) <= half_width {
            return 0.0;
        }
        // Over the horizon delta stays within half its distance from the nearer pole.
        let delta = libm::atan2(sight.sin_delta, sight.cos_delta);
        let pole = libm::fmin(delta, PI - delta);
        let mean = motion.spin + motion.precession * motion.cos_alpha;
        let horizon = libm::fmin(
            TAU / (libm::fabs(motion.spin) + libm::fabs(motion.precession)),
            0.5 * pole / rates.delta_rad_s,
        );
        let closest_to_pole = pole - rates.delta_rad_s * horizon;
        let (sin, cos) = trigonometry::sin_cos(closest_to_pole);
        let spread = (libm::fabs(motion.precession) * motion.sin_alpha * libm::fabs(cos)
            + rates.target.rate)
            / libm::fmax(sin, ROUNDING);
        // azimuth' lies in -mean +- spread.
        let ahead = if libm::fabs(mean) > spread {
            let along = if mean < 0.0 { azimuth } else { -azimuth };
            if along < 0.0 { -along - half_width } else { TAU - along - half_width }
        } else {
            libm::fabs(azimuth) - half_width
        };
        libm::fmin(ahead / (libm::fabs(mean) + spread), horizon)
    }
}

#[cfg(test)]
mod tests {
    use super::super::cases::{Case, noise};
    use super::*;

    #[test]
    fn azimuths_move_within_their_spread() {
        let mut largest = 0.0_f64;
        for case in Case::many(4_000) {
            let t = noise(8) * 50.0;
            let (sight, rates) = (case.sight(t), case.rates());
            let azimuth = |t: f64| {
                let w = case.sight(t).direction;
                libm::atan2(w.y, w.x)
            };
            let h = 1e-5 * sight.sin_delta;
            let rate = libm::remainder(azimuth(t + h) - azimuth(t - h), TAU) / (2.0 * h);
            let motion = &case.motion;
            let mean = motion.spin + motion.precession * motion.cos_alpha;
            let across = libm::fabs(motion.precession) * motion.sin_alpha;
            let spread =
                (across * libm::fabs(sight.cos_delta) + rates.target.rate) / sight.sin_delta;
            largest = largest.max(libm::fabs(rate + mean) / spread);
        }
        assert!(largest > 0.9 && largest < 1.0 + 1e-5, "{largest}");
    }

    #[test]
    // REQ-TRANSIT-2.
    fn nothing_enters_while_the_gate_is_shut() {
        let (mut shut, mut tight) = (0, f64::INFINITY);
        for case in Case::many(4_000) {
            let (reach, rates) = (case.reach(), case.rates());
            let centre = reach.centre;
            let sin_beta = libm::hypot(centre.x, centre.y);
            let gate = SpinGate::new((sin_beta, case.beta), case.field.reach_rad());
            let t = noise(9) * 50.0;
            let seconds = gate.seconds(&case.motion, &case.sight(t), (&centre, &rates));
            let Some(half_width) = gate.0 else {
                assert!(seconds <= 0.0);
                continue;
            };
            if seconds <= 0.0 {
                continue;
            }
            shut += 1;
            for k in 0..100 {
                let there = case.sight(t + seconds * f64::from(k) / 100.0);
                assert!(!reach.inside(&there), "{case:?} at {t} for {seconds}");
                let w = there.direction;
                let azimuth =
                    libm::atan2(centre.x * w.y - centre.y * w.x, centre.x * w.x + centre.y * w.y);
                tight = tight.min(libm::fabs(azimuth) - half_width);
            }
        }
        assert!(shut > 500 && tight > -1e-9 && tight < 0.05, "{shut} {tight}");
    }
}
