//! At most so many sessions start in any sliding window.
//!
//! Method: the worst window begins at a session's start; walking over the sessions that stand, every one
//! that begins an overfull window gives that window's row.

use super::separation::AT_ONCE;
use crate::program::number::i64_from_usize;
use crate::program::{Family, Row};
use crate::schedule::model::Session;

/// At most `count` starts in `[t, t + window)`.
#[derive(Debug)]
pub(super) struct Starts<'m> {
    pub(super) sessions: &'m [Session],
    pub(super) count: usize,
    pub(super) window: i64,
}

impl Starts<'_> {
    /// The row of the window from an instant.
    pub(super) fn row(&self, from: i64) -> Row {
        let first = self.sessions.partition_point(|it| it.start < from);
        let until = from.saturating_add(self.window);
        let last = self.sessions.partition_point(|it| it.start < until);
        Row { terms: (first..last).map(|id| (id, 1)).collect(), limit: i64_from_usize(self.count) }
    }
}

impl Family for Starts<'_> {
    fn broken(&self, taken: &[bool]) -> Vec<Row> {
        let standing: Vec<usize> = (0..taken.len()).filter(|&id| taken[id]).collect();
        let mut rows = Vec::new();
        let mut at = 0;
        while let (Some(&first), Some(&last)) = (standing.get(at), standing.get(at + self.count)) {
            let from = self.sessions[first].start;
            if self.sessions[last].start.saturating_sub(from) < self.window {
                rows.push(self.row(from));
                at += self.count;
            }
            at += 1;
            if rows.len() >= AT_ONCE {
                break;
            }
        }
        rows
    }
}
