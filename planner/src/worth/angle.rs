//! The ranges of an angle, in which passes count as seen at the same one.

use std::f64::consts::{PI, TAU};

/// Ranges of an angle.
const BINS: u32 = 16;

/// The range of an angle, of 16 from -180 deg on.
pub(crate) fn angle_bin(angle_rad: f64) -> u32 {
    let turn = (angle_rad + PI).rem_euclid(TAU) / TAU;
    (0..BINS).rfind(|&bin| f64::from(bin) <= turn * f64::from(BINS)).unwrap_or(0)
}
