//! A bound on every schedule from dual prices: weak duality in integers.
//!
//! Method: for prices z >= 0 of inequalities `A x <= b` that every schedule meets, no schedule is
//! worth more than `b . z + sum_i max(0, w_i - (A^T z)_i)`. Everything is an integer number of
//! units: values are rounded up, what a session pays is rounded down and what capacity is worth is
//! rounded up, so rounding can only raise the bound, and no property of the solver matters.
//!
//! Limits: the bound of the linear relaxation at best; the Lagrangian dual (`lagrangian.rs`) goes below
//! it.

use crate::schedule::model::Model;
use crate::schedule::price::Prices;

/// `b . z + sum_i max(0, w_i - (A^T z)_i)` in units.
pub(super) fn priced(model: &Model, prices: &Prices) -> i128 {
    let cells = 0..model.cell_count();
    let cells: i128 = cells.map(|cell| i128::from(cell_worth(model, prices, cell))).sum();
    let instants: i128 = prices.lanes.iter().map(|lane| i128::from(lane.total())).sum();
    let surplus: i128 = model
        .sessions
        .iter()
        .map(|session| i128::from((session.value - prices.of(model, session)).max(0)))
        .sum();
    cells + instants + windows_worth(model, prices) + surplus
}

/// What the whole limit of a cell is worth.
pub(super) fn cell_worth(model: &Model, prices: &Prices, cell: usize) -> i64 {
    model.day_limit.map_or(0, |limit| prices.cell_worth(cell, limit))
}

/// What the starts that all windows allow are worth.
pub(super) fn windows_worth(model: &Model, prices: &Prices) -> i128 {
    let count = model.count.map_or(0, |(count, _)| i128::try_from(count).unwrap_or(i128::MAX));
    count.saturating_mul(i128::from(prices.windows.total()))
}
