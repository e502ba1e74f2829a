//! The best choice among a few sessions, and a bound on it, by exact search.
//!
//! A **region** is a set of sessions that may be added to what already stands, with what the rules
//! leave for them. The search walks over sets of sessions that stand together, one session added per
//! node, and keeps for each node the sessions that may still be added.
//!
//! Method: depth first; those that reach in from before first, then the most valuable (by value less
//! price where no day limit makes time short). A branch ends where one of two bounds shows that it
//! holds nothing better: the prices (worth of the capacity, plus the reduced values taken, plus the
//! positive ones that remain), or the best filling of the time and places left by sessions not yet
//! looked at, overlap ignored, from a table (`fill.rs`).
//!
//! Limits: at most `nodes` nodes; the bound returned then covers what was not visited.

use super::fill::{Fill, Kind, Piece};
use super::model::{Model, Session};
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
    /// Starts that already stand and may share a window with an item, ascending.
    pub(super) starts: Vec<i64>,
    /// Where the region begins: items that start earlier all hold this instant reserved.
    pub(super) from: i64,
}

/// What a search found.
#[derive(Debug, Clone)]
pub(super) struct Found {
    /// The best set of sessions, as indices in the model.
    pub(super) ids: Vec<usize>,
    /// Its value in units.
    pub(super) value: i64,
    /// No set is worth more.
    pub(super) bound: i64,
}

/// An item with all that the search asks of it.
#[derive(Debug, Clone, Copy)]
struct Choice {
    session: Session,
    item: Item,
    kind: Kind,
    /// Time in the region's cells, if limited, ns.
    time: i64,
    /// Where its time in all cells stands in [`Walk::parts`].
    parts: (usize, usize),
}

#[derive(Debug)]
struct Walk<'a> {
    model: &'a Model,
    choices: Vec<Choice>,
    /// (cell of the region, ns) of all choices.
    parts: Vec<(usize, i64)>,
    fill: Fill,
    left: Vec<i64>,
    starts: Vec<i64>,
    /// Most counted choices that may still be added.
    places: usize,
    path: Vec<usize>,
    found: Found,
    /// Largest bound of a branch that was not visited.
    unvisited: i64,
    nodes: usize,
}

/// The best set of items worth more than `at_least`, and a bound on all sets.
///
/// Where none is worth more, the set returned is empty and its value is `at_least`.
pub(super) fn search(region: &Region<'_>, at_least: i64, nodes: usize) -> Found {
    let places = match region.model.count {
        Some((count, window)) => {
            let until = region.from.saturating_add(window);
            let stand = region.starts.iter().filter(|start| (region.from..until).contains(*start));
            count.saturating_sub(stand.count())
        }
        None => usize::MAX,
    };
    let mut parts = Vec::new();
    let useful = region.items.iter().filter(|item| item.value > 0);
    let choices: Vec<_> = useful.map(|&item| choice(region, item, &mut parts)).collect();
    let mut walk = Walk {
        model: region.model,
        choices,
        parts,
        fill: Fill::default(),
        left: region.left.clone(),
        starts: region.starts.clone(),
        places,
        path: Vec::new(),
        found: Found { ids: Vec::new(), value: at_least, bound: at_least },
        unvisited: i64::MIN,
        nodes,
    };
    walk.prepare();
    let open: Vec<usize> = (0..walk.choices.len()).collect();
    walk.visit(&open, 0, region.worth);
    let Walk { mut found, unvisited, .. } = walk;
    found.bound = found.value.max(unvisited);
    found
}

fn choice(region: &Region<'_>, item: Item, parts: &mut Vec<(usize, i64)>) -> Choice {
    let session = region.model.sessions[item.id];
    let first = parts.len();
    if !region.left.is_empty() {
        let inside = region.model.shares(&session);
        let counted = inside.filter(|(cell, _)| region.cells.contains(cell));
        parts.extend(counted.map(|(cell, ns)| (cell - region.cells.start, ns)));
    }
    let time: i64 = parts[first..].iter().map(|part| part.1).sum();
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
        let worst = self.found.value;
        let keep = super::fill::promising(&pieces, time_left, self.places, worst);
        let mut keep = keep.into_iter();
        choices.retain(|_| keep.next().unwrap_or(true));
        let limited = time_left < i64::MAX;
        choices.sort_unstable_by_key(|it| {
            let group = if let Kind::Head(lane) = it.kind { lane } else { usize::MAX };
            let first = if limited { it.item.value } else { it.item.reduced };
            (group, Reverse(first), it.time, it.item.id)
        });
        let pieces: Vec<Piece> = choices.iter().map(Choice::piece).collect();
        self.fill = Fill::new(&pieces, time_left, self.places);
        self.choices = choices;
    }

    /// Time left in all cells; the largest number where no limit holds.
    fn time_left(&self) -> i64 {
        if self.left.is_empty() {
            return i64::MAX;
        }
        self.left.iter().sum()
    }

    /// Whether a choice's time and start still fit what is left.
    fn fits(&self, choice: &Choice) -> bool {
        self.parts[choice.parts.0..choice.parts.1].iter().all(|&(cell, ns)| ns <= self.left[cell])
            && self.model.count.is_none_or(|(count, window)| {
                start_fits(&self.starts, choice.session.start, count, window)
            })
    }

    /// Visits all sets that extend the path by choices of `open`.
    fn visit(&mut self, open: &[usize], value: i64, priced: i64) {
        let time_left = self.time_left();
        let by_price = self.by_price(open);
        for (place, &index) in open.iter().enumerate() {
            let choice = self.choices[index];
            let filled = self.fill.most(index, time_left, self.places);
            let bound = value.saturating_add(filled).min(priced.saturating_add(by_price[place]));
            if bound <= self.found.value {
                // Both bounds fall from place to place, so no later one is better.
                return;
            }
            if self.nodes == 0 {
                self.unvisited = self.unvisited.max(bound);
                return;
            }
            self.nodes -= 1;
            let value = value + choice.item.value;
            self.path.push(choice.item.id);
            if value > self.found.value {
                self.found.value = value;
                self.found.ids.clone_from(&self.path);
            }
            self.take(&choice, true);
            let next = self.fill.most(index + 1, time_left - choice.time, self.places);
            if value.saturating_add(next) > self.found.value {
                let rest = self.compatible(&open[place + 1..], &choice.session);
                self.visit(&rest, value, priced + choice.item.reduced);
            }
            self.take(&choice, false);
            self.path.pop();
        }
    }

    /// The choices of `open` that may still be added after `taken`.
    fn compatible(&self, open: &[usize], taken: &Session) -> Vec<usize> {
        let exclusive = self.model.lanes > 0;
        open.iter()
            .copied()
            .filter(|&index| {
                let choice = &self.choices[index];
                let other = &choice.session;
                let clash = exclusive && other.lane == taken.lane && other.overlaps(taken);
                !clash && self.fits(choice)
            })
            .collect()
    }

    /// For each place, the most by price that choices from there on can add, at least one taken.
    fn by_price(&self, open: &[usize]) -> Vec<i64> {
        let mut most = vec![0; open.len()];
        let (mut positive, mut dearest) = (0_i64, i64::MIN);
        for (place, &index) in open.iter().enumerate().rev() {
            let reduced = self.choices[index].item.reduced;
            positive = positive.saturating_add(reduced.max(0));
            dearest = dearest.max(reduced);
            most[place] = if dearest < 0 { dearest } else { positive };
        }
        most
    }

    fn take(&mut self, choice: &Choice, on: bool) {
        for &(cell, ns) in &self.parts[choice.parts.0..choice.parts.1] {
            self.left[cell] += if on { -ns } else { ns };
        }
        let start = choice.session.start;
        if self.model.count.is_some() {
            let place = self.starts.partition_point(|&other| other < start);
            if on {
                self.starts.insert(place, start);
            } else {
                self.starts.remove(place);
            }
        }
        if choice.kind == Kind::Counted {
            self.places = if on { self.places - 1 } else { self.places + 1 };
        }
    }
}

impl Choice {
    const fn piece(&self) -> Piece {
        Piece { value: self.item.value, time: self.time, kind: self.kind }
    }
}

/// Whether one more start leaves at most `count` in every half-open window.
pub(super) fn start_fits(starts: &[i64], start: i64, count: usize, window: i64) -> bool {
    if starts.len() < count {
        return true;
    }
    if count == 0 {
        return false;
    }
    // The new start and `count` neighbours in order must span a window or more.
    let place = starts.partition_point(|&other| other < start);
    let first = place.saturating_sub(count);
    let last = (place + count).min(starts.len());
    starts[first..last].windows(count).all(|run| {
        let from = run[0].min(start);
        let until = run[count - 1].max(start);
        until.saturating_sub(from) >= window
    })
}
