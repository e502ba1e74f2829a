//! The Lagrangian dual: days searched apart, rows that link them dualised, multipliers optimised.
//!
//! Method: from the split at the relaxation's prices (`split.rs`) the multipliers are moved along
//! subgradients (`subgradient.rs`), so that both ends of a session agree on taking it and the starts of
//! every window meet the limit. Every round gives a bound, the least of which counts, and a best set per
//! cell, which the primal search reuses as a pattern. Only cells whose amounts changed are searched
//! again.
//!
//! Limits: [`ROUNDS`] rounds, fewer for more than [`SEARCHES`] / [`ROUNDS`] days, [`FEWEST_ROUNDS`] at
//! least.

use super::bound::windows_worth;
use super::split::{Best, Split};
use super::subgradient::Descent;
use crate::program::number::u64_from_usize;
use crate::progress::Progress;
use crate::schedule::model::Model;
use crate::schedule::price::Prices;
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

/// The bound of the Lagrangian dual; `scale` is the typical value of a session in units. Ends early
/// where the bound comes down to `enough`.
pub(super) fn sharpen<'a>(
    model: &'a Model,
    prices: &Prices,
    (scale, enough): (f64, i128),
    progress: &dyn Progress,
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
    // At most a hundred words about the rounds.
    let telling = rounds.div_ceil(100);
    progress.begin("bounds by days", u64_from_usize(rounds));
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
        if bound <= enough || progress.stopped() {
            break;
        }
        if round.is_multiple_of(telling) {
            progress.advance(u64_from_usize(telling));
        }
        descent.step(&mut split, &bests, here, &mut changed);
    }
    if splits.is_empty() {
        splits.push(split);
    }
    Sharpened { splits, bound, patterns }
}
