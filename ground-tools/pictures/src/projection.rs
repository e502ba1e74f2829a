//! Where a direction stands in a picture, and which direction a point shows.
//!
//! A picture's plane has x to the right and y upwards; the whole sky fills |x| <= 2, |y| <= 1, a patch
//! |x|, |y| <= 1. North is up, longitude increases to the left. Angles are radians of the map's frame.
//!
//! Method: Mollweide's equal-area projection and the gnomonic one [Snyder1987, chapters 31 and 22].

use super::error::PictureError;
use planner::healpix::unit_vector;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// What part of the sky a picture shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum View {
    /// All of it, in Mollweide's projection.
    WholeSky {
        /// Longitude in the middle.
        longitude_rad: f64,
    },
    /// A square patch, in the gnomonic projection.
    Patch {
        /// Longitude in the middle.
        longitude_rad: f64,
        /// Latitude in the middle.
        latitude_rad: f64,
        /// Width and height, through the middle.
        side_rad: f64,
    },
}

/// A longitude's offset in [-pi, pi).
pub(super) fn wrapped(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}

impl View {
    pub(super) fn check(&self) -> Result<(), PictureError> {
        let (lon, lat, side) = match *self {
            Self::WholeSky { longitude_rad } => (longitude_rad, 0.0, 1.0),
            Self::Patch { longitude_rad, latitude_rad, side_rad } => {
                (longitude_rad, latitude_rad, side_rad)
            }
        };
        if !(lon.is_finite() && lat.abs() <= FRAC_PI_2) {
            return Err(PictureError::Centre(lon.to_degrees(), lat.to_degrees()));
        }
        if !(side > 0.0 && side.to_degrees() <= 150.0 + 1e-9) {
            return Err(PictureError::Side(side.to_degrees()));
        }
        Ok(())
    }

    /// The plane's half width and half height.
    pub(super) const fn half_size(&self) -> (f64, f64) {
        match self {
            Self::WholeSky { .. } => (2.0, 1.0),
            Self::Patch { .. } => (1.0, 1.0),
        }
    }

    /// The point of a direction; none where the plane has none.
    pub(super) fn forward(&self, longitude_rad: f64, latitude_rad: f64) -> Option<(f64, f64)> {
        match *self {
            Self::WholeSky { longitude_rad: center } => {
                let theta = auxiliary(latitude_rad);
                let x = -2.0 / PI * wrapped(longitude_rad - center) * theta.cos();
                Some((x, theta.sin()))
            }
            Self::Patch { longitude_rad: center, latitude_rad: middle, side_rad } => {
                let (sin, cos) = latitude_rad.sin_cos();
                let (sin_middle, cos_middle) = middle.sin_cos();
                let (sin_lon, cos_lon) = (longitude_rad - center).sin_cos();
                let depth = sin_middle * sin + cos_middle * cos * cos_lon;
                if depth <= 1e-3 {
                    return None;
                }
                let scale = 1.0 / (depth * (side_rad / 2.0).tan());
                let north = cos_middle * sin - sin_middle * cos * cos_lon;
                Some((-cos * sin_lon * scale, north * scale))
            }
        }
    }

    /// The longitude and latitude that a point shows; none outside the sky.
    pub(super) fn inverse(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        match *self {
            Self::WholeSky { longitude_rad } => {
                if x * x / 4.0 + y * y > 1.0 {
                    return None;
                }
                let theta = y.asin();
                let latitude = ((2.0 * theta + (2.0 * theta).sin()) / PI).clamp(-1.0, 1.0).asin();
                let offset = -PI * x / (2.0 * theta.cos()).max(1e-300);
                Some((longitude_rad + offset.clamp(-PI, PI), latitude))
            }
            Self::Patch { longitude_rad, latitude_rad, side_rad } => {
                let half = (side_rad / 2.0).tan();
                let (east, north) = (-x * half, y * half);
                let (sin, cos) = latitude_rad.sin_cos();
                // Middle + east + north, before the turn by the middle's longitude.
                let (out, up) = (cos - north * sin, sin + north * cos);
                let longitude = longitude_rad + east.atan2(out);
                Some((longitude, up.atan2(out.hypot(east))))
            }
        }
    }
}

/// Solves 2 t + sin 2t = pi sin(latitude) by halving.
fn auxiliary(latitude_rad: f64) -> f64 {
    let target = PI * latitude_rad.sin();
    let (mut low, mut high) = (-FRAC_PI_2, FRAC_PI_2);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if 2.0 * middle + (2.0 * middle).sin() < target {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::midpoint(low, high)
}

/// A line on the sky with no step longer than `step_rad`, along great circles.
pub(super) fn densified(line: &[(f64, f64)], step_rad: f64) -> Vec<(f64, f64)> {
    let mut dense: Vec<(f64, f64)> = line.first().copied().into_iter().collect();
    for (&(lon0, lat0), &(lon1, lat1)) in line.iter().zip(line.iter().skip(1)) {
        let (from, to) = (unit_vector(lon0, lat0), unit_vector(lon1, lat1));
        let cosine: f64 = from.iter().zip(&to).map(|(a, b)| a * b).sum();
        let parts = (cosine.clamp(-1.0, 1.0).acos() / step_rad).ceil().clamp(1.0, 10_000.0);
        let mut part = 1.0;
        while part < parts {
            let [x, y, z] = std::array::from_fn(|axis| {
                let share = part / parts;
                from[axis] * (1.0 - share) + to[axis] * share
            });
            dense.push((f64::atan2(y, x), f64::atan2(z, f64::hypot(x, y))));
            part += 1.0;
        }
        dense.push((lon1, lat1));
    }
    dense
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SKY: View = View::WholeSky { longitude_rad: 0.4 };

    #[test]
    fn longitude_increases_to_the_left_and_north_is_up() {
        let patch = View::Patch { longitude_rad: 0.4, latitude_rad: 0.2, side_rad: 0.5 };
        for view in [SKY, patch] {
            assert!(view.forward(0.5, 0.2).unwrap().0 < view.forward(0.4, 0.2).unwrap().0);
            assert!(view.forward(0.4, 0.3).unwrap().1 > view.forward(0.4, 0.2).unwrap().1);
        }
        let (x, y) = patch.forward(0.4, 0.2 + 0.25).unwrap();
        assert!(x.abs() < 1e-12 && (y - 1.0).abs() < 1e-12, "the edge is half a side away");
    }

    #[test]
    fn mollweides_projection_has_its_known_points() {
        let view = View::WholeSky { longitude_rad: 0.0 };
        for (lon, lat, x, y) in [
            (0.0, 0.0, 0.0, 0.0),
            (90.0, 0.0, -1.0, 0.0),
            (-90.0, 0.0, 1.0, 0.0),
            (0.0, 90.0, 0.0, 1.0),
            (0.0, -90.0, 0.0, -1.0),
            // Half of the northern hemisphere's area lies below 30 deg: 2 t + sin 2t = pi / 2.
            (0.0, 30.0, 0.0, 0.415_856_2_f64.sin()),
        ] {
            let found = view.forward(f64::to_radians(lon), f64::to_radians(lat)).unwrap();
            assert!(
                (found.0 - x).abs() < 1e-6 && (found.1 - y).abs() < 1e-6,
                "{lon} {lat}: {found:?}"
            );
        }
    }

    #[test]
    fn a_dense_line_keeps_its_ends_and_its_circle() {
        let line = densified(&[(0.0, 0.0), (1.0, 0.0)], 0.01);
        assert_eq!(line.len(), 101);
        assert_eq!((line[0], line[100]), ((0.0, 0.0), (1.0, 0.0)));
        assert!(line.iter().all(|&(_, lat)| lat.abs() < 1e-12));
        assert!(densified(&[], 0.01).is_empty());
    }

    proptest! {
        #[test]
        fn forward_and_inverse_agree(lon in -3.0..6.0f64, lat in -1.55..1.55f64, side in 0.01..2.0f64) {
            let patch = View::Patch { longitude_rad: 0.4, latitude_rad: 0.9, side_rad: side };
            for view in [SKY, patch] {
                if let Some((x, y)) = view.forward(lon, lat) {
                    let (lon_again, lat_again) = view.inverse(x, y).unwrap();
                    prop_assert!(wrapped(lon_again - lon).abs() * lat.cos() < 1e-7, "{} {}", lon, lon_again);
                    prop_assert!((lat_again - lat).abs() < 1e-7, "{} {}", lat, lat_again);
                }
            }
        }
    }
}
