//! Where a survey is collected: sums of hits and moments, a row per pixel, in integers.
//!
//! Every sum over samples is rounded once per visit of a pixel to a multiple of 2^-40 and added as an
//! integer, so the order of additions, and with it the number of threads, cannot change a bit. An
//! h of many samples is off by far less than 1e-12.
//!
//! Rows stand in NESTED order, in which neighbours on the sky are neighbours in memory, and hold all
//! that a visit changes side by side. Maps, with an array for each quantity, are made of them at the
//! end.
//!
//! Limits: a row whose hits reach 2^22 is set aside and started again, so that no sum overflows.

use super::maps::SurveyMaps;
use super::moment::Moment;
use super::sampled::Pixels;

/// Steps of a sum in one.
const SCALE: f64 = 1_099_511_627_776.0;
/// 1.5 * 2^52: added to a number below 2^51 it leaves the nearest integer in the low bits.
const TO_INTEGER: f64 = 6_755_399_441_055_744.0;
/// Hits of a row that is set aside.
const FULL: i64 = 1 << 22;
/// Parts in which rows are given back while maps are made.
const PARTS: usize = 16;

/// Sums of a survey, or of one thread's share.
#[derive(Debug, Clone)]
pub(super) struct Sums {
    pixels: Pixels,
    moments: Vec<Moment>,
    /// Per pixel: hits, real parts, imaginary parts.
    rows: Vec<i64>,
    stride: usize,
    /// Rows set aside, by pixel once merged.
    aside: Vec<(u32, Vec<i128>)>,
}

impl Sums {
    pub(super) fn new(pixels: Pixels, moments: &[Moment]) -> Self {
        let stride = 1 + 2 * moments.len();
        let rows = vec![0; pixels.nside.pixels() as usize * stride];
        Self { pixels, moments: moments.to_vec(), rows, stride, aside: Vec::new() }
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
        for pixel in 0..self.pixels.nside.pixels() {
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

    /// The maps of what was collected so far.
    pub(super) fn maps(&self) -> SurveyMaps {
        let mut maps = SurveyMaps::blank(self.pixels, &self.moments);
        self.write(0, &self.rows, &mut maps);
        maps
    }

    /// The maps, made from the last rows to the first, whose memory is given back as they are done.
    pub(super) fn into_maps(mut self) -> SurveyMaps {
        let mut maps = SurveyMaps::blank(self.pixels, &self.moments);
        let pixels = self.pixels.nside.pixels() as usize;
        let part = pixels.div_ceil(PARTS);
        for first in (0..pixels).step_by(part).rev() {
            let rows = self.rows.split_off(first * self.stride);
            self.rows.shrink_to_fit();
            self.write(first, &rows, &mut maps);
        }
        maps
    }

    /// Writes the rows of pixels from `first` on into maps.
    #[expect(clippy::cast_precision_loss, reason = "a quotient of rounded numbers")]
    fn write(&self, first: usize, rows: &[i64], maps: &mut SurveyMaps) {
        let count = self.moments.len();
        let mut whole = vec![0_i128; self.stride];
        for (pixel, row) in (first..).zip(rows.chunks_exact(self.stride)) {
            for (cell, &here) in whole.iter_mut().zip(row) {
                *cell = i128::from(here);
            }
            let number = u32::try_from(pixel).unwrap_or(u32::MAX);
            if let Ok(at) = self.aside.binary_search_by_key(&number, |(pixel, _)| *pixel) {
                for (cell, more) in whole.iter_mut().zip(&self.aside[at].1) {
                    *cell += more;
                }
            }
            let hits = u64::try_from(whole[0]).unwrap_or(0);
            // Not a number where there is no sample.
            let per = if hits > 0 { 1.0 / (SCALE * hits as f64) } else { f64::NAN };
            let (re, im) = whole[1..].split_at(count);
            let parts = re.iter().zip(im).map(|(&re, &im)| (re as f64 * per, im as f64 * per));
            maps.set(pixel, hits, parts);
        }
    }
}

/// A sum, at most 2^10 in size, as a whole number of steps.
#[inline(always)]
pub(super) fn steps(sum: f64) -> i64 {
    let shifted = sum * SCALE + TO_INTEGER;
    shifted.to_bits().wrapping_sub(TO_INTEGER.to_bits()).cast_signed()
}
