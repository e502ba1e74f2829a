//! Where a survey is collected: hits and moments per pixel, in integers.
//!
//! Every sum over samples is rounded once per visit of a pixel to a multiple of 2^-40 and added as an
//! integer, so the order of additions, and with it the number of threads, cannot change a bit. An
//! h of many samples is off by far less than 1e-12.
//!
//! Rows stand in NESTED order, in which neighbours on the sky are neighbours in memory.
//!
//! Limits: a row whose hits reach 2^22 is set aside and started again, so that no sum overflows.

use super::moment::Moment;
use crate::healpix::{Nside, Ordering};

/// Steps of a sum in one.
const SCALE: f64 = 1_099_511_627_776.0;
/// 1.5 * 2^52: added to a number below 2^51 it leaves the nearest integer in the low bits.
const TO_INTEGER: f64 = 6_755_399_441_055_744.0;
/// Hits of a row that is set aside.
const FULL: i64 = 1 << 22;

/// Hits and sums of a survey, or of one thread's share.
#[derive(Debug, Clone)]
pub struct SurveyMaps {
    nside: Nside,
    moments: Vec<Moment>,
    /// Per pixel: hits, real parts, imaginary parts.
    rows: Vec<i64>,
    stride: usize,
    /// Rows set aside, by pixel once merged.
    aside: Vec<(u32, Vec<i128>)>,
}

/// Bytes that the maps of one thread take.
#[must_use]
pub fn map_bytes(nside: Nside, moments: usize) -> u64 {
    let row = 8 * (1 + 2 * u64::try_from(moments).unwrap_or(u64::MAX / 64));
    u64::from(nside.pixels()) * row
}

impl SurveyMaps {
    pub(super) fn new(nside: Nside, moments: &[Moment]) -> Self {
        let stride = 1 + 2 * moments.len();
        let pixels = nside.pixels() as usize;
        Self {
            nside,
            moments: moments.to_vec(),
            rows: vec![0; pixels * stride],
            stride,
            aside: Vec::new(),
        }
    }

    /// Adds `hits` samples of a pixel, at most 2^10, with their sums in steps.
    #[inline(always)]
    pub(super) fn add(&mut self, pixel: u32, hits: i64, re: &[i64], im: &[i64]) {
        let count = self.stride / 2;
        let first = pixel as usize * self.stride;
        let row = &mut self.rows[first..first + self.stride];
        row[0] += hits;
        let (re_row, im_row) = row[1..].split_at_mut(count);
        for (cell, sum) in re_row.iter_mut().zip(re) {
            *cell += sum;
        }
        for (cell, sum) in im_row.iter_mut().zip(im) {
            *cell += sum;
        }
        if row[0] >= FULL {
            self.set_aside(pixel);
        }
    }

    /// Reads the ends of rows, so that they are fetched at the same time.
    #[inline(always)]
    pub(super) fn fetch(&self, pixels: &[u32]) {
        let mut seen = 0;
        for &pixel in pixels {
            let first = pixel as usize * self.stride;
            seen |= self.rows[first] | self.rows[first + self.stride - 1];
        }
        std::hint::black_box(seen);
    }

    #[cold]
    #[inline(never)]
    fn set_aside(&mut self, pixel: u32) {
        let first = pixel as usize * self.stride;
        let row = &mut self.rows[first..first + self.stride];
        self.aside.push((pixel, row.iter().map(|&cell| i128::from(cell)).collect()));
        row.fill(0);
    }

    /// Takes over another share of the same survey, which is left empty.
    pub(super) fn take(&mut self, other: &mut Self) {
        for pixel in 0..self.nside.pixels() {
            let first = pixel as usize * self.stride;
            let theirs = &mut other.rows[first..first + self.stride];
            if theirs[0] == 0 {
                continue;
            }
            let row = &mut self.rows[first..first + self.stride];
            for (cell, more) in row.iter_mut().zip(&mut *theirs) {
                *cell += *more;
            }
            theirs.fill(0);
            if row[0] >= FULL {
                self.set_aside(pixel);
            }
        }
        self.aside.append(&mut other.aside);
    }

    /// Joins what was set aside.
    pub(super) fn settle(&mut self) {
        self.aside.sort_by_key(|(pixel, _)| *pixel);
        self.aside.dedup_by(|later, kept| {
            let same = later.0 == kept.0;
            if same {
                for (cell, more) in kept.1.iter_mut().zip(&later.1) {
                    *cell += more;
                }
            }
            same
        });
    }

    /// Resolution.
    #[must_use]
    pub const fn nside(&self) -> Nside {
        self.nside
    }

    /// The moments, in the order asked for.
    #[must_use]
    pub fn moments(&self) -> &[Moment] {
        &self.moments
    }

    fn cell(&self, nested: u32, index: usize) -> i128 {
        let here = i128::from(self.rows[nested as usize * self.stride + index]);
        let aside = self.aside.binary_search_by_key(&nested, |(pixel, _)| *pixel);
        aside.map_or(here, |at| here + self.aside[at].1[index])
    }

    /// Samples in a NESTED pixel.
    #[must_use]
    pub fn hits(&self, nested: u32) -> u64 {
        u64::try_from(self.cell(nested, 0)).unwrap_or(0)
    }

    /// Real and imaginary part of the moment of index `moment` in a NESTED pixel; `None` where it has
    /// no samples.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a quotient of rounded numbers")]
    pub fn h(&self, nested: u32, moment: usize) -> Option<(f64, f64)> {
        let hits = self.hits(nested);
        (hits > 0 && moment < self.moments.len()).then(|| {
            let per = 1.0 / (SCALE * hits as f64);
            let re = self.cell(nested, 1 + moment) as f64;
            let im = self.cell(nested, 1 + self.moments.len() + moment) as f64;
            (re * per, im * per)
        })
    }

    /// Hits of all pixels in an order.
    pub fn hits_in(&self, ordering: Ordering) -> impl Iterator<Item = u64> + '_ {
        (0..self.nside.pixels()).map(move |pixel| self.hits(self.nside.nested(ordering, pixel)))
    }
}

/// A sum, at most 2^10 in size, as a whole number of steps.
#[inline(always)]
pub(super) fn steps(sum: f64) -> i64 {
    let shifted = sum * SCALE + TO_INTEGER;
    shifted.to_bits().wrapping_sub(TO_INTEGER.to_bits()).cast_signed()
}
