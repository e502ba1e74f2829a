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

use super::gain::FRACTION_BITS;
use super::number::i64_from_i128;
use super::problem::Program;
use super::relaxation::Relaxed;

/// What is left of a programme when some rows and all gains are dualised.
#[derive(Debug)]
pub(crate) struct Charged {
    /// Worth of the dualised rows and gains, units.
    pub(crate) constant: i128,
    /// Reduced value of each choice, units.
    pub(crate) values: Vec<i64>,
}

/// Dualises the rows from `first` on, and all gains.
pub(crate) fn charged(program: &Program, relaxed: &Relaxed, first: usize) -> Charged {
    let mut values: Vec<i128> =
        program.values.iter().map(|&value| i128::from(value) << FRACTION_BITS).collect();
    let mut fine = 0_i128;
    let rows = program.rows.iter().zip(&relaxed.prices.rows).skip(first);
    for (row, &z) in rows.filter(|it| *it.1 > 0) {
        fine += z * i128::from(row.limit);
        for &(choice, coefficient) in &row.terms {
            values[choice] -= z * i128::from(coefficient);
        }
    }
    for (cell, &slope) in program.cells.iter().zip(&relaxed.prices.slopes) {
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
