//! The best sets among a few sessions, and a bound on them, by depth-first branch and bound.
//!
//! A **region** is a set of sessions that may be added to what already stands, with what the rules
//! leave for them. The search walks over sets of sessions that stand together, one session added per
//! node, and keeps for each node the sessions that may still be added.
//!
//! Method: those that reach in from before first, then the most valuable (by reduced value where no day
//! limit makes time short). A branch is pruned where one of two bounds shows that it holds nothing
//! better: weak duality (worth of the capacity, plus the reduced values taken, plus the positive ones
//! that remain), or the knapsack of the time and places left over sessions not yet looked at, overlap
//! ignored (`knapsack.rs`). Sets of sessions are bits, one set per depth, so that a node allocates
//! nothing.
//!
//! Limits: at most [`Effort::nodes`] nodes; the bound returned then covers what was not visited.

use super::bits::Bits;
use super::knapsack::{Kind, Knapsack, Piece, promising};
use super::starts::{crowded, start_fits};
use crate::schedule::model::{Model, Session};
use std::cmp::Reverse;
use std::ops::Range;

/// A session that may be added.
#[derive(Debug, Clone, Copy)]
pub(super) struct Item {
    /// Index in the model.
    pub(super) id: usize,
    /// What adding it brings, in units.
    pub(super) value: i64,
    /// The same less what it pays.
    pub(super) reduced: i64,
}

/// What may be added, and what is left for it.
#[derive(Debug)]
pub(super) struct Region<'a> {
    pub(super) model: &'a Model,
    pub(super) items: Vec<Item>,
    /// Price of all the capacity that the items could use, in units.
    pub(super) worth: i64,
    /// Cells whose limits count.
    pub(super) cells: Range<usize>,
    /// Time left in each of these cells, ns; empty without a day limit.
    pub(super) left: Vec<i64>,
    /// How many of these cells, from the first, the knapsack counts as one.
    pub(super) filled: usize,
    /// Starts that already stand and may share a window with an item, ascending.
    pub(super) starts: Vec<i64>,
    /// Where the region begins: items that start earlier all hold this instant reserved.
    pub(super) from: i64,
}

/// How much work a search may do, and what for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effort {
    /// Most nodes.
    pub(super) nodes: usize,
    /// Number of sets wanted, at least one.
    pub(super) sets: usize,
}

/// What a search found.
#[derive(Debug, Clone)]
pub(super) struct Found {
    /// The best sets by value in units, as indices in the model; empty where none is better than
    /// asked for.
    pub(super) sets: Vec<(i64, Vec<usize>)>,
    /// No set is worth more, or the value asked for is not exceeded by any.
    pub(super) bound: i64,
}

/// An item with all that the search asks of it.
#[derive(Debug, Clone, Copy)]
struct Choice {
    session: Session,
    item: Item,
    kind: Kind,
    /// Time in the cells that the knapsack counts, ns.
    time: i64,
    /// Where its time in all cells stands in [`Walk::parts`].
    parts: (usize, usize),
}

#[derive(Debug)]
struct Walk<'a> {
    region: &'a Region<'a>,
    effort: Effort,
    choices: Vec<Choice>,
    /// (cell of the region, ns) of all choices.
    parts: Vec<(usize, i64)>,
    knapsack: Knapsack,
    left: Vec<i64>,
    starts: Vec<i64>,
    /// For each choice, those after it that may stand together with it.
    together: Bits,
    /// For each depth, the choices that may still be added.
    open: Bits,
    /// For each depth and each open choice there, what prices say.
    by_price: Vec<i64>,
    /// Most counted choices that may still be added.
    places: usize,
    path: Vec<usize>,
    sets: Vec<(i64, Vec<usize>)>,
    /// Only sets worth more are wanted.
    threshold: i64,
    /// Largest bound of a branch that was not visited.
    unvisited: i64,
}

/// The best sets of items worth more than `at_least`, and a bound on all sets.
pub(super) fn search(region: &Region<'_>, at_least: i64, effort: Effort) -> Found {
    let places = region.model.count.map_or(usize::MAX, |(count, window)| {
        let until = region.from.saturating_add(window);
        let stand = region.starts.iter().filter(|start| (region.from..until).contains(*start));
        count.saturating_sub(stand.count())
    });
    let mut parts = Vec::new();
    let useful = region.items.iter().filter(|item| item.value > 0);
    let choices: Vec<_> = useful.map(|&item| choice(region, item, &mut parts)).collect();
    let mut walk = Walk {
        region,
        effort,
        choices,
        parts,
        knapsack: Knapsack::default(),
        left: region.left.clone(),
        starts: region.starts.clone(),
        together: Bits::default(),
        open: Bits::default(),
        by_price: Vec::new(),
        places,
        path: Vec::new(),
        sets: Vec::new(),
        threshold: at_least,
        unvisited: at_least,
    };
    walk.prepare();
    walk.visit(0, 0, region.worth);
    let best = walk.sets.first().map_or(at_least, |set| set.0);
    Found { bound: best.max(walk.unvisited), sets: walk.sets }
}

fn choice(region: &Region<'_>, item: Item, parts: &mut Vec<(usize, i64)>) -> Choice {
    let session = region.model.sessions[item.id];
    let first = parts.len();
    if !region.left.is_empty() {
        let inside = region.model.shares(&session);
        parts.extend(
            inside
                .filter(|(cell, _)| region.cells.contains(cell))
                .map(|(cell, ns)| (cell - region.cells.start, ns)),
        );
    }
    let filled = parts[first..].iter().filter(|part| part.0 < region.filled);
    let time: i64 = filled.map(|part| part.1).sum();
    let counted = region
        .model
        .count
        .is_some_and(|(_, window)| session.start < region.from.saturating_add(window));
    let kind = if session.start < region.from {
        if region.model.lanes > 0 { Kind::Head(session.lane) } else { Kind::Free }
    } else if counted {
        Kind::Counted
    } else {
        Kind::Free
    };
    Choice { session, item, kind, time, parts: (first, parts.len()) }
}

impl Walk<'_> {
    /// Leaves out choices that fit nowhere or cannot be part of anything better, and orders the rest.
    fn prepare(&mut self) {
        let mut choices = std::mem::take(&mut self.choices);
        choices.retain(|choice| self.fits(choice));
        let time_left = self.time_left();
        let pieces: Vec<Piece> = choices.iter().map(Choice::piece).collect();
        let mut keep = promising(&pieces, time_left, self.places, self.threshold).into_iter();
        choices.retain(|_| keep.next().unwrap_or(true));
        let limited = time_left.is_some();
        choices.sort_unstable_by_key(|it| {
            let group = if let Kind::Head(lane) = it.kind { lane } else { usize::MAX };
            let first = if limited { it.item.value } else { it.item.reduced };
            (group, Reverse(first), it.time, it.item.id)
        });
        let pieces: Vec<Piece> = choices.iter().map(Choice::piece).collect();
        self.knapsack = Knapsack::new(&pieces, time_left, self.places);
        let model = self.region.model;
        self.together = Bits::sets_of(choices.len());
        for (index, choice) in choices.iter().enumerate() {
            let row = self.together.push();
            for (later, other) in choices.iter().enumerate().skip(index + 1) {
                if !model.clash(&other.session, &choice.session) {
                    self.together.insert(row, later);
                }
            }
        }
        self.open = Bits::sets_of(choices.len());
        let all = self.open.push();
        for index in 0..choices.len() {
            self.open.insert(all, index);
        }
        self.choices = choices;
    }

    /// Time left in the cells that the knapsack counts; `None` where there is no limit.
    fn time_left(&self) -> Option<i64> {
        let filled = self.left.iter().take(self.region.filled);
        (!self.left.is_empty()).then(|| filled.fold(0, |sum: i64, &ns| sum.saturating_add(ns)))
    }

    /// Whether a choice's time and start still fit what is left.
    fn fits(&self, choice: &Choice) -> bool {
        self.has_time(choice)
            && self.region.model.count.is_none_or(|(count, window)| {
                start_fits(&self.starts, choice.session.start, count, window)
            })
    }

    fn has_time(&self, choice: &Choice) -> bool {
        self.parts[choice.parts.0..choice.parts.1].iter().all(|&(cell, ns)| ns <= self.left[cell])
    }

    /// Visits all sets that extend the path by choices that are open at `depth`.
    fn visit(&mut self, depth: usize, value: i64, priced: i64) {
        let time_left = self.time_left();
        let mut next = self.open.first_from(depth, 0);
        let most = next.map_or(0, |first| self.knapsack.most(first, time_left, self.places));
        if value.saturating_add(most) <= self.threshold {
            return;
        }
        self.price(depth);
        while let Some(index) = next {
            next = self.open.first_from(depth, index + 1);
            let choice = self.choices[index];
            let filled = self.knapsack.most(index, time_left, self.places);
            let by_price = self.by_price[depth * self.choices.len() + index];
            let bound = value.saturating_add(filled).min(priced.saturating_add(by_price));
            if bound <= self.threshold {
                // Both bounds fall from place to place, so no later one is better.
                return;
            }
            if self.effort.nodes == 0 {
                self.unvisited = self.unvisited.max(bound);
                return;
            }
            self.effort.nodes -= 1;
            let value = value + choice.item.value;
            self.path.push(choice.item.id);
            self.note(value);
            self.take(&choice, true);
            let most = self.knapsack.most(index + 1, self.time_left(), self.places);
            if value.saturating_add(most) > self.threshold {
                self.open_after(depth, index);
                self.visit(depth + 1, value, priced + choice.item.reduced);
            }
            self.take(&choice, false);
            self.path.pop();
        }
    }

    /// Keeps the path if it is among the best so far.
    fn note(&mut self, value: i64) {
        if value <= self.threshold {
            return;
        }
        let place = self.sets.partition_point(|set| set.0 >= value);
        self.sets.insert(place, (value, self.path.clone()));
        self.sets.truncate(self.effort.sets);
        if let Some(last) = self.sets.get(self.effort.sets - 1) {
            self.threshold = self.threshold.max(last.0);
        }
    }

    /// Opens at the next depth what is open at `depth` and may be added after `taken`, which has just
    /// been put in: what was open fits but for what that changed.
    fn open_after(&mut self, depth: usize, taken: usize) {
        let rest = self.open.meet(depth, (&self.together, taken));
        let (low, high) = match self.region.model.count {
            None => (0, 0),
            Some(limit) => crowded(&self.starts, self.choices[taken].session.start, limit),
        };
        let mut next = self.open.first_from(rest, 0);
        while let Some(index) = next {
            let choice = &self.choices[index];
            let start = choice.session.start;
            if (low < start && start < high) || !self.has_time(choice) {
                self.open.remove(rest, index);
            }
            next = self.open.first_from(rest, index + 1);
        }
    }

    /// For each choice open at `depth`, the most by price that choices from there on can add, at least
    /// one taken.
    fn price(&mut self, depth: usize) {
        let count = self.choices.len();
        if self.by_price.len() < (depth + 1) * count {
            self.by_price.resize((depth + 1) * count, 0);
        }
        let (mut positive, mut dearest) = (0_i64, i64::MIN);
        let mut place = self.open.last_before(depth, count);
        while let Some(index) = place {
            let reduced = self.choices[index].item.reduced;
            positive = positive.saturating_add(reduced.max(0));
            dearest = dearest.max(reduced);
            self.by_price[depth * count + index] = if dearest < 0 { dearest } else { positive };
            place = self.open.last_before(depth, index);
        }
    }

    /// Puts a choice in, or takes it out again.
    fn take(&mut self, choice: &Choice, put_in: bool) {
        for &(cell, ns) in &self.parts[choice.parts.0..choice.parts.1] {
            self.left[cell] += if put_in { -ns } else { ns };
        }
        if self.region.model.count.is_some() {
            let start = choice.session.start;
            let place = self.starts.partition_point(|&other| other < start);
            if put_in {
                self.starts.insert(place, start);
            } else {
                self.starts.remove(place);
            }
        }
        if choice.kind == Kind::Counted {
            self.places = if put_in { self.places - 1 } else { self.places + 1 };
        }
    }
}

impl Choice {
    const fn piece(&self) -> Piece {
        Piece { value: self.item.value, time: self.time, kind: self.kind }
    }
}
