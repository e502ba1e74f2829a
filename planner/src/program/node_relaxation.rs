//! The linear relaxation that the nodes of branch and bound share, rows and tangents entering as needed.
//!
//! Method: a row of the programme enters where the shares violate it, over its largest coefficient. A
//! cell's gain is outer-approximated: its variable is the part of the cell's range that is earned, each
//! tangent of the concave gain a row that holds for every set. Values and ranges are scaled to a largest
//! of one. The dual prices of both go back to the programme's rows and cells, where integers turn them
//! into a bound (`bound.rs`).
//!
//! Limits: f64 throughout; at most [`MOST_LINES`] lines before tangents stop to enter.

use super::bound::{Prices, impossible};
use super::gain::{Gain, UNIT};
use super::number::f64_from_i64;
use super::problem::{Cell, Choice, Program, Row};
use super::simplex::Simplex;

/// Rows must be violated by this share of their size.
const BROKEN: f64 = 1e-7;
/// A gain must be exceeded by this share of its cell's range.
const EXCEEDED: f64 = 1e-7;
/// Most rows added at once.
const AT_ONCE: usize = 40;
/// Lines beyond which no tangent enters.
const MOST_LINES: usize = 4_000;
/// Tangents of a logarithm at first: at squares of their number's share of the range.
const FIRST_TANGENTS: i32 = 5;

/// A line of the relaxation.
#[derive(Debug, Clone, Copy)]
enum Line {
    /// A row of the programme, over its size.
    Row(usize, f64),
    /// A tangent of a cell's gain, with its slope.
    Tangent(usize, f64),
}

/// The relaxation of a programme whose rows enter as they are violated.
#[derive(Debug, Clone)]
pub(super) struct NodeRelaxation {
    pub(super) simplex: Simplex,
    lines: Vec<Line>,
    present: Vec<bool>,
    /// The largest value or range, by which all are divided.
    pub(super) unit: f64,
    /// Worth of each cell's whole range.
    ranges: Vec<f64>,
}

impl NodeRelaxation {
    /// Without rows; a few tangents of each gain.
    pub(super) fn new(program: &Program) -> Self {
        let range = |cell: &Cell| {
            f64_from_i64(cell.gain.at(cell.most()) - cell.gain.at(cell.base)).max(1.0)
        };
        let ranges: Vec<f64> = program.cells.iter().map(range).collect();
        let values = program.values.iter().map(|&value| f64_from_i64(value));
        let unit = values.clone().map(f64::abs).chain(ranges.iter().copied()).fold(1.0, f64::max);
        let costs: Vec<f64> = values.chain(ranges.iter().copied()).map(|it| it / unit).collect();
        let upper = vec![1.0; costs.len()];
        let mut relaxation = Self {
            simplex: Simplex::new(costs, upper),
            lines: Vec::new(),
            present: vec![false; program.rows.len()],
            unit,
            ranges,
        };
        for (cell, it) in program.cells.iter().enumerate() {
            let (base, most) = (f64_from_i64(it.base), f64_from_i64(it.most()));
            let places = match it.gain {
                Gain::Shortfall { .. } => 1,
                Gain::Log { .. } => FIRST_TANGENTS,
            };
            for place in 0..places {
                let sum = base + (most - base) * f64::from(place * place) / 25.0;
                relaxation.tangent(program, cell, sum);
            }
        }
        relaxation
    }

    /// Sets the bounds of a choice to what is open about it.
    pub(super) fn bind(&mut self, choice: usize, open: Choice) {
        let (lower, upper) = match open {
            Choice::Free => (0.0, 1.0),
            Choice::Always => (1.0, 1.0),
            Choice::Never => (0.0, 0.0),
        };
        self.simplex.lower[choice] = lower;
        self.simplex.upper[choice] = upper;
    }

    /// Shares of the first `count` variables, the choices.
    pub(super) fn shares(&self, count: usize) -> Vec<f64> {
        (0..count).map(|it| self.simplex.share(it).clamp(0.0, 1.0)).collect()
    }

    /// Dual prices of the programme's rows and slopes of its cells.
    pub(super) fn prices(&self, program: &Program) -> Prices {
        let mut rows = vec![0.0; program.rows.len()];
        let mut slopes = vec![0.0; program.cells.len()];
        for (line, kind) in self.lines.iter().enumerate() {
            let price = self.simplex.price(line);
            match *kind {
                Line::Row(row, size) => rows[row] += price * self.unit / size,
                Line::Tangent(cell, slope) => {
                    slopes[cell] += price * self.unit / self.ranges[cell] * slope;
                }
            }
        }
        Prices::new(program, rows.into_iter(), slopes.into_iter())
    }

    /// Whether integers confirm that a row of the tableau shows the node to be infeasible.
    pub(super) fn is_impossible(&self, program: &Program, tableau_row: usize) -> bool {
        let ray = self.simplex.ray(tableau_row);
        let mut rows = vec![0.0; program.rows.len()];
        for (kind, multiplier) in self.lines.iter().zip(ray) {
            if let Line::Row(row, size) = *kind {
                rows[row] += multiplier / size;
            }
        }
        // Scaled so that the integers resolve it.
        let largest = rows.iter().copied().fold(0.0, f64::max);
        let scaled = rows.into_iter().map(|it| it / largest.max(1e-300) * UNIT);
        let prices = Prices::new(program, scaled, std::iter::empty());
        impossible(program, &prices.rows)
    }

    /// Adds rows and tangents that the shares violate; false where there are none.
    pub(super) fn add_broken(&mut self, program: &Program, shares: &[f64]) -> bool {
        let mut broken: Vec<(f64, usize)> = Vec::new();
        for (index, row) in program.rows.iter().enumerate() {
            if self.present[index] {
                continue;
            }
            let used: f64 = row.terms.iter().map(|it| shares[it.0] * f64_from_i64(it.1)).sum();
            let by = (used - f64_from_i64(row.limit)) / size(row);
            if by > BROKEN {
                broken.push((by, index));
            }
        }
        broken.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        broken.truncate(AT_ONCE);
        for &(_, index) in &broken {
            self.enter(program, index);
        }
        let mut found = !broken.is_empty();
        for (cell, it) in program.cells.iter().enumerate() {
            let sum = f64_from_i64(it.base)
                + it.terms.iter().map(|it| shares[it.0] * f64_from_i64(it.1)).sum::<f64>();
            if let Gain::Log { scale, offset } = it.gain {
                let ln = |sum: f64| (sum / f64_from_i64(offset)).ln_1p();
                let worth = f64_from_i64(scale) * (ln(sum) - ln(f64_from_i64(it.base)));
                let range = self.ranges[cell];
                let claimed = self.simplex.share(program.values.len() + cell) * range;
                if claimed > worth + EXCEEDED * range && self.lines.len() < MOST_LINES {
                    self.tangent(program, cell, sum);
                    found = true;
                }
            }
        }
        found
    }

    /// Enters all rows of the programme from `first` on.
    pub(super) fn enter_from(&mut self, program: &Program, first: usize) {
        self.present.resize(program.rows.len(), false);
        for index in first..program.rows.len() {
            self.enter(program, index);
        }
    }

    /// Puts a row into the relaxation.
    fn enter(&mut self, program: &Program, index: usize) {
        let row = &program.rows[index];
        let size = size(row);
        let terms = row.terms.iter().map(|it| (it.0, f64_from_i64(it.1) / size)).collect();
        self.simplex.add(terms, f64_from_i64(row.limit) / size);
        self.lines.push(Line::Row(index, size));
        self.present[index] = true;
    }

    /// Puts the tangent of a cell's gain at a sum into the relaxation.
    fn tangent(&mut self, program: &Program, cell: usize, sum: f64) {
        let (it, range) = (&program.cells[cell], self.ranges[cell]);
        let slope = it.gain.slope(sum);
        let base = f64_from_i64(it.base);
        let worth = match it.gain {
            Gain::Shortfall { price, wanted } => {
                f64_from_i64(price)
                    * (sum.min(f64_from_i64(wanted)) - base.min(f64_from_i64(wanted)))
            }
            Gain::Log { scale, offset } => {
                let ln = |sum: f64| (sum / f64_from_i64(offset)).ln_1p();
                f64_from_i64(scale) * (ln(sum) - ln(base))
            }
        };
        let column = program.values.len() + cell;
        let mut terms: Vec<(usize, f64)> =
            it.terms.iter().map(|it| (it.0, -slope * f64_from_i64(it.1) / range)).collect();
        terms.push((column, 1.0));
        self.simplex.add(terms, (worth + slope * (base - sum)) / range);
        self.lines.push(Line::Tangent(cell, slope));
    }
}

/// What a row is divided by.
fn size(row: &Row) -> f64 {
    row.terms.iter().map(|it| f64_from_i64(it.1.abs())).fold(1.0, f64::max)
}
