//! Where are HEALPix's rings, and which pixels lie on them.
//!
//! RING order: from the north, along each ring eastwards from the first pixel, which is at longitude 0
//! or half a pixel further.
//!
//! Method: \[Gorski2005, eqs. 2 to 9\], with `1 - z` of a ring and of its mirror image exact, so that
//! `sin theta` keeps its digits next to the poles.

use super::circle::Circle;
use super::fourier::Fourier;
use crate::healpix::Nside;

/// The rings of a resolution, ready for transforms.
#[derive(Debug)]
pub struct Rings {
    nside: Nside,
    /// From the north to the equator, that included.
    pub(super) circles: Vec<Circle>,
    pub(super) fourier: Fourier,
}

impl Rings {
    /// The rings of a resolution.
    #[must_use]
    pub fn new(nside: Nside) -> Self {
        let side = nside.get();
        let n = f64::from(side);
        let pixels = nside.pixels() as usize;
        let circle = |i: u32| {
            let at = f64::from(i);
            let cap = i < side;
            let sagitta = if cap { at * at / (3.0 * n * n) } else { (2.0 * at - n) / (3.0 * n) };
            let count = 4 * i.min(side) as usize;
            let first =
                if cap { 2 * i * (i - 1) } else { 2 * side * (side - 1) + (i - side) * 4 * side };
            let first = first as usize;
            Circle {
                sagitta,
                count,
                shifted: cap || (i - side).is_multiple_of(2),
                first,
                mirrored: (i < 2 * side).then(|| pixels - first - count),
            }
        };
        let circles: Vec<Circle> = (1..=2 * side).map(circle).collect();
        let fourier = Fourier::new(circles.iter().map(|circle| circle.count));
        Self { nside, circles, fourier }
    }

    /// The resolution.
    #[must_use]
    pub const fn nside(&self) -> Nside {
        self.nside
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn pixels_lie_where_the_healpix_crate_has_them() {
        for side in [1, 2, 8] {
            let nside = Nside::new(side).unwrap();
            let mut seen = 0;
            for circle in &Rings::new(nside).circles {
                for (first, sign) in [(Some(circle.first), 1.0), (circle.mirrored, -1.0)] {
                    let Some(first) = first else { continue };
                    for k in 0..circle.count {
                        seen += 1;
                        let pixel = u32::try_from(first + k).unwrap();
                        let (lon, lat) = nside.center(nside.nested_of_ring(pixel));
                        let half = if circle.shifted { 0.5 } else { 0.0 };
                        let (k, count) = (f64::from(u32::try_from(k).unwrap()), circle.count);
                        let count = f64::from(u32::try_from(count).unwrap());
                        let off = (lon - TAU * (k + half) / count).rem_euclid(TAU);
                        assert!(off.min(TAU - off) < 1e-14, "{side} {pixel} {lon}");
                        assert!((lat.sin() - sign * circle.cos()).abs() < 1e-15);
                        assert!((lat.cos() - circle.sin()).abs() < 1e-15);
                    }
                }
            }
            assert_eq!(seen, nside.pixels());
        }
    }
}
