//! What a schedule is worth by the problem's own numbers, and what it changes of an earlier plan.
//!
//! Method: the objective in floating point, charges taken off, session by session or by cells of the
//! logarithm; no units of the search enter.
//!
//! Limits: the rounding of a sum of f64 in the sessions' order.

use super::demands::Log;
use super::joint::Built;
use crate::program::number::f64_from_usize;
use std::collections::{BTreeMap, BTreeSet};

/// What the sessions taken are worth, charges taken off.
pub(super) fn objective(built: &Built<'_>, taken: &[usize]) -> f64 {
    let (problem, demands) = (built.problem, &built.problem.demands);
    let mut worth = match &demands.log {
        None => {
            let candidates = built.model.candidates(taken);
            sum(candidates.into_iter().map(|candidate| problem.value(candidate)))
        }
        Some(log) => logarithms(built, log, taken),
    };
    let stands = |id: &usize| taken.binary_search(id).is_ok();
    let empty = built.gaps.iter().filter(|gap| !gap.sessions.iter().any(stands)).count();
    if empty > 0 {
        worth -= built.gap_charge * f64_from_usize(empty);
    }
    if let Some(previous) = &demands.previous {
        worth -= previous.price * f64_from_usize(changes(built, taken));
    }
    worth
}

/// Candidates of the earlier plan that were dropped, and those that it did not have.
pub(super) fn changes(built: &Built<'_>, taken: &[usize]) -> usize {
    let Some(previous) = &built.problem.demands.previous else { return 0 };
    let before: BTreeSet<usize> = previous.sessions.iter().copied().collect();
    let now: BTreeSet<usize> = built.model.candidates(taken).into_iter().collect();
    before.symmetric_difference(&now).count()
}

/// `sum over cells of weight ln(1 + t / offset)`.
fn logarithms(built: &Built<'_>, log: &Log, taken: &[usize]) -> f64 {
    let problem = built.problem;
    let mut cells: BTreeMap<(usize, usize, i64, u32), f64> = BTreeMap::new();
    for &id in taken {
        let session = &built.model.sessions[id];
        let since = session.start.saturating_sub(problem.span.0.tai_ns());
        let epoch = since.div_euclid(log.epoch.ns().max(1));
        let (target, telescope) = built.facts.of[id];
        for &(bin, time) in &log.parts[session.candidate] {
            *cells.entry((target, telescope, epoch, bin)).or_default() += time.seconds();
        }
    }
    let offset = log.offset.seconds();
    let weight = |target, bin| log.weight(&problem.weights, target, bin);
    sum(cells.iter().map(|(key, t)| weight(key.0, key.3) * (t / offset).ln_1p()))
}

/// A sum that is +0 where there is nothing to add.
fn sum(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |sum, value| sum + value)
}
