//! What a survey finds: per pixel its hits, and the mean phasor of each moment.
//!
//! Pixels stand in NESTED order, in which neighbours on the sky are neighbours in memory; RING order
//! is had on request ([`SurveyMaps::hits_in`], [`Nside::in_order`]).
//!
//! Each quantity is one contiguous array over the pixels: hits, then for each moment the real parts
//! and the imaginary parts of h, NaN where a pixel has no samples.

use super::frame::MapFrame;
use super::moment::Moment;
use super::sampled::Pixels;
use crate::healpix::{Nside, Ordering};

/// Hits and moments of all pixels.
#[derive(Debug, Clone)]
pub struct SurveyMaps {
    pixels: Pixels,
    moments: Vec<Moment>,
    hits: Vec<u64>,
    /// Per moment: real parts of all pixels, imaginary parts of all pixels.
    parts: Vec<f64>,
}

/// Bytes that the maps of one thread take.
#[must_use]
pub fn map_bytes(nside: Nside, moments: usize) -> u64 {
    let row = 8 * (1 + 2 * u64::try_from(moments).unwrap_or(u64::MAX / 64));
    u64::from(nside.pixels()) * row
}

impl SurveyMaps {
    /// Maps to be set pixel by pixel.
    pub(super) fn blank(pixels: Pixels, moments: &[Moment]) -> Self {
        let count = pixels.nside.pixels() as usize;
        Self {
            pixels,
            moments: moments.to_vec(),
            hits: vec![0; count],
            parts: vec![0.0; 2 * count * moments.len()],
        }
    }

    /// Sets hits and h of each moment of a pixel.
    pub(super) fn set(&mut self, nested: usize, hits: u64, h: impl Iterator<Item = (f64, f64)>) {
        self.hits[nested] = hits;
        let count = self.hits.len();
        let mut at = nested;
        for (re, im) in h {
            self.parts[at] = re;
            self.parts[at + count] = im;
            at += 2 * count;
        }
    }

    /// Resolution.
    #[must_use]
    pub const fn nside(&self) -> Nside {
        self.pixels.nside
    }

    /// Frame of the pixels and of the crossing angle.
    #[must_use]
    pub const fn frame(&self) -> MapFrame {
        self.pixels.frame
    }

    /// The moments, in the order asked for.
    #[must_use]
    pub fn moments(&self) -> &[Moment] {
        &self.moments
    }

    /// Samples in a NESTED pixel.
    #[must_use]
    pub fn hits(&self, nested: u32) -> u64 {
        self.hits.get(nested as usize).copied().unwrap_or(0)
    }

    /// Real and imaginary part of the moment of index `moment` in a NESTED pixel; `None` where it has
    /// no samples.
    #[must_use]
    pub fn h(&self, nested: u32, moment: usize) -> Option<(f64, f64)> {
        let at = |part: &[f64]| part.get(nested as usize).copied();
        let (re, im) = (at(self.real_map(moment))?, at(self.imaginary_map(moment))?);
        (self.hits(nested) > 0).then_some((re, im))
    }

    /// Hits of all pixels in an order.
    pub fn hits_in(&self, ordering: Ordering) -> impl Iterator<Item = u64> + '_ {
        let nside = self.nside();
        (0..nside.pixels()).map(move |pixel| self.hits(nside.nested(ordering, pixel)))
    }

    /// Hits by NESTED pixel.
    #[must_use]
    pub fn hits_map(&self) -> &[u64] {
        &self.hits
    }

    /// Real parts of the moment of index `moment` by NESTED pixel, NaN without samples; empty where
    /// there is no such moment.
    #[must_use]
    pub fn real_map(&self, moment: usize) -> &[f64] {
        self.part(2 * moment)
    }

    /// Imaginary parts, as [`SurveyMaps::real_map`].
    #[must_use]
    pub fn imaginary_map(&self, moment: usize) -> &[f64] {
        self.part(2 * moment + 1)
    }

    /// All parts of all moments in one array of shape (moments, 2, pixels).
    #[must_use]
    pub fn moment_maps(&self) -> &[f64] {
        &self.parts
    }

    fn part(&self, index: usize) -> &[f64] {
        let count = self.hits.len();
        let from = index.saturating_mul(count);
        self.parts.get(from..from.saturating_add(count)).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_those_of_the_pixels() {
        let moments = [(1.0, 0.0), (2.0, 4.0)].map(|(n, m)| Moment::new(n, m).unwrap());
        let pixels = Pixels { nside: Nside::new(2).unwrap(), frame: MapFrame::Galactic };
        let mut maps = SurveyMaps::blank(pixels, &moments);
        for pixel in 0..48 {
            maps.set(pixel, 0, [(f64::NAN, f64::NAN); 2].into_iter());
        }
        maps.set(3, 7, [(0.1, 0.2), (0.3, 0.4)].into_iter());
        maps.set(47, 1, [(1.0, 0.0), (0.0, -1.0)].into_iter());
        assert_eq!((maps.hits_map().len(), maps.moment_maps().len()), (48, 4 * 48));
        assert_eq!((maps.hits(3), maps.hits_map()[47], maps.hits(48)), (7, 1, 0));
        assert_eq!((maps.h(3, 0), maps.h(3, 1)), (Some((0.1, 0.2)), Some((0.3, 0.4))));
        assert_eq!((maps.h(4, 0), maps.h(3, 2), maps.h(48, 0)), (None, None, None));
        assert_eq!(maps.real_map(1)[3].to_bits(), 0.3_f64.to_bits());
        assert_eq!(maps.imaginary_map(1)[47].to_bits(), (-1.0_f64).to_bits());
        assert!(maps.real_map(0)[0].is_nan() && maps.imaginary_map(2).is_empty());
        let bits = |part: &[f64]| part.iter().map(|it| it.to_bits()).collect::<Vec<u64>>();
        assert_eq!(bits(&maps.moment_maps()[3 * 48..]), bits(maps.imaginary_map(1)));
        let ring = maps.nside().in_order(maps.hits_map(), Ordering::Ring);
        assert_eq!(ring, maps.hits_in(Ordering::Ring).collect::<Vec<u64>>());
        assert_eq!(ring[maps.nside().ring_of_nested(3) as usize], 7);
    }
}
