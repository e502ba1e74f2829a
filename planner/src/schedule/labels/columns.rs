//! Labels by columns: one list for each number of a label, so that many are compared at a time.

use super::items::{FREE, NEVER};
use super::size::{MOST_AMOUNTS, MOST_PLACES};
use pulp::{Arch, NullaryFnOnce};
use std::cmp::Reverse;

/// Labels that are compared at a time.
const BLOCK: usize = 32;

/// A schedule as far as later sessions can tell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Label {
    pub(super) value: i64,
    /// Reserved ns of this day and the following ones, what the memory holds, reserved ns in the
    /// thermal window of each line; the less the better.
    pub(super) used: [i64; MOST_AMOUNTS],
    /// Ranks of the last starts that count, latest first, then of the ends until which the lanes of each
    /// class are busy, latest first ([`FREE`] where there is none), then the negative ranks of the last
    /// starts on the lanes of each class, latest first ([`NEVER`] where there is none); the less the better.
    pub(super) places: [i32; MOST_PLACES],
    /// Its last session among the pass's links.
    pub(super) link: u32,
    /// How often it takes the present item beyond that.
    pub(super) copies: u32,
}

impl Label {
    /// Nothing taken; no place holds a last start.
    pub(super) const EMPTY: Self =
        Self { value: 0, used: [0; MOST_AMOUNTS], places: [FREE; MOST_PLACES], link: 0, copies: 0 };

    /// Nothing taken, the places from one on those of last starts.
    pub(super) fn empty(last_starts: usize) -> Self {
        let mut label = Self::EMPTY;
        label.places.iter_mut().skip(last_starts).for_each(|it| *it = NEVER);
        label
    }
}

/// Labels by columns.
#[derive(Debug)]
pub(super) struct Columns {
    pub(super) value: Vec<i64>,
    pub(super) used: Vec<Vec<i64>>,
    pub(super) places: Vec<Vec<i32>>,
    link: Vec<u32>,
    arch: Arch,
}

impl Columns {
    /// None yet, of so many amounts and places.
    pub(super) fn new(amounts: usize, places: usize) -> Self {
        Self {
            value: Vec::new(),
            used: vec![Vec::new(); amounts],
            places: vec![Vec::new(); places],
            link: Vec::new(),
            arch: Arch::new(),
        }
    }

    pub(super) const fn len(&self) -> usize {
        self.value.len()
    }

    /// The last session of each, among the pass's links.
    pub(super) fn links(&self) -> &[u32] {
        &self.link
    }

    pub(super) fn links_mut(&mut self) -> &mut [u32] {
        &mut self.link
    }

    pub(super) fn clear(&mut self) {
        self.value.clear();
        self.link.clear();
        self.used.iter_mut().for_each(Vec::clear);
        self.places.iter_mut().for_each(Vec::clear);
    }

    pub(super) fn push(&mut self, label: &Label) {
        self.value.push(label.value);
        self.link.push(label.link);
        for (column, used) in self.used.iter_mut().zip(label.used) {
            column.push(used);
        }
        for (column, place) in self.places.iter_mut().zip(label.places) {
            column.push(place);
        }
    }

    pub(super) fn get(&self, index: usize) -> Label {
        let mut label = Label { value: self.value[index], link: self.link[index], ..Label::EMPTY };
        for (used, column) in label.used.iter_mut().zip(&self.used) {
            *used = column[index];
        }
        for (place, column) in label.places.iter_mut().zip(&self.places) {
            *place = column[index];
        }
        label
    }

    /// The first of the first `until` labels of which no resource is worse than this label's; values are
    /// not looked at.
    pub(super) fn no_worse(&self, label: &Label, until: usize) -> Option<usize> {
        self.arch.dispatch(Sought { labels: self, label, until })
    }

    fn is_no_worse(&self, label: &Label, index: usize) -> bool {
        let places = self.places.iter().zip(&label.places);
        places.into_iter().all(|(column, limit)| column[index] <= *limit)
            && self.is_within(label, index)
    }

    fn is_within(&self, label: &Label, index: usize) -> bool {
        self.used.iter().zip(&label.used).all(|(column, limit)| column[index] <= *limit)
    }

    /// Keeps the `width` labels of the largest worth, the earlier of equals, in their order.
    pub(super) fn keep_best(&mut self, worth: &[i64], width: usize) {
        let mut order: Vec<usize> = (0..self.len()).collect();
        if width == 0 || width >= order.len() {
            return;
        }
        order.select_nth_unstable_by_key(width - 1, |&at| (Reverse(worth[at]), at));
        order.truncate(width);
        order.sort_unstable();
        self.pick(&order);
    }

    /// The labels at some places, in that order.
    fn pick(&mut self, order: &[usize]) {
        let long = |column: &mut Vec<i64>| *column = order.iter().map(|&at| column[at]).collect();
        long(&mut self.value);
        self.used.iter_mut().for_each(long);
        for column in &mut self.places {
            *column = order.iter().map(|&at| column[at]).collect();
        }
        self.link = order.iter().map(|&at| self.link[at]).collect();
    }

    /// Puts the labels in order of falling value, equals as they were.
    pub(super) fn sort(&mut self) {
        if self.value.is_sorted_by(|a, b| a >= b) {
            return;
        }
        let mut order: Vec<usize> = (0..self.len()).collect();
        order.sort_by_key(|&at| Reverse(self.value[at]));
        self.pick(&order);
    }

    /// Lowers the resources of a label to another's.
    pub(super) fn lower(&mut self, index: usize, to: &Label) {
        for (column, used) in self.used.iter_mut().zip(to.used) {
            column[index] = column[index].min(used);
        }
        for (column, place) in self.places.iter_mut().zip(to.places) {
            column[index] = column[index].min(place);
        }
    }
}

/// A search for a label that is no worse, in the widest arithmetic that the processor has.
struct Sought<'c> {
    labels: &'c Columns,
    label: &'c Label,
    until: usize,
}

impl Sought<'_> {
    /// Which labels of a block are no worse, all of them at a time; `None` where none is.
    #[expect(clippy::inline_always, reason = "compiled once for each width of arithmetic")]
    #[inline(always)]
    fn block(&self, from: usize) -> Option<[i32; BLOCK]> {
        let mut all = [-1_i32; BLOCK];
        for (column, limit) in self.labels.places.iter().zip(&self.label.places) {
            let block: &[i32; BLOCK] = column.get(from..from + BLOCK)?.try_into().ok()?;
            for (all, place) in all.iter_mut().zip(block) {
                *all &= if place <= limit { -1 } else { 0 };
            }
        }
        let any = |all: &[i32; BLOCK]| all.iter().fold(0, |any, it| any | it) != 0;
        if !any(&all) {
            return None;
        }
        for (column, limit) in self.labels.used.iter().zip(&self.label.used) {
            let block: &[i64; BLOCK] = column.get(from..from + BLOCK)?.try_into().ok()?;
            for (all, used) in all.iter_mut().zip(block) {
                *all &= if used <= limit { -1 } else { 0 };
            }
        }
        any(&all).then_some(all)
    }
}

impl NullaryFnOnce for Sought<'_> {
    type Output = Option<usize>;

    #[expect(clippy::inline_always, reason = "compiled once for each width of arithmetic")]
    #[inline(always)]
    fn call(self) -> Option<usize> {
        let Some(last) = self.until.checked_sub(BLOCK) else {
            return (0..self.until).find(|&index| self.labels.is_no_worse(self.label, index));
        };
        let mut from = 0;
        loop {
            // The last block may overlap the one before, in which there was none.
            from = from.min(last);
            if let Some(all) = self.block(from) {
                return all.iter().position(|it| *it != 0).map(|at| from + at);
            }
            if from == last {
                return None;
            }
            from += BLOCK;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_that_is_no_worse_is_found_in_blocks_and_beyond() {
        for len in [1, 31, 32, 33, 70] {
            for at in 0..len {
                let mut labels = Columns::new(2, 3);
                for index in 0..len {
                    let mut label = Label::EMPTY;
                    label.places[1] = 5;
                    label.used[index % 2] = 7;
                    if index == at {
                        (label.places[1], label.used) = (4, [6; MOST_AMOUNTS]);
                    }
                    labels.push(&label);
                }
                let mut limit = Label { used: [6; MOST_AMOUNTS], ..Label::EMPTY };
                limit.places[1] = 4;
                assert_eq!(labels.no_worse(&limit, len), Some(at));
                assert_eq!(labels.no_worse(&limit, at), None);
                limit.used[1] = 5;
                assert_eq!(labels.no_worse(&limit, len), None);
            }
        }
    }
}
