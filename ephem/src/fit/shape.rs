//! How many granules of how many coefficients make the shortest table.
//!
//! A granule's series is the Chebyshev interpolant cut after n terms; its last two coefficients then
//! take up the cut terms of their parity, so that both ends are met and the table is continuous. Its
//! error is the sum over k >= n of `c_k (T_k - T_j)`, j the one of n - 1, n - 2 of k's parity.
//!
//! Method: for rising granule counts g, only n < (best bytes)/(24 g) can win, and the first granule
//! that needs more ends the trial; a doubling search finds the first g that is possible at all.

use super::master::{Master, SHORTEST_NS};
use crate::chebyshev::{Transform, ends};
use crate::convert::{f64_from_i64, f64_from_usize};
use core::f64::consts::PI;
use nalgebra::Vector3;

/// Terms sampled beyond the most that are kept.
const EXTRA: usize = 32;
/// Fewest coefficients: one for each parity.
pub(super) const FEWEST: usize = 2;
/// The error is measured on a grid; between its points it may be this much larger.
const GRID_SHARE: f64 = 0.97;
/// Counts beyond the first possible one that are tried, as a multiple of it.
const SPREAD: usize = 8;

/// The shape of one span's series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) granules: usize,
    pub(super) coefficients: usize,
}

/// Cosines that every search of one fit shares.
pub(super) struct Tables {
    transform: Transform,
    /// `T_k` at the measuring points, k major.
    grid: Vec<f64>,
    max_coefficients: usize,
}

impl Tables {
    pub(super) fn new(max_coefficients: usize) -> Self {
        let size = max_coefficients + EXTRA;
        let points = 2 * size;
        let grid = (0..size * points)
            .map(|at| {
                let angle = PI * (f64_from_usize(at % points) + 0.5) / f64_from_usize(points);
                libm::cos(f64_from_usize(at / points) * angle)
            })
            .collect();
        Self { transform: Transform::new(size), grid, max_coefficients }
    }
}

/// A search over one span.
pub(super) struct Search<'a> {
    pub(super) tables: &'a Tables,
    pub(super) master: &'a Master,
    pub(super) length_ns: i64,
}

impl Search<'_> {
    /// Length of a granule in whole ns: together they reach the span's end or just beyond when
    /// `cover`, else the end or just before it (by less than a ns per granule).
    pub(super) fn granule_ns(&self, granules: usize, cover: bool) -> i64 {
        let count = i64::try_from(granules).unwrap_or(i64::MAX);
        let floor = self.length_ns / count;
        if cover && self.length_ns % count != 0 { floor + 1 } else { floor }
    }

    /// The shape of fewest bytes within `tolerance_rad`; `None` when no granule of 60 s suffices.
    pub(super) fn shortest(&self, tolerance_rad: f64) -> Option<Shape> {
        let limit = usize::try_from(self.length_ns / SHORTEST_NS).unwrap_or(usize::MAX).max(1);
        let most = self.tables.max_coefficients;
        let mut hint = 0;
        let mut try_count = |granules: usize, cap: usize| {
            self.needed_everywhere(granules, cap, tolerance_rad, &mut hint)
        };
        let (mut impossible, mut possible) = (0, 1);
        let mut best = loop {
            match try_count(possible, most) {
                Some(coefficients) => break Shape { granules: possible, coefficients },
                None if possible >= limit => return None,
                None => (impossible, possible) = (possible, (2 * possible).min(limit)),
            }
        };
        while possible - impossible > 1 {
            let middle = impossible + (possible - impossible) / 2;
            match try_count(middle, most) {
                Some(coefficients) => {
                    possible = middle;
                    best = shorter(best, Shape { granules: middle, coefficients });
                }
                None => impossible = middle,
            }
        }
        let mut granules = possible + 1;
        while granules <= (SPREAD * possible + 32).min(limit) {
            let cap = (best.granules * best.coefficients - 1) / granules;
            if cap < FEWEST {
                break;
            }
            if let Some(coefficients) = try_count(granules, cap.min(most)) {
                best = shorter(best, Shape { granules, coefficients });
            }
            granules += 1 + granules / 64;
        }
        Some(best)
    }

    /// Coefficients that the most demanding granule needs, if that is at most `cap`.
    ///
    /// The granule nearest to `hint` (thousandths of the span), where the last trial failed, is
    /// looked at first.
    fn needed_everywhere(
        &self,
        granules: usize,
        cap: usize,
        tolerance_rad: f64,
        hint: &mut usize,
    ) -> Option<usize> {
        let first = (*hint * granules / 1000).min(granules - 1);
        let mut most = FEWEST;
        for index in core::iter::once(first).chain((0..granules).filter(|i| *i != first)) {
            let Some(needed) = self.needed(&self.sampled(granules, index), cap, tolerance_rad)
            else {
                *hint = (1000 * index + 500) / granules;
                return None;
            };
            most = most.max(needed);
        }
        Some(most)
    }

    fn sampled(&self, granules: usize, index: usize) -> Vec<Vector3<f64>> {
        let length = f64_from_i64(self.granule_ns(granules, false));
        let start = length * f64_from_usize(index);
        let values: Vec<Vector3<f64>> = self
            .tables
            .transform
            .nodes()
            .iter()
            .map(|x| self.master.at(start + length * (1.0 + x) / 2.0))
            .collect();
        self.tables.transform.series(&values)
    }

    /// Coefficients that one granule's series needs, if that is at most `cap`.
    fn needed(&self, series: &[Vector3<f64>], cap: usize, tolerance_rad: f64) -> Option<usize> {
        // |T_k - T_j| <= 2: the cut terms' norms bound the error without measuring.
        let mut tail = 0.0;
        let mut sure = series.len();
        for (order, c) in series.iter().enumerate().rev() {
            tail += 2.0 * c.norm();
            if tail > tolerance_rad || order < FEWEST {
                break;
            }
            sure = order;
        }
        let mut needed = if sure <= cap {
            sure
        } else if self.error_within(series, cap, tolerance_rad) {
            cap
        } else {
            return None;
        };
        while needed > FEWEST && self.error_within(series, needed - 1, tolerance_rad) {
            needed -= 1;
        }
        Some(needed)
    }

    /// Whether the series cut after `count` terms errs by less than the tolerance on the grid.
    fn error_within(&self, series: &[Vector3<f64>], count: usize, tolerance_rad: f64) -> bool {
        let legal = (tolerance_rad * GRID_SHARE) * (tolerance_rad * GRID_SHARE);
        let points = 2 * self.tables.transform.nodes().len();
        let row = |order: usize| &self.tables.grid[order * points..(order + 1) * points];
        // Terms beyond this add less than a thousandth of the tolerance together.
        let mut sum = 0.0;
        let mut used = series.len();
        while used > count {
            sum += 2.0 * series[used - 1].norm();
            if sum > 1e-3 * tolerance_rad {
                break;
            }
            used -= 1;
        }
        let mut error = vec![Vector3::<f64>::zeros(); points];
        for (order, c) in series.iter().enumerate().take(used).skip(count) {
            let partner = if (order - count) % 2 == 1 { count - 1 } else { count - 2 };
            for (slot, (t, p)) in error.iter_mut().zip(row(order).iter().zip(row(partner))) {
                *slot += c * (t - p);
            }
        }
        error.iter().all(|e| e.norm_squared() <= legal)
    }

    /// The series of a granule, cut to `shape` and pinned to the master at both ends.
    pub(super) fn series(&self, shape: Shape, index: usize, granule_ns: i64) -> Vec<Vector3<f64>> {
        let length = f64_from_i64(granule_ns);
        let edge = |index: usize| {
            let count = i64::try_from(index).unwrap_or(0);
            f64_from_i64(count.saturating_mul(granule_ns))
        };
        let (start, end) = (edge(index), edge(index + 1));
        let values: Vec<Vector3<f64>> = self
            .tables
            .transform
            .nodes()
            .iter()
            .map(|x| self.master.at(start + length * (1.0 + x) / 2.0))
            .collect();
        let mut series = self.tables.transform.series(&values);
        series.truncate(shape.coefficients);
        let (low, high) = ends(&series);
        let (low, high) = (self.master.at(start) - low, self.master.at(end) - high);
        let (even, odd) = ((high + low) / 2.0, (high - low) / 2.0);
        let last = shape.coefficients - 1;
        for (order, c) in series.iter_mut().enumerate().skip(last.saturating_sub(1)) {
            *c += if order % 2 == 0 { even } else { odd };
        }
        series
    }
}

fn shorter(a: Shape, b: Shape) -> Shape {
    if b.granules * b.coefficients < a.granules * a.coefficients { b } else { a }
}
