//! Which pixel of the sky: HEALPix resolutions, orderings and geometry.
//!
//! A pixel is a number below `12 nside^2`, in RING order (along circles of latitude) or NESTED order
//! (along the quadtree of the twelve base pixels). Longitudes and latitudes are radians of the map's
//! frame; unit vectors are its Cartesian components.
//!
//! Method: \[Gorski2005\]; geometry and conversions by the `cdshealpix` crate.
//!
//! Limits: `nside` a power of two up to [`MAX_NSIDE`].
//!
//! # Example
//! ```
//! use planner::healpix::{Nside, Ordering, unit_vector};
//!
//! let nside = Nside::new(64)?;
//! assert_eq!(nside.pixels(), 49_152);
//! let nested = nside.pixel_at(83.6_f64.to_radians(), 22.0_f64.to_radians());
//! let ring = nside.numbered(Ordering::Ring, nested);
//! assert_eq!(nside.nested(Ordering::Ring, ring), nested);
//! // The centre lies within a pixel's diagonal, some 1.4 deg, of the point.
//! let (longitude_rad, latitude_rad) = nside.center(nested);
//! assert!((latitude_rad.to_degrees() - 22.0).abs() < 1.4);
//! assert!(unit_vector(longitude_rad, latitude_rad)[2] > 0.0);
//! # Ok::<(), planner::healpix::NsideError>(())
//! ```

use cdshealpix::nested::{self, Layer};
use std::f64::consts::PI;
use thiserror::Error;

/// Largest resolution.
pub const MAX_NSIDE: u32 = 2048;

/// A HEALPix resolution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Nside {
    depth: u8,
}

/// Not a resolution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("nside {0}: a power of two from 1 to {MAX_NSIDE} is needed")]
pub struct NsideError(pub u32);

/// In which order pixels are numbered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Ordering {
    /// Along circles of latitude, from the north.
    Ring,
    /// Along the quadtree of each base pixel.
    Nested,
}

impl Ordering {
    /// The FITS keyword's value.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ring => "RING",
            Self::Nested => "NESTED",
        }
    }
}

impl Nside {
    /// The resolution of `nside` pixels along the side of a base pixel.
    ///
    /// # Errors
    /// [`NsideError`] where `nside` is no power of two or exceeds [`MAX_NSIDE`].
    pub fn new(nside: u32) -> Result<Self, NsideError> {
        if nside.is_power_of_two() && nside <= MAX_NSIDE {
            Ok(Self { depth: cdshealpix::depth(nside) })
        } else {
            Err(NsideError(nside))
        }
    }

    /// Pixels along the side of a base pixel.
    #[must_use]
    pub const fn get(self) -> u32 {
        1 << self.depth
    }

    /// Its binary logarithm, the order.
    #[must_use]
    pub const fn depth(self) -> u8 {
        self.depth
    }

    /// Pixels on the sphere.
    #[must_use]
    pub const fn pixels(self) -> u32 {
        12 << (2 * self.depth)
    }

    /// Solid angle of each pixel in steradians.
    #[must_use]
    pub fn pixel_area_sr(self) -> f64 {
        4.0 * PI / f64::from(self.pixels())
    }

    fn layer(self) -> &'static Layer {
        nested::get(self.depth)
    }

    /// The RING number of a NESTED one.
    #[must_use]
    pub fn ring_of_nested(self, pixel: u32) -> u32 {
        number(self.layer().to_ring(u64::from(pixel)))
    }

    /// The NESTED number of a RING one.
    #[must_use]
    pub fn nested_of_ring(self, pixel: u32) -> u32 {
        number(self.layer().from_ring(u64::from(pixel)))
    }

    /// The NESTED number of a pixel numbered in `ordering`.
    #[must_use]
    pub fn nested(self, ordering: Ordering, pixel: u32) -> u32 {
        match ordering {
            Ordering::Ring => self.nested_of_ring(pixel),
            Ordering::Nested => pixel,
        }
    }

    /// The number in `ordering` of a NESTED pixel.
    #[must_use]
    pub fn numbered(self, ordering: Ordering, nested: u32) -> u32 {
        match ordering {
            Ordering::Ring => self.ring_of_nested(nested),
            Ordering::Nested => nested,
        }
    }

    /// A map in NESTED order, a value per pixel, as a map in `ordering`.
    #[must_use]
    pub fn in_order<T: Copy>(self, nested: &[T], ordering: Ordering) -> Vec<T> {
        let values = (0..self.pixels()).map(|pixel| self.nested(ordering, pixel) as usize);
        values.filter_map(|at| nested.get(at).copied()).collect()
    }

    /// The NESTED pixel that holds a longitude and latitude.
    #[must_use]
    pub fn pixel_at(self, longitude_rad: f64, latitude_rad: f64) -> u32 {
        number(self.layer().hash(longitude_rad, latitude_rad))
    }

    /// Longitude and latitude of a NESTED pixel's centre.
    #[must_use]
    pub fn center(self, nested: u32) -> (f64, f64) {
        self.layer().center(u64::from(nested))
    }

    /// Longitudes and latitudes of a NESTED pixel's corners: south, east, north, west.
    #[must_use]
    pub fn corners(self, nested: u32) -> [(f64, f64); 4] {
        self.layer().vertices(u64::from(nested))
    }
}

/// A pixel of at most [`MAX_NSIDE`], which fits.
fn number(hash: u64) -> u32 {
    u32::try_from(hash).unwrap_or(u32::MAX)
}

/// Unit vector of a longitude and latitude.
#[must_use]
pub fn unit_vector(longitude_rad: f64, latitude_rad: f64) -> [f64; 3] {
    let (sin_lon, cos_lon) = longitude_rad.sin_cos();
    let (sin_lat, cos_lat) = latitude_rad.sin_cos();
    [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolutions_are_powers_of_two() {
        for nside in [1, 2, 64, 128, 2048] {
            let it = Nside::new(nside).unwrap();
            assert_eq!((it.get(), it.pixels()), (nside, 12 * nside * nside));
        }
        for nside in [0, 3, 100, 4096, u32::MAX] {
            assert_eq!(Nside::new(nside), Err(NsideError(nside)));
        }
    }

    #[test]
    fn orderings_are_permutations_of_each_other() {
        let nside = Nside::new(8).unwrap();
        let mut seen = vec![false; 768];
        for nested in 0..768 {
            let ring = nside.ring_of_nested(nested);
            assert_eq!(nside.nested_of_ring(ring), nested);
            assert!(!std::mem::replace(&mut seen[ring as usize], true));
        }
        // Ring 0 surrounds the north pole; NESTED pixel 63 is the northern corner of base pixel 0.
        assert_eq!(nside.ring_of_nested(63), 0);
    }

    #[test]
    fn centres_lie_in_their_pixels() {
        let nside = Nside::new(64).unwrap();
        for nested in (0..nside.pixels()).step_by(97) {
            let (lon, lat) = nside.center(nested);
            assert_eq!(nside.pixel_at(lon, lat), nested);
        }
    }
}
