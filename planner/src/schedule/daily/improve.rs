//! A schedule by rounding the relaxation, and local search over spans of a few days.
//!
//! Method: [`round`] takes sessions in order of their relaxed share in steps of 1e-4, then by value
//! per reserved time, then by position: ties fall the same way every time. [`improve`] slides a span
//! of one and a half cells over the mission by a quarter of a cell; all sessions that start inside are
//! removed, and the best set given all that stands outside, found by exact search, is put in.
//! Passes repeat until one changes nothing; only spans that a change can affect are searched again.
//!
//! Limits: at most the given number of passes, and [`NODES`] nodes per search.

use super::relaxation::Relaxed;
use super::search::{Effort, Item, Region, search};
use crate::program::number::{f64_from_i64, i64_from_f64, i64_from_usize};
use crate::progress::Progress;
use crate::schedule::draft::Draft;
use crate::schedule::model::Model;
use crate::schedule::price::Prices;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BTreeSet;

/// Most nodes of one search.
const NODES: usize = 2_000;
/// Shares count in steps of 1e-4.
const SHARE_STEPS: f64 = 1e4;
/// Offsets of the running sum tried in rounding.
const OFFSETS: i64 = 4;
/// Spans begin so many to a cell, and each is so many of these steps long.
const SLIDES: i64 = 4;
const SPAN: i64 = 6;

/// Prices, and what each session is worth beyond what it pays.
#[derive(Debug)]
pub(super) struct Priced<'a> {
    prices: &'a Prices,
    reduced: Vec<i64>,
}

impl<'a> Priced<'a> {
    pub(super) fn new(model: &Model, prices: &'a Prices) -> Self {
        let sessions = model.sessions.iter();
        Self { prices, reduced: sessions.map(|it| it.value - prices.of(model, it)).collect() }
    }
}

/// The best schedule by rounding the relaxation in several ways; nothing more fits into it.
///
/// First by share alone. Then by the running sum of the shares, which a session steps over an
/// integer plus an offset or not: so every window holds at most its relaxed number, rounded up.
pub(super) fn round<'a>(model: &'a Model, relaxed: &Relaxed) -> Draft<'a> {
    let share = |id: usize| i64_from_f64((relaxed.shares[id] * SHARE_STEPS).round());
    let ways = if model.count.is_some() { OFFSETS } else { 0 };
    let drafts: Vec<Draft<'a>> = (0..=ways)
        .into_par_iter()
        .map(|way| {
            let mut draft = Draft::new(model);
            let offset = f64_from_i64(2 * way - 1) / f64_from_i64(2 * OFFSETS);
            let mut sum = offset;
            let stepped: Vec<bool> = relaxed
                .shares
                .iter()
                .map(|share| {
                    let before = sum.floor();
                    sum += share.clamp(0.0, 1.0);
                    way > 0 && sum.floor() > before
                })
                .collect();
            let first = i64_from_f64(2.0 * SHARE_STEPS);
            fill_up(&mut draft, model, |id| share(id) + if stepped[id] { first } else { 0 });
            draft
        })
        .collect();
    let best = drafts.into_iter().rev().max_by_key(Draft::value);
    best.unwrap_or_else(|| Draft::new(model))
}

/// Adds what fits, in order of rank, then of value per reserved time.
fn fill_up(draft: &mut Draft<'_>, model: &Model, rank: impl Fn(usize) -> i64) {
    let sessions = model.sessions.iter().enumerate();
    let mut order: Vec<_> = sessions
        .filter(|&(id, session)| !draft.stands(id) && draft.fits(session))
        .map(|(id, session)| {
            let density = f64_from_i64(session.value) / f64_from_i64(session.length());
            (Reverse(rank(id)), Reverse(density.to_bits()), id)
        })
        .collect();
    order.sort_unstable();
    for (_, _, id) in order {
        if draft.fits(&model.sessions[id]) {
            draft.add(id);
        }
    }
}

/// Exchanges sessions in at most `passes` passes, until asked to stop; true if nothing within a span
/// helps any more.
///
/// Nothing more fits into the result.
pub(super) fn improve(
    draft: &mut Draft<'_>,
    model: &Model,
    priced: &Priced<'_>,
    (passes, progress): (usize, &dyn Progress),
) -> bool {
    fill_up(draft, model, |_| 0);
    let (Some(&first), Some(&last)) = (model.cells.first(), model.cells.last()) else {
        return true;
    };
    let mut spans = Spans::new(model, first, last);
    for _ in 0..passes {
        let mut changed = false;
        for place in 0..spans.stale.len() {
            if progress.stopped() {
                return false;
            }
            if std::mem::take(&mut spans.stale[place]) {
                let span = spans.span(place);
                if exchange(draft, model, priced, span) {
                    spans.touch(span.0, span.1);
                    changed = true;
                }
            }
        }
        let before: BTreeSet<usize> = draft.chosen().collect();
        changed |= swap(draft, model);
        fill_up(draft, model, |_| 0);
        if !changed {
            return true;
        }
        for &id in &before {
            if !draft.stands(id) {
                spans.touch(model.sessions[id].start, model.sessions[id].start);
            }
        }
        for id in draft.chosen().filter(|id| !before.contains(id)) {
            spans.touch(model.sessions[id].start, model.sessions[id].start);
        }
    }
    false
}

/// The spans of a pass, and which of them may have something new to find.
#[derive(Debug)]
struct Spans {
    /// Start of the first span.
    first: i64,
    /// Time from one span to the next.
    slide: i64,
    /// How far a change is felt, in slides.
    reach: i64,
    stale: Vec<bool>,
}

impl Spans {
    fn new(model: &Model, first: i64, last: i64) -> Self {
        let cells = i64_from_usize(model.cell_count().max(1));
        let slide = (last.saturating_sub(first) / cells / SLIDES).max(1);
        let first = first.saturating_sub(slide * (SPAN - 1));
        let felt = model.count.map_or(0, |(_, window)| window).max(model.longest);
        let felt = felt.max(if model.day_limit.is_some() { 2 * SLIDES * slide } else { 0 });
        let spans = usize::try_from((last - first + slide - 1) / slide).unwrap_or(0);
        Self { first, slide, reach: felt / slide + 1 + SPAN, stale: vec![true; spans] }
    }

    fn span(&self, place: usize) -> (i64, i64) {
        let from = self.first.saturating_add(self.slide.saturating_mul(i64_from_usize(place)));
        (from, from.saturating_add(self.slide * SPAN))
    }

    /// Something changed among the sessions that start in `[from, until]`.
    fn touch(&mut self, from: i64, until: i64) {
        let place = |at: i64| (at - self.first) / self.slide;
        let from = usize::try_from(place(from) - self.reach).unwrap_or(0);
        let until = usize::try_from(place(until) + self.reach).unwrap_or(0);
        let until = until.saturating_add(1).min(self.stale.len());
        if let Some(stale) = self.stale.get_mut(from..until) {
            stale.fill(true);
        }
    }
}

/// Takes in every session that is worth more than what stands in its way; false where none is.
fn swap(draft: &mut Draft<'_>, model: &Model) -> bool {
    let mut order: Vec<usize> = (0..model.sessions.len()).collect();
    order.sort_unstable_by_key(|&id| (Reverse(model.sessions[id].value), id));
    let mut changed = false;
    for id in order {
        if draft.stands(id) {
            continue;
        }
        let Some(blockers) = draft.cheaper_blockers(&model.sessions[id]) else { continue };
        for blocker in blockers {
            draft.remove(blocker);
        }
        draft.add(id);
        changed = true;
    }
    changed
}

/// Replaces what starts in a span by something better; false where nothing is.
fn exchange(draft: &mut Draft<'_>, model: &Model, priced: &Priced<'_>, span: (i64, i64)) -> bool {
    let ids = model.starting(span.0, span.1);
    let taken: Vec<usize> = ids.clone().filter(|&id| draft.stands(id)).collect();
    let before: i64 = taken.iter().map(|&id| model.sessions[id].value).sum();
    for &id in &taken {
        draft.remove(id);
    }
    let items: Vec<Item> = ids
        .filter(|&id| draft.fits(&model.sessions[id]))
        .map(|id| Item { id, value: model.sessions[id].value, reduced: priced.reduced[id] })
        .collect();
    let region = region(draft, model, priced.prices, items);
    let found = search(&region, before, Effort { nodes: NODES, sets: 1 });
    let better = found.sets.first();
    for &id in better.map_or(&taken, |(_, ids)| ids) {
        draft.add(id);
    }
    better.is_some()
}

/// The items, which come by start, with what the rules leave for them.
fn region<'a>(
    draft: &Draft<'_>,
    model: &'a Model,
    prices: &Prices,
    items: Vec<Item>,
) -> Region<'a> {
    let session = |item: &Item| model.sessions[item.id];
    let from = items.first().map_or(0, |item| session(item).start);
    let last_start = items.last().map_or(0, |item| session(item).start);
    let until = items.iter().map(|item| session(item).end).max().unwrap_or(0);
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
        for (at, price) in prices.windows.between(first, last_start.saturating_add(1)) {
            let inside = starts.partition_point(|&start| start < at.saturating_add(window))
                - starts.partition_point(|&start| start < at);
            let free = i64_from_usize(count.saturating_sub(inside));
            worth = worth.saturating_add(price.saturating_mul(free));
        }
    }
    let filled = cells.len();
    Region { model, items, worth, cells, left, filled, starts, from }
}
