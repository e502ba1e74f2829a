//! Primal heuristics: rounding of the relaxation, repair, greedy completion.
//!
//! Method: choices come in an order; each that fits is taken, rows with coefficients below zero left
//! aside at first, since they may need several choices together. Where such a row is violated in the
//! end, choices that use it are removed, the least valuable per use first; then what fits is added.
//! Ties fall by position.
//!
//! Limits: at most [`REPAIRS`] removals; the set may still violate a row, which the caller checks.

use super::family::Family;
use super::number::{f64_from_i64, f64_from_i128, i64_from_f64};
use super::problem::{Choice, Program};
use super::state::{Index, State};
use std::cmp::Reverse;

/// Ways to round.
pub(super) const WAYS: usize = 3;
/// Most rounds of repair.
const REPAIRS: usize = 10_000;

/// Only what must be taken.
pub(super) fn always<'p>(program: &'p Program, index: &'p Index) -> State<'p> {
    let mut state = State::new(program, index);
    for (choice, kind) in program.choices.iter().enumerate() {
        if *kind == Choice::Always {
            state.set(choice, true);
        }
    }
    state
}

/// The shares of the rows that a choice uses, together.
pub(super) fn uses(program: &Program, index: &Index, choice: usize) -> f64 {
    let share = |&(row, coefficient): &(usize, i64)| {
        f64_from_i64(coefficient.max(0)) / f64_from_i64(program.rows[row].limit.max(1))
    };
    index.rows[choice].iter().map(share).sum::<f64>().max(1e-9)
}

/// Value of a choice per share of the rows it uses.
fn density(program: &Program, index: &Index, choice: usize) -> f64 {
    let cells = index.cells[choice].iter().map(|&(cell, adds)| {
        let cell = &program.cells[cell];
        f64_from_i64(cell.gain.at(cell.base + adds) - cell.gain.at(cell.base))
    });
    (f64_from_i64(program.values[choice]) + cells.sum::<f64>()) / uses(program, index, choice)
}

/// Choices in order of value per share of the rows they use.
pub(super) fn greedy(program: &Program, index: &Index) -> Vec<bool> {
    let mut order: Vec<(f64, usize)> =
        (0..program.values.len()).map(|choice| (density(program, index, choice), choice)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let order: Vec<usize> = order.into_iter().map(|it| it.1).collect();
    finished(program, index, always(program, index), &order, 0)
}

/// A given set, and what fits beside it.
pub(super) fn repaired(program: &Program, index: &Index, given: &[usize]) -> Vec<bool> {
    let within: Vec<usize> =
        given.iter().copied().filter(|&choice| choice < program.values.len()).collect();
    finished(program, index, always(program, index), &within, within.len())
}

/// A set from shares, in one of several ways.
///
/// By share; by share and density; by the running sum of shares, so that what they use of rows over
/// neighbours is kept.
pub(super) fn rounded(program: &Program, index: &Index, shares: &[f64], way: usize) -> Vec<bool> {
    let mut sum = 0.5;
    let mut order: Vec<(Reverse<i64>, Reverse<i64>, usize)> = Vec::with_capacity(shares.len());
    for (choice, &share) in shares.iter().enumerate() {
        let before: f64 = f64::floor(sum);
        sum += share.clamp(0.0, 1.0);
        let stepped = way == 2 && sum.floor() > before;
        let steps = if way == 1 { 10.0 } else { 1e4 };
        let rank = i64_from_f64((share * steps).round()) + i64::from(stepped) * 20_000;
        // Positive floats order as their bits.
        let density = density(program, index, choice).max(0.0).to_bits() >> 1;
        order.push((Reverse(rank), Reverse(i64::try_from(density).unwrap_or(i64::MAX)), choice));
    }
    let likely = order.iter().filter(|it| shares[it.2] > 0.3).count();
    order.sort_unstable();
    let order: Vec<usize> = order.into_iter().map(|it| it.2).collect();
    finished(program, index, always(program, index), &order, likely)
}

/// Takes choices in order, the first `likely` without regard to rows with coefficients below zero;
/// repairs; fills up.
fn finished(
    program: &Program,
    index: &Index,
    mut state: State<'_>,
    order: &[usize],
    likely: usize,
) -> Vec<bool> {
    for &choice in &order[..likely.min(order.len())] {
        if !state.holds(choice) && state.fits_packing(choice) && state.gain(choice) > 0 {
            state.set(choice, true);
        }
    }
    repair(program, index, &mut state);
    fill(&mut state, order);
    state.marks()
}

/// Adds what fits and brings something, in order.
pub(super) fn fill(state: &mut State<'_>, order: &[usize]) {
    for &choice in order {
        if !state.holds(choice) && state.gain(choice) > 0 && state.fits(choice) {
            state.set(choice, true);
        }
    }
}

/// Removes choices until no row is violated, or none helps.
fn repair(program: &Program, index: &Index, state: &mut State<'_>) {
    for _ in 0..REPAIRS {
        let Some(row) = state.broken_rows().next() else { return };
        let worth = |choice: usize, uses: i64| {
            f64_from_i128(lost(program, index, state, choice)) / f64_from_i64(uses)
        };
        let out = program.rows[row]
            .terms
            .iter()
            .filter(|&&(choice, uses)| {
                uses > 0 && state.holds(choice) && program.choices[choice] != Choice::Always
            })
            .map(|&(choice, uses)| (worth(choice, uses), choice))
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let Some((_, out)) = out else { return };
        state.set(out, false);
    }
}

/// The set less what violates rows of families.
pub(super) fn within_families(
    program: &Program,
    index: &Index,
    families: &[&dyn Family],
    set: Vec<bool>,
) -> Vec<bool> {
    if families.is_empty() {
        return set;
    }
    let mut state = State::of(program, index, &set);
    let mut marks = set;
    for _ in 0..REPAIRS {
        let broken = families.iter().find_map(|it| it.broken(&marks).into_iter().next());
        let Some(row) = broken else { break };
        // The choice of least worth per use of the row.
        let out = row
            .terms
            .iter()
            .filter(|&&(choice, uses)| {
                uses > 0 && marks[choice] && program.choices[choice] != Choice::Always
            })
            .min_by(|a, b| {
                let worth = |it: &(usize, i64)| {
                    f64_from_i128(lost(program, index, &state, it.0)) / f64_from_i64(it.1)
                };
                worth(a).total_cmp(&worth(b)).then(a.0.cmp(&b.0))
            });
        let Some(&(out, _)) = out else { break };
        state.set(out, false);
        marks[out] = false;
    }
    marks
}

/// What removing a choice loses.
fn lost(program: &Program, index: &Index, state: &State<'_>, choice: usize) -> i128 {
    let mut lost = i128::from(program.values[choice]);
    for &(cell, adds) in &index.cells[choice] {
        let gain = program.cells[cell].gain;
        lost += i128::from(gain.at(state.sum(cell)) - gain.at(state.sum(cell) - adds));
    }
    lost
}
