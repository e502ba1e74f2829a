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
//! looked at, overlap ignored, from a table (`fill.rs`). Sets of sessions are bits, one set per depth,
//! so that a node allocates nothing.
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
        fill: Fill::default(),
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
        self.fill = Fill::new(&pieces, time_left, self.places);
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

    /// Time left in the cells that the filling counts; `None` where there is no limit.
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
        let most = next.map_or(0, |first| self.fill.most(first, time_left, self.places));
        if value.saturating_add(most) <= self.threshold {
            return;
        }
        self.price(depth);
        while let Some(index) = next {
            next = self.open.first_from(depth, index + 1);
            let choice = self.choices[index];
            let filled = self.fill.most(index, time_left, self.places);
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
            let most = self.fill.most(index + 1, self.time_left(), self.places);
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

/// Sets of numbers below a limit, each a row of words.
#[derive(Debug, Default)]
struct Bits {
    /// Words of a row.
    width: usize,
    words: Vec<u64>,
}

impl Bits {
    /// No set yet of numbers below `limit`.
    fn sets_of(limit: usize) -> Self {
        Self { width: limit.div_ceil(64).max(1), words: Vec::new() }
    }

    /// Adds an empty set; its row.
    fn push(&mut self) -> usize {
        let row = self.words.len() / self.width;
        self.words.resize(self.words.len() + self.width, 0);
        row
    }

    fn insert(&mut self, row: usize, number: usize) {
        self.words[row * self.width + number / 64] |= 1 << (number % 64);
    }

    fn remove(&mut self, row: usize, number: usize) {
        self.words[row * self.width + number / 64] &= !(1 << (number % 64));
    }

    /// Writes what a row has in common with a row of others into the row after it, which it returns.
    fn meet(&mut self, row: usize, (others, other): (&Self, usize)) -> usize {
        let from = (row + 1) * self.width;
        if self.words.len() < from + self.width {
            self.words.resize(from + self.width, 0);
        }
        let (before, after) = self.words.split_at_mut(from);
        let mine = &before[row * self.width..];
        let theirs = &others.words[other * others.width..][..others.width];
        for ((into, a), b) in after.iter_mut().zip(mine).zip(theirs) {
            *into = a & b;
        }
        row + 1
    }

    /// The least number of a row that is at least `least`.
    fn first_from(&self, row: usize, least: usize) -> Option<usize> {
        let words = &self.words[row * self.width..][..self.width];
        let mut at = least / 64;
        let mut word = words.get(at)? & (u64::MAX << (least % 64));
        while word == 0 {
            at += 1;
            word = *words.get(at)?;
        }
        Some(64 * at + word.trailing_zeros() as usize)
    }

    /// The largest number of a row below `end`.
    fn last_before(&self, row: usize, end: usize) -> Option<usize> {
        let words = &self.words[row * self.width..][..self.width];
        let mut at = end / 64;
        let mut word = words.get(at).map_or(0, |it| it & !(u64::MAX << (end % 64)));
        while word == 0 {
            at = at.checked_sub(1)?;
            word = words[at];
        }
        Some(64 * at + 63 - word.leading_zeros() as usize)
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

/// Where, ends excluded, no start fits any more because of `start`, which stands among `starts`
/// (ascending); nowhere is an empty interval.
fn crowded(starts: &[i64], start: i64, (count, window): (usize, i64)) -> (i64, i64) {
    let place = starts.partition_point(|&other| other < start);
    let first = (place + 1).saturating_sub(count);
    let last = (place + count).min(starts.len());
    // A run of `count` starts shorter than the window lets nothing in within a window of both its ends;
    // those that hold `start` exclude intervals about it.
    let runs = starts[first..last].windows(count.max(1)).map(|run| (run[0], run[run.len() - 1]));
    let full = runs.filter(|(from, until)| until.saturating_sub(*from) < window);
    full.fold((start, start), |(low, high), (from, until)| {
        (low.min(until.saturating_sub(window)), high.max(from.saturating_add(window)))
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
                    let fits = |starts: &[i64], at| start_fits(starts, at, count, window);
                    let before: Vec<i64> = (-30..70).filter(|&at| fits(&starts, at)).collect();
                    starts.push(start);
                    starts.sort_unstable();
                    let (low, high) = crowded(&starts, start, (count, window));
                    for at in before {
                        assert_eq!(fits(&starts, at), !(low < at && at < high));
                    }
                }
            }
        }
    }
}
