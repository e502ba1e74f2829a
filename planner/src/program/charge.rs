//! Some rows and all gains dualised: the Lagrangian relaxation that a search without them maximises.
//!
//! For prices z >= 0 of some rows and slopes g >= 0 of the cells, every set that meets these rows is
//! worth at most
//!
//! `b . z + sum_c reserve_c(g_c) + sum_i (v_i + (W^T g)_i - (A^T z)_i) x_i`,
//!
//! as in `bound.rs`. Whoever bounds the last sum under the other rows bounds the whole.
//!
//! Limits: sums are exact; the constant and the reduced value of each choice are rounded up to whole
//! units, so the bound stays one.

use super::bound::Prices;
use super::gain::FRACTION_BITS;
use super::number::i64_from_i128;
use super::problem::Program;

/// What is left of a programme when some rows and all gains are dualised.
#[derive(Debug)]
pub(crate) struct Charged {
    /// Worth of the dualised rows and gains, units.
    pub(crate) constant: i128,
    /// Reduced value of each choice, units.
    pub(crate) values: Vec<i64>,
}

/// Which rows and cells are dualised: the rows from one on, the cells before one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dualised {
    pub(crate) rows_from: usize,
    pub(crate) cells_until: usize,
}

/// Dualises rows and gains at prices and slopes in units.
pub(crate) fn charged(
    program: &Program,
    (rows, slopes): (&[f64], &[f64]),
    which: Dualised,
) -> Charged {
    let prices = Prices::new(program, rows.iter().copied(), slopes.iter().copied());
    let mut values: Vec<i128> =
        program.values.iter().map(|&value| i128::from(value) << FRACTION_BITS).collect();
    let mut fine = 0_i128;
    let rows = program.rows.iter().zip(&prices.rows).skip(which.rows_from);
    for (row, &z) in rows.filter(|it| *it.1 > 0) {
        fine += z * i128::from(row.limit);
        for &(choice, coefficient) in &row.terms {
            values[choice] -= z * i128::from(coefficient);
        }
    }
    for (cell, &slope) in program.cells.iter().zip(&prices.slopes).take(which.cells_until) {
        fine += cell.gain.reserve(cell.base, program.most_open(cell), slope);
        for &(choice, adds) in &cell.terms {
            values[choice] += slope * i128::from(adds);
        }
    }
    let up = |fine: i128| -(-fine >> FRACTION_BITS);
    Charged {
        constant: up(fine),
        values: values.into_iter().map(|it| i64_from_i128(up(it))).collect(),
    }
}

/// What a set is worth, in units.
pub(crate) fn worth_of(program: &Program, taken: &[usize]) -> i128 {
    let mut stands = vec![false; program.values.len()];
    for &choice in taken {
        stands[choice] = true;
    }
    let values: i128 = taken.iter().map(|&choice| i128::from(program.values[choice])).sum();
    let cells = program.cells.iter().map(|cell| {
        let added: i64 = cell.terms.iter().filter(|it| stands[it.0]).map(|it| it.1).sum();
        i128::from(cell.gain.at(cell.base + added) - cell.gain.at(cell.base))
    });
    values + cells.sum::<i128>()
}
