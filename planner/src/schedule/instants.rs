//! At which instants the rules of overlap and of sliding windows need a row.
//!
//! Method: sessions that overlap form an interval graph, whose maximal cliques each share an instant:
//! the last start before one of their ends. A sliding window is worst where it begins with a session.
//!
//! Limits: of the windows only some get a row, the next one beginning with the first session that starts
//! a set distance later: a [`WINDOWS`]th of a window, at most [`MOST_APART`].

use super::model::Model;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Windows with a row in the length of a window, at least.
pub(super) const WINDOWS: i64 = 24;
/// Distance in ns after which a further window gets a row, at most.
pub(super) const MOST_APART: i64 = 10_800_000_000_000;

/// One instant in each maximal set of sessions that overlap; sessions come by start.
///
/// A set is maximal where a session ends before the next one starts.
pub(super) fn cliques(model: &Model, ids: impl Iterator<Item = usize>) -> Vec<i64> {
    let mut points = Vec::new();
    let mut ends: BinaryHeap<Reverse<i64>> = BinaryHeap::new();
    let mut last = None;
    for id in ids {
        let session = &model.sessions[id];
        let ended =
            |ends: &BinaryHeap<Reverse<i64>>| ends.peek().is_some_and(|end| end.0 <= session.start);
        if ended(&ends) {
            points.extend(last);
        }
        while ended(&ends) {
            ends.pop();
        }
        ends.push(Reverse(session.end));
        last = Some(session.start);
    }
    points.extend(last);
    points
}

/// First instants of the windows that get a row.
pub(super) fn window_starts(model: &Model, ids: &[usize]) -> Vec<i64> {
    let Some((count, window)) = model.count else { return Vec::new() };
    let apart = (window / WINDOWS).min(MOST_APART);
    let mut points: Vec<i64> = Vec::new();
    for (place, &id) in ids.iter().enumerate() {
        let start = model.sessions[id].start;
        let next = points.last().is_none_or(|&last| start.saturating_sub(last) >= apart);
        let crowded = ids
            .get(place.saturating_add(count))
            .is_some_and(|&other| model.sessions[other].start < start.saturating_add(window));
        if next && crowded && points.last() != Some(&start) {
            points.push(start);
        }
    }
    points
}
