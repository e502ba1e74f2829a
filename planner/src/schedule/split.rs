//! A sharper bound than the prices give: the days apart, what joins them priced.
//!
//! A session that touches several cells is split: in each cell but the one it starts in it earns
//! some amount, and where it starts it earns the rest of its value less the price of its start's
//! windows. Whatever the amounts, a schedule earns the same in sum, and no more in each cell than
//! the best set of that cell alone. So the sum over cells of the best sets, plus the worth of the
//! windows, bounds every schedule.
//!
//! Method: the amounts start at what the session pays for its time in the cell, which makes the
//! bound at most the one of `bound.rs`. Then every amount is moved so that both ends of a session
//! agree on taking it, and every window's price so that its starts meet the limit (`descent.rs`).
//! Only cells whose amounts changed are searched again. Amounts are integers, so rounding does not
//! enter.
//!
//! Limits: [`ROUNDS`] rounds, fewer for more than [`SEARCHES`] / [`ROUNDS`] days; a cell's search
//! is cut at [`NODES`] nodes and then bounded by what it did not visit.

use super::bound::{cell_worth, windows_worth};
use super::descent::Descent;
use super::model::Model;
use super::price::Prices;
use super::search::{Effort, Found, Item, Region, search};
use super::{Stop, asked};
use rayon::prelude::*;
use std::cmp::Reverse;

/// Most rounds.
const ROUNDS: usize = 600;
/// Cells times rounds are at most this, so that long missions take seconds.
const SEARCHES: usize = 280_000;
/// Splits kept from rounds so far apart, back from the last, and their number.
const KEPT: (usize, usize) = (15, 3);
/// Rounds that even the longest mission gets.
const FEWEST_ROUNDS: usize = 4;
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

/// A bound, and the sets of sessions that cells found best on the way.
#[derive(Debug)]
pub(super) struct Sharpened<'a> {
    /// Splits by good amounts, the last one last; at least one.
    pub(super) splits: Vec<Split<'a>>,
    /// No schedule is worth more, in units.
    pub(super) bound: i128,
    /// Per cell, different sets of sessions that start in it, the most valuable session first.
    pub(super) patterns: Vec<Vec<Vec<usize>>>,
}

/// The best set of one cell.
#[derive(Debug, Clone, Default)]
pub(super) struct Best {
    bound: i64,
    pub(super) ids: Vec<usize>,
}

impl<'a> Split<'a> {
    /// Splits by prices.
    fn new(model: &'a Model, prices: &Prices) -> Self {
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
    fn best(&self, cell: usize, known: &[usize]) -> Best {
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

/// A bound by splitting; `scale` is the typical value of a session in units. Ends early where the
/// bound comes down to `enough`.
pub(super) fn sharpen<'a>(
    model: &'a Model,
    prices: &Prices,
    (scale, enough): (f64, i128),
    stop: Stop<'_>,
) -> Sharpened<'a> {
    let mut split = Split::new(model, prices);
    let cells = model.cell_count();
    let mut changed = vec![true; cells];
    let mut bests = vec![Best::default(); cells];
    let mut patterns: Vec<Vec<Vec<usize>>> = vec![Vec::new(); cells];
    let mut descent = Descent::new(&split, scale);
    let mut splits = Vec::new();
    let mut bound = i128::MAX;
    let rounds = ROUNDS.min(SEARCHES / model.cell_count().max(1)).max(FEWEST_ROUNDS);
    for round in 1..=rounds {
        bests = (0..cells)
            .into_par_iter()
            .map(|cell| {
                let before = &bests[cell];
                if changed[cell] { split.best(cell, &before.ids) } else { before.clone() }
            })
            .collect();
        changed.fill(false);
        let sum: i128 = bests.iter().map(|best| i128::from(best.bound)).sum();
        let here = sum + windows_worth(model, &split.prices);
        bound = bound.min(here);
        for (cell, best) in bests.iter().enumerate() {
            let starts_here = |id: &usize| split.parts(*id)[0].cell == cell;
            let mut pattern: Vec<usize> = best.ids.iter().copied().filter(starts_here).collect();
            pattern.sort_unstable_by_key(|&id| (Reverse(model.sessions[id].value), id));
            if !pattern.is_empty() && !patterns[cell].contains(&pattern) {
                patterns[cell].push(pattern);
            }
        }
        let left = rounds - round;
        if left.is_multiple_of(KEPT.0) && left / KEPT.0 < KEPT.1 {
            splits.push(split.clone());
        }
        if bound <= enough || asked(stop) {
            break;
        }
        descent.step(&mut split, &bests, here, &mut changed);
    }
    if splits.is_empty() {
        splits.push(split);
    }
    Sharpened { splits, bound, patterns }
}
