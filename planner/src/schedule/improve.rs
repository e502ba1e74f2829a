//! From the relaxation to a schedule, and exchanges until none helps.
//!
//! Method: sessions enter in order of their relaxed value in steps of 1e-4, then by value per
//! reserved time, then by position: ties fall the same way every time. Then, region by region, a day
//! long and a quarter apart, all sessions that start inside are taken out and the best set for the
//! region, given all that stands outside, is looked for by exact search. Passes repeat until none
//! changes anything.
//!
//! Limits: at most [`PASSES`] passes, [`NODES`] nodes per region.

use super::Stopped;
use super::draft::Draft;
use super::model::Model;
use super::number::{f64_from_i64, i64_from_f64};
use super::price::Prices;
use super::relaxation::Relaxed;
use super::search::{Item, Region, search};
use std::cmp::Reverse;

/// Length of a region, a day.
const REGION_NS: i64 = 86_400_000_000_000;
/// Regions begin so far apart.
const STRIDE_NS: i64 = REGION_NS / 4;
/// Most passes over the mission.
const PASSES: usize = 3;
/// Most nodes of one region's search.
const NODES: usize = 1_000;

/// A schedule by rounding the relaxation.
pub(super) fn round<'a>(model: &'a Model, relaxed: &Relaxed) -> Draft<'a> {
    let mut draft = Draft::new(model);
    let mut order: Vec<_> = model
        .sessions
        .iter()
        .enumerate()
        .map(|(id, session)| {
            let share = i64_from_f64((relaxed.shares[id] * 1e4).round());
            let length = f64_from_i64(session.end.saturating_sub(session.start));
            let density = f64_from_i64(session.value) / length;
            (Reverse(share), Reverse(density.to_bits()), id)
        })
        .collect();
    order.sort_unstable();
    for (_, _, id) in order {
        if draft.fits(&model.sessions[id]) {
            draft.add(id);
        }
    }
    draft
}

/// Exchanges sessions until none helps, the bound is reached, or the work is used up.
pub(super) fn improve(
    draft: &mut Draft<'_>,
    model: &Model,
    prices: &Prices,
    bound: i128,
) -> Stopped {
    let (Some(&first), Some(&last)) = (model.cells.first(), model.cells.last()) else {
        return Stopped::Optimal;
    };
    for _ in 0..PASSES {
        if i128::from(draft.value()) >= bound {
            return Stopped::Optimal;
        }
        let mut changed = false;
        let mut at = first.saturating_sub(REGION_NS - STRIDE_NS);
        while at < last {
            changed |= exchange(draft, model, prices, (at, at.saturating_add(REGION_NS)));
            at = at.saturating_add(STRIDE_NS);
        }
        if !changed {
            return Stopped::LocalOptimum;
        }
    }
    if i128::from(draft.value()) >= bound { Stopped::Optimal } else { Stopped::WorkLimit }
}

/// Replaces what starts in a span by something better; false where nothing is.
fn exchange(draft: &mut Draft<'_>, model: &Model, prices: &Prices, span: (i64, i64)) -> bool {
    let ids = model.starting(span.0, span.1);
    let taken: Vec<usize> = ids.clone().filter(|&id| draft.stands(id)).collect();
    let before: i64 = taken.iter().map(|&id| model.sessions[id].value).sum();
    for &id in &taken {
        draft.remove(id);
    }
    let items: Vec<Item> = ids
        .filter(|&id| draft.fits(&model.sessions[id]))
        .map(|id| {
            let session = &model.sessions[id];
            let value = session.value;
            Item { id, value, reduced: value - prices.of(model, session) }
        })
        .collect();
    let found = search(&region(draft, model, prices, items), before, NODES);
    let better = found.value > before;
    for &id in if better { &found.ids } else { &taken } {
        draft.add(id);
    }
    better
}

/// The items with what the rules leave for them.
fn region<'a>(
    draft: &Draft<'_>,
    model: &'a Model,
    prices: &Prices,
    items: Vec<Item>,
) -> Region<'a> {
    let session = |item: &Item| model.sessions[item.id];
    let from = items.iter().map(|item| session(item).start).min().unwrap_or(0);
    let until = items.iter().map(|item| session(item).end).max().unwrap_or(0);
    let last_start = items.iter().map(|item| session(item).start).max().unwrap_or(0);
    let cells = if model.day_limit.is_some() && !items.is_empty() {
        model.cell_at(from)..model.cell_at(until - 1) + 1
    } else {
        0..0
    };
    let left: Vec<i64> = cells.clone().map(|cell| draft.left(cell)).collect();
    let mut worth: i64 =
        cells.clone().zip(&left).map(|(cell, &ns)| prices.cell_worth(cell, ns)).sum();
    // Instants that an item could use, each once: the union of the items per lane.
    for (lane, ladder) in prices.lanes.iter().enumerate() {
        let mut covered = i64::MIN;
        for it in items.iter().map(session).filter(|it| it.lane == lane) {
            worth += ladder.sum(it.start.max(covered), it.end);
            covered = covered.max(it.end);
        }
    }
    let mut starts = Vec::new();
    if let Some((count, window)) = model.count {
        let first = from.saturating_sub(window).saturating_add(1);
        starts = draft.starts(first, last_start.saturating_add(window)).collect();
        for (at, price) in prices.windows.points() {
            if at >= first && at <= last_start {
                let inside = starts.partition_point(|&start| start < at.saturating_add(window))
                    - starts.partition_point(|&start| start < at);
                let free = i64::try_from(count.saturating_sub(inside)).unwrap_or(i64::MAX);
                worth = worth.saturating_add(price.saturating_mul(free));
            }
        }
    }
    Region { model, items, worth, cells, left, starts, from }
}

/// Adds what still fits, the most valuable first, so that a rule excludes every session left out.
pub(super) fn complete(draft: &mut Draft<'_>, model: &Model) {
    let mut order: Vec<usize> = (0..model.sessions.len()).filter(|&id| !draft.stands(id)).collect();
    order.sort_by_key(|&id| (Reverse(model.sessions[id].value), id));
    for id in order {
        if draft.fits(&model.sessions[id]) {
            draft.add(id);
        }
    }
}
