//! I, Q and U of each pixel from its samples by least squares.
//!
//! With a sample's response `a = (1, cos x, -sin x)`, `x = 4 phi - 2 psi_pol` in the map's frame and Q
//! and U in the COSMO sense, a pixel's sums are the normal matrix `A^T A` and `A^T d`.
//!
//! Method: Cholesky decomposition of `A^T A / N`; its condition number is the ratio of its largest to
//! its smallest eigenvalue. The inverse of `A^T A` is the covariance for white noise of variance 1.
//!
//! Limits: pixels with fewer than three samples, or a condition number above the limit given, have no
//! solution. That of the others is off by about the condition number times 1e-16 of the signal.

use crate::healpix::Nside;
use crate::survey::{MapFrame, Pixels};
use nalgebra::{Matrix3, Vector3};
use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

/// Condition number up to which pixels are solved by default.
pub const CONDITION_LIMIT: f64 = 1e6;

/// Samples, cos, -sin, cos^2, -cos sin, d, d cos, -d sin.
type Sums = [f64; 8];

/// Consecutive samples of a detector in one pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    pixel: u32,
    sums: Sums,
}

impl Crossing {
    pub(super) const fn new(pixel: u32) -> Self {
        Self { pixel, sums: [0.0; 8] }
    }

    pub(super) const fn pixel(&self) -> u32 {
        self.pixel
    }

    pub(super) fn is_empty(&self) -> bool {
        self.sums[0] < 0.5
    }

    /// Adds a sample: (cosine, sine) of its modulation, what it measures.
    #[inline]
    pub(super) fn add(&mut self, (c, sin): (f64, f64), d: f64) {
        let s = -sin;
        let more = [1.0, c, s, c * c, c * s, d, d * c, d * s];
        for (sum, more) in self.sums.iter_mut().zip(more) {
            *sum += more;
        }
    }
}

/// Sums of all pixels, from which maps are solved.
#[derive(Debug, Clone)]
pub struct BinnedMaps {
    pixels: Pixels,
    rows: Vec<Sums>,
    left_out: u64,
}

/// I, Q, U of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// I, Q, U, COSMO sense.
    pub stokes: [f64; 3],
    /// Their covariance for white noise of variance 1 per sample.
    pub covariance: [[f64; 3]; 3],
    /// Condition number of the normal matrix.
    pub condition: f64,
}

/// Bytes that the maps take.
#[must_use]
pub fn map_bytes(nside: Nside) -> u64 {
    u64::from(nside.pixels()) * size_of::<Sums>() as u64
}

impl BinnedMaps {
    pub(super) fn new(pixels: Pixels) -> Self {
        Self { pixels, rows: vec![[0.0; 8]; pixels.nside.pixels() as usize], left_out: 0 }
    }

    /// Adds crossings in their order.
    pub(super) fn add(&mut self, crossings: &[Crossing], left_out: u64) {
        for crossing in crossings {
            let row = &mut self.rows[crossing.pixel as usize];
            for (sum, more) in row.iter_mut().zip(&crossing.sums) {
                *sum += more;
            }
        }
        self.left_out += left_out;
    }

    /// Resolution.
    #[must_use]
    pub const fn nside(&self) -> Nside {
        self.pixels.nside
    }

    /// Frame of the pixels, and of Q and U.
    #[must_use]
    pub const fn frame(&self) -> MapFrame {
        self.pixels.frame
    }

    /// Samples that fell on sky pixels without a value, or measured nothing finite.
    #[must_use]
    pub const fn left_out(&self) -> u64 {
        self.left_out
    }

    /// Samples in a NESTED pixel, those left out not counted.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a count below 2^53"
    )]
    pub fn hits(&self, nested: u32) -> u64 {
        self.rows[nested as usize][0] as u64
    }

    /// The normal matrix of a NESTED pixel over its samples, for I, Q and U (COSMO).
    fn normal(&self, nested: u32) -> Matrix3<f64> {
        let [n, c, s, cc, cs, ..] = self.rows[nested as usize];
        let per = 1.0 / n;
        Matrix3::new(n, c, s, c, cc, cs, s, cs, n - cc) * per
    }

    /// The condition number of a NESTED pixel's normal matrix, infinite where it is singular; `None`
    /// where the pixel has no samples.
    #[must_use]
    pub fn condition(&self, nested: u32) -> Option<f64> {
        (self.hits(nested) > 0).then(|| {
            let eigenvalues = self.normal(nested).symmetric_eigenvalues();
            let (low, high) = (eigenvalues.min(), eigenvalues.max());
            if low > 0.0 { high / low } else { f64::INFINITY }
        })
    }

    /// I, Q and U of a NESTED pixel; `None` where it has fewer than three samples or a condition number
    /// above `limit`.
    #[must_use]
    pub fn solve(&self, nested: u32, limit: f64) -> Option<Solution> {
        let [n, .., d, dc, ds] = self.rows[nested as usize];
        let condition = self.condition(nested).filter(|&it| n > 2.5 && it <= limit)?;
        let factors = self.normal(nested).cholesky()?;
        let stokes = factors.solve(&(Vector3::new(d, dc, ds) / n)).into();
        // Symmetric, so that columns are rows.
        let covariance = (factors.inverse() / n).into();
        Some(Solution { stokes, covariance, condition })
    }

    /// I, Q, U and condition number of all pixels; I, Q and U where [`BinnedMaps::solve`] has them.
    #[must_use]
    pub fn stokes(&self, limit: f64) -> StokesMaps {
        let blank = || vec![f64::NAN; self.rows.len()];
        let (mut i, mut q, mut u, mut condition) = (blank(), blank(), blank(), blank());
        (&mut i, &mut q, &mut u, &mut condition).into_par_iter().enumerate().for_each(
            |(pixel, (i, q, u, condition))| {
                let pixel = u32::try_from(pixel).unwrap_or(u32::MAX);
                if let Some(solution) = self.solve(pixel, limit) {
                    [*i, *q, *u] = solution.stokes;
                }
                *condition = self.condition(pixel).unwrap_or(f64::NAN);
            },
        );
        let hits = (0..self.pixels.nside.pixels()).map(|pixel| self.hits(pixel)).collect();
        StokesMaps { pixels: self.pixels, hits, stokes: [i, q, u], condition }
    }
}

/// I, Q, U, condition number and samples of all pixels, one contiguous array each.
///
/// Arrays are in NESTED order ([`Nside::in_order`] makes RING of them), Q and U in the COSMO sense,
/// NaN where a pixel has no value.
#[derive(Debug, Clone)]
pub struct StokesMaps {
    pixels: Pixels,
    hits: Vec<u64>,
    stokes: [Vec<f64>; 3],
    condition: Vec<f64>,
}

impl StokesMaps {
    /// Resolution.
    #[must_use]
    pub const fn nside(&self) -> Nside {
        self.pixels.nside
    }

    /// Frame of the pixels, and of Q and U.
    #[must_use]
    pub const fn frame(&self) -> MapFrame {
        self.pixels.frame
    }

    /// Samples by NESTED pixel, those left out not counted.
    #[must_use]
    pub fn hits(&self) -> &[u64] {
        &self.hits
    }

    /// I, Q and U by NESTED pixel.
    #[must_use]
    pub fn iqu(&self) -> [&[f64]; 3] {
        self.stokes.each_ref().map(Vec::as_slice)
    }

    /// Condition numbers by NESTED pixel.
    #[must_use]
    pub fn condition(&self) -> &[f64] {
        &self.condition
    }

    /// Pixels without I, Q and U.
    #[must_use]
    pub fn unsolved(&self) -> usize {
        self.stokes[0].iter().filter(|i| i.is_nan()).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(samples: &[(f64, f64)]) -> BinnedMaps {
        let nside = Nside::new(1).unwrap();
        let mut maps = BinnedMaps::new(Pixels { nside, frame: MapFrame::Ecliptic });
        let mut crossing = Crossing::new(7);
        for &(angle, d) in samples {
            crossing.add((angle.cos(), angle.sin()), d);
        }
        maps.add(&[crossing], 0);
        maps
    }

    #[test]
    fn even_angles_give_a_condition_of_two() {
        // A^T A / N is diag(1, 1/2, 1/2).
        let turn = std::f64::consts::TAU / 5.0;
        let samples: Vec<(f64, f64)> = (0..5)
            .map(|k| turn * f64::from(k))
            .map(|x| (x, 3.0 + 0.5 * x.cos() - 0.25 * -x.sin()))
            .collect();
        let maps = pixel(&samples);
        let solution = maps.solve(7, CONDITION_LIMIT).unwrap();
        for (found, expected) in solution.stokes.iter().zip([3.0, 0.5, -0.25]) {
            assert!((found - expected).abs() < 1e-15);
        }
        for (row, expected) in [0.2, 0.4, 0.4].into_iter().enumerate() {
            assert!((solution.covariance[row][row] - expected).abs() < 1e-15);
        }
        assert!((solution.condition - 2.0).abs() < 1e-14);
        assert_eq!((maps.hits(7), maps.hits(6)), (5, 0));
        assert_eq!((maps.condition(6), maps.solve(6, f64::INFINITY)), (None, None));
        let arrays = maps.stokes(CONDITION_LIMIT);
        assert_eq!(arrays.iqu().map(|map| map[7].to_bits()), solution.stokes.map(f64::to_bits));
        assert_eq!(arrays.condition()[7].to_bits(), solution.condition.to_bits());
        assert_eq!(
            (arrays.hits(), arrays.unsolved()),
            (&[0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0, 0][..], 11)
        );
        assert!(arrays.iqu().iter().all(|map| map[6].is_nan()) && arrays.condition()[6].is_nan());
    }

    #[test]
    fn what_cannot_be_told_apart_has_no_solution() {
        // Two samples; equal angles; angles so near that the condition exceeds the limit.
        for samples in [
            vec![(0.0, 1.0), (1.0, 1.0)],
            vec![(0.3, 1.0); 10],
            vec![(0.0, 1.0), (1e-3, 1.0), (2e-3, 1.0)],
        ] {
            let maps = pixel(&samples);
            assert!(maps.condition(7).unwrap() > 1e6);
            assert_eq!(maps.solve(7, CONDITION_LIMIT), None);
        }
    }
}
