//! The relaxation sharpened by the rows of families that it violates: cutting planes in rounds.
//!
//! Method: solve, separate, add, and again, each round told the shares of the one before.
//!
//! Limits: a count of rounds; [`grow`] also ends where a round hardly lowers the bound.

use super::bound::priced;
use super::family::Family;
use super::problem::{Program, Row};
use super::relaxation::{self, Relaxed};

/// The relaxation of a programme, to be handed on to the search; `None` where there is none. Shares
/// known from elsewhere say which choices matter.
pub(crate) fn relax(program: &Program, known: &[f64]) -> Option<Relaxed> {
    program.validate().ok()?;
    relaxation::solve(program, known)
}

/// The relaxation's worth in units and the share of each choice, after some rounds of the families'
/// rows; `None` where the solver fails.
pub(crate) fn relaxed_shares(
    program: &Program,
    families: &[&dyn Family],
    rounds: usize,
) -> Option<(i128, Vec<f64>)> {
    program.validate().ok()?;
    let mut grown = program.clone();
    let mut shares = vec![0.0; program.values.len()];
    for round in 0..=rounds {
        let found = relaxation::solve(&grown, &shares)?;
        shares = found.shares;
        let cuts: Vec<Row> = families.iter().flat_map(|family| family.separate(&shares)).collect();
        if cuts.is_empty() || round == rounds {
            return Some((priced(&grown, &found.prices).bound, shares));
        }
        grown.rows.extend(cuts);
    }
    None
}

/// Adds rows of families that the relaxation violates, until there are none or they hardly lower the
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
        let bound = priced(program, &relaxed.prices).bound;
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
