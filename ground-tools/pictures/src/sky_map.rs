//! A map of the sky by its HEALPix pixels.

use formats::fits::MapFrame;
use planner::healpix::{Nside, Ordering};

/// A map by its pixels.
#[derive(Clone, Copy)]
pub struct SkyMap<'a> {
    /// Resolution.
    pub nside: Nside,
    /// How pixels are numbered.
    pub ordering: Ordering,
    /// The frame of longitudes and latitudes.
    pub frame: MapFrame,
    /// The value of a pixel; NaN where unobserved.
    pub values: &'a (dyn Fn(u32) -> f64 + Sync),
}
