//! The best schedule by labels: an exact dynamic programme over time.
//!
//! Sessions are visited by start. A **label** is a schedule of the sessions so far, as far as later ones
//! can tell: its value, the time used of this day and the following ones, the last starts that still
//! count in the sliding window, and until when each lane is busy. One label dominates another when its
//! value is at least as large and nothing of it is worse; dominated labels are dropped, so the best of
//! those at the end is the optimum under overlap, days and windows of starts.
//!
//! Method: lanes with the same sessions are one class of several places, which removes their symmetry
//! (`items.rs`). Labels stand by columns, so that a dominator is looked for in many at a time
//! (`columns.rs`). Where more labels live than the work that is left allows (`effort.rs`), one pass keeps the most valuable, which
//! gives a schedule, and another lets a label that nearly dominates others absorb them, its resources
//! lowered to theirs, which gives a bound (`pass.rs`).
//!
//! Limits: rules that link far times (seasons, gaps, memory, scan angles) are not known here. More than
//! [`MOST_PLACES`] starts and lanes, or sessions over more than [`MOST_DAYS`] days, are left to the other
//! searches.

mod items;
mod columns;
mod effort;
mod pass;

use super::model::Model;
use crate::program::Program;
use crate::progress::Progress;
use effort::Effort;
use items::Items;
use pass::{Keep, pass};
use std::sync::atomic::{AtomicBool, Ordering};

/// Most starts in a window and lanes together.
pub(super) const MOST_PLACES: usize = 24;
/// Most days that a session touches.
pub(super) const MOST_DAYS: usize = 4;

/// Comparisons of labels in one pass: some ten seconds.
const EFFORT: u64 = 20_000_000_000;

/// What the labels give.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Found {
    /// Sessions of the schedule, ascending.
    pub(super) taken: Vec<usize>,
    /// Its value in units.
    pub(super) value: i128,
    /// No schedule has a larger value.
    pub(super) bound: i128,
}

/// Stops where a schedule is proved to be the best.
struct Unless<'p> {
    progress: &'p dyn Progress,
    proved: &'p AtomicBool,
}

impl Progress for Unless<'_> {
    fn advance(&self, steps: u64) {
        self.progress.advance(steps);
    }

    fn stopped(&self) -> bool {
        self.proved.load(Ordering::Relaxed) || self.progress.stopped()
    }
}

/// The best schedule and a bound; `None` where labels do not serve or the search was stopped.
pub(super) fn search(
    model: &Model,
    program: &Program,
    progress: &dyn Progress,
) -> Option<Found> {
    let items = Items::new(model, program)?;
    let effort = Effort::new(EFFORT);
    let work = u64::try_from(items.len()).unwrap_or(u64::MAX);
    progress.begin("labels", work.saturating_mul(2));
    let proved = AtomicBool::new(false);
    let best = || {
        let below = pass(&items, Keep::Best, effort, progress);
        proved.store(below.as_ref().is_some_and(|it| it.exact), Ordering::Relaxed);
        below
    };
    let merged = || pass(&items, Keep::Merged, effort, &Unless { progress, proved: &proved });
    let (below, above) = rayon::join(best, merged);
    let below = below?;
    let bound = if below.exact { below.value } else { above?.value };
    let taken = items.sessions(&below.taken);
    Some(Found { taken, value: i128::from(below.value), bound: i128::from(bound) })
}
