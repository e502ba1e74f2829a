//! Which pixel a place belongs to: HEALPix pixel coordinates, and keys that tell pixels apart.
//!
//! Inside one region of the sky (the equatorial belt, or one quadrant of a polar cap) pixels are the
//! unit squares of two smooth coordinates u and v [Gorski2005, section 4]. With t the longitude in
//! quarter turns and z the cosine of the colatitude,
//!
//! | region | u | v |
//! |---|---|---|
//! | belt, abs(z) <= 2/3 | `N (1/2 + t - 3/4 z)` | `N (1/2 + t + 3/4 z)` |
//! | cap, quadrant q | `(t - q) N sqrt(3 (1 - abs z))` | `(q + 1 - t) N sqrt(3 (1 - abs z))` |
//!
//! A [`Key`] is the region and the two whole parts in one exactly represented number: equal for
//! samples of one pixel and region, and cheap to compare in vector registers.
//!
//! Limits: a place within [`Grid::EDGE`] of a whole u or v gets no key: the flight core decides its
//! pixel, so that no instruction set's rounding does.

use super::lanes::madd;
use crate::healpix::Nside;

/// A resolution as the kernel needs it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    pub(super) nside: Nside,
    n: f64,
}

/// Region and whole parts of u and v; negative where a place lies too near an edge.
pub(super) type Key = f64;

/// 2^16: whole parts stay below it, and 2^32 regions fit an f64.
const SHIFT: f64 = 65_536.0;

impl Grid {
    /// How near to a whole number u or v may come, in pixels. Rounding and interpolation stay an
    /// order of magnitude below.
    pub(super) const EDGE: f64 = 1e-6;

    pub(super) fn new(nside: Nside) -> Self {
        Self { nside, n: f64::from(nside.get()) }
    }

    /// u and v in the belt, a whole number of turns added that keeps both positive.
    #[inline(always)]
    pub(super) fn belt<const FUSED: bool>(&self, z: f64, quarters: f64) -> (f64, f64) {
        let middle = self.n * (4.5 + quarters);
        let tilt = 0.75 * self.n;
        (madd::<FUSED>(-tilt, z, middle), madd::<FUSED>(tilt, z, middle))
    }

    /// u and v in quadrant `quadrant` of a cap.
    #[inline(always)]
    pub(super) fn cap<const FUSED: bool>(
        &self,
        (z, sin_theta): (f64, f64),
        quarters: f64,
        quadrant: f64,
    ) -> (f64, f64) {
        // sqrt(3 (1 - |z|)) without cancellation: sin(theta) sqrt(3 / (1 + |z|)).
        let scale = self.n * sin_theta * (3.0 / (1.0 + z.abs())).sqrt();
        let u = (quarters - quadrant) * scale;
        (u, scale - u)
    }

    /// The key of whole parts in a region.
    #[inline(always)]
    pub(super) fn key<const FUSED: bool>(region: f64, u: f64, v: f64) -> Key {
        madd::<FUSED>(madd::<FUSED>(region, SHIFT, u), SHIFT, v)
    }

    /// Distance in pixels from the middle between whole numbers, the larger of u's and v's.
    #[inline(always)]
    pub(super) fn off_middle((u, v): (f64, f64), (floor_u, floor_v): (f64, f64)) -> f64 {
        let du = (u - floor_u - 0.5).abs();
        let dv = (v - floor_v - 0.5).abs();
        if du > dv { du } else { dv }
    }

    /// The key of a place; negative near an edge.
    #[inline(always)]
    pub(super) fn key_at<const FUSED: bool>(&self, z: f64, sin_theta: f64, quarters: f64) -> Key {
        let quadrant = quarters.floor();
        let quadrant = if quadrant > 3.0 { 3.0 } else { quadrant };
        let (belt_u, belt_v) = self.belt::<FUSED>(z, quarters);
        let (cap_u, cap_v) = self.cap::<FUSED>((z, sin_theta), quarters, quadrant);
        let in_belt = z.abs() <= 2.0 / 3.0;
        let u = if in_belt { belt_u } else { cap_u };
        let v = if in_belt { belt_v } else { cap_v };
        let (floor_u, floor_v) = (u.floor(), v.floor());
        let cap_region = quadrant + if z > 0.0 { 1.0 } else { 5.0 };
        let region = if in_belt { 0.0 } else { cap_region };
        let key = Self::key::<FUSED>(region, floor_u, floor_v);
        if Self::off_middle((u, v), (floor_u, floor_v)) > 0.5 - Self::EDGE { -1.0 } else { key }
    }

    /// A key that stands for a NESTED pixel itself.
    pub(super) fn key_of_nested(nested: u32) -> Key {
        -1.0 - f64::from(nested)
    }

    /// The NESTED pixel of a key, or the one that it stands for.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "keys are whole numbers below 2^36, faces below 12"
    )]
    pub(super) fn nested(&self, key: Key) -> u32 {
        let itself = (-1.0 - key) as u32;
        let bits = key as u64;
        let (region, u, v) =
            ((bits >> 32) as u32, (bits >> 16) as u32 & 0xffff, bits as u32 & 0xffff);
        let depth = u32::from(self.nside.depth());
        let last = self.nside.get() - 1;
        let (face, x, y) = match region {
            0 => {
                let (up, vp) = (u >> depth, v >> depth);
                let face = match up.cmp(&vp) {
                    std::cmp::Ordering::Equal => (up & 3) + 4,
                    std::cmp::Ordering::Less => up & 3,
                    std::cmp::Ordering::Greater => (vp & 3) + 8,
                };
                (face, v & last, last - (u & last))
            }
            1..=4 => (region - 1, last - v.min(last), last - u.min(last)),
            _ => (region + 3, u.min(last), v.min(last)),
        };
        let nested = (face << (2 * depth)) | spread(x) | (spread(y) << 1);
        if key < 0.0 { itself } else { nested }
    }
}

/// The bits of a number below 2^16 at even places.
#[inline(always)]
fn spread(x: u32) -> u32 {
    let x = (x | (x << 8)) & 0x00ff_00ff;
    let x = (x | (x << 4)) & 0x0f0f_0f0f;
    let x = (x | (x << 2)) & 0x3333_3333;
    (x | (x << 1)) & 0x5555_5555
}

#[cfg(test)]
mod tests {
    use super::super::lanes::quarter_turns;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn pixels_are_those_of_cdshealpix(
            z in -1.0..1.0_f64, lon in 0.0..std::f64::consts::TAU, depth in 0_u32..12,
        ) {
            let nside = Nside::new(1 << depth).unwrap();
            let grid = Grid::new(nside);
            let sin_theta = (1.0 - z * z).sqrt();
            let quarters = quarter_turns::<false>(lon.cos(), lon.sin());
            let key = grid.key_at::<false>(z, sin_theta, quarters);
            if key >= 0.0 {
                prop_assert_eq!(grid.nested(key), nside.pixel_at(lon, z.asin()));
            }
        }
    }

    #[test]
    fn every_pixel_has_a_key() {
        let nside = Nside::new(16).unwrap();
        let grid = Grid::new(nside);
        for pixel in 0..nside.pixels() {
            let (lon, lat) = nside.center(pixel);
            // Off the centre, which lies on edges between quadrants for some pixels.
            let (lon, lat) = (lon + 1e-3, lat + 2e-4);
            let quarters = quarter_turns::<false>(lon.cos(), lon.sin());
            let key = grid.key_at::<false>(lat.sin(), lat.cos(), quarters);
            assert!(key >= 0.0);
            assert_eq!(grid.nested(key), pixel);
        }
    }
}
