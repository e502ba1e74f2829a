//! Which precession phase, alpha and spin phase is an attitude.
//!
//! The rotation from [`Spin`] to [`AntiSun`] is `R_z(a) R_y(alpha) R_z(b)`. Its quaternion is
//! x = -sin(alpha/2) sin((a - b)/2), y = sin(alpha/2) cos((a - b)/2),
//! z = cos(alpha/2) sin((a + b)/2), w = cos(alpha/2) cos((a + b)/2),
//! so that sum and difference of the phases come out apart, each as well as it can be known.
//!
//! Limits: at alpha = 0 only the sum means anything, at 180 deg only the difference b - a.

use onboard_core::frame::{AntiSun, Spin};
use onboard_core::rotation::Rotation;
use std::f64::consts::{PI, TAU};

/// ZYZ Euler angles, radians; any number of turns.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::struct_field_names, reason = "the unit stands in every name")]
pub(super) struct Angles {
    /// a + b.
    pub(super) sum_rad: f64,
    /// b - a.
    pub(super) difference_rad: f64,
    /// Alpha, in [0, pi].
    pub(super) alpha_rad: f64,
}

impl Angles {
    /// Of an attitude in the anti-Sun frame.
    #[must_use]
    pub(super) fn of(attitude: Rotation<Spin, AntiSun>) -> Self {
        let [x, y, z, w] = attitude.to_xyzw();
        Self {
            sum_rad: 2.0 * z.atan2(w),
            difference_rad: 2.0 * x.atan2(y),
            alpha_rad: 2.0 * x.hypot(y).atan2(z.hypot(w)),
        }
    }

    /// Precession phase a.
    #[must_use]
    pub(super) fn precession_rad(&self) -> f64 {
        0.5 * (self.sum_rad - self.difference_rad)
    }

    /// Spin phase b.
    #[must_use]
    pub(super) fn spin_rad(&self) -> f64 {
        0.5 * (self.sum_rad + self.difference_rad)
    }
}

/// An angle less whole turns, in [-pi, pi].
#[must_use]
pub(super) fn wrapped(angle_rad: f64) -> f64 {
    let turns = angle_rad / TAU;
    ((turns - turns.round()) * TAU).clamp(-PI, PI)
}

/// Axis times angle of a rotation, radians, at most half a turn long.
#[must_use]
pub fn rotation_vector<A, B>(rotation: Rotation<A, B>) -> [f64; 3] {
    let [x, y, z, w] = rotation.to_xyzw();
    let sin = x.hypot(y).hypot(z);
    let scale = if sin > 0.0 { 2.0 * sin.atan2(w) / sin } else { 2.0 };
    [x * scale, y * scale, z * scale]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn chain(a: f64, alpha: f64, b: f64) -> Rotation<Spin, AntiSun> {
        Rotation::<Spin, Spin>::about_z(b)
            .then(Rotation::<Spin, Spin>::about_y(alpha))
            .then(Rotation::about_z(a))
    }

    proptest! {
        #[test]
        fn angles_come_back(a in -4.0..4.0_f64, b in -4.0..4.0_f64, alpha in 0.01..3.13_f64) {
            let seen = Angles::of(chain(a, alpha, b));
            prop_assert!(wrapped(seen.precession_rad() - a).abs() < 1e-12);
            prop_assert!(wrapped(seen.spin_rad() - b).abs() < 1e-12);
            prop_assert!((seen.alpha_rad - alpha).abs() < 1e-14);
        }

        #[test]
        fn the_sum_survives_alpha_of_zero(a in -4.0..4.0_f64, b in -4.0..4.0_f64) {
            let seen = Angles::of(chain(a, 0.0, b));
            prop_assert!(wrapped(seen.sum_rad - a - b).abs() < 1e-14);
            let seen = Angles::of(chain(a, PI, b));
            prop_assert!(wrapped(seen.difference_rad - (b - a)).abs() < 1e-14);
        }

        #[test]
        fn vectors_are_axis_times_angle(angle in -3.1..3.1_f64) {
            let [x, y, z] = rotation_vector(Rotation::<Spin, Spin>::about_y(angle));
            prop_assert!((y - angle).abs() < 1e-14 && x.abs() < 1e-15 && z.abs() < 1e-15);
        }
    }
}
