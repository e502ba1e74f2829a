//! Greedy fill by reduced profit, then large-neighbourhood search with threshold acceptance.
//!
//! Method: the greedy fill takes the choice of largest worth over cost, judged beside those taken so
//! far; its cost is the dual price of the capacity that it uses, or its shares of the rows where there
//! are no prices yet. Gains are concave, so that ratio only falls, and a choice at the top of the heap
//! whose ratio still holds is the best (lazy greedy, Minoux 1978). It is taken where neither a row nor a
//! family is violated. The large-neighbourhood search (Shaw 1998) then removes most of a few neighbours
//! in the programme's order and fills their stretch anew, costs varied by a fixed hash. A loss up to a
//! threshold is accepted, which falls to nothing over the rounds (threshold accepting, Dueck and Scheuer
//! 1990); the best set seen is returned. Ties fall by position.
//!
//! Limits: up to [`MOST_CHOICES`] choices; a choice that does not fit when its turn comes is not asked
//! again.

use super::gain::UNIT;
use super::number::{f64_from_i64, f64_from_i128, f64_from_usize, i128_from_f64, u64_from_usize};
use super::options::Aids;
use super::problem::{Choice, Program};
use super::relaxation::Relaxed;
use super::round;
use super::state::{Index, State};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

/// Beyond so many choices the families would be asked too often.
pub(super) const MOST_CHOICES: usize = 15_000;
/// Neighbours in one neighbourhood, in turn.
const STRETCHES: [usize; 7] = [4, 9, 2, 14, 6, 3, 24];
/// Rounds over all neighbourhoods, and between two words about them.
const ROUNDS: usize = 240;
const TELLING: usize = 10;
/// Costs are raised by at most so many times themselves, in turn.
const VARIED: [f64; 3] = [0.3, 1.0, 3.0];
/// The threshold: a neighbourhood may lose this part of a taken choice's mean value at first, nothing in
/// the last rounds.
const LOSS: f64 = 0.1;
const CALM: usize = 48;
/// Of the neighbours so many in sixteen are removed.
const REMOVED: u64 = 12;

/// What each choice costs by its shares of the rows.
pub(super) fn by_shares(program: &Program, index: &Index) -> Vec<f64> {
    (0..program.values.len()).map(|it| round::uses(program, index, it)).collect()
}

/// What each choice costs at the dual prices of a relaxation, in units.
pub(super) fn by_prices(program: &Program, relaxed: &Relaxed) -> Vec<f64> {
    let mut costs = vec![0.0; program.values.len()];
    for (row, &z) in program.rows.iter().zip(&relaxed.prices.rows).filter(|it| *it.1 > 0) {
        for &(choice, coefficient) in &row.terms {
            costs[choice] += f64_from_i128(z) * f64_from_i64(coefficient) / UNIT;
        }
    }
    let mean = costs.iter().sum::<f64>() / f64_from_usize(costs.len().max(1));
    costs.into_iter().map(|it| it.max(1e-3 * mean).max(1e-9)).collect()
}

/// A number that belongs to a choice and a round.
fn hash(choice: usize, round: usize) -> u64 {
    let mut it = f64_from_usize(choice).to_bits() ^ f64_from_usize(round).to_bits().rotate_left(23);
    for _ in 0..2 {
        it = (it ^ (it >> 29)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
    it >> 32
}

/// A set under construction, which violates nothing.
pub(super) struct Construction<'p, 'a> {
    program: &'p Program,
    aids: &'p Aids<'a>,
    state: State<'p>,
    marks: Vec<bool>,
}

impl<'p, 'a> Construction<'p, 'a> {
    /// From a set that violates nothing.
    pub(super) fn new(
        program: &'p Program,
        index: &'p Index,
        aids: &'p Aids<'a>,
        set: Vec<bool>,
    ) -> Self {
        Self { program, aids, state: State::of(program, index, &set), marks: set }
    }

    pub(super) fn marks(self) -> Vec<bool> {
        self.marks
    }

    fn set(&mut self, choice: usize, taken: bool) {
        self.marks[choice] = taken;
        self.state.set(choice, taken);
    }

    /// Takes what fits of a stretch and has worth, the largest worth over cost first; what it took.
    pub(super) fn fill(
        &mut self,
        stretch: Range<usize>,
        costs: &dyn Fn(usize) -> f64,
    ) -> Vec<usize> {
        if self.marks.len() > MOST_CHOICES {
            return Vec::new();
        }
        // Positive floats order as their bits.
        let rank = |state: &State<'_>, choice: usize| -> Option<u64> {
            let gain = state.gain(choice);
            (gain > 0).then(|| (f64_from_i128(gain) / costs(choice)).to_bits())
        };
        let free = |it: &usize| {
            !self.marks[*it] && self.program.choices[*it] == Choice::Free && self.state.fits(*it)
        };
        let mut heap: BinaryHeap<(u64, Reverse<usize>)> = stretch
            .filter(free)
            .filter_map(|choice| Some((rank(&self.state, choice)?, Reverse(choice))))
            .collect();
        let mut took = Vec::new();
        while let Some((before, Reverse(choice))) = heap.pop() {
            if !self.state.fits(choice) {
                continue;
            }
            match rank(&self.state, choice) {
                Some(now) if now < before => heap.push((now, Reverse(choice))),
                Some(_) => {
                    self.marks[choice] = true;
                    if self.aids.families.iter().all(|it| it.broken(&self.marks).is_empty()) {
                        self.state.set(choice, true);
                        took.push(choice);
                    } else {
                        self.marks[choice] = false;
                    }
                }
                None => {}
            }
        }
        took
    }

    /// Searches all neighbourhoods for some rounds; the best set seen stands in the end.
    pub(super) fn improve(&mut self, costs: &[f64]) {
        if self.marks.len() > MOST_CHOICES {
            return;
        }
        let taken = self.marks.iter().zip(&self.program.values).filter(|it| *it.0);
        let (sum, count) = taken.fold((0.0, 0), |(sum, count), (_, &value)| {
            (sum + f64_from_i64(value.abs()), count + 1)
        });
        let mean = sum / f64_from_usize(count.max(1));
        let mut best = (self.state.value(), self.marks.clone());
        self.aids.progress.begin("large-neighbourhood search", u64_from_usize(ROUNDS));
        for round in 0..ROUNDS {
            if round > 0 && round.is_multiple_of(TELLING) {
                self.aids.progress.advance(u64_from_usize(TELLING));
            }
            let left = (1.0 - f64_from_usize(round) / f64_from_usize(ROUNDS - CALM)).max(0.0);
            let loss = i128_from_f64(mean * LOSS * left);
            let length = STRETCHES[round % STRETCHES.len()];
            let taken: Vec<usize> = (0..self.marks.len()).filter(|&it| self.marks[it]).collect();
            let step = length.div_ceil(2);
            for from in (0..taken.len()).step_by(step) {
                if self.aids.progress.stopped() {
                    break;
                }
                let before = if from == 0 { 0 } else { taken[from - 1] + 1 };
                let after = taken.get(from + length).copied().unwrap_or(self.marks.len());
                self.renew(before..after, (round, loss), costs);
                if self.state.value() > best.0 {
                    best = (self.state.value(), self.marks.clone());
                }
            }
        }
        for (choice, &mark) in best.1.iter().enumerate() {
            if self.marks[choice] != mark {
                self.set(choice, mark);
            }
        }
    }

    /// Removes most of a stretch and fills it anew; undone where that loses the threshold or more.
    fn renew(&mut self, stretch: Range<usize>, (round, loss): (usize, i128), costs: &[f64]) {
        let value = self.state.value();
        let leaves = |it: &usize| {
            self.marks[*it]
                && self.program.choices[*it] == Choice::Free
                && hash(*it, round) % 16 < REMOVED
        };
        let removed: Vec<usize> = stretch.clone().filter(leaves).collect();
        for &choice in &removed {
            self.set(choice, false);
        }
        let varied = |choice: usize| {
            let part = f64_from_i128(i128::from(hash(choice, round + ROUNDS) % 1024)) / 1024.0;
            costs[choice] * (1.0 + VARIED[round % VARIED.len()] * part)
        };
        let took = self.fill(stretch, &varied);
        // Rows with coefficients below zero may miss what was removed.
        let worse = value - self.state.value();
        if worse >= loss.max(0) || self.state.broken_rows().next().is_some() {
            for choice in took {
                self.set(choice, false);
            }
            for choice in removed {
                self.set(choice, true);
            }
        }
    }
}
