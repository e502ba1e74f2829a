//! States from modified difference lines, SPK types 1 and 21.
//!
//! Each line holds a reference state, stepsizes and a table of modified divided differences of the
//! acceleration, and counts up to its last time.
//!
//! Method: \[Krogh1974\]'s interpolation as NAIF's "SPK Required Reading" lays it down: with
//! `delta = t - t_ref`, weights W from the stepsizes G, `x = x0 + delta (v0 + delta sum DT W)`.
//!
//! Limits: what is summed is checked when the line is read; the numbers themselves cannot be.

use crate::convert::count_from_f64;
use crate::interpolation::PosVel;
use nalgebra::Vector3;

/// Difference lines and their last times.
#[derive(Debug, Clone)]
pub(super) struct DifferenceLines {
    ends_s: Vec<f64>,
    numbers: Vec<f64>,
    /// Orders that a line has room for.
    dimension: usize,
}

/// One line by its parts.
struct Line<'a> {
    reference_s: f64,
    /// Stepsizes G.
    steps: &'a [f64],
    /// Position and velocity at the reference time, by axis.
    state: [(f64, f64); 3],
    /// Differences DT by axis.
    differences: [&'a [f64]; 3],
    /// The largest order plus one, and the orders by axis.
    largest: usize,
    orders: [usize; 3],
}

impl DifferenceLines {
    /// Checks the orders and stepsizes of each line; the number that is wrong otherwise.
    pub(super) fn new(
        ends_s: Vec<f64>,
        numbers: Vec<f64>,
        dimension: usize,
    ) -> Result<Self, (&'static str, f64)> {
        let lines = Self { ends_s, numbers, dimension };
        for index in 0..lines.ends_s.len() {
            let Some(line) = lines.line(index) else {
                return Err(("an order of differences", f64::NAN));
            };
            let used = line.steps.get(..line.largest.saturating_sub(2)).unwrap_or_default();
            if let Some(step) = used.iter().find(|it| it.abs() <= 0.0) {
                return Err(("a stepsize", *step));
            }
        }
        Ok(lines)
    }

    /// The last times of the lines.
    pub(super) fn ends_s(&self) -> impl Iterator<Item = f64> {
        self.ends_s.iter().copied()
    }

    fn line(&self, index: usize) -> Option<Line<'_>> {
        let size = 4 * self.dimension + 11;
        let numbers = self.numbers.get(index * size..(index + 1) * size)?;
        let (reference, rest) = numbers.split_first()?;
        let (steps, rest) = rest.split_at_checked(self.dimension)?;
        let (state, rest) = rest.split_at_checked(6)?;
        let (differences, orders) = rest.split_at_checked(3 * self.dimension)?;
        let [x, vx, y, vy, z, vz] = *state else { return None };
        let [largest, kx, ky, kz] = *orders else { return None };
        let largest = count_from_f64(largest).filter(|it| (2..=self.dimension + 1).contains(it))?;
        let order = |found| count_from_f64(found).filter(|it| *it < largest);
        let axis =
            |axis: usize| differences.get(axis * self.dimension..(axis + 1) * self.dimension);
        Some(Line {
            reference_s: *reference,
            steps,
            state: [(x, vx), (y, vy), (z, vz)],
            differences: [axis(0)?, axis(1)?, axis(2)?],
            largest,
            orders: [order(kx)?, order(ky)?, order(kz)?],
        })
    }

    /// The state at a time, by the first line that ends there or later.
    pub(super) fn at(&self, at_s: f64) -> PosVel {
        let index = self.ends_s.partition_point(|end| *end < at_s);
        let index = index.min(self.ends_s.len().saturating_sub(1));
        let nowhere = (Vector3::repeat(f64::NAN), Vector3::repeat(f64::NAN));
        self.line(index).map_or(nowhere, |line| line.at(at_s))
    }
}

impl Line<'_> {
    fn at(&self, at_s: f64) -> PosVel {
        let delta = at_s - self.reference_s;
        let (mut forward, mut backward) = (vec![1.0], Vec::new());
        let mut passed = delta;
        for step in self.steps.iter().take(self.largest - 2) {
            forward.push(passed / step);
            backward.push(delta / step);
            passed = delta + step;
        }
        // W_j = 1 / j, then for each order W_(j + k) = FC_(j + 1) W_(j + k - 1) - WC_j W_(j + k).
        let mut weights = vec![0.0];
        let mut divisor = 1.0;
        while weights.len() <= self.largest {
            weights.push(1.0 / divisor);
            divisor += 1.0;
        }
        let raise = |weights: &mut [f64], terms: usize, shift: usize| {
            for j in 1..=terms {
                weights[j + shift] =
                    forward[j] * weights[j + shift - 1] - backward[j - 1] * weights[j + shift];
            }
        };
        let (mut shift, mut terms) = (self.largest - 1, 0);
        while shift >= 2 {
            terms += 1;
            raise(&mut weights, terms, shift);
            shift -= 1;
        }
        let sum = |weights: &[f64], axis: usize, shift: usize| -> f64 {
            let differences = self.differences[axis].iter().zip(&weights[shift + 1..]);
            differences.take(self.orders[axis]).map(|(dt, w)| dt * w).sum()
        };
        let position = Vector3::from_fn(|axis, _| {
            let (x, v) = self.state[axis];
            x + delta * (v + delta * sum(&weights, axis, shift))
        });
        raise(&mut weights, terms, shift);
        let velocity =
            Vector3::from_fn(|axis, _| self.state[axis].1 + delta * sum(&weights, axis, shift - 1));
        (position, velocity)
    }
}
