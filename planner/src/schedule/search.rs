//! The best choices among a few sessions, and a bound on them, by exact search.
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
//! Limits: at most [`Effort::nodes`] nodes; the bound returned then covers what was not visited.

use super::fill::{Fill, Kind, Piece, promising};
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
    /// How many of these cells, from the first, the filling counts as one.
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
    /// Time in the cells that the filling counts, ns.
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
    fill: Fill,
    left: Vec<i64>,
    starts: Vec<i64>,
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
        fill: Fill::default(),
        left: region.left.clone(),
        starts: region.starts.clone(),
        places,
        path: Vec::new(),
        sets: Vec::new(),
        threshold: at_least,
        unvisited: at_least,
    };
    walk.prepare();
    let open: Vec<usize> = (0..walk.choices.len()).collect();
    walk.visit(&open, 0, region.worth);
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
        self.fill = Fill::new(&pieces, time_left, self.places);
        self.choices = choices;
    }

    /// Time left in the cells that the filling counts; `None` where there is no limit.
    fn time_left(&self) -> Option<i64> {
        let filled = self.left.iter().take(self.region.filled);
        (!self.left.is_empty()).then(|| filled.fold(0, |sum: i64, &ns| sum.saturating_add(ns)))
    }

    /// Whether a choice's time and start still fit what is left.
    fn fits(&self, choice: &Choice) -> bool {
        self.parts[choice.parts.0..choice.parts.1].iter().all(|&(cell, ns)| ns <= self.left[cell])
            && self.region.model.count.is_none_or(|(count, window)| {
                start_fits(&self.starts, choice.session.start, count, window)
            })
    }

    /// Visits all sets that extend the path by choices of `open`.
    fn visit(&mut self, open: &[usize], value: i64, priced: i64) {
        let by_price = self.by_price(open);
        let time_left = self.time_left();
        for (place, &index) in open.iter().enumerate() {
            let choice = self.choices[index];
            let filled = self.fill.most(index, time_left, self.places);
            let bound = value.saturating_add(filled).min(priced.saturating_add(by_price[place]));
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
            let next = self.fill.most(index + 1, self.time_left(), self.places);
            if value.saturating_add(next) > self.threshold {
                let rest = self.compatible(&open[place + 1..], &choice.session);
                self.visit(&rest, value, priced + choice.item.reduced);
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

    /// The choices of `open` that may still be added after `taken`.
    fn compatible(&self, open: &[usize], taken: &Session) -> Vec<usize> {
        open.iter()
            .copied()
            .filter(|&index| {
                let choice = &self.choices[index];
                !self.region.model.clash(&choice.session, taken) && self.fits(choice)
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

/// Whether one more start leaves at most `count` in every half-open window; `starts` ascend and
/// leave as much already.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_fit_as_every_window_says() {
        let mut state = 5_u64;
        let mut next = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            i64::try_from((state >> 33) % below).unwrap()
        };
        for _ in 0..2_000 {
            let (count, window) = (usize::try_from(next(4) + 1).unwrap(), next(20) + 1);
            let mut starts: Vec<i64> = Vec::new();
            for _ in 0..12 {
                let start = next(40);
                let mut with = starts.clone();
                with.push(start);
                let legal = with.iter().all(|from| {
                    with.iter().filter(|it| (*from..from + window).contains(*it)).count() <= count
                });
                assert_eq!(start_fits(&starts, start, count, window), legal);
                if legal {
                    starts.push(start);
                    starts.sort_unstable();
                }
            }
        }
    }
}
