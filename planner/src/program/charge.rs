//! Rows and gains turned into charges on the choices, for a search that does not know them.
//!
//! For prices z >= 0 of some rows and slopes g >= 0 of the cells, every set that meets these rows is
//! worth at most
//!
//! `b . z + sum_c reserve_c(g_c) + sum_i (v_i + (W^T g)_i - (A^T z)_i) x_i`,
//!
//! as in `bound.rs`. Whoever bounds the last sum under the other rows bounds the whole. Sums are exact;
//! the constant and what each choice is worth are rounded up to whole units.

use super::gain::FRACTION_BITS;
use super::number::i64_from_i128;
use super::{Choice, Family, Program, Relaxed, Row, bound, relax};

/// What is left of a programme when some rows and all gains are priced.
#[derive(Debug)]
pub(crate) struct Charged {
    /// Worth of rows and gains, units.
    pub(crate) constant: i128,
    /// What each choice is worth, units.
    pub(crate) values: Vec<i64>,
}

/// Prices the rows from `first` on, and all gains.
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
        let open = cell.terms.iter().filter(|it| program.choices[it.0] != Choice::Never);
        let most = cell.base + open.map(|term| term.1).sum::<i64>();
        fine += cell.gain.reserve(cell.base, most, slope);
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

/// Adds rows of families that the relaxation breaks, until there are none or they hardly lower the
/// bound (by less than 2^-12 of it, `offset` taken off); the last relaxation, and the family of each row
/// added.
pub(crate) fn grow(
    program: &mut Program,
    families: &[&dyn Family],
    (rounds, offset): (usize, i128),
) -> (Option<Relaxed>, Vec<usize>) {
    let mut of = Vec::new();
    let mut last: Option<(Relaxed, i128)> = None;
    let nothing = vec![0.0; program.values.len()];
    for round in 0..=rounds {
        let Some(relaxed) = relax(program, last.as_ref().map_or(&nothing, |it| &it.0.shares))
        else {
            break;
        };
        let bound = bound::priced(program, &relaxed.prices).bound;
        let gained = last.as_ref().map_or(i128::MAX, |it| it.1 - bound);
        let rows: Vec<Vec<Row>> =
            families.iter().map(|family| family.separate(&relaxed.shares)).collect();
        let none = rows.iter().all(Vec::is_empty);
        last = Some((relaxed, bound));
        if none || round == rounds || gained < (bound - offset).abs() >> 12 {
            break;
        }
        for (family, rows) in rows.into_iter().enumerate() {
            of.resize(of.len() + rows.len(), family);
            program.rows.extend(rows);
        }
    }
    (last.map(|it| it.0), of)
}
