//! At most so much reserved time in any sliding window.
//!
//! Method: the worst window begins at a session's start or ends at a session's end, where the reserved
//! time inside, a piecewise linear function of the window's start, is largest. Windows that a fractional
//! solution violates are taken in order of their excess, a part of a window apart.

use super::separation::{AT_ONCE, BROKEN, SHARE};
use crate::program::number::f64_from_i128;
use crate::program::{Family, Row};
use crate::schedule::model::Session;

/// Windows that a fractional solution violates are at least this part of a window apart.
const WINDOWS_APART: i64 = 24;

/// At most `most` reserved time in `[t, t + window)`.
#[derive(Debug)]
pub(super) struct Heat<'m> {
    pub(super) sessions: &'m [Session],
    pub(super) longest: i64,
    pub(super) most: i64,
    pub(super) window: i64,
}

impl Heat<'_> {
    /// The row of the window from an instant.
    pub(super) fn row(&self, from: i64) -> Row {
        let until = from.saturating_add(self.window);
        let first =
            self.sessions.partition_point(|it| it.start < from.saturating_sub(self.longest));
        let last = self.sessions.partition_point(|it| it.start < until);
        let terms = (first..last.max(first)).filter_map(|id| {
            let it = &self.sessions[id];
            let inside = it.end.min(until).saturating_sub(it.start.max(from));
            (inside > 0).then_some((id, inside))
        });
        Row { terms: terms.collect(), limit: self.most }
    }
}

impl Family for Heat<'_> {
    fn broken(&self, taken: &[bool]) -> Vec<Row> {
        let standing = (0..taken.len()).filter(|&id| taken[id]).map(|id| self.sessions[id]);
        let standing: Vec<Session> = standing.collect();
        let used = |from: i64| -> i128 {
            let until = from.saturating_add(self.window);
            let first = standing.partition_point(|it| it.start < from.saturating_sub(self.longest));
            let near = standing[first..].iter().take_while(|it| it.start < until);
            near.map(|it| i128::from((it.end.min(until) - it.start.max(from)).max(0))).sum()
        };
        let places = standing.iter().flat_map(|it| [it.start, it.end.saturating_sub(self.window)]);
        let over = places.filter(|&from| used(from) > i128::from(self.most));
        over.take(AT_ONCE).map(|from| self.row(from)).collect()
    }

    fn separate(&self, shares: &[f64]) -> Vec<Row> {
        let standing: Vec<(Session, f64)> = self
            .sessions
            .iter()
            .zip(shares)
            .filter(|it| *it.1 > SHARE)
            .map(|(session, share)| (*session, *share))
            .collect();
        let most = f64_from_i128(i128::from(self.most));
        let used = |from: i64| -> f64 {
            let until = from.saturating_add(self.window);
            let early = from.saturating_sub(self.longest);
            let first = standing.partition_point(|it| it.0.start < early);
            let near = standing[first..].iter().take_while(|it| it.0.start < until);
            let inside = near.map(|(it, share)| {
                let ns = it.end.min(until).saturating_sub(it.start.max(from)).max(0);
                share * f64_from_i128(i128::from(ns))
            });
            inside.sum()
        };
        let places =
            standing.iter().flat_map(|it| [it.0.start, it.0.end.saturating_sub(self.window)]);
        let mut over: Vec<(f64, i64)> = places
            .map(|from| (used(from) - most, from))
            .filter(|it| it.0 > BROKEN * most)
            .collect();
        over.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        // Neighbours say nearly the same.
        let apart = self.window / WINDOWS_APART;
        let mut chosen: Vec<i64> = Vec::new();
        for (_, from) in over {
            let near = |it: &i64| from.abs_diff(*it) < apart.unsigned_abs();
            if chosen.len() < AT_ONCE && !chosen.iter().any(near) {
                chosen.push(from);
            }
        }
        chosen.into_iter().map(|from| self.row(from)).collect()
    }
}
