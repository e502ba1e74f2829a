//! Rotations between frames.
//!
//! `Rotation<A, B>` takes components in A to components in B: `v_B = q v_A q*`. The same quaternion
//! (x, y, z, w) stands in files, outputs and code.
//!
//! ```
//! use onboard_core::direction::Direction;
//! use onboard_core::frame::{Boresight, Detector, Ecliptic};
//! use onboard_core::rotation::Rotation;
//!
//! let detector = Rotation::<Detector, Boresight>::IDENTITY;
//! let attitude = Rotation::<Boresight, Ecliptic>::from_xyzw([0.0, 0.0, 0.6, 0.8]).unwrap();
//! let sky: Direction<Ecliptic> = detector.then(attitude).apply(Direction::Z);
//! assert_eq!(sky.xyz(), [0.0, 0.0, 1.0]);
//! ```
//!
//! A chain in the wrong order does not compile:
//!
//! ```compile_fail,E0308
//! use onboard_core::frame::{Boresight, Detector, Ecliptic};
//! use onboard_core::rotation::Rotation;
//!
//! let detector = Rotation::<Detector, Boresight>::IDENTITY;
//! let attitude = Rotation::<Boresight, Ecliptic>::IDENTITY;
//! let _ = attitude.then(detector);
//! ```
//!
//! Limits: quaternions are renormalised where they enter, not after each product; the longest chain
//! of the crate has six products (error below 2e-15 rad).

use crate::direction::{Direction, root_near_one};
use crate::frame::{Ecliptic, Icrf, OBLIQUITY_ARCSEC};
use crate::phase::Phase;
use crate::trigonometry;
use crate::vector::{cross, plus, times, vector};
use core::marker::PhantomData;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// The unit quaternion that takes components in `A` to components in `B`.
#[derive(Debug)]
pub struct Rotation<A, B> {
    quaternion: UnitQuaternion<f64>,
    frames: PhantomData<fn(A) -> B>,
}

impl<A, B> Clone for Rotation<A, B> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A, B> Copy for Rotation<A, B> {}

/// Why four numbers are not a rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RotationError {
    /// A component is NaN or infinite.
    NotFinite,
    /// The norm is too far from one (the value).
    NotUnit(f64),
}

/// Largest accepted distance of a quaternion's norm from one.
pub const NORM_TOLERANCE: f64 = 1e-6;

impl<A, B> Rotation<A, B> {
    /// The rotation that changes nothing.
    pub const IDENTITY: Self = Self::from_parts(0.0, 0.0, 0.0, 1.0);

    pub(crate) const fn from_parts(x: f64, y: f64, z: f64, w: f64) -> Self {
        let quaternion = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        Self { quaternion, frames: PhantomData }
    }

    /// The rotation of quaternion (x, y, z, w), normalised.
    ///
    /// # Errors
    /// [`RotationError`] when a component is not finite or the norm is off by more than
    /// [`NORM_TOLERANCE`].
    pub fn from_xyzw(xyzw: [f64; 4]) -> Result<Self, RotationError> {
        let norm = norm(&xyzw)?;
        let [x, y, z, w] = xyzw;
        Ok(Self::from_parts(x / norm, y / norm, z / norm, w / norm))
    }

    /// The quaternion (x, y, z, w), with w >= 0.
    #[must_use]
    pub fn to_xyzw(self) -> [f64; 4] {
        let q = self.quaternion.quaternion().coords;
        if q.w < 0.0 { [-q.x, -q.y, -q.z, -q.w] } else { [q.x, q.y, q.z, q.w] }
    }

    /// `R_x`: turns y towards z by `angle_rad`.
    #[must_use]
    pub fn about_x(angle_rad: f64) -> Self {
        let (sin, cos) = trigonometry::sin_cos(0.5 * angle_rad);
        Self::from_parts(sin, 0.0, 0.0, cos)
    }

    /// `R_y`: turns z towards x by `angle_rad`.
    #[must_use]
    pub fn about_y(angle_rad: f64) -> Self {
        let (sin, cos) = trigonometry::sin_cos(0.5 * angle_rad);
        Self::from_parts(0.0, sin, 0.0, cos)
    }

    /// `R_z`: turns x towards y by `angle_rad`.
    #[must_use]
    pub fn about_z(angle_rad: f64) -> Self {
        let (sin, cos) = trigonometry::sin_cos(0.5 * angle_rad);
        Self::from_parts(0.0, 0.0, sin, cos)
    }

    /// `R_z`: turns x towards y by an exact phase.
    #[must_use]
    pub fn about_z_by(phase: Phase) -> Self {
        let (sin, cos) = phase.half().sin_cos();
        Self::from_parts(0.0, 0.0, sin, cos)
    }

    /// The rotation that puts A's z at colatitude and longitude of `direction` in B, and A's x
    /// towards B's north (+z): `R_z(longitude) R_y(colatitude) R_z(pi)`.
    ///
    /// At a pole of B the longitude is taken as 0.
    #[must_use]
    #[inline(never)]
    pub fn to_direction_with_x_north(direction: Direction<B>) -> Self {
        let [x, y, z] = direction.xyz();
        let rho = root_near_one(x * x + y * y);
        let (cos_lon, sin_lon) = if rho > 0.0 { (x / rho, y / rho) } else { (1.0, 0.0) };
        let (sin_half_lon, cos_half_lon) = half_angle(sin_lon, cos_lon);
        let (sin_half_col, cos_half_col) = half_angle(rho, z);
        // R_z(longitude) R_y(colatitude) R_z(pi), multiplied out.
        Self::from_parts(
            cos_half_lon * sin_half_col,
            sin_half_lon * sin_half_col,
            cos_half_lon * cos_half_col,
            -sin_half_lon * cos_half_col,
        )
    }

    /// First this rotation, then `next`.
    #[must_use]
    pub fn then<C>(self, next: Rotation<B, C>) -> Rotation<A, C> {
        let quaternion = UnitQuaternion::new_unchecked(
            next.quaternion.into_inner() * self.quaternion.into_inner(),
        );
        Rotation { quaternion, frames: PhantomData }
    }

    /// The rotation back from `B` to `A`.
    #[must_use]
    pub fn inverse(self) -> Rotation<B, A> {
        Rotation { quaternion: self.quaternion.inverse(), frames: PhantomData }
    }

    /// The same numbers, from any frame: for code that would otherwise stand once per frame.
    pub(crate) const fn of_any_frame<C>(self) -> Rotation<C, B> {
        Rotation { quaternion: self.quaternion, frames: PhantomData }
    }

    /// A direction's components in `B`.
    #[must_use]
    pub fn apply(self, direction: Direction<A>) -> Direction<B> {
        Direction::from_unit(self.rotate(direction.vector()))
    }

    /// A's x and z axes in `B`: columns of the rotation's matrix.
    pub(crate) fn x_and_z(self) -> (Vector3<f64>, Vector3<f64>) {
        let q = self.quaternion.quaternion().coords;
        let (xx, yy, zz) = (q.x * q.x, q.y * q.y, q.z * q.z);
        let (xy, xz, yz) = (q.x * q.y, q.x * q.z, q.y * q.z);
        let (wx, wy, wz) = (q.w * q.x, q.w * q.y, q.w * q.z);
        (
            Vector3::new(1.0 - 2.0 * (yy + zz), 2.0 * (xy + wz), 2.0 * (xz - wy)),
            Vector3::new(2.0 * (xz + wy), 2.0 * (yz - wx), 1.0 - 2.0 * (xx + yy)),
        )
    }

    /// A's z axis in `B`: the last column of the rotation's matrix.
    pub(crate) fn z_axis(self) -> Vector3<f64> {
        let q = self.quaternion.quaternion().coords;
        Vector3::new(
            2.0 * (q.x * q.z + q.w * q.y),
            2.0 * (q.y * q.z - q.w * q.x),
            1.0 - 2.0 * (q.x * q.x + q.y * q.y),
        )
    }

    /// First `R_y` of this half angle (its sine and cosine), then this rotation: the product without
    /// its zeros.
    pub(crate) fn after_about_y<C>(self, (sin, cos): (f64, f64)) -> Rotation<C, B> {
        let q = self.quaternion.quaternion().coords;
        Rotation::from_parts(
            q.x * cos - q.z * sin,
            q.w * sin + q.y * cos,
            q.x * sin + q.z * cos,
            q.w * cos - q.y * sin,
        )
    }

    pub(crate) fn rotate(self, vector: Vector3<f64>) -> Vector3<f64> {
        rotated(&self.quaternion, &vector)
    }
}

impl Rotation<Icrf, Ecliptic> {
    /// From equatorial to ecliptic axes: `R_x(-obliquity)`.
    #[must_use]
    pub fn by_obliquity() -> Self {
        Self::about_x(-(OBLIQUITY_ARCSEC / 3600.0).to_radians())
    }
}

/// The norm of a quaternion, where that is near one.
#[inline(never)]
fn norm([x, y, z, w]: &[f64; 4]) -> Result<f64, RotationError> {
    let norm = libm::sqrt(x * x + y * y + z * z + w * w);
    if !norm.is_finite() {
        return Err(RotationError::NotFinite);
    }
    if libm::fabs(norm - 1.0) > NORM_TOLERANCE {
        return Err(RotationError::NotUnit(norm));
    }
    Ok(norm)
}

/// Apart from [`Rotation::rotate`], whose frames would make it several functions.
#[inline(never)]
fn rotated(quaternion: &UnitQuaternion<f64>, from: &Vector3<f64>) -> Vector3<f64> {
    // t = 2 q x v; v + w t + q x t.
    let q = quaternion.quaternion().coords;
    let axis = vector(q.x, q.y, q.z);
    let t = times(cross(axis, *from), 2.0);
    plus(plus(times(t, q.w), cross(axis, t)), *from)
}

/// Sine and cosine of half the angle whose sine and cosine are given, without cancellation.
fn half_angle(sin: f64, cos: f64) -> (f64, f64) {
    if cos >= 0.0 {
        let cos_half = libm::sqrt(0.5 * (1.0 + cos));
        (0.5 * sin / cos_half, cos_half)
    } else {
        let sin_half = libm::copysign(libm::sqrt(0.5 * (1.0 - cos)), sin);
        (sin_half, 0.5 * sin / sin_half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{AntiSun, Boresight, Ecliptic, Spin};
    use proptest::prelude::*;

    fn close(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 4e-16)
    }

    #[test]
    fn axes_turn_the_right_way() {
        let quarter = core::f64::consts::FRAC_PI_2;
        let x = Direction::<Spin>::new(1.0, 0.0, 0.0).unwrap();
        let y = Direction::<Spin>::new(0.0, 1.0, 0.0).unwrap();
        let z = Direction::<Spin>::Z;
        assert!(close(Rotation::<Spin, Spin>::about_z(quarter).apply(x).xyz(), y.xyz()));
        assert!(close(Rotation::<Spin, Spin>::about_y(quarter).apply(z).xyz(), x.xyz()));
        assert!(close(Rotation::<Spin, Spin>::about_x(quarter).apply(y).xyz(), z.xyz()));
    }

    #[test]
    fn refuses_what_is_not_a_rotation() {
        assert_eq!(
            Rotation::<Spin, Spin>::from_xyzw([f64::NAN, 0.0, 0.0, 1.0]).unwrap_err(),
            RotationError::NotFinite
        );
        assert_eq!(
            Rotation::<Spin, Spin>::from_xyzw([0.0, 0.0, 0.0, 2.0]).unwrap_err(),
            RotationError::NotUnit(2.0)
        );
    }

    #[test]
    fn the_ecliptic_pole_lies_at_eighteen_hours() {
        let (sin, cos) = libm::sincos((OBLIQUITY_ARCSEC / 3600.0).to_radians());
        let pole = Direction::<Icrf>::new(0.0, -sin, cos).unwrap();
        let equinox = Direction::<Icrf>::new(1.0, 0.0, 0.0).unwrap();
        let turn = Rotation::by_obliquity();
        assert!(close(turn.apply(pole).xyz(), [0.0, 0.0, 1.0]));
        assert!(close(turn.apply(equinox).xyz(), [1.0, 0.0, 0.0]));
    }

    proptest! {
        #[test]
        fn the_anti_sun_frame_has_its_axes(
            lon in -4.0..4.0_f64,
            lat in prop_oneof![-1.5..1.5_f64, -4e-3..4e-3_f64, -1e-5..1e-5_f64],
        ) {
            let d = Direction::<Ecliptic>::from_longitude_latitude(lon, lat);
            let r = Rotation::<AntiSun, Ecliptic>::to_direction_with_x_north(d);
            let [zx, zy, zz] = r.apply(Direction::Z).xyz();
            let [dx, dy, dz] = d.xyz();
            prop_assert!((zx - dx).abs() < 1e-15 && (zy - dy).abs() < 1e-15 && (zz - dz).abs() < 1e-15);
            let [x, y, z] = r.apply(Direction::new(1.0, 0.0, 0.0).unwrap()).xyz();
            prop_assert!((x * dx + y * dy + z * dz).abs() < 1e-15, "x is perpendicular to z");
            prop_assert!((z - lat.cos()).abs() < 1e-15, "x points north");
            let [.., yz] = r.apply(Direction::new(0.0, 1.0, 0.0).unwrap()).xyz();
            prop_assert!(yz.abs() < 1e-15, "y is level");
        }

        #[test]
        fn a_rotation_and_its_inverse_cancel(a in -3.0..3.0_f64, b in -3.0..3.0_f64, c in -3.0..3.0_f64) {
            let r = Rotation::<Spin, Spin>::about_z(a)
                .then(Rotation::<Spin, Spin>::about_y(b))
                .then(Rotation::<Spin, Spin>::about_x(c));
            let (x_axis, z_axis) = r.x_and_z();
            for (axis, unit) in [(x_axis, [1.0, 0.0, 0.0]), (z_axis, [0.0, 0.0, 1.0])] {
                let [x, y, z] = unit;
                prop_assert!((axis - r.rotate(Vector3::new(x, y, z))).norm() < 2e-15);
            }
            let [x, y, z, w] = r.then(r.inverse()).to_xyzw();
            prop_assert!(x.abs() < 2e-15 && y.abs() < 2e-15 && z.abs() < 2e-15 && (w - 1.0).abs() < 2e-15);
        }
    }

    #[test]
    fn a_quaternion_is_normalised_within_the_tolerance() {
        let unit = [0.1, -0.5, 0.7, 0.5];
        let stretched =
            |by: f64| Rotation::<Boresight, Boresight>::from_xyzw(unit.map(|it| by * it));
        for by in [1.0, 1.0 + 0.9 * NORM_TOLERANCE, 1.0 - 0.9 * NORM_TOLERANCE] {
            let own = stretched(by).unwrap().to_xyzw();
            assert!(own.iter().zip(unit).all(|(own, it)| (own - it).abs() < 1e-15), "{own:?}");
        }
        for by in [1.0 + 1.1 * NORM_TOLERANCE, 1.0 - 1.1 * NORM_TOLERANCE] {
            assert!(
                matches!(stretched(by), Err(RotationError::NotUnit(norm)) if (norm - by).abs() < 1e-15)
            );
        }
        for place in 0..4 {
            let mut alone = [0.0; 4];
            alone[place] = 1.0;
            let own = Rotation::<Boresight, Boresight>::from_xyzw(alone).unwrap().to_xyzw();
            assert_eq!(own.map(|it| it.abs().to_bits()), alone.map(f64::to_bits));
            alone[place] = f64::INFINITY;
            let refused = Rotation::<Boresight, Boresight>::from_xyzw(alone);
            assert!(matches!(refused, Err(RotationError::NotFinite)));
        }
    }
}
