//! A dual simplex method for bounded variables, warm-started after every change of bounds or rows.
//!
//! Method: one dense tableau. Every variable has two finite bounds, so setting each nonbasic one to
//! the bound that its reduced cost asks for is dual feasible whatever the bounds are: after any
//! change the method goes on from the basis it has. The ratio test lets variables jump from bound to
//! bound as long as the dual objective still improves (bound flipping). Rows may be added; nothing
//! is removed.
//!
//! Limits: f64; results serve as shares and prices only, and every conclusion is drawn from prices
//! in integers (`bound.rs`). The tableau is rebuilt after [`REBUILD`] pivots.

use std::cmp::Ordering;

/// Pivots between two rebuilds.
const REBUILD: usize = 3_000;
/// Smallest pivot.
const PIVOT: f64 = 1e-9;
/// Largest violation of a bound.
const FEASIBLE: f64 = 1e-9;
/// A pivot row with fewer than one in so many entries is handled entry by entry.
const SPARSE: usize = 4;
/// Ratios this close count as equal.
const TIE: f64 = 1e-11;

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Status {
    /// The relaxation is solved.
    Solved,
    /// No shares between the bounds meet the rows: this row of the tableau shows it.
    Impossible(usize),
    /// The dual objective fell to the cutoff.
    CutOff,
    /// Too many pivots.
    Stuck,
}

/// A linear programme `max c x, A x <= b, lower <= x <= upper`, and a basis.
#[derive(Debug, Clone)]
pub(super) struct Simplex {
    costs: Vec<f64>,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    rows: Vec<(Vec<(usize, f64)>, f64)>,
    /// `table[row * width + column]`.
    table: Vec<f64>,
    right: Vec<f64>,
    reduced: Vec<f64>,
    constant: f64,
    basic: Vec<usize>,
    nonbasic: Vec<usize>,
    /// Row or column of each variable, basic ones first-bit set by `is_basic`.
    place: Vec<usize>,
    is_basic: Vec<bool>,
    at_upper: Vec<bool>,
    basic_values: Vec<f64>,
    since_rebuild: usize,
    /// Entries of the tableau touched.
    pub(super) touched: usize,
}

impl Simplex {
    /// Without rows; the bounds are 0 and `upper`.
    pub(super) fn new(costs: Vec<f64>, upper: Vec<f64>) -> Self {
        let width = costs.len();
        Self {
            lower: vec![0.0; width],
            at_upper: vec![false; width],
            reduced: costs.clone(),
            costs,
            upper,
            rows: Vec::new(),
            table: Vec::new(),
            right: Vec::new(),
            constant: 0.0,
            basic: Vec::new(),
            nonbasic: (0..width).collect(),
            place: (0..width).collect(),
            is_basic: vec![false; width],
            basic_values: Vec::new(),
            since_rebuild: 0,
            touched: 0,
        }
    }

    const fn width(&self) -> usize {
        self.costs.len()
    }

    /// Adds a row; its slack is basic.
    pub(super) fn add(&mut self, terms: Vec<(usize, f64)>, limit: f64) {
        let width = self.width();
        let (mut line, mut right) = (vec![0.0; width], limit);
        for &(variable, coefficient) in &terms {
            let place = self.place[variable];
            if self.is_basic[variable] {
                // x_B = right - T x_N
                right -= coefficient * self.right[place];
                let from = &self.table[place * width..(place + 1) * width];
                for (entry, of) in line.iter_mut().zip(from) {
                    *entry -= coefficient * of;
                }
            } else {
                line[place] += coefficient;
            }
        }
        let row = self.rows.len();
        self.table.extend(line);
        self.right.push(right);
        self.basic.push(width + row);
        self.place.push(row);
        self.is_basic.push(true);
        self.basic_values.push(0.0);
        self.rows.push((terms, limit));
    }

    fn bounds(&self, variable: usize) -> (f64, f64) {
        if variable < self.width() {
            (self.lower[variable], self.upper[variable])
        } else {
            (0.0, f64::INFINITY)
        }
    }

    fn value_at(&self, column: usize) -> f64 {
        let (lower, upper) = self.bounds(self.nonbasic[column]);
        if self.at_upper[column] { upper } else { lower }
    }

    /// The dual objective.
    pub(super) fn objective(&self) -> f64 {
        let columns = 0..self.width();
        self.constant
            + columns.map(|column| self.reduced[column] * self.value_at(column)).sum::<f64>()
    }

    /// Sets nonbasic variables to the bound that their reduced cost asks for, and the basic ones.
    fn settle(&mut self) {
        let width = self.width();
        for column in 0..width {
            let structural = self.nonbasic[column] < width;
            let reduced = self.reduced[column];
            if !structural {
                self.at_upper[column] = false;
            } else if reduced > 0.0 {
                self.at_upper[column] = true;
            } else if reduced < 0.0 {
                self.at_upper[column] = false;
            }
        }
        self.touched += self.table.len();
        let values: Vec<f64> = (0..width).map(|column| self.value_at(column)).collect();
        for row in 0..self.rows.len() {
            let line = &self.table[row * width..(row + 1) * width];
            let sum: f64 = line.iter().zip(&values).map(|(a, b)| a * b).sum();
            self.basic_values[row] = self.right[row] - sum;
        }
    }

    /// Solves from the basis at hand, until the dual objective is at most `cutoff`.
    pub(super) fn solve(&mut self, cutoff: f64, most_pivots: usize) -> Status {
        if self.since_rebuild > REBUILD {
            self.rebuild();
        }
        self.settle();
        let width = self.width();
        let mut candidates: Vec<(f64, f64, usize)> = Vec::new();
        for _ in 0..most_pivots {
            if self.objective() <= cutoff {
                return Status::CutOff;
            }
            let Some((row, too_low, excess)) = self.worst() else { return Status::Solved };
            // Moving column j by d changes the basic variable by -T_rj d.
            candidates.clear();
            let line = &self.table[row * width..(row + 1) * width];
            for (column, &entry) in line.iter().enumerate() {
                if entry.abs() < PIVOT {
                    continue;
                }
                let (lower, upper) = self.bounds(self.nonbasic[column]);
                let raises = (entry < 0.0) != self.at_upper[column];
                if lower < upper && raises == too_low {
                    candidates.push((
                        self.reduced[column].abs() / entry.abs(),
                        entry.abs(),
                        column,
                    ));
                }
            }
            candidates.sort_unstable_by(|a, b| {
                a.0.partial_cmp(&b.0)
                    .unwrap_or(Ordering::Equal)
                    .then_with(|| b.1.partial_cmp(&a.1).unwrap_or(Ordering::Equal))
                    .then(a.2.cmp(&b.2))
            });
            let mut slope = excess;
            let mut enter = None;
            for (place, &(_, size, column)) in candidates.iter().enumerate() {
                let (lower, upper) = self.bounds(self.nonbasic[column]);
                slope -= size * (upper - lower);
                if slope <= 0.0 {
                    enter = Some(place);
                    break;
                }
            }
            let Some(mut enter) = enter else {
                if slope > 1e-7 || candidates.is_empty() {
                    return Status::Impossible(row);
                }
                // Within rounding: every candidate jumps, and the row holds.
                for &(_, _, column) in &candidates {
                    self.flip(column);
                }
                self.basic_values[row] = {
                    let (lower, upper) = self.bounds(self.basic[row]);
                    self.basic_values[row].clamp(lower, upper)
                };
                continue;
            };
            // Among equal ratios the largest pivot.
            let ratio = candidates[enter].0;
            for place in enter + 1..candidates.len() {
                if candidates[place].0 > ratio + TIE {
                    break;
                }
                if candidates[place].1 > 10.0 * candidates[enter].1 {
                    candidates.swap(place, enter);
                    enter = place.min(enter);
                }
            }
            for &(_, _, column) in &candidates[..enter] {
                self.flip(column);
            }
            self.pivot(row, candidates[enter].2, too_low);
        }
        Status::Stuck
    }

    /// The basic variable furthest outside its bounds: row, whether too low, by how much.
    fn worst(&self) -> Option<(usize, bool, f64)> {
        let mut worst: Option<(usize, bool, f64)> = None;
        for (row, &value) in self.basic_values.iter().enumerate() {
            let (lower, upper) = self.bounds(self.basic[row]);
            let (too_low, excess) =
                if value < lower { (true, lower - value) } else { (false, value - upper) };
            if excess > FEASIBLE && worst.is_none_or(|it| excess > it.2) {
                worst = Some((row, too_low, excess));
            }
        }
        worst
    }

    fn flip(&mut self, column: usize) {
        let (lower, upper) = self.bounds(self.nonbasic[column]);
        let change = if self.at_upper[column] { lower - upper } else { upper - lower };
        self.at_upper[column] = !self.at_upper[column];
        let width = self.width();
        for (row, value) in self.basic_values.iter_mut().enumerate() {
            *value -= self.table[row * width + column] * change;
        }
    }

    /// The basic variable of a row leaves to its bound, a column enters.
    fn pivot(&mut self, row: usize, column: usize, too_low: bool) {
        let width = self.width();
        let leaving = self.basic[row];
        let (lower, upper) = self.bounds(leaving);
        let bound = if too_low { lower } else { upper };
        let pivot = self.table[row * width + column];
        let change = (self.basic_values[row] - bound) / pivot;
        let entered = self.value_at(column) + change;
        for (other, value) in self.basic_values.iter_mut().enumerate() {
            *value -= self.table[other * width + column] * change;
        }
        self.basic_values[row] = entered;
        self.exchange(row, column);
        self.at_upper[column] = !too_low;
    }

    /// Swaps the basic variable of a row with the nonbasic one of a column.
    fn exchange(&mut self, row: usize, column: usize) {
        let width = self.width();
        let pivot = self.table[row * width + column];
        let mut line: Vec<f64> =
            self.table[row * width..(row + 1) * width].iter().map(|it| it / pivot).collect();
        line[column] = 1.0 / pivot;
        let right = self.right[row] / pivot;
        let few: Vec<(usize, f64)> =
            line.iter().copied().enumerate().filter(|it| it.1.abs() > 0.0).collect();
        let sparse = few.len() * SPARSE < width;
        let eliminate = |factor: f64, target: &mut [f64]| {
            target[column] = 0.0;
            if sparse {
                for &(at, of) in &few {
                    target[at] -= factor * of;
                }
            } else {
                for (entry, of) in target.iter_mut().zip(&line) {
                    *entry -= factor * of;
                }
            }
        };
        for other in 0..self.rows.len() {
            let factor = self.table[other * width + column];
            if other != row && factor.abs() > 0.0 {
                eliminate(factor, &mut self.table[other * width..(other + 1) * width]);
                self.right[other] -= factor * right;
            }
        }
        let factor = self.reduced[column];
        eliminate(factor, &mut self.reduced);
        self.constant += factor * right;
        self.table[row * width..(row + 1) * width].copy_from_slice(&line);
        self.right[row] = right;
        let (out, into) = (self.basic[row], self.nonbasic[column]);
        self.basic[row] = into;
        self.nonbasic[column] = out;
        self.place[into] = row;
        self.is_basic[into] = true;
        self.place[out] = column;
        self.is_basic[out] = false;
        self.since_rebuild += 1;
        self.touched += self.table.len();
    }

    /// The tableau of the same basis, from the rows.
    fn rebuild(&mut self) {
        let wanted: Vec<usize> =
            self.basic.iter().copied().filter(|&it| it < self.width()).collect();
        let touched = self.touched;
        let rows = std::mem::take(&mut self.rows);
        let mut fresh = Self::new(self.costs.clone(), self.upper.clone());
        fresh.lower.clone_from(&self.lower);
        for (terms, limit) in rows {
            fresh.add(terms, limit);
        }
        let width = fresh.width();
        for variable in wanted {
            let column = fresh.place[variable];
            // Rows whose slack is still basic and was not before.
            let row = (0..fresh.rows.len())
                .filter(|&row| fresh.basic[row] >= width && !self.is_basic[fresh.basic[row]])
                .max_by(|&a, &b| {
                    let size = |row: usize| fresh.table[row * width + column].abs();
                    size(a).partial_cmp(&size(b)).unwrap_or(Ordering::Equal)
                });
            if let Some(row) = row
                && fresh.table[row * width + column].abs() > PIVOT
            {
                fresh.exchange(row, column);
            }
        }
        fresh.since_rebuild = 0;
        fresh.touched += touched;
        *self = fresh;
    }

    /// Value of a choice.
    pub(super) fn share(&self, variable: usize) -> f64 {
        let place = self.place[variable];
        if self.is_basic[variable] { self.basic_values[place] } else { self.value_at(place) }
    }

    /// Price of a row.
    pub(super) fn price(&self, row: usize) -> f64 {
        let slack = self.width() + row;
        if self.is_basic[slack] { 0.0 } else { (-self.reduced[self.place[slack]]).max(0.0) }
    }

    /// Multipliers of the rows that show a row of the tableau to be impossible.
    pub(super) fn ray(&self, row: usize) -> Vec<f64> {
        let (width, value) = (self.width(), self.basic_values[row]);
        let (lower, _) = self.bounds(self.basic[row]);
        let sign = if value < lower { 1.0 } else { -1.0 };
        let multiplier = |other: usize| {
            let slack = width + other;
            let entry = match (self.is_basic[slack], self.place[slack]) {
                (true, place) => f64::from(u8::from(place == row)),
                (false, column) => self.table[row * width + column],
            };
            (sign * entry).max(0.0)
        };
        (0..self.rows.len()).map(multiplier).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_programme_by_hand() {
        // max 3x + 2y + z, x + y + z <= 1.5, 2x + y <= 2: x = 0.5 y = 1 gives 3.5.
        let mut simplex = Simplex::new(vec![3.0, 2.0, 1.0], vec![1.0; 3]);
        simplex.add(vec![(0, 1.0), (1, 1.0), (2, 1.0)], 1.5);
        assert_eq!(simplex.solve(f64::NEG_INFINITY, 100), Status::Solved);
        assert!((simplex.objective() - 4.0).abs() < 1e-12);
        simplex.add(vec![(0, 2.0), (1, 1.0)], 2.0);
        assert_eq!(simplex.solve(f64::NEG_INFINITY, 100), Status::Solved);
        // x = 0.5, y = 1, or x = 1, z = 0.5: 3.5 either way.
        assert!((simplex.objective() - 3.5).abs() < 1e-12, "{}", simplex.objective());
        simplex.lower[2] = 1.0;
        assert_eq!(simplex.solve(f64::NEG_INFINITY, 100), Status::Solved);
        assert!((simplex.objective() - 2.5).abs() < 1e-12, "{}", simplex.objective());
        simplex.lower = vec![1.0; 3];
        assert!(matches!(simplex.solve(f64::NEG_INFINITY, 100), Status::Impossible(_)));
        simplex.lower = vec![0.0; 3];
        simplex.rebuild();
        assert_eq!(simplex.solve(f64::NEG_INFINITY, 100), Status::Solved);
        assert!((simplex.objective() - 3.5).abs() < 1e-12);
    }
}
