//! A schedule from sets of sessions, one per cell, by beam search from cell to cell.
//!
//! Method: a state is what the next cells can see of the choices made: sessions that reach into them,
//! and the latest starts. [`assemble`] extends each state by every pattern of the cell, without what does
//! not fit, and by the best sets for what the state leaves, found by exact search. States are ranked by
//! what their sessions have earned so far (`split.rs`), which already holds back what a session owes to
//! later cells; of equal states one is kept. [`splice`] uses the patterns of given schedules only, and so
//! looks for their best recombination.
//!
//! Limits: the beam keeps [`STATES`] states, or [`MIXED`] in splicing.

use super::search::{Effort, Item, Region, search};
use super::split::Split;
use super::starts::start_fits;
use crate::program::number::i64_from_f64;
use crate::schedule::draft::Draft;
use crate::schedule::model::Model;
use rayon::prelude::*;

/// Most states kept in assembling, and of them with the same sessions reaching on.
const STATES: (usize, usize) = (192, 8);
/// The same in splicing, where a state has few ways on.
const MIXED: (usize, usize) = (1_024, 64);
/// Work of one search, and sets taken from it.
const EFFORT: Effort = Effort { nodes: 1500, sets: 12 };
/// Sets that are worse than a pattern by this share of a typical value are still of use.
const MARGIN: f64 = 0.2;

/// Choices made up to some cell.
#[derive(Debug, Clone, Default)]
struct State {
    /// What they earned.
    earned: i64,
    /// Sessions that reach on, by id.
    reaching: Vec<usize>,
    /// Reserved ns in the next cells.
    used: Vec<i64>,
    /// Latest starts, ascending, as far as windows reach.
    starts: Vec<i64>,
    /// Index of the state before.
    before: usize,
    /// Sessions added in the last cell.
    added: Vec<usize>,
}

/// A schedule from patterns and searches; `scale` is the typical value of a session in units.
pub(super) fn assemble<'a>(
    split: &Split<'a>,
    patterns: &[Vec<Vec<usize>>],
    scale: f64,
) -> Draft<'a> {
    let margin = i64_from_f64(MARGIN * scale);
    beam(split.model, STATES, |cell, state| {
        let mut next: Vec<State> =
            patterns[cell].iter().map(|pattern| state.extended(split, cell, pattern)).collect();
        next.push(state.extended(split, cell, &[]));
        let base = state.earned + state.credit(split, cell);
        let best = next.iter().map(|it| it.earned - base).max().unwrap_or(0);
        let found = search(&state.region(split, cell), (best - margin).max(0), EFFORT);
        next.extend(found.sets.iter().map(|(_, set)| state.extended(split, cell, set)));
        next
    })
}

/// The best mixture of schedules that the beam finds.
pub(super) fn splice<'a>(split: &Split<'a>, drafts: &[Draft<'_>]) -> Draft<'a> {
    let model = split.model;
    let mut patterns = vec![vec![Vec::new(); drafts.len()]; model.cell_count()];
    for (index, draft) in drafts.iter().enumerate() {
        for id in draft.chosen() {
            patterns[split.parts(id)[0].cell][index].push(id);
        }
    }
    beam(model, MIXED, |cell, state| {
        patterns[cell].iter().map(|pattern| state.extended(split, cell, pattern)).collect()
    })
}

/// The schedule of the state that earned most, states extended cell by cell.
fn beam(
    model: &Model,
    most: (usize, usize),
    extend: impl Fn(usize, &State) -> Vec<State> + Sync,
) -> Draft<'_> {
    let mut layers = vec![vec![State::default()]];
    for cell in 0..model.cell_count() {
        let layer = layers.last().map_or(&[][..], Vec::as_slice);
        let next: Vec<Vec<State>> = layer.par_iter().map(|state| extend(cell, state)).collect();
        let mut next: Vec<State> = next
            .into_iter()
            .enumerate()
            .flat_map(|(before, states)| {
                states.into_iter().map(move |state| State { before, ..state })
            })
            .collect();
        next.sort_by(|a, b| b.earned.cmp(&a.earned).then_with(|| a.added.cmp(&b.added)));
        layers.push(thin(next, most));
    }
    let mut draft = Draft::new(model);
    let mut at = 0;
    for layer in layers.iter().rev() {
        let Some(state) = layer.get(at) else { break };
        for &id in &state.added {
            draft.add(id);
        }
        at = state.before;
    }
    draft
}

/// The states to keep, of states in order.
fn thin(states: Vec<State>, most: (usize, usize)) -> Vec<State> {
    let mut kept: Vec<State> = Vec::with_capacity(most.0);
    for state in states {
        if kept.len() == most.0 {
            break;
        }
        let alike = || kept.iter().filter(|it| it.reaching == state.reaching);
        if alike().count() < most.1 && alike().all(|it| it.starts != state.starts) {
            kept.push(state);
        }
    }
    kept
}

impl State {
    /// What the sessions that reach into a cell earn there.
    fn credit(&self, split: &Split<'_>, cell: usize) -> i64 {
        let parts = self.reaching.iter().flat_map(|&id| split.parts(id));
        parts.filter(|part| part.cell == cell).map(|part| part.earns).sum()
    }

    /// The state after a cell, with what fits of a pattern.
    fn extended(&self, split: &Split<'_>, cell: usize, pattern: &[usize]) -> Self {
        let model = split.model;
        let mut state = self.clone();
        state.added.clear();
        state.earned += self.credit(split, cell);
        for &id in pattern {
            let session = &model.sessions[id];
            let parts = split.parts(id);
            let used = |ahead: usize| state.used.get(ahead).copied().unwrap_or(0);
            let full = model
                .day_limit
                .is_some_and(|limit| parts.iter().any(|it| used(it.cell - cell) + it.ns > limit));
            let clash = |&other: &usize| model.clash(&model.sessions[other], session);
            let crowded = model.count.is_some_and(|(count, window)| {
                !start_fits(&state.starts, session.start, count, window)
            });
            if full || crowded || state.reaching.iter().any(clash) {
                continue;
            }
            for part in parts {
                let ahead = part.cell - cell;
                state.used.resize(state.used.len().max(ahead + 1), 0);
                state.used[ahead] += part.ns;
            }
            let place = state.starts.partition_point(|&start| start < session.start);
            state.starts.insert(place, session.start);
            state.earned += parts[0].earns;
            state.reaching.push(id);
            state.added.push(id);
        }
        state.leave(model, cell);
        state
    }

    /// Forgets what the cells after this one cannot see.
    fn leave(&mut self, model: &Model, cell: usize) {
        let boundary = model.cells[cell + 1];
        self.reaching.retain(|&id| model.sessions[id].end > boundary);
        self.reaching.sort_unstable();
        if !self.used.is_empty() {
            self.used.remove(0);
        }
        let seen = model.count.map_or(0, |(count, window)| {
            let gone = self.starts.partition_point(|&at| at <= boundary.saturating_sub(window));
            count.min(self.starts.len() - gone)
        });
        self.starts.drain(..self.starts.len() - seen);
    }

    /// What may be added in a cell.
    fn region<'a>(&self, split: &Split<'a>, cell: usize) -> Region<'a> {
        let model = split.model;
        let (from, until) = (model.cells[cell], model.cells[cell + 1]);
        let free = |&id: &usize| {
            let session = &model.sessions[id];
            !self.reaching.iter().any(|&other| model.clash(&model.sessions[other], session))
        };
        let items: Vec<Item> = model
            .starting(from, until)
            .filter(free)
            .map(|id| {
                let earns = split.parts(id)[0].earns;
                Item { id, value: earns, reduced: earns }
            })
            .collect();
        let ends = items.iter().filter_map(|item| split.parts(item.id).last());
        let last = ends.map(|part| part.cell).max().unwrap_or(cell);
        let used = |ahead: usize| self.used.get(ahead).copied().unwrap_or(0);
        let left = model
            .day_limit
            .map(|limit| (0..=last - cell).map(|ahead| limit - used(ahead)).collect());
        Region {
            model,
            items,
            worth: 0,
            cells: cell..last + 1,
            left: left.unwrap_or_default(),
            filled: 1,
            starts: self.starts.clone(),
            from,
        }
    }
}
