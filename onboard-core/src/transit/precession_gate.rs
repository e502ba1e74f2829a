//! Hours without a crossing: the precession keeps the target outside the field's annulus.
//!
//! | equation | bound |
//! |---|---|
//! | `cos delta = cos alpha cos gamma + sin alpha sin gamma cos x`, x the precession phase from the target's azimuth | no crossing until x is where delta, widened by `V h`, meets the annulus `beta - r` to `beta + r`, for at most h |
//!
//! Proof: the cosine rule in the triangle of anti-Sun axis, spin axis and target. Were the target
//! fixed, x would run at exactly `w_a` and delta follow x; within h it moves by `V h` at most, which
//! changes its angle from the spin axis by no more, so the annulus widened by that margin holds every
//! delta that can meet the field. cos delta is monotone in cos x: both edges are closed forms in x.
//!
//! Three horizons h are tried, the longest first; each is an eighth of the one before.
//!
//! Requirements: REQ-TRANSIT-2.

use super::edge::ROUNDING;
use super::sight::{Motion, Sight};
use crate::trigonometry;
use core::f64::consts::{PI, TAU};

/// Horizons tried.
const HORIZONS: usize = 3;
/// Margin in radians that the longest horizon may cost where the field of view is smaller.
const LONGEST_MARGIN_RAD: f64 = 4e-3;

/// The annulus for one horizon.
#[derive(Debug, Clone, Copy)]
struct Horizon {
    seconds: f64,
    /// Cosine of the annulus' far edge, widened.
    cos_far: f64,
    /// Cosine of its near edge, widened.
    cos_near: f64,
}

/// The field's annulus about the spin axis, widened for each horizon.
#[derive(Debug, Clone, Copy)]
pub(super) struct PrecessionGate([Horizon; HORIZONS]);

impl PrecessionGate {
    /// Before a field of view is known.
    pub(super) const NOTHING: Self =
        Self([Horizon { seconds: 0.0, cos_far: 0.0, cos_near: 0.0 }; HORIZONS]);

    /// For a field within `reach` of its centre, which lies at `beta` from the spin axis, and a target
    /// that moves at `rate` rad/s at most; in place, to spare the stack.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn set(&mut self, motion: &Motion, (beta, reach): (f64, f64), rate: f64) {
        let widest = libm::fmax(reach, LONGEST_MARGIN_RAD);
        let longest =
            libm::fmin(TAU / libm::fabs(motion.precession), libm::fmin(widest / rate, f64::MAX));
        for (horizon, share) in self.0.iter_mut().zip([1.0, 8.0, 64.0]) {
            let seconds = longest / share;
            horizon.set(seconds, (beta, reach), rate * seconds + ROUNDING);
        }
    }

    /// Seconds until the target can be within the annulus, by the first horizon that says any.
    pub(super) fn seconds(&self, motion: &Motion, sight: &Sight) -> f64 {
        let mut wait = 0.0;
        for horizon in &self.0 {
            wait = horizon.seconds_from(motion, sight, 0.0);
            if wait > 0.0 {
                break;
            }
        }
        wait
    }

    /// The same, not less than `from`, by the longest horizon.
    pub(super) fn seconds_from(&self, motion: &Motion, sight: &Sight, from: f64) -> f64 {
        let [longest, ..] = &self.0;
        longest.seconds_from(motion, sight, from)
    }
}

impl Horizon {
    /// Not inlined three times over.
    #[cfg_attr(target_os = "none", inline(never))]
    fn set(&mut self, seconds: f64, (beta, reach): (f64, f64), margin: f64) {
        let (near, far) = (beta - reach - margin, beta + reach + margin);
        self.seconds = seconds;
        self.cos_far = if far >= PI { -2.0 } else { trigonometry::cos(far) - ROUNDING };
        self.cos_near = if near <= 0.0 { 2.0 } else { trigonometry::cos(near) + ROUNDING };
    }

    fn seconds_from(&self, motion: &Motion, sight: &Sight, from: f64) -> f64 {
        let mean = motion.cos_alpha * sight.cos_gamma;
        let swing = motion.sin_alpha * sight.sin_gamma;
        if from >= self.seconds {
            return from;
        }
        if mean + swing < self.cos_far || mean - swing > self.cos_near {
            return self.seconds;
        }
        if swing < ROUNDING {
            return from;
        }
        let outer = libm::acos((self.cos_far - mean).max(-swing).min(swing) / swing);
        let inner = libm::acos((self.cos_near - mean).max(-swing).min(swing) / swing);
        let (east, north) = sight.precessed;
        let turned = libm::fabs(motion.precession) * from;
        let now = libm::atan2(libm::copysign(north, -north * motion.precession), east) + turned;
        let x = now - TAU * libm::round(now / TAU);
        let ahead = if x < -outer {
            -outer - x
        } else if x <= -inner {
            0.0
        } else if x < inner {
            inner - x
        } else if x <= outer {
            0.0
        } else {
            TAU - outer - x
        };
        let wait = from + libm::fmax(ahead - ROUNDING, 0.0) / libm::fabs(motion.precession);
        libm::fmin(wait, self.seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::super::cases::{Case, noise};
    use super::*;

    #[test]
    fn the_cosine_rule_holds_and_x_runs_at_the_precessions_rate() {
        for case in Case::many(300) {
            let (t, h) = (noise(5) * 50.0, 1e-4);
            let sight = case.sight(t);
            let (east, north) = sight.precessed;
            let x = libm::atan2(-north, east);
            let (sin_alpha, cos_alpha) = (case.motion.sin_alpha, case.motion.cos_alpha);
            let rule = cos_alpha * sight.cos_gamma + sin_alpha * sight.sin_gamma * libm::cos(x);
            assert!((rule - sight.cos_delta).abs() < 1e-14);
            // Of a target at rest.
            let mut still = case;
            still.amplitude = 0.0;
            let at = |t: f64| {
                let (east, north) = still.sight(t).precessed;
                libm::atan2(-north, east)
            };
            let turned = libm::remainder(at(t + h) - at(t - h), TAU) / (2.0 * h);
            assert!((turned - case.motion.precession).abs() < 1e-7, "{turned}");
        }
    }

    #[test]
    // REQ-TRANSIT-2.
    fn nothing_enters_while_the_gate_is_shut() {
        let (mut shut, mut tight) = (0, f64::INFINITY);
        for case in Case::many(3_000) {
            let (reach, mut gate) = (case.reach(), PrecessionGate::NOTHING);
            gate.set(&case.motion, (case.beta, case.field.reach_rad()), case.bounds().rate);
            let t = noise(6) * 50.0;
            let sight = case.sight(t);
            let first = gate.seconds(&case.motion, &sight);
            let from = first + noise(7) * first;
            // What lies between `first` and `from` is shut by another gate: only what follows counts.
            for (begin, end) in
                [(0.0, first), (from, gate.seconds_from(&case.motion, &sight, from))]
            {
                assert!(end >= begin);
                shut += u32::from(end > begin);
                for k in (0..100).filter(|_| end > begin) {
                    let share = f64::from(k) / 100.0;
                    let there = case.sight(t + begin + (end - begin) * share);
                    assert!(!reach.inside(&there), "{case:?} at {t} from {begin} to {end}");
                }
                if end > begin {
                    let delta = libm::acos(case.sight(t + end).cos_delta);
                    let beyond = libm::fabs(delta - case.beta) - case.field.reach_rad();
                    tight = tight.min(beyond);
                }
            }
        }
        // Shut up to the annulus, all but the margins.
        assert!(shut > 1_000 && tight > -1e-9 && tight < 1e-3, "{shut} {tight}");
    }
}
