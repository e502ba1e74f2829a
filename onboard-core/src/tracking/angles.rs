//! Which angles of the scan does an attitude show.
//!
//! [`ScanAngles`] are precession phase a, alpha and spin phase b of a measured attitude.
//!
//! Frames: the Sun's rotation (`AntiSun` to `Ecliptic`) and beta (`Boresight` to `Spin`) are known
//! and undone; what is left is `R_z(a) R_y(alpha) R_z(b)` from `Spin` to `AntiSun`.
//!
//! Method: multiplied out, that quaternion is
//!
//! ```text
//! w = cos(alpha/2) cos p    z = cos(alpha/2) sin p    p = (a + b)/2
//! y = sin(alpha/2) cos m    x = -sin(alpha/2) sin m   m = (a - b)/2
//! ```
//!
//! so each of p, m and alpha/2 is one arctangent. The other sign of the quaternion moves p and m by
//! pi each: a = p + m and b = p - m stay what they are, up to whole turns.
//!
//! A small turn of sigma rad about each of three axes moves a + b by `sigma / cos(alpha/2)`, a - b
//! by `sigma / sin(alpha/2)` and alpha by sigma, the three independently; hence the covariance of
//! (a, alpha, b): `sigma^2 [[1/s^2, 0, -c/s^2], [0, 1, 0], [-c/s^2, 0, 1/s^2]]`, s and c the sine
//! and cosine of alpha (`tests/tests/tracking.rs` draws it).
//!
//! Limits: at alpha = 0 and pi one of m and p has no meaning and comes out as some angle.

use crate::ephemeris::EphemerisError;
use crate::frame::{AntiSun, Boresight, Ecliptic, Spin};
use crate::phase::Phase;
use crate::rotation::Rotation;
use crate::scan::ScanStrategy;
use crate::sun::SunModel;
use crate::time::Instant;

/// The three angles between the anti-Sun frame and the spinning spacecraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanAngles {
    /// Precession phase.
    pub precession: Phase,
    /// Angle from the anti-Sun axis to the spin axis in radians, in [0, pi].
    pub alpha_rad: f64,
    /// Spin phase.
    pub spin: Phase,
}

impl ScanAngles {
    /// The angles that `attitude` shows at `at`; beta and the mission's start are the strategy's.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] beyond the Sun's table.
    pub fn measured(
        attitude: Rotation<Boresight, Ecliptic>,
        scan: &ScanStrategy,
        sun: &SunModel<'_>,
        at: Instant,
    ) -> Result<Self, EphemerisError> {
        let anti_sun = sun.state(scan.parameters().start, at)?.direction;
        let frame = Rotation::<AntiSun, Ecliptic>::to_direction_with_x_north(anti_sun);
        let spin = scan.boresight_in_spin().inverse().then(attitude).then(frame.inverse());
        Ok(Self::of(spin))
    }

    /// The angles of a rotation `R_z(a) R_y(alpha) R_z(b)`.
    #[must_use]
    pub fn of(rotation: Rotation<Spin, AntiSun>) -> Self {
        let [x, y, z, w] = rotation.to_xyzw();
        let half_sum = Phase::from_radians(libm::atan2(z, w));
        let half_difference = Phase::from_radians(libm::atan2(-x, y));
        Self {
            precession: half_sum.plus(half_difference),
            alpha_rad: 2.0 * libm::atan2(libm::hypot(x, y), libm::hypot(z, w)),
            spin: half_sum.plus(half_difference.negated()),
        }
    }

    /// The angles that the strategy has at `at`.
    #[must_use]
    pub const fn modelled(scan: &ScanStrategy, at: Instant) -> Self {
        let (precession, spin) = scan.phases(at);
        Self { precession, alpha_rad: scan.parameters().alpha_rad, spin }
    }

    /// These angles minus `model`'s in radians: precession phase, alpha, spin phase; phases in
    /// [-pi, pi).
    #[must_use]
    pub const fn minus(&self, model: &Self) -> [f64; 3] {
        [
            self.precession.plus(model.precession.negated()).radians(),
            self.alpha_rad - model.alpha_rad,
            self.spin.plus(model.spin.negated()).radians(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;
    use proptest::prelude::*;

    fn rotation(a: Phase, alpha: f64, b: Phase) -> Rotation<Spin, AntiSun> {
        Rotation::<Spin, Spin>::about_z_by(b)
            .then(Rotation::<Spin, Spin>::about_y(alpha))
            .then(Rotation::about_z_by(a))
    }

    proptest! {
        #[test]
        fn angles_come_back(a: u64, b: u64, alpha in 0.017..3.124_f64) {
            let there = ScanAngles {
                precession: Phase::from_bits(a),
                alpha_rad: alpha,
                spin: Phase::from_bits(b),
            };
            let back = ScanAngles::of(rotation(there.precession, alpha, there.spin));
            for off in back.minus(&there) {
                prop_assert!(off.abs() < 2e-15 / alpha.sin(), "{off:e}");
            }
        }

        #[test]
        fn the_sum_of_the_phases_survives_small_alpha(a: u64, b: u64, alpha in 0.0..1e-3_f64) {
            let (a, b) = (Phase::from_bits(a), Phase::from_bits(b));
            let back = ScanAngles::of(rotation(a, alpha, b));
            let off = back.precession.plus(back.spin).plus(a.plus(b).negated()).radians();
            prop_assert!(off.abs() < 4e-15, "{off:e}");
            prop_assert!((back.alpha_rad - alpha).abs() < 1e-15);
        }

        #[test]
        fn the_difference_survives_alpha_near_pi(a: u64, b: u64, rest in 0.0..1e-3_f64) {
            let (a, b) = (Phase::from_bits(a), Phase::from_bits(b));
            let back = ScanAngles::of(rotation(a, PI - rest, b));
            let off = back
                .precession
                .plus(back.spin.negated())
                .plus(a.plus(b.negated()).negated())
                .radians();
            prop_assert!(off.abs() < 4e-15, "{off:e}");
            prop_assert!((PI - rest - back.alpha_rad).abs() < 1e-15);
        }
    }
}
