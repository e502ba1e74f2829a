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
//! agree on taking it, and every window's price so that its starts meet the limit: a subgradient
//! method with a step per amount that grows while the sign stays and halves when it turns (Riedmiller
//! and Braun 1993, Rprop). Only cells whose amounts changed are searched again. Amounts are integers,
//! so rounding does not enter.
//!
//! Limits: [`ROUNDS`] rounds, fewer for more than three years of days; a cell's search is cut at [`NODES`] nodes and then bounded by what it
//! did not visit.

use super::bound::{cell_worth, windows_worth};
use super::model::Model;
use super::price::{Ladder, Prices};
use super::search::{Effort, Found, Item, Region, search};
use crate::program::number::{f64_from_i64, i64_from_f64, i64_from_usize};
use rayon::prelude::*;
use std::cmp::Reverse;

/// Most rounds.
const ROUNDS: usize = 100;
/// Cells times rounds are at most this, so that long missions take seconds.
const SEARCHES: usize = 120_000;
/// Rounds that even the longest mission gets.
const FEWEST_ROUNDS: usize = 4;
/// Most nodes of one cell's search.
const NODES: usize = 4_000;
/// First step of an amount, and of a window's price, over the mean value of a relaxed session.
const FIRST_STEP: (f64, f64) = (0.12, 0.012);
/// A step grows by this factor while its sign stays, and shrinks by the other when it turns.
const STEP_FACTORS: (f64, f64) = (1.3, 0.5);

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
#[derive(Debug)]
pub(super) struct Split<'a> {
    pub(super) model: &'a Model,
    prices: Prices,
    /// `parts[first[id]..first[id + 1]]` belong to session id, the cell it starts in first.
    first: Vec<usize>,
    parts: Vec<Part>,
    /// Sessions that touch each cell, and the index of their part there.
    touching: Vec<Vec<(usize, usize)>>,
}

/// A bound, and the sets of sessions that cells found best on the way.
#[derive(Debug)]
pub(super) struct Sharpened<'a> {
    pub(super) split: Split<'a>,
    /// No schedule is worth more, in units.
    pub(super) bound: i128,
    /// Per cell, different sets of sessions that start in it, the most valuable session first.
    pub(super) patterns: Vec<Vec<Vec<usize>>>,
}

/// The best set of one cell.
#[derive(Debug, Clone, Default)]
struct Best {
    bound: i64,
    ids: Vec<usize>,
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
    fn settle(&mut self, changed: &mut [bool]) {
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
    scale: f64,
    enough: i128,
) -> Sharpened<'a> {
    let mut split = Split::new(model, prices);
    let cells = model.cell_count();
    let mut changed = vec![true; cells];
    let mut bests = vec![Best::default(); cells];
    let mut patterns: Vec<Vec<Vec<usize>>> = vec![Vec::new(); cells];
    let mut steps = Steps::new(&split, scale);
    let mut bound = i128::MAX;
    let rounds = ROUNDS.min(SEARCHES / model.cell_count().max(1)).max(FEWEST_ROUNDS);
    for _ in 0..rounds {
        bests = (0..cells)
            .into_par_iter()
            .map(|cell| {
                let before = &bests[cell];
                if changed[cell] { split.best(cell, &before.ids) } else { before.clone() }
            })
            .collect();
        changed.fill(false);
        let sum: i128 = bests.iter().map(|best| i128::from(best.bound)).sum();
        bound = bound.min(sum + windows_worth(model, &split.prices));
        for (cell, best) in bests.iter().enumerate() {
            let starts_here = |id: &usize| split.parts(*id)[0].cell == cell;
            let mut pattern: Vec<usize> = best.ids.iter().copied().filter(starts_here).collect();
            pattern.sort_unstable_by_key(|&id| (Reverse(model.sessions[id].value), id));
            if !pattern.is_empty() && !patterns[cell].contains(&pattern) {
                patterns[cell].push(pattern);
            }
        }
        if bound <= enough {
            break;
        }
        steps.take(&mut split, &bests, &mut changed);
    }
    Sharpened { split, bound, patterns }
}

/// How one number is moved.
#[derive(Debug, Clone, Copy)]
struct Step {
    size: f64,
    /// Sign of the move before, 0 at first.
    sign: f64,
}

impl Step {
    /// The move along a slope that is not zero.
    fn along(&mut self, slope: f64) -> f64 {
        let sign = slope.signum();
        if self.sign * sign > 0.0 {
            self.size *= STEP_FACTORS.0;
        } else if self.sign * sign < 0.0 {
            self.size *= STEP_FACTORS.1;
        }
        self.sign = sign;
        self.size * slope
    }
}

#[derive(Debug)]
struct Steps {
    /// Per part; that of a session's first part is not used.
    parts: Vec<Step>,
    /// First instant, price and step of each priced window.
    windows: Vec<(i64, f64, Step)>,
    /// Largest step of a window whose price is zero.
    idle: f64,
}

impl Steps {
    fn new(split: &Split<'_>, scale: f64) -> Self {
        let idle = FIRST_STEP.1 * scale;
        let part = Step { size: FIRST_STEP.0 * scale, sign: 0.0 };
        let windows = split.prices.windows.points();
        Self {
            parts: vec![part; split.parts.len()],
            windows: windows
                .map(|(at, price)| (at, f64_from_i64(price), Step { size: idle, sign: 0.0 }))
                .collect(),
            idle,
        }
    }

    /// Moves amounts and prices towards agreement, and marks the cells where something changed.
    fn take(&mut self, split: &mut Split<'_>, bests: &[Best], changed: &mut [bool]) {
        let model = split.model;
        let mut taken = vec![false; split.parts.len()];
        for (cell, best) in bests.iter().enumerate() {
            for &id in &best.ids {
                let parts = split.first[id]..split.first[id + 1];
                for part in parts.filter(|&part| split.parts[part].cell == cell) {
                    taken[part] = true;
                }
            }
        }
        let mut starts = Vec::new();
        for (id, session) in model.sessions.iter().enumerate() {
            let start = split.first[id];
            if taken[start] {
                starts.push(session.start);
            }
            for part in start + 1..split.first[id + 1] {
                if taken[part] != taken[start] {
                    let slope = if taken[start] { 1.0 } else { -1.0 };
                    let moved = i64_from_f64(self.parts[part].along(slope));
                    split.parts[part].earns += moved;
                    changed[split.parts[part].cell] = true;
                }
            }
        }
        if let Some((count, window)) = model.count {
            for (at, price, step) in &mut self.windows {
                let until = at.saturating_add(window);
                let inside = starts.partition_point(|start| *start < until)
                    - starts.partition_point(|start| start < at);
                let over = i64_from_usize(inside) - i64_from_usize(count);
                if over > 0 || (over < 0 && *price > 0.0) {
                    *price = (*price + step.along(f64_from_i64(over))).max(0.0);
                }
                if *price <= 0.0 {
                    step.size = step.size.min(self.idle);
                }
            }
            split.prices.windows = Ladder::new(self.windows.iter().map(|it| (it.0, it.1)));
        }
        split.settle(changed);
    }
}
