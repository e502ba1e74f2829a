//! Sessions split by days, so that each day is searched alone: a Lagrangian decomposition.
//!
//! A session that touches several cells is split: in each cell but the one it starts in it earns
//! some amount, and where it starts it earns the rest of its value less the price of its start's
//! windows. The amounts are the multipliers of "both cells take the session or neither does", the prices
//! those of the windows. Whatever they are, a schedule earns the same in sum, and no more in each cell
//! than the best set of that cell alone. So the sum over cells of the best sets, plus the worth of the
//! windows, bounds every schedule.
//!
//! Method: the amounts start at what the session pays for its time in the cell at the relaxation's
//! prices, which makes the bound at most the one of `bound.rs`. Amounts are integers, so rounding does
//! not enter.
//!
//! Limits: a cell's search is cut at [`NODES`] nodes and then bounded by what it did not visit.

use super::bound::cell_worth;
use super::search::{Effort, Found, Item, Region, search};
use crate::schedule::model::Model;
use crate::schedule::price::Prices;

/// Most nodes of one cell's search.
const NODES: usize = 16_000;

/// A session in one of its cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub(super) cell: usize,
    /// Time in the cell.
    pub(super) ns: i64,
    /// What it pays for its time in the cell.
    paid: i64,
    /// What it earns in the cell.
    pub(super) earns: i64,
}

/// All sessions split by cells.
#[derive(Debug, Clone)]
pub(super) struct Split<'a> {
    pub(super) model: &'a Model,
    pub(super) prices: Prices,
    /// `parts[first[id]..first[id + 1]]` belong to session id, the cell it starts in first.
    pub(super) first: Vec<usize>,
    pub(super) parts: Vec<Part>,
    /// Sessions that touch each cell, and the index of their part there.
    touching: Vec<Vec<(usize, usize)>>,
}

/// The best set of one cell.
#[derive(Debug, Clone, Default)]
pub(super) struct Best {
    /// No set of the cell is worth more.
    pub(super) bound: i64,
    /// The set, as session indices.
    pub(super) ids: Vec<usize>,
}

impl<'a> Split<'a> {
    /// Splits by prices.
    pub(super) fn new(model: &'a Model, prices: &Prices) -> Self {
        let (mut first, mut parts) = (vec![0], Vec::new());
        let mut touching = vec![Vec::new(); model.cell_count()];
        for (id, session) in model.sessions.iter().enumerate() {
            for (cell, ns) in model.shares(session) {
                let paid = prices.in_cell(model, session, cell, ns);
                touching[cell].push((id, parts.len()));
                parts.push(Part { cell, ns, paid, earns: paid });
            }
            first.push(parts.len());
        }
        let mut split = Self { model, prices: prices.clone(), first, parts, touching };
        split.settle(&mut vec![false; model.cell_count()]);
        split
    }

    /// The parts of a session, the cell it starts in first.
    pub(super) fn parts(&self, id: usize) -> &[Part] {
        &self.parts[self.first[id]..self.first[id + 1]]
    }

    /// Sets what each session earns where it starts, and marks the cells where that changes.
    pub(super) fn settle(&mut self, changed: &mut [bool]) {
        for (id, session) in self.model.sessions.iter().enumerate() {
            let parts = &mut self.parts[self.first[id]..self.first[id + 1]];
            let Some((start, rest)) = parts.split_first_mut() else { continue };
            let elsewhere: i64 = rest.iter().map(|part| part.earns).sum();
            let windows = self.prices.for_start(self.model, session.start);
            let earns = session.value - windows - elsewhere;
            if earns != start.earns {
                start.earns = earns;
                changed[start.cell] = true;
            }
        }
    }

    /// The best set of one cell; `known` is a set that can stand there.
    pub(super) fn best(&self, cell: usize, known: &[usize]) -> Best {
        let model = self.model;
        let items: Vec<Item> = self.touching[cell]
            .iter()
            .map(|&(id, part)| {
                let Part { earns, paid, .. } = self.parts[part];
                Item { id, value: earns, reduced: earns - paid }
            })
            .collect();
        let (from, until) = (model.cells[cell], model.cells[cell + 1]);
        let instants: i64 = self.prices.lanes.iter().map(|lane| lane.sum(from, until)).sum();
        let worth = instants + cell_worth(model, &self.prices, cell);
        let priced = worth + items.iter().map(|item| item.reduced.max(0)).sum::<i64>();
        let region = Region {
            model,
            items,
            worth,
            cells: cell..cell + 1,
            left: model.day_limit.into_iter().collect(),
            filled: 1,
            starts: Vec::new(),
            from,
        };
        let earns = |&id: &usize| {
            self.parts(id).iter().find(|part| part.cell == cell).map_or(0, |part| part.earns)
        };
        let known_value = known.iter().map(earns).sum::<i64>().max(0);
        let Found { sets, bound } = search(&region, known_value, Effort { nodes: NODES, sets: 1 });
        let ids = match sets.into_iter().next() {
            Some((_, ids)) => ids,
            None if known_value > 0 => known.to_vec(),
            None => Vec::new(),
        };
        Best { bound: bound.min(priced), ids }
    }
}
