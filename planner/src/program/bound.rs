//! A bound on every set, from dual prices, in exact arithmetic.
//!
//! For dual prices z >= 0 of the rows and slopes g >= 0 of the cells, every set that meets the rows is
//! worth at most
//!
//! `b . z + sum_c reserve_c(g_c) + sum_i max over open x_i of (v_i + (W^T g)_i - (A^T z)_i) x_i`,
//!
//! since `z . (b - A x) >= 0` and `G_c(s) <= reserve_c(g_c) + g_c s` (`gain.rs`): weak duality, which
//! holds for any z and g, however found. The term of `x_i` is its reduced cost; where the bound less its
//! magnitude is no more than a known value, `x_i` is the same in every better set (reduced-cost fixing).
//!
//! Method: prices and slopes are integers of 2^-32 unit, so nothing is rounded after they are chosen but
//! the last result, down to a whole unit: values of sets are whole.
//!
//! Limits: a price is cut at [`LARGEST_PRICE`] units for a row's largest coefficient; the bound is at
//! best that of the linear relaxation.

use super::gain::{FRACTION_BITS, UNIT};
use super::number::{f64_from_i64, f64_from_i128, i128_from_f64};
use super::problem::{Choice, Program};

/// Largest price of a row's largest coefficient, in units.
const LARGEST_PRICE: f64 = 281_474_976_710_656.0;

/// Prices of rows and slopes of cells, in 2^-32 units.
#[derive(Debug, Clone, Default)]
pub(super) struct Prices {
    pub(super) rows: Vec<i128>,
    pub(super) slopes: Vec<i128>,
}

/// A bound, and what each choice adds to it.
#[derive(Debug)]
pub(super) struct Priced {
    /// No set is worth more, in units.
    pub(super) bound: i128,
    /// The same in 2^-32 units, not yet rounded.
    fine: i128,
    /// Reduced cost of each choice, in 2^-32 units.
    pub(super) reduced: Vec<i128>,
}

impl Prices {
    /// All zero.
    pub(super) fn none(program: &Program) -> Self {
        let slopes =
            program.cells.iter().map(|cell| price(cell.gain.slope(f64_from_i64(cell.base)), 1));
        Self { rows: vec![0; program.rows.len()], slopes: slopes.collect() }
    }

    /// From prices and slopes in units per unit of limit or sum; what is not a price counts as 0.
    pub(super) fn new(
        program: &Program,
        rows: impl Iterator<Item = f64>,
        slopes: impl Iterator<Item = f64>,
    ) -> Self {
        let largest = |terms: &[(usize, i64)]| {
            terms.iter().map(|term| term.1.abs()).max().unwrap_or(1).max(1)
        };
        let rows = rows.zip(&program.rows).map(|(z, row)| price(z, largest(&row.terms)));
        let slopes = slopes.zip(&program.cells).map(|(g, cell)| price(g, largest(&cell.terms)));
        Self { rows: rows.collect(), slopes: slopes.collect() }
    }

    /// Prices of the rows in units.
    pub(super) fn per_unit(&self) -> Vec<f64> {
        self.rows.iter().map(|&z| f64_from_i128(z) / UNIT).collect()
    }

    /// Slopes of the cells in units.
    pub(super) fn slopes_per_unit(&self) -> Vec<f64> {
        self.slopes.iter().map(|&g| f64_from_i128(g) / UNIT).collect()
    }
}

fn price(units: f64, largest: i64) -> i128 {
    let most = LARGEST_PRICE / f64_from_i64(largest);
    i128_from_f64((units.max(0.0).min(most) * UNIT).floor())
}

/// The bound that prices give.
pub(super) fn priced(program: &Program, prices: &Prices) -> Priced {
    let mut reduced: Vec<i128> =
        program.values.iter().map(|&value| i128::from(value) << FRACTION_BITS).collect();
    let mut fine = 0_i128;
    for (row, &z) in program.rows.iter().zip(&prices.rows) {
        if z > 0 {
            fine += z * i128::from(row.limit);
            for &(choice, coefficient) in &row.terms {
                reduced[choice] -= z * i128::from(coefficient);
            }
        }
    }
    for (cell, &slope) in program.cells.iter().zip(&prices.slopes) {
        fine += cell.gain.reserve(cell.base, program.most_open(cell), slope);
        for &(choice, adds) in &cell.terms {
            reduced[choice] += slope * i128::from(adds);
        }
    }
    for (value, choice) in reduced.iter().zip(&program.choices) {
        fine += match choice {
            Choice::Free => (*value).max(0),
            Choice::Always => *value,
            Choice::Never => 0,
        };
    }
    Priced { bound: fine >> FRACTION_BITS, fine, reduced }
}

/// Whether prices prove that no set meets the rows (Farkas): `b . z < min z . A x`.
pub(super) fn impossible(program: &Program, rows: &[i128]) -> bool {
    let mut pays = vec![0_i128; program.values.len()];
    let mut room = 0_i128;
    for (row, &z) in program.rows.iter().zip(rows) {
        if z > 0 {
            room += z * i128::from(row.limit);
            for &(choice, coefficient) in &row.terms {
                pays[choice] += z * i128::from(coefficient);
            }
        }
    }
    let least: i128 = pays
        .iter()
        .zip(&program.choices)
        .map(|(&pays, choice)| match choice {
            Choice::Free => pays.min(0),
            Choice::Always => pays,
            Choice::Never => 0,
        })
        .sum();
    room < least
}

impl Priced {
    /// The value that a choice has in every set worth more than `value`, if there is one.
    pub(super) fn fixed(&self, choice: usize, value: i128) -> Option<bool> {
        let reduced = self.reduced[choice];
        let without = self.fine - reduced.abs();
        ((without >> FRACTION_BITS) <= value && reduced != 0).then_some(reduced > 0)
    }

    /// Notes the value of each choice that is the same in every set worth more than `value`; false
    /// where two notes contradict each other, so that no such set exists.
    pub(super) fn note(&self, value: i128, fixes: &mut [Option<bool>]) -> bool {
        let mut agree = true;
        for (choice, fix) in fixes.iter_mut().enumerate() {
            if let Some(found) = self.fixed(choice, value) {
                agree &= *fix != Some(!found);
                *fix = Some(found);
            }
        }
        agree
    }
}
