//! A HEALPix pixel's true boundary, and how far from it a direction surely is.
//!
//! A pixel is the square `column <= x < column + 1`, `row <= y < row + 1` of its base pixel, x towards
//! the north-east and y towards the north-west, both from 0 to N = nside.
//!
//! Method: [Gorski2005, section 5]. With s the longitude from the base pixel's middle in quarter turns,
//! z the sine of latitude (in a polar base pixel towards its pole) and `k = N sqrt(3 (1 - z))`:
//!
//! | base pixel | where | x | y |
//! |---|---|---|---|
//! | equatorial | | N (1/2 + 3z/4 + s) | N (1/2 + 3z/4 - s) |
//! | polar | z <= 2/3 | N (3z/4 + s) | N (3z/4 - s) |
//! | polar | z > 2/3 | N - k (1/2 - s) | N - k (1/2 + s) |
//!
//! A southern base pixel is the northern one mirrored, with (x, y) replaced by (N - y, N - x).
//!
//! **Distance.** The gradients on the sphere are at most `N sqrt(0.75^2 + 0.855^2) = 1.14 N` where
//! |z| <= 2/3, and in the cap `N sqrt(1.2248^2 (1/2 + |s|)^2 + 0.855^2)`: 1.50 N inside the base
//! pixel, 2.60 N for |s| <= 3/2, where s is held, less where |s| stays small within reach. So the
//! smallest excess over the four sides, over that rate, is a distance within which no edge lies.
//! Longitude wraps: seen from the other way round, s is held at the opposite end, and the nearer of
//! both ways counts. Where the formulas do not reach, differences of latitude and the planes of the
//! base pixel's meridians bound the distance.
//!
//! A galactic pixel turns every direction into its frame first.
//!
//! Limits: rounding, some 1e-15 rad times N; `tests` hold membership against `cdshealpix` and the
//! distance against points of the boundary.

use crate::healpix::{Nside, unit_vector};
use crate::survey::{Galactic, MapFrame};
use onboard_core::direction::Direction;
use onboard_core::frame::Ecliptic;
use onboard_core::rotation::Rotation;
use std::f64::consts::FRAC_PI_2;

/// Sine of the latitude at which the polar caps begin.
const CAP: f64 = 2.0 / 3.0;
/// Rate of pixel coordinates per radian over N: inside a polar base pixel, outside it, and in the belt.
const POLAR_INSIDE_RATE: f64 = 1.50;
const POLAR_RATE: f64 = 2.60;
const BELT_RATE: f64 = 1.14;
/// The belt's rate on shortest paths of at most [`BELT_REACH_RAD`], which may bulge out of it.
const BELT_RATE_BEYOND: f64 = 1.21;
const BELT_REACH_RAD: f64 = 0.2;
/// Distance within which a polar base pixel's formulas hold.
const POLAR_REACH_RAD: f64 = 0.7;
/// How far in quarter turns longitude is followed from the middle.
const FOLLOWED: f64 = 1.5;
/// Points per edge from which the enclosing circle is taken.
const EDGE_POINTS: u32 = 32;
/// Largest length on the sphere, over 1/N, of a unit of one pixel coordinate.
const LONGEST_UNIT: f64 = 1.6;

/// Where a base pixel lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Base {
    Belt,
    North,
    South,
}

/// One pixel with its edges.
#[derive(Debug, Clone, Copy)]
pub struct Boundary {
    base: Base,
    /// N.
    side: f64,
    /// Lower edges in x and y, of the mirrored pixel in the south.
    column: f64,
    row: f64,
    /// Cosine and sine of the base pixel's middle longitude.
    middle: (f64, f64),
    /// Into the pixel's frame; none where that is the ecliptic.
    turn: Option<Rotation<Ecliptic, Galactic>>,
}

impl Boundary {
    /// The boundary of a NESTED pixel of `nside`; numbers beyond the last wrap round.
    #[must_use]
    pub fn new(nside: Nside, nested: u32) -> Self {
        let depth = u32::from(nside.depth());
        let face = (nested >> (2 * depth)) % 12;
        let (mut column, mut row) = (0, 0);
        for bit in 0..depth {
            column |= (nested >> (2 * bit) & 1) << bit;
            row |= (nested >> (2 * bit + 1) & 1) << bit;
        }
        let last = nside.get() - 1;
        let base = match face {
            0..4 => Base::North,
            4..8 => Base::Belt,
            _ => Base::South,
        };
        if base == Base::South {
            (column, row) = (last - row, last - column);
        }
        // Quarter turns to the middle: 0, 1, 2, 3 in the belt, half a quarter more in the caps.
        let quarters = f64::from(face % 4) + if base == Base::Belt { 0.0 } else { 0.5 };
        let (sin, cos) = (quarters * FRAC_PI_2).sin_cos();
        Self {
            base,
            side: f64::from(nside.get()),
            column: f64::from(column),
            row: f64::from(row),
            middle: (cos, sin),
            turn: None,
        }
    }

    /// The same pixel of a map in this frame.
    #[must_use]
    pub fn in_frame(self, frame: MapFrame) -> Self {
        Self { turn: (frame != MapFrame::Ecliptic).then(|| frame.from_ecliptic()), ..self }
    }

    /// Whether the pixel, its lower edges included, holds the direction.
    #[must_use]
    pub fn contains(&self, direction: Direction<Ecliptic>) -> bool {
        self.clearance_rad(direction) >= 0.0
    }

    /// Positive inside, negative outside; no edge lies nearer than its magnitude in radians.
    #[must_use]
    pub fn clearance_rad(&self, direction: Direction<Ecliptic>) -> f64 {
        let [x, y, z] = match self.turn {
            None => direction.xyz(),
            Some(turn) => turn.apply(direction).xyz(),
        };
        let (cos, sin) = self.middle;
        // Along the middle's meridian and to the east of it.
        let (ahead, east) = (x * cos + y * sin, y * cos - x * sin);
        let z = if self.base == Base::South { -z } else { z };
        match self.base {
            Base::Belt => self.belt(ahead, east, z),
            Base::North | Base::South => self.polar(ahead, east, z),
        }
    }

    fn belt(&self, ahead: f64, east: f64, z: f64) -> f64 {
        if z.abs() > CAP {
            // The pixel lies between the parallels of +-2/3, and 45 deg to either side of the middle.
            let below = z.abs().min(1.0).asin() - CAP.asin();
            let aside = (east.abs() - ahead) * std::f64::consts::FRAC_1_SQRT_2;
            return -below.max(aside).max(f64::MIN_POSITIVE);
        }
        let excess = |s: f64| {
            let rise = 0.5 + 0.75 * z;
            self.excess(self.side * (rise + s), self.side * (rise - s))
        };
        let s = east.atan2(ahead) / FRAC_PI_2;
        let (near, far) = both_ways(s);
        let inside = excess(near);
        if inside >= 0.0 {
            return inside / (BELT_RATE * self.side);
        }
        let outside = inside.max(excess(far)).min(0.0);
        (outside / (BELT_RATE_BEYOND * self.side)).max(-BELT_REACH_RAD)
    }

    fn polar(&self, ahead: f64, east: f64, z: f64) -> f64 {
        if z < -CAP {
            return -POLAR_REACH_RAD;
        }
        // k = N sqrt(3 (1 - z)), from the distance to the axis, which keeps its digits at the pole.
        let k = self.side * (3.0 * (ahead * ahead + east * east) / (1.0 + z)).sqrt();
        let excess = |s: f64| {
            if z > CAP {
                self.excess(self.side - k * (0.5 - s), self.side - k * (0.5 + s))
            } else {
                self.excess(self.side * (0.75 * z + s), self.side * (0.75 * z - s))
            }
        };
        let s = east.atan2(ahead) / FRAC_PI_2;
        let (near, far) = both_ways(s);
        let inside = excess(near);
        if inside >= 0.0 {
            return inside / (POLAR_INSIDE_RATE * self.side);
        }
        let outside = inside.max(excess(far)).min(0.0);
        let sure = (outside / (POLAR_RATE * self.side)).max(-POLAR_REACH_RAD);
        // Within `reach` s changes by at most reach over the distance from the axis.
        let reach = (2.0 * -sure).min(POLAR_REACH_RAD);
        let widest = s.abs() + reach / (ahead * ahead + east * east).sqrt();
        if widest > FOLLOWED {
            return sure;
        }
        (inside / (polar_rate(widest) * self.side)).max(-reach)
    }

    /// Smallest distance from the four sides in pixel coordinates, negative outside.
    fn excess(&self, x: f64, y: f64) -> f64 {
        let (x, y) = (x - self.column, y - self.row);
        x.min(1.0 - x).min(y.min(1.0 - y))
    }

    /// The direction at fractions of the pixel's columns and rows, both from 0 to 1.
    #[must_use]
    pub fn at(&self, (across, along): (f64, f64)) -> Direction<Ecliptic> {
        let (x, y) = (self.column + across, self.row + along);
        let side = self.side;
        // In the cap x + y = 2 N - k.
        let k = 2.0 * side - x - y;
        let (quarters, height, axis) = if self.base != Base::Belt && k < side {
            let height = 1.0 - k * k / (3.0 * side * side);
            let quarters = if k > 0.0 { (x - y) / (2.0 * k) } else { 0.0 };
            (quarters, height, k / side * ((1.0 + height) / 3.0).sqrt())
        } else {
            let middle = if self.base == Base::Belt { 1.0 } else { 0.0 };
            let height = ((x + y) / side - middle) / 1.5;
            ((x - y) / (2.0 * side), height, (1.0 - height * height).sqrt())
        };
        let (sin, cos) = (quarters * FRAC_PI_2).sin_cos();
        let (ahead, east) = (axis * cos, axis * sin);
        let height = if self.base == Base::South { -height } else { height };
        let (mid_cos, mid_sin) = self.middle;
        let (x, y) = (ahead * mid_cos - east * mid_sin, ahead * mid_sin + east * mid_cos);
        match self.turn {
            None => Direction::new(x, y, height).unwrap_or(Direction::Z),
            Some(turn) => {
                turn.inverse().apply(Direction::new(x, y, height).unwrap_or(Direction::Z))
            }
        }
    }

    /// Centre and radius in radians of a circle that holds the pixel.
    ///
    /// The farthest of points along the edges, and half a step between them, whose length on the
    /// sphere is bounded.
    #[must_use]
    pub fn enclosing_circle(&self) -> (Direction<Ecliptic>, f64) {
        let centre = self.at((0.5, 0.5));
        let mut farthest = 0.0_f64;
        for point in 0..=EDGE_POINTS {
            let share = f64::from(point) / f64::from(EDGE_POINTS);
            for corner in [(share, 0.0), (share, 1.0), (0.0, share), (1.0, share)] {
                farthest = farthest.max(centre.separation_rad(self.at(corner)));
            }
        }
        let half_step = 0.5 * LONGEST_UNIT / (self.side * f64::from(EDGE_POINTS));
        (centre, farthest + half_step)
    }
}

/// Rate of a polar base pixel's coordinates per radian over N, for |s| up to `widest`.
fn polar_rate(widest: f64) -> f64 {
    (1.225 * (0.5 + widest)).hypot(0.855).max(BELT_RATE)
}

/// Quarter turns from the middle the short way, and the long way round, both held to what is followed.
fn both_ways(s: f64) -> (f64, f64) {
    (s.clamp(-FOLLOWED, FOLLOWED), if s > 0.0 { -FOLLOWED } else { FOLLOWED })
}

/// The NESTED pixel that holds a colatitude and longitude in radians; on an edge the pixel that
/// \[Gorski2005\]'s integer parts name.
#[must_use]
pub fn pixel_at(nside: Nside, theta_rad: f64, phi_rad: f64) -> u32 {
    let [x, y, z] = unit_vector(phi_rad, FRAC_PI_2 - theta_rad);
    let side = f64::from(nside.get());
    let quarters = (phi_rad / FRAC_PI_2).rem_euclid(4.0);
    // A tiny negative longitude rounds up to a whole turn.
    let quarters = if quarters >= 4.0 { 0.0 } else { quarters };
    let (face, column, row) = if z.abs() <= CAP {
        // Numbers of the lines that rise and fall eastwards, and of the base pixels between them.
        let rising = side * (0.5 + quarters - 0.75 * z);
        let falling = side * (0.5 + quarters + 0.75 * z);
        let (above, below) = ((rising / side).floor(), (falling / side).floor());
        let face = if (above - below).abs() < 0.5 {
            4.0 + above.rem_euclid(4.0)
        } else if above < below {
            above
        } else {
            below + 8.0
        };
        (face, (falling - below * side).floor(), side - 1.0 - (rising - above * side).floor())
    } else {
        let quarter = quarters.floor();
        let share = quarters - quarter;
        let k = side * (3.0 * (x * x + y * y) / (1.0 + z.abs())).sqrt();
        let line = |share: f64| (share * k).floor().min(side - 1.0);
        let (west, east) = (line(share), line(1.0 - share));
        if z > 0.0 {
            (quarter, side - 1.0 - east, side - 1.0 - west)
        } else {
            (quarter + 8.0, west, east)
        }
    };
    let mut nested = whole(face) << (2 * u32::from(nside.depth()));
    for bit in 0..u32::from(nside.depth()) {
        nested |= (whole(column) >> bit & 1) << (2 * bit);
        nested |= (whole(row) >> bit & 1) << (2 * bit + 1);
    }
    nested
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole numbers from 0 to 2047"
)]
fn whole(value: f64) -> u32 {
    value as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn direction(lon: f64, z: f64) -> Direction<Ecliptic> {
        let axis = (1.0 - z * z).sqrt();
        Direction::new(axis * lon.cos(), axis * lon.sin(), z).unwrap()
    }

    fn of(nside: u32, pixel: u32) -> Boundary {
        Boundary::new(Nside::new(nside).unwrap(), pixel)
    }

    #[test]
    fn points_of_a_pixel_are_in_it() {
        for depth in [0, 1, 3, 6, 11] {
            let nside = Nside::new(1 << depth).unwrap();
            for pixel in (0..nside.pixels()).step_by(1 + nside.pixels() as usize / 900) {
                let boundary = Boundary::new(nside, pixel);
                for point in
                    [(0.5, 0.5), (1e-3, 1e-3), (1e-3, 0.999), (0.999, 1e-3), (0.999, 0.999)]
                {
                    let there = boundary.at(point);
                    assert!(boundary.contains(there), "{depth} {pixel} {point:?}");
                    let held = nside.pixel_at(there.longitude_rad(), there.latitude_rad());
                    assert_eq!(held, pixel, "{depth} {point:?}");
                }
                let (lon, lat) = nside.center(pixel);
                let centre = Direction::from_longitude_latitude(lon, lat);
                assert!(boundary.at((0.5, 0.5)).separation_rad(centre) < 1e-14);
            }
        }
    }

    #[test]
    fn a_galactic_pixel_is_the_ecliptic_one_turned() {
        let nside = Nside::new(64).unwrap();
        let turn = MapFrame::Galactic.from_ecliptic();
        for pixel in [0, 4095, 20_000, 40_000] {
            let (plain, galactic) = (
                Boundary::new(nside, pixel),
                Boundary::new(nside, pixel).in_frame(MapFrame::Galactic),
            );
            for point in [(0.5, 0.5), (0.01, 0.9), (-0.3, 1.2)] {
                let there = galactic.at(point);
                let held = turn.apply(there);
                let (lon, lat) = (held.longitude_rad(), held.latitude_rad());
                assert_eq!(nside.pixel_at(lon, lat) == pixel, galactic.contains(there));
                let off = galactic.clearance_rad(there) - plain.clearance_rad(plain.at(point));
                assert!(off.abs() < 1e-13, "{off:e}");
            }
            assert!((galactic.enclosing_circle().1 - plain.enclosing_circle().1).abs() < 1e-12);
        }
    }

    #[test]
    fn the_papers_directions_fall_where_healpy_puts_them() {
        // healpy.ang2pix(64, theta, phi): at a pole, on a base pixel's meridian, on a corner.
        let nside = Nside::new(64).unwrap();
        let ring = |theta: f64, phi: f64| {
            nside.ring_of_nested(pixel_at(nside, theta.to_radians(), phi.to_radians()))
        };
        assert_eq!(ring(0.0, 0.0), 0);
        // z = 0.7071: k = 59.99, ring 60 of the cap, first pixel of the third quadrant.
        assert_eq!(ring(45.0, 180.0), 2 * 59 * 60 + 2 * 60);
        // z = 0: ring 128 of 4 N pixels, the one that begins at longitude 180 deg.
        assert_eq!(ring(90.0, 180.0), 2 * 64 * 63 + (128 - 64) * 256 + 128);
    }

    proptest! {
        #[test]
        fn membership_is_cdshealpix_membership(
            depth in 0_u8..12, lon in 0.0..TAU, z in -1.0..1.0_f64,
        ) {
            let nside = Nside::new(1 << depth).unwrap();
            let there = direction(lon, z);
            let pixel = nside.pixel_at(lon, there.latitude_rad());
            let clearance = Boundary::new(nside, pixel).clearance_rad(there);
            prop_assert!(clearance > -1e-14, "{clearance:e}");
            if clearance > 1e-13 {
                prop_assert_eq!(pixel_at(nside, FRAC_PI_2 - there.latitude_rad(), lon), pixel);
                let other = (pixel + 1) % nside.pixels();
                prop_assert!(!Boundary::new(nside, other).contains(there));
            }
        }

        #[test]
        fn no_edge_is_nearer_than_the_clearance(
            depth in 0_u8..8, number: u32, lon in 0.0..TAU, z in -1.0..1.0_f64,
            near: bool, share in 0.0..1.0_f64, side in 0..4,
        ) {
            let nside = Nside::new(1 << depth).unwrap();
            let boundary = Boundary::new(nside, number % nside.pixels());
            let (centre, radius) = boundary.enclosing_circle();
            let mut there = direction(lon, z);
            if near {
                // Within some pixels of the centre.
                let ([a, b, c], [x, y, w]) = (centre.xyz(), there.xyz());
                let mixed = |u: f64, v: f64| u + 2.0 * radius * v;
                if let Some(moved) = Direction::new(mixed(a, x), mixed(b, y), mixed(c, w)) {
                    there = moved;
                }
            }
            let point = match side {
                0 => (share, 0.0),
                1 => (share, 1.0),
                2 => (0.0, share),
                _ => (1.0, share),
            };
            let edge = boundary.at(point);
            let apart = there.separation_rad(edge);
            prop_assert!(boundary.clearance_rad(there).abs() <= apart + 1e-13);
            prop_assert!(centre.separation_rad(edge) <= radius);
        }
    }

    #[test]
    fn clearance_is_no_less_than_a_fifth_of_the_distance_nearby() {
        // Steps stay long: along the diagonal through a pixel, the bound is not far from the truth.
        for (nside, pixel) in
            [(1, 0), (1, 5), (1, 11), (64, 0), (64, 4095), (64, 20_000), (64, 40_000)]
        {
            let boundary = of(nside, pixel);
            for outside in [0.05, 0.1, 0.3] {
                let there = boundary.at((-outside, 0.5));
                let nearest = (0..=1000)
                    .map(|i| there.separation_rad(boundary.at((0.0, f64::from(i) / 1000.0))))
                    .fold(f64::INFINITY, f64::min);
                let clearance = boundary.clearance_rad(there);
                if clearance < 0.0 {
                    assert!(-clearance > 0.2 * nearest, "{nside} {pixel} {clearance} {nearest}");
                }
            }
        }
    }
}
