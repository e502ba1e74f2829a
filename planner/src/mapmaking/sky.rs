//! The sky that is observed: I, Q and U per pixel of a map with its own resolution and frame.
//!
//! Q and U are kept in the COSMO sense; a map in the IAU's has its U negated on the way in.
//!
//! Limits: a pixel in which any of the three is missing (HEALPix's UNSEEN, or not finite) has no
//! value.

use crate::healpix::{Nside, Ordering};
use crate::survey::MapFrame;
use thiserror::Error;

/// HEALPix's mark of a pixel without a value.
const UNSEEN: f64 = -1.637_5e30;

/// In which sense U grows: the FITS keyword POLCCONV.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PolarisationConvention {
    /// From south to east, as HEALPix has it.
    Cosmo,
    /// From north to east.
    Iau,
}

/// A sky map as it comes from a file.
#[derive(Debug, Clone, Copy)]
pub struct SkyMap<'a> {
    /// Resolution.
    pub nside: Nside,
    /// Order of the pixels.
    pub ordering: Ordering,
    /// Frame of the pixels, and of Q and U.
    pub frame: MapFrame,
    /// Sense of U.
    pub convention: PolarisationConvention,
    /// I, Q and U, a value per pixel.
    pub stokes: [&'a [f64]; 3],
}

/// A map with too few or too many values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("{name} has {found} values: nside {nside} needs {needed}")]
pub struct SkyError {
    /// Which of I, Q, U.
    pub name: char,
    /// Its values.
    pub found: usize,
    /// Pixels of the resolution.
    pub needed: usize,
    /// The resolution.
    pub nside: u32,
}

/// A sky to observe.
#[derive(Debug, Clone)]
pub struct Sky {
    nside: Nside,
    frame: MapFrame,
    /// By NESTED pixel; NaN where there is no value.
    stokes: Vec<[f64; 3]>,
}

impl Sky {
    /// The sky of a map.
    ///
    /// # Errors
    /// [`SkyError`] where I, Q or U has not one value per pixel.
    pub fn new(map: &SkyMap<'_>) -> Result<Self, SkyError> {
        let needed = map.nside.pixels() as usize;
        for (name, values) in ['I', 'Q', 'U'].into_iter().zip(map.stokes) {
            if values.len() != needed {
                let found = values.len();
                return Err(SkyError { name, found, needed, nside: map.nside.get() });
            }
        }
        let [i, q, u] = map.stokes;
        let sign = match map.convention {
            PolarisationConvention::Cosmo => 1.0,
            PolarisationConvention::Iau => -1.0,
        };
        let stokes = (0..map.nside.pixels())
            .map(|nested| {
                let at = map.nside.numbered(map.ordering, nested) as usize;
                let values = [i[at], q[at], u[at]];
                if values.into_iter().all(is_value) {
                    [values[0], values[1], sign * values[2]]
                } else {
                    [f64::NAN; 3]
                }
            })
            .collect();
        Ok(Self { nside: map.nside, frame: map.frame, stokes })
    }

    /// Resolution.
    #[must_use]
    pub const fn nside(&self) -> Nside {
        self.nside
    }

    /// Frame.
    #[must_use]
    pub const fn frame(&self) -> MapFrame {
        self.frame
    }

    /// I, Q, U (COSMO) of a NESTED pixel, if it has values.
    #[must_use]
    pub fn at(&self, nested: u32) -> Option<[f64; 3]> {
        self.stokes.get(nested as usize).copied().filter(|it| !it[0].is_nan())
    }
}

/// UNSEEN may have gone through f32.
fn is_value(x: f64) -> bool {
    x.is_finite() && (x / UNSEEN - 1.0).abs() > 1e-5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_found_by_nested_pixel_in_the_cosmo_sense() {
        let nside = Nside::new(2).unwrap();
        let numbers: Vec<f64> = (0..48).map(f64::from).collect();
        let map = SkyMap {
            nside,
            ordering: Ordering::Ring,
            frame: MapFrame::Galactic,
            convention: PolarisationConvention::Iau,
            stokes: [&numbers; 3],
        };
        let sky = Sky::new(&map).unwrap();
        for ring in 0..48 {
            let x = f64::from(ring);
            assert_eq!(sky.at(nside.nested_of_ring(ring)), Some([x, x, -x]));
        }
        assert_eq!(sky.at(48), None);
    }

    #[test]
    fn missing_values_are_none() {
        let numbers = [1.0; 12];
        for missing in [UNSEEN, f64::from(-1.6375e30_f32), f64::NAN, f64::INFINITY] {
            let mut q = numbers;
            q[5] = missing;
            let map = SkyMap {
                nside: Nside::new(1).unwrap(),
                ordering: Ordering::Nested,
                frame: MapFrame::Ecliptic,
                convention: PolarisationConvention::Cosmo,
                stokes: [&numbers, &q, &numbers],
            };
            let sky = Sky::new(&map).unwrap();
            assert_eq!((sky.at(5), sky.at(4)), (None, Some([1.0; 3])));
        }
    }

    #[test]
    fn a_map_of_another_length_is_refused() {
        let numbers = [1.0; 12];
        let map = SkyMap {
            nside: Nside::new(1).unwrap(),
            ordering: Ordering::Nested,
            frame: MapFrame::Ecliptic,
            convention: PolarisationConvention::Cosmo,
            stokes: [&numbers, &numbers, &numbers[..11]],
        };
        let refused = Sky::new(&map).unwrap_err();
        assert_eq!(refused.to_string(), "U has 11 values: nside 1 needs 12");
    }
}
