//! Dual prices and shares from the continuous relaxation, solved by `crate::conic`.
//!
//! Method: rows are scaled to a largest number of one, values to a largest of one; each value is
//! raised by up to [`TIE`] of itself, by a fixed hash of its position, so that of equally good
//! solutions one is preferred. A logarithm is an exponential cone, whose dual is the cell's slope; a
//! shortfall is two rows. Above [`ALL_AT_ONCE`] choices columns are generated: first the most valuable
//! for the capacity they use, then those of positive reduced cost at the prices found, until what is
//! left out can raise the bound by [`LEFT_OUT`] of it at most. Prices hold for all choices, seen or not.
//!
//! Limits: prices are approximate; nothing relies on them but the quality of bound and set.

use super::bound::{Prices, priced};
use super::gain::{Gain, UNIT};
use super::number::{f64_from_i64, f64_from_i128, f64_from_usize};
use super::problem::{Choice, Program};
use crate::conic::{Cone, Conic, Solution};

/// Largest raise of a value, as a share of it.
const TIE: f64 = 1e-7;
/// Up to so many choices the solver sees all.
const ALL_AT_ONCE: usize = 40_000;
/// Of each so many neighbours the solver sees the best few at first.
const FIRST: (usize, usize) = (48, 12);
/// Most rounds of adding choices.
const ROUNDS: usize = 6;
/// Choices left out may raise the bound by this share.
const LEFT_OUT: f64 = 5e-3;
/// Tolerance up to so many columns, and above the last.
const TOLERANCES: [(usize, f64); 2] = [(3_000, 1e-8), (15_000, 1e-6)];
const LOOSE: f64 = 1e-5;
/// Most iterations of the solver.
const ITERATIONS: u32 = 200;

/// Dual prices, and the share of each choice.
#[derive(Debug, Clone)]
pub(crate) struct Relaxed {
    pub(super) prices: Prices,
    pub(super) shares: Vec<f64>,
}

impl Relaxed {
    /// Prices of the rows and slopes of the cells, in units.
    pub(crate) fn per_unit(&self) -> (Vec<f64>, Vec<f64>) {
        (self.prices.per_unit(), self.prices.slopes_per_unit())
    }
}

/// Prices and shares; `None` where the solver fails. Shares known already say which choices matter.
pub(super) fn solve(program: &Program, known: &[f64]) -> Option<Relaxed> {
    let count = program.values.len();
    let open = |choice: usize| program.choices[choice] != Choice::Never;
    let mut inside: Vec<bool> = (0..count).map(open).collect();
    if count <= ALL_AT_ONCE {
        return solve_over(program, &inside);
    }
    inside = first(program, known);
    let mut found = None;
    for _ in 0..ROUNDS {
        let Some(relaxed) = solve_over(program, &inside) else { break };
        let bound = priced(program, &relaxed.prices);
        let mut missing = 0.0;
        for (choice, (inside, &reduced)) in inside.iter_mut().zip(&bound.reduced).enumerate() {
            if !*inside && open(choice) && reduced > 0 {
                missing += f64_from_i128(reduced) / UNIT;
                *inside = true;
            }
        }
        found = Some(relaxed);
        if missing <= LEFT_OUT * f64_from_i128(bound.bound.abs()) {
            break;
        }
    }
    found
}

/// The choices that the first round sees.
fn first(program: &Program, known: &[f64]) -> Vec<bool> {
    let count = program.values.len();
    let mut uses = vec![0.0; count];
    for row in &program.rows {
        for &(choice, coefficient) in &row.terms {
            uses[choice] += f64_from_i64(coefficient.max(0)) / f64_from_i64(row.limit.max(1));
        }
    }
    let mut worth: Vec<f64> = program.values.iter().map(|&value| f64_from_i64(value)).collect();
    let mut inside = vec![false; count];
    for cell in &program.cells {
        for &(choice, adds) in &cell.terms {
            worth[choice] += f64_from_i64(cell.gain.at(cell.base + adds) - cell.gain.at(cell.base));
        }
        let mut by_sum = cell.terms.clone();
        by_sum.sort_by_key(|&(choice, adds)| (std::cmp::Reverse(adds), choice));
        for &(choice, _) in by_sum.iter().take(FIRST.1) {
            inside[choice] = true;
        }
    }
    let choices: Vec<usize> = (0..count).collect();
    for neighbours in choices.chunks(FIRST.0) {
        let mut order = neighbours.to_vec();
        let density = |choice: usize| worth[choice] / uses[choice].max(1e-9);
        order.sort_by(|&a, &b| density(b).total_cmp(&density(a)).then(a.cmp(&b)));
        for &choice in order.iter().take(FIRST.1) {
            inside[choice] = true;
        }
    }
    for choice in 0..count {
        inside[choice] |= known[choice] > 1e-6 || program.choices[choice] == Choice::Always;
        inside[choice] &= program.choices[choice] != Choice::Never;
    }
    inside
}

/// A number in [0, 1) that belongs to a position.
fn hash(position: usize) -> f64 {
    let golden = 0.618_033_988_749_894_9;
    (f64_from_usize(position) * golden).fract()
}

/// Where a column's coefficients go.
struct Matrix {
    columns: Vec<Vec<(usize, f64)>>,
    right: Vec<f64>,
}

impl Matrix {
    /// Adds a row.
    fn row(&mut self, terms: impl Iterator<Item = (usize, f64)>, right: f64) -> usize {
        let row = self.right.len();
        for (column, coefficient) in terms {
            self.columns[column].push((row, coefficient));
        }
        self.right.push(right);
        row
    }
}

/// Solves with only the choices `inside`.
fn solve_over(program: &Program, inside: &[bool]) -> Option<Relaxed> {
    let count = program.values.len();
    let mut column_of = vec![usize::MAX; count];
    let ids: Vec<usize> = (0..count).filter(|&choice| inside[choice]).collect();
    for (column, &choice) in ids.iter().enumerate() {
        column_of[choice] = column;
    }
    let cell_count = program.cells.len();
    let worth = |choice: usize| f64_from_i64(program.values[choice]);
    let scales = program.cells.iter().map(|cell| match cell.gain {
        Gain::Log { scale, .. } => f64_from_i64(scale),
        Gain::Shortfall { price, wanted } => {
            f64_from_i64(price) * f64_from_i64(wanted.min(cell.most()).max(1))
        }
    });
    let scales: Vec<f64> = scales.collect();
    let unit =
        ids.iter().map(|&id| worth(id).abs()).chain(scales.iter().copied()).fold(1.0, f64::max);
    let mut costs: Vec<f64> =
        ids.iter().map(|&id| -worth(id) * (1.0 + TIE * hash(id)) / unit).collect();
    costs.extend(scales.iter().map(|scale| -scale / unit));
    let width = ids.len() + cell_count;
    let mut matrix = Matrix { columns: vec![Vec::new(); width], right: Vec::new() };
    let inside_terms = |terms: &'_ [(usize, i64)]| -> Vec<(usize, f64)> {
        let seen = terms.iter().filter(|it| inside[it.0]);
        seen.map(|&(choice, a)| (column_of[choice], f64_from_i64(a))).collect()
    };
    // Rows that nothing inside can break stay out.
    let mut row_of = vec![None; program.rows.len()];
    for (index, row) in program.rows.iter().enumerate() {
        let used: i128 = row
            .terms
            .iter()
            .filter(|it| inside[it.0])
            .map(|it| match program.choices[it.0] {
                Choice::Always => i128::from(it.1),
                _ => i128::from(it.1.max(0)),
            })
            .sum();
        if used <= i128::from(row.limit) {
            continue;
        }
        let terms = inside_terms(&row.terms);
        let limit = f64_from_i64(row.limit);
        let size = terms.iter().map(|it| it.1.abs()).fold(limit.abs(), f64::max).max(1.0);
        let divided = terms.into_iter().map(|(column, a)| (column, a / size));
        row_of[index] = Some((matrix.row(divided, limit / size), size));
    }
    // Shares t of a shortfall's worth: t <= (base + sum) / wanted, t <= 1.
    let mut slope_of = vec![None; cell_count];
    for (index, cell) in program.cells.iter().enumerate() {
        let column = ids.len() + index;
        if let Gain::Shortfall { wanted, .. } = cell.gain {
            let wanted = f64_from_i64(wanted.min(cell.most()).max(1));
            let mut terms: Vec<(usize, f64)> =
                inside_terms(&cell.terms).into_iter().map(|(at, w)| (at, -w / wanted)).collect();
            terms.push((column, 1.0));
            let row = matrix.row(terms.into_iter(), f64_from_i64(cell.base) / wanted);
            slope_of[index] = Some((row, wanted));
            matrix.row(std::iter::once((column, 1.0)), 1.0);
        }
    }
    for (column, &id) in ids.iter().enumerate() {
        let least = if program.choices[id] == Choice::Always { -1.0 } else { 0.0 };
        matrix.row(std::iter::once((column, -1.0)), least);
        matrix.row(std::iter::once((column, 1.0)), 1.0);
    }
    let mut cones = vec![Cone::Nonnegative(matrix.right.len())];
    for (index, cell) in program.cells.iter().enumerate() {
        let column = ids.len() + index;
        if let Gain::Log { offset, .. } = cell.gain {
            // exp(t) <= 1 + (base + sum) / offset
            let offset = f64_from_i64(offset);
            matrix.row(std::iter::once((column, -1.0)), 0.0);
            matrix.row(std::iter::empty(), 1.0);
            let terms = inside_terms(&cell.terms);
            let terms = terms.into_iter().map(|(at, w)| (at, -w / offset));
            let row = matrix.row(terms, 1.0 + f64_from_i64(cell.base) / offset);
            slope_of[index] = Some((row, offset));
            cones.push(Cone::Exponential);
        }
    }
    let Matrix { columns, right: limits } = matrix;
    let tolerance = TOLERANCES.iter().find(|it| width <= it.0).map_or(LOOSE, |it| it.1);
    let conic = Conic { columns, costs, limits, cones, tolerance, iterations: ITERATIONS };
    let Solution { primal, dual } = conic.solve()?;
    let rows = row_of.iter().map(|it| it.map_or(0.0, |(row, size)| dual[row] * unit / size));
    let slopes = slope_of.iter().map(|it| it.map_or(0.0, |(row, size)| dual[row] * unit / size));
    let prices = Prices::new(program, rows, slopes);
    let mut shares = vec![0.0; count];
    for (&id, share) in ids.iter().zip(primal) {
        shares[id] = share.clamp(0.0, 1.0);
    }
    Some(Relaxed { prices, shares })
}
