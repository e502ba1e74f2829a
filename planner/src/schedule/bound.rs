//! No schedule is worth more than this.
//!
//! Method: for prices z >= 0 of inequalities `A x <= b` that every schedule meets, no schedule is
//! worth more than `b . z + sum_i max(0, w_i - (A^T z)_i)`. Everything is an integer number of
//! units: values are rounded up, what a session pays is rounded down and what capacity is worth is
//! rounded up, so rounding can only raise the bound, and no property of the solver matters.
//!
//! The bound is then sharpened cell by cell. A session that touches several cells earns in every
//! cell but the one it starts in what it pays there, and the rest where it starts; the shares sum to
//! its value less the price of its start's windows. So the sum over cells of the best set in each
//! cell alone, plus the worth of the windows, bounds every schedule, and each term is at most the
//! cell's part of the first bound.
//!
//! Limits: a cell's search is cut at [`NODES`] nodes and is then bounded by what was not visited.

use super::model::Model;
use super::price::Prices;
use super::search::{Item, Region, search};
use rayon::prelude::*;

/// Most nodes of one cell's search.
const NODES: usize = 2_000;

/// `b . z + sum_i max(0, w_i - (A^T z)_i)` in units.
pub(super) fn priced(model: &Model, prices: &Prices) -> i128 {
    let cells: i128 =
        (0..model.cell_count()).map(|cell| i128::from(cell_worth(model, prices, cell))).sum();
    let instants: i128 = prices.lanes.iter().map(|lane| i128::from(lane.total())).sum();
    let surplus: i128 = model
        .sessions
        .iter()
        .map(|session| i128::from((session.value - prices.of(model, session)).max(0)))
        .sum();
    cells + instants + windows_worth(model, prices) + surplus
}

/// The bound sharpened cell by cell, in units.
pub(super) fn searched(model: &Model, prices: &Prices) -> i128 {
    let touching = touching(model);
    let cells: i128 = touching
        .par_iter()
        .enumerate()
        .map(|(cell, ids)| i128::from(cell_bound(model, prices, cell, ids)))
        .collect::<Vec<_>>()
        .into_iter()
        .sum();
    cells + windows_worth(model, prices)
}

/// Sessions that touch each cell.
fn touching(model: &Model) -> Vec<Vec<usize>> {
    let mut touching = vec![Vec::new(); model.cell_count()];
    for (id, session) in model.sessions.iter().enumerate() {
        for (cell, _) in model.shares(session) {
            touching[cell].push(id);
        }
    }
    touching
}

fn cell_bound(model: &Model, prices: &Prices, cell: usize, ids: &[usize]) -> i64 {
    let (from, until) = (model.cells[cell], model.cells[cell + 1]);
    let items: Vec<Item> = ids
        .iter()
        .map(|&id| {
            let session = &model.sessions[id];
            let (mut here, mut elsewhere) = (0, prices.for_start(model, session.start));
            for (other, ns) in model.shares(session) {
                let paid = prices.in_cell(model, session, other, ns);
                if other == cell {
                    here = paid;
                } else {
                    elsewhere += paid;
                }
            }
            let value = if session.start >= from { session.value - elsewhere } else { here };
            Item { id, value, reduced: value - here }
        })
        .collect();
    let instants: i64 = prices.lanes.iter().map(|lane| lane.sum(from, until)).sum();
    let worth = instants + cell_worth(model, prices, cell);
    let root = worth + items.iter().map(|item| item.reduced.max(0)).sum::<i64>();
    let region = Region {
        model,
        items,
        worth,
        cells: cell..cell + 1,
        left: model.day_limit.into_iter().collect(),
        starts: Vec::new(),
        from,
    };
    search(&region, 0, NODES).bound.min(root)
}

fn cell_worth(model: &Model, prices: &Prices, cell: usize) -> i64 {
    model.day_limit.map_or(0, |limit| prices.cell_worth(cell, limit))
}

fn windows_worth(model: &Model, prices: &Prices) -> i128 {
    let count = model.count.map_or(0, |(count, _)| i128::try_from(count).unwrap_or(i128::MAX));
    count * i128::from(prices.windows.total())
}
