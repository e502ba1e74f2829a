//! Unit vectors that know their frame.
//!
//! A [`Direction`] has length one to rounding; [`DirectionState`] adds how it moves.
//!
//! Method: separations by `atan2(|a x b|, a . b)`, accurate from 0 to pi.
//!
//! Limits: the longitude of a pole is given as 0.

use crate::trigonometry;
use crate::vector::{cross, dot, times};
use core::marker::PhantomData;
use nalgebra::Vector3;

/// Largest `1 - |v|^2` whose root two terms give.
const NEARLY_UNIT: f64 = 5e-6;

/// Square root of a square that is one but for a small error, as the cosine of the Sun's latitude is.
///
/// With e = 1 - square, `(1 - e)^(1/2) = 1 - e/2 - e^2/8 - ...`; below the limit on e the first term
/// left out is e^3/16 < 8e-18. Others go the long way.
pub(crate) fn root_near_one(square: f64) -> f64 {
    let e = 1.0 - square;
    if libm::fabs(e) < NEARLY_UNIT { 1.0 - e * (0.5 + 0.125 * e) } else { libm::sqrt(square) }
}

/// A unit vector with components in frame `F`.
#[derive(Debug)]
pub struct Direction<F> {
    vector: Vector3<f64>,
    frame: PhantomData<fn() -> F>,
}

impl<F> Clone for Direction<F> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F> Copy for Direction<F> {}

impl<F> Direction<F> {
    /// The direction along z.
    pub const Z: Self = Self { vector: Vector3::new(0.0, 0.0, 1.0), frame: PhantomData };

    /// No direction: zeros, before one is known.
    pub(crate) const NOWHERE: Self = Self::from_unit(Vector3::new(0.0, 0.0, 0.0));

    /// The direction of (x, y, z), normalised; `None` when the squared length is zero, so small that
    /// it has lost digits (below 1e-307), or not finite.
    #[must_use]
    pub fn new(x: f64, y: f64, z: f64) -> Option<Self> {
        let squared = x * x + y * y + z * z;
        if !squared.is_normal() {
            return None;
        }
        let length = libm::sqrt(squared);
        Some(Self::from_unit(Vector3::new(x / length, y / length, z / length)))
    }

    /// The direction at `longitude_rad` from x towards y, `latitude_rad` towards z.
    #[must_use]
    pub fn from_longitude_latitude(longitude_rad: f64, latitude_rad: f64) -> Self {
        let (sin_lon, cos_lon) = trigonometry::sin_cos(longitude_rad);
        let (sin_lat, cos_lat) = trigonometry::sin_cos(latitude_rad);
        Self::from_unit(Vector3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat))
    }

    /// The direction of a vector whose length is one but for a small error.
    ///
    /// With e = 1 - |v|^2, `1/|v| = (1 - e)^(-1/2) = 1 + e/2 + 3 e^2/8 + ...`; below the limit on e
    /// the first term left out is 5 e^3 / 16 < 4e-17. Others go the long way.
    pub(crate) fn from_nearly_unit(v: Vector3<f64>) -> Option<Self> {
        let e = 1.0 - dot(v, v);
        if libm::fabs(e) < NEARLY_UNIT {
            Some(Self::from_unit(times(v, 1.0 + e * (0.5 + 0.375 * e))))
        } else {
            Self::new(v.x, v.y, v.z)
        }
    }

    pub(crate) const fn from_unit(vector: Vector3<f64>) -> Self {
        Self { vector, frame: PhantomData }
    }

    /// Components (x, y, z).
    #[must_use]
    pub fn xyz(self) -> [f64; 3] {
        [self.vector.x, self.vector.y, self.vector.z]
    }

    pub(crate) const fn vector(self) -> Vector3<f64> {
        self.vector
    }

    /// Angle to another direction in radians, in [0, pi].
    #[must_use]
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn separation_rad(self, other: Self) -> f64 {
        let (a, b) = (self.vector, other.vector);
        let across = cross(a, b);
        libm::atan2(libm::sqrt(dot(across, across)), dot(a, b))
    }

    /// Longitude in radians from x towards y, in [-pi, pi]; 0 at a pole.
    #[must_use]
    pub fn longitude_rad(self) -> f64 {
        libm::atan2(self.vector.y, self.vector.x)
    }

    /// Latitude in radians towards z, in [-pi/2, pi/2].
    #[must_use]
    pub fn latitude_rad(self) -> f64 {
        libm::atan2(self.vector.z, libm::hypot(self.vector.x, self.vector.y))
    }
}

/// A direction and its rate of change in the same frame.
#[derive(Debug)]
pub struct DirectionState<F> {
    /// Where it points.
    pub direction: Direction<F>,
    /// Time derivative of the unit vector in 1/s, perpendicular to it.
    pub rate_per_s: [f64; 3],
}

impl<F> DirectionState<F> {
    /// Zeros, before one is known.
    pub(crate) const NOWHERE: Self = Self { direction: Direction::NOWHERE, rate_per_s: [0.0; 3] };
}

impl<F> Clone for DirectionState<F> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F> Copy for DirectionState<F> {}

/// Bounds on how a direction moves, over all the time it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionBounds {
    /// Largest angular speed in rad/s.
    pub rate_rad_s: f64,
    /// Largest magnitude of the unit vector's second derivative in 1/s^2.
    pub acceleration_per_s2: f64,
    /// Largest absolute z component.
    pub max_abs_z: f64,
}

impl MotionBounds {
    /// Of what does not move, on the equator.
    pub const NONE: Self = Self { rate_rad_s: 0.0, acceleration_per_s2: 0.0, max_abs_z: 0.0 };

    /// Bounds that hold for both motions: the larger of each two.
    #[must_use]
    #[inline(never)]
    pub fn and(&self, other: &Self) -> Self {
        let larger = |a: f64, b: f64| if b > a { b } else { a };
        Self {
            rate_rad_s: larger(self.rate_rad_s, other.rate_rad_s),
            acceleration_per_s2: larger(self.acceleration_per_s2, other.acceleration_per_s2),
            max_abs_z: larger(self.max_abs_z, other.max_abs_z),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Ecliptic;
    use core::f64::consts::{FRAC_PI_2, PI};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_root_near_one_is_the_root(e in prop_oneof![-1e-5..1e-5_f64, -0.9..9.0_f64]) {
            let off = root_near_one(1.0 + e) - libm::sqrt(1.0 + e);
            prop_assert!(off.abs() <= f64::EPSILON, "{off:e}");
        }
    }

    #[test]
    fn separations_hold_their_digits_near_zero_and_pi() {
        let a = Direction::<Ecliptic>::from_longitude_latitude(1.0, 0.0);
        let b = Direction::<Ecliptic>::from_longitude_latitude(1.0 + 1e-9, 0.0);
        assert!((a.separation_rad(b) - 1e-9).abs() < 2e-16);
        let opposite = Direction::<Ecliptic>::from_longitude_latitude(1.0 + PI - 1e-9, 0.0);
        assert!((PI - a.separation_rad(opposite) - 1e-9).abs() < 1e-15);
    }

    #[test]
    fn both_ways_to_normalise_agree() {
        for length in [1.0, 1.0 - 2.4e-6, 1.0 + 2.4e-6, 1.0 + 1e-9, 1.0 - 2.6e-6, 0.5, 3.0] {
            let v = Vector3::new(0.48, -0.6, 0.64) * length;
            let quick = Direction::<Ecliptic>::from_nearly_unit(v).unwrap();
            let long = Direction::<Ecliptic>::new(v.x, v.y, v.z).unwrap();
            for (a, b) in quick.xyz().into_iter().zip(long.xyz()) {
                assert!((a - b).abs() < 2.3e-16, "{length}");
            }
        }
        assert!(
            Direction::<Ecliptic>::from_nearly_unit(Vector3::new(f64::NAN, 0.0, 1.0)).is_none()
        );
    }

    #[test]
    fn no_direction_without_a_length() {
        assert!(Direction::<Ecliptic>::new(0.0, 0.0, 0.0).is_none());
        assert!(Direction::<Ecliptic>::new(f64::NAN, 0.0, 1.0).is_none());
        assert!(Direction::<Ecliptic>::new(f64::INFINITY, 0.0, 1.0).is_none());
        assert!(Direction::<Ecliptic>::new(1e-161, 3e-161, 0.0).is_none());
        let pole = Direction::<Ecliptic>::new(0.0, 0.0, -2.0).unwrap();
        assert!((pole.latitude_rad() + FRAC_PI_2).abs() < 1e-15);
    }

    #[test]
    fn a_nearly_unit_vector_is_normalised_on_either_way() {
        let v = Vector3::new(0.36, 0.48, -0.8);
        for by in [1.0, 1.0 + 1e-9, 1.0 - 1e-7, 1.0 + 4e-6, 1.0 - 4e-6, 1.001, 0.9, 3.0, 1e-3] {
            let own = Direction::<Ecliptic>::from_nearly_unit(v * by).unwrap().vector();
            assert!((own - v).norm() < 3e-16, "{by}");
        }
        assert!(Direction::<Ecliptic>::from_nearly_unit(Vector3::zeros()).is_none());
    }

    #[test]
    fn longitude_and_latitude_come_back() {
        for (longitude, latitude) in [(0.3, 0.2), (-2.5, -1.1), (3.0, 1.5), (-0.1, 0.0)] {
            let own = Direction::<Ecliptic>::from_longitude_latitude(longitude, latitude);
            assert!((own.longitude_rad() - longitude).abs() < 1e-15);
            assert!((own.latitude_rad() - latitude).abs() < 1e-15);
            let turned = Direction::<Ecliptic>::from_longitude_latitude(longitude + 0.3, latitude);
            let half = (0.15_f64.sin() * latitude.cos()).asin();
            assert!((own.separation_rad(turned) - 2.0 * half).abs() < 1e-14);
        }
    }
}
