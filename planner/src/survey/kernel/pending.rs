//! Crossings on their way to the map.
//!
//! A row of a large map is seldom in the processor's nearest memory. Crossings are therefore noted
//! side by side and added together: their rows are fetched at the same time, not one after the
//! other, and the arithmetic of their pixels is done in vector registers.

use super::level::{COARSE, Phasors};
use super::pixel::{Grid, Key};
use crate::survey::sums::{Sums, steps};
use std::ops::Range;

/// Crossings that are worth adding together.
pub(super) const BATCH: usize = 64;
/// Most crossings noted: one less than a batch, then those of a block.
const MOST: usize = BATCH + COARSE;

/// Crossings not yet in the map.
#[derive(Debug)]
pub(super) struct Pending<const LANES: usize> {
    count: usize,
    keys: [Key; MOST],
    /// Rows to add: hits, then real and imaginary parts as the map's rows have them.
    rows: [Row<LANES>; MOST],
}

/// Hits, real and imaginary parts.
#[derive(Debug, Clone, Copy)]
struct Row<const LANES: usize> {
    hits: i64,
    parts: [[i64; LANES]; 2],
}

impl<const LANES: usize> Pending<LANES> {
    pub(super) const fn new() -> Self {
        Self { count: 0, keys: [0.0; MOST], rows: [Row { hits: 0, parts: [[0; LANES]; 2] }; MOST] }
    }

    /// Notes the samples of a range within a block, all of one pixel.
    #[inline(always)]
    #[expect(clippy::cast_possible_wrap, reason = "a block is short")]
    #[expect(clippy::needless_range_loop, reason = "lanes of two arrays side by side")]
    pub(super) fn note(&mut self, key: Key, samples: Range<usize>, sums: &Phasors<LANES>) {
        let at = self.count;
        self.keys[at] = key;
        let row = &mut self.rows[at];
        row.hits = (samples.end - samples.start) as i64;
        for part in 0..2 {
            for lane in 0..LANES {
                row.parts[part][lane] = steps(sums[part][lane]);
            }
        }
        self.count = at + 1;
    }

    /// Adds to the map what was noted, where it is at least `WORTH` crossings.
    #[inline(always)]
    pub(super) fn flush<const WORTH: usize>(&mut self, grid: &Grid, sums: &mut Sums) {
        if self.count < WORTH {
            return;
        }
        let mut pixels = [0; MOST];
        let count = self.count.min(MOST);
        for (pixel, key) in pixels[..count].iter_mut().zip(&self.keys[..count]) {
            *pixel = grid.nested(*key);
        }
        sums.fetch(&pixels[..count]);
        for (pixel, row) in pixels[..count].iter().zip(&self.rows[..count]) {
            sums.add(*pixel, row.hits, &row.parts[0], &row.parts[1]);
        }
        self.count = 0;
    }
}
