//! The target as the spinning spacecraft sees it: one evaluation of the search.

use crate::direction::DirectionState;
use crate::ephemeris::{BodyTable, EphemerisError};
use crate::frame::{AntiSun, Ecliptic};
use crate::scan::ScanStrategy;
use crate::sun::{AntiSunAxes, SunModel};
use crate::time::{Duration, Instant};
use crate::trigonometry;
use nalgebra::Vector3;

/// The scanning strategy with its trigonometry done once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    pub(super) scan: ScanStrategy,
    pub(super) sin_alpha: f64,
    pub(super) cos_alpha: f64,
    /// Signed precession rate in rad/s.
    pub(super) precession: f64,
    /// Signed spin rate in rad/s.
    pub(super) spin: f64,
}

impl Motion {
    /// Before a strategy is known.
    pub(super) const NOTHING: Self = Self {
        scan: ScanStrategy::STILL,
        sin_alpha: 0.0,
        cos_alpha: 0.0,
        precession: 0.0,
        spin: 0.0,
    };

    /// Takes up a strategy, in place.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn set(&mut self, scan: &ScanStrategy) {
        self.scan = *scan;
        (self.sin_alpha, self.cos_alpha) = trigonometry::sin_cos(scan.parameters().alpha_rad);
        (self.precession, self.spin) = scan.rates_rad_s();
    }
}

/// Sun, target and phases at one instant.
///
/// Evaluated apart from [`Sight`], so that the sines, which need the most stack, are taken while
/// little else lies on it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seen {
    /// Sun to spacecraft.
    anti_sun: DirectionState<Ecliptic>,
    /// In the anti-Sun frame.
    target: DirectionState<AntiSun>,
    /// Sine and cosine of the precession phase, then of the spin phase.
    sines: [(f64, f64); 2],
    /// Where the series of the Sun or of the target ends: there direction, rate and second
    /// derivative may jump, as at a burn.
    joint: Instant,
}

impl Seen {
    /// Before the first evaluation: zeros, which take no place among the read-only data.
    pub(crate) const NOTHING: Self = Self {
        anti_sun: DirectionState::NOWHERE,
        target: DirectionState::NOWHERE,
        sines: [(0.0, 0.0); 2],
        joint: Instant::from_tai_ns(0),
    };

    /// Of a target in the anti-Sun frame, with the sines and cosines of both phases.
    #[cfg(test)]
    pub(super) const fn of(target: DirectionState<AntiSun>, sines: [(f64, f64); 2]) -> Self {
        Self { target, sines, ..Self::NOTHING }
    }

    /// The longest that a step may take from `at`, where it was evaluated: to the last instant before
    /// the joint, and from there to the joint, so that no step passes it unseen.
    pub(super) const fn latest_step(&self, at: Instant) -> Instant {
        let before = self.joint.plus(Duration::from_ns(-1));
        if before.tai_ns() > at.tai_ns() { before } else { at.plus(Duration::from_ns(1)) }
    }

    /// Evaluates at `at`, in place.
    #[inline]
    pub(super) fn evaluate(
        &mut self,
        at: Instant,
        motion: &Motion,
        sun: &SunModel<'_>,
        target: BodyTable<'_>,
    ) -> Result<(), EphemerisError> {
        self.evaluate_sun(at, motion, sun)?;
        self.evaluate_target(at, target)?;
        self.evaluate_phases(at, &motion.scan);
        Ok(())
    }

    #[cfg_attr(target_os = "none", inline(never))]
    fn evaluate_sun(
        &mut self,
        at: Instant,
        motion: &Motion,
        sun: &SunModel<'_>,
    ) -> Result<(), EphemerisError> {
        let start = motion.scan.parameters().start;
        self.joint = sun.place_state(start, at, &mut self.anti_sun)?;
        Ok(())
    }

    #[cfg_attr(target_os = "none", inline(never))]
    fn evaluate_target(
        &mut self,
        at: Instant,
        target: BodyTable<'_>,
    ) -> Result<(), EphemerisError> {
        let mut state = DirectionState::NOWHERE;
        let joint = target.place_state(at, &mut state)?;
        self.joint = self.joint.min(joint);
        self.place_target(&state);
        Ok(())
    }

    /// Apart, so that it does not lie on the stack below the series.
    #[cfg_attr(target_os = "none", inline(never))]
    fn place_target(&mut self, state: &DirectionState<Ecliptic>) {
        self.target = AntiSunAxes::new(&self.anti_sun).in_anti_sun(state);
    }

    #[cfg_attr(target_os = "none", inline(never))]
    fn evaluate_phases(&mut self, at: Instant, scan: &ScanStrategy) {
        let (precession, spin) = scan.phases(at);
        self.sines = [precession.sin_cos(), spin.sin_cos()];
    }
}

/// The target's direction at one instant, in the frames of the search.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    pub(super) cos_gamma: f64,
    pub(super) sin_gamma: f64,
    /// In the anti-Sun frame turned by the precession phase: its azimuth is minus x.
    pub(super) precessed: (f64, f64),
    pub(super) cos_delta: f64,
    pub(super) sin_delta: f64,
    /// In [`crate::frame::Spin`].
    pub(super) direction: Vector3<f64>,
    /// Its derivative there, 1/s.
    pub(super) rate: Vector3<f64>,
}

impl Sight {
    /// The target as seen, taken to the spinning spacecraft.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn new(motion: &Motion, seen: &Seen) -> Self {
        let Seen { target: seen, sines: [(sin_a, cos_a), (sin_b, cos_b)], .. } = *seen;
        let p = seen.direction.vector();
        let [vx, vy, vz] = seen.rate_per_s;

        // R_z(-a), then R_y(-alpha); the turning frame adds -w_a z x p.
        let turned = back_about_z(p, sin_a, cos_a);
        let turned_rate = back_about_z(
            Vector3::new(vx + motion.precession * p.y, vy - motion.precession * p.x, vz),
            sin_a,
            cos_a,
        );
        let tilted = back_about_y(turned, motion);
        let tilted_rate = back_about_y(turned_rate, motion);
        // R_z(-b); the spinning frame adds -w_b z x u.
        let direction = back_about_z(tilted, sin_b, cos_b);
        let rate = back_about_z(
            Vector3::new(
                tilted_rate.x + motion.spin * tilted.y,
                tilted_rate.y - motion.spin * tilted.x,
                tilted_rate.z,
            ),
            sin_b,
            cos_b,
        );
        Self {
            cos_gamma: p.z,
            sin_gamma: libm::sqrt(p.x * p.x + p.y * p.y),
            precessed: (turned.x, turned.y),
            cos_delta: tilted.z,
            sin_delta: libm::sqrt(tilted.x * tilted.x + tilted.y * tilted.y),
            direction,
            rate,
        }
    }
}

fn back_about_z(v: Vector3<f64>, sin: f64, cos: f64) -> Vector3<f64> {
    Vector3::new(v.x * cos + v.y * sin, v.y * cos - v.x * sin, v.z)
}

fn back_about_y(v: Vector3<f64>, motion: &Motion) -> Vector3<f64> {
    let (sin, cos) = (motion.sin_alpha, motion.cos_alpha);
    Vector3::new(v.x * cos - v.z * sin, v.y, v.x * sin + v.z * cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    // REQ-TRANSIT-3.
    fn a_step_ends_just_before_a_joint_and_then_at_it() {
        let at = Instant::from_tai_ns;
        let seen = Seen { joint: at(1_000), ..Seen::NOTHING };
        assert_eq!(seen.latest_step(at(0)), at(999));
        assert_eq!(seen.latest_step(at(998)), at(999));
        assert_eq!(seen.latest_step(at(999)), at(1_000));
        assert_eq!(seen.latest_step(at(1_000)), at(1_001));
    }
}
