//! Three lines in time through points with outliers, the noise alike in all three.
//!
//! Axes: 0 and 2 are lines, 1 is a constant. With one dimension only axis 2 counts, the others are
//! zero. Method: rows are rejected first by the median misfit, then by chi-square against the sigma
//! of those kept, until the choice stands; a row may come back.

use super::follow::{LEAST_MISFIT_RAD, median};
use std::f64::consts::PI;

/// Chance that any row of a file is rejected without cause.
const FALSE_ALARM: f64 = 0.01;
/// Rounds after which the choice of rows is taken as it is.
const ROUNDS: usize = 30;

/// A line through points, about their mean time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    pub(super) mean_time: f64,
    pub(super) at_mean: f64,
    pub(super) slope: f64,
}

impl Line {
    pub(super) const fn new(at_zero: f64, slope: f64) -> Self {
        Self { mean_time: 0.0, at_mean: at_zero, slope }
    }

    pub(super) fn at(&self, time: f64) -> f64 {
        self.at_mean + self.slope * (time - self.mean_time)
    }
}

/// Points of up to three components at times.
pub(super) struct Points<'p> {
    pub(super) times: &'p [f64],
    pub(super) values: Vec<[f64; 3]>,
    /// 3, or 1 where only the last component counts.
    pub(super) dimensions: u8,
}

/// The lines, and how well they are known.
pub(super) struct Solution {
    pub(super) lines: [Line; 3],
    pub(super) used: Vec<bool>,
    /// Standard deviation of a component.
    pub(super) sigma: f64,
    /// Rows used.
    pub(super) rows: f64,
    /// Sum of squares of the times used about their mean.
    pub(super) spread: f64,
}

impl Points<'_> {
    /// Least squares from first lines that outliers have not moved.
    pub(super) fn solve(&self, first: [Line; 3]) -> Solution {
        let mut squares = self.misfits(&first);
        let (middle, unknowns) = if self.dimensions == 3 { (2.366, 5.0) } else { (0.4549, 2.0) };
        let sigma = (median(&mut squares.clone()) / middle).sqrt();
        let mut solution = Solution {
            lines: first,
            used: vec![true; self.times.len()],
            sigma: sigma.max(LEAST_MISFIT_RAD),
            rows: 0.0,
            spread: 0.0,
        };
        // The first lines are good to a few sigma.
        let mut limit = 100.0;
        for round in 0..ROUNDS {
            let largest = limit * solution.sigma * solution.sigma;
            let kept: Vec<bool> = squares.iter().map(|square| *square <= largest).collect();
            if round > 1 && kept == solution.used {
                break;
            }
            solution.used = kept;
            self.fit(&mut solution);
            squares = self.misfits(&solution.lines);
            let inside = squares.iter().zip(&solution.used).filter(|it| *it.1);
            let sum: f64 = inside.map(|it| it.0).sum();
            let freedom = f64::from(self.dimensions) * solution.rows - unknowns;
            solution.sigma = (sum / freedom.max(1.0)).sqrt().max(LEAST_MISFIT_RAD);
            limit = threshold(self.times.len(), self.dimensions);
        }
        solution
    }

    fn misfits(&self, lines: &[Line; 3]) -> Vec<f64> {
        let square = |(time, point): (&f64, &[f64; 3])| {
            let rest = point.iter().zip(lines).map(|(value, line)| value - line.at(*time));
            rest.map(|it| it * it).sum()
        };
        self.times.iter().zip(&self.values).map(square).collect()
    }

    /// Least squares on the rows used.
    fn fit(&self, solution: &mut Solution) {
        let rows: Vec<(f64, &[f64; 3])> = self
            .times
            .iter()
            .zip(&self.values)
            .zip(&solution.used)
            .filter(|it| *it.1)
            .map(|((time, point), _)| (*time, point))
            .collect();
        let count: f64 = rows.iter().map(|_| 1.0).sum();
        let mean = |sum: f64| sum / count.max(1.0);
        let mean_time = mean(rows.iter().map(|row| row.0).sum());
        let spread: f64 = rows.iter().map(|row| (row.0 - mean_time).powi(2)).sum();
        for (axis, line) in solution.lines.iter_mut().enumerate() {
            let at_mean = mean(rows.iter().map(|row| row.1[axis]).sum());
            let along = |row: &(f64, &[f64; 3])| (row.0 - mean_time) * (row.1[axis] - at_mean);
            let slope = if axis == 1 || spread <= 0.0 {
                0.0
            } else {
                rows.iter().map(along).sum::<f64>() / spread
            };
            *line = Line { mean_time, at_mean, slope };
        }
        solution.rows = count;
        solution.spread = spread;
    }
}

/// The chi-square that one of `count` rows exceeds with a chance of at most [`FALSE_ALARM`].
fn threshold(count: usize, dimensions: u8) -> f64 {
    let rows: f64 = (0..count).map(|_| 1.0).sum();
    // Upper bounds of the tails: sqrt(2/(pi x)) e^(-x/2), times (x + 1) in three dimensions.
    let tail = |x: f64| {
        let one = (2.0 / (PI * x)).sqrt() * (-0.5 * x).exp();
        if dimensions == 3 { one * (x + 1.0) } else { one }
    };
    let (mut low, mut high) = (1.0, 200.0);
    while high - low > 1e-6 {
        let middle = 0.5 * (low + high);
        if rows * tail(middle) > FALSE_ALARM { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_those_of_the_distribution() {
        // Tabulated: chi-square of 1e-5 is 25.90 with three degrees of freedom, 19.51 with one.
        assert!((threshold(1000, 3) - 25.90).abs() < 0.05, "{}", threshold(1000, 3));
        assert!((threshold(1000, 1) - 19.51).abs() < 0.15, "{}", threshold(1000, 1));
    }

    #[test]
    fn outliers_do_not_move_the_lines() {
        let times: Vec<f64> = (0..100).map(f64::from).collect();
        let values = times
            .iter()
            .map(|t| {
                let small = 1e-3 * (t * 12.9898).sin();
                let far = if t.rem_euclid(10.0) < 0.5 { 5.0 } else { 0.0 };
                [1.0 + 0.5 * t + small, 3.0 - small, -2.0 * t + small + far]
            })
            .collect();
        let points = Points { times: &times, values, dimensions: 3 };
        let first = [Line::new(1.0, 0.5), Line::new(3.0, 0.0), Line::new(0.0, -2.0)];
        let found = points.solve(first);
        assert_eq!(found.used.iter().filter(|used| !**used).count(), 10);
        assert!((found.lines[0].slope - 0.5).abs() < 1e-5);
        assert!((found.lines[1].at_mean - 3.0).abs() < 1e-3);
        assert!((found.lines[2].slope + 2.0).abs() < 1e-5);
        assert!((found.sigma / 7.1e-4 - 1.0).abs() < 0.1, "{}", found.sigma);
    }
}
