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
//! (`columns.rs`). Memory, thermal windows and gaps are further numbers of a label (`further.rs`). Where more
//! labels live than the work that is left allows (`effort.rs`), one pass keeps the most promising, which
//! gives a schedule, and another lets a label that nearly dominates others absorb them, its resources
//! lowered to theirs, which gives a bound (`pass.rs`).
//!
//! Limits: seasons, scan angles and logarithms are not known here, and for a bound gaps are not either. More
//! than `MOST_PLACES` starts, lanes and last starts, or sessions over more than `MOST_DAYS` days, are left to
//! the other searches (`size.rs`).

mod size;
mod items;
mod columns;
mod further;
mod effort;
mod pass;

use crate::progress::Progress;
use effort::Effort;
use pass::{Keep, pass};
use std::sync::atomic::{AtomicBool, Ordering};

pub(super) use further::Further;
pub(super) use items::Items;

/// Comparisons of labels in one pass: some ten seconds.
pub(super) const EFFORT: u64 = 20_000_000_000;

/// What the labels give.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Found {
    /// Sessions of the schedule, ascending.
    pub(super) taken: Vec<usize>,
    /// Its value in units.
    pub(super) value: i128,
    /// It is the best.
    pub(super) exact: bool,
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

/// A schedule of the most valuable labels, and whether it is the best: `None` where labels do not serve or
/// the search was stopped.
pub(super) fn best(items: &Items<'_>, comparisons: u64, progress: &dyn Progress) -> Option<Found> {
    let passed = pass(items, Keep::Best, Effort::new(comparisons), progress)?;
    Some(Found {
        taken: items.sessions(&passed.taken),
        value: i128::from(passed.value),
        exact: passed.exact,
    })
}

/// No schedule is worth more; as [`best`].
pub(super) fn bound(items: &Items<'_>, comparisons: u64, progress: &dyn Progress) -> Option<i128> {
    let passed = pass(items, Keep::Merged, Effort::new(comparisons), progress)?;
    Some(i128::from(passed.value))
}

/// The best schedule and a bound in one; as [`best`].
pub(super) fn both(
    items: &Items<'_>,
    comparisons: u64,
    progress: &dyn Progress,
) -> Option<(Found, i128)> {
    let proved = AtomicBool::new(false);
    let below = || {
        let below = best(items, comparisons, progress);
        proved.store(below.as_ref().is_some_and(|it| it.exact), Ordering::Relaxed);
        below
    };
    let above = || bound(items, comparisons, &Unless { progress, proved: &proved });
    let (below, above) = rayon::join(below, above);
    let below = below?;
    let bound = if below.exact { below.value } else { above? };
    Some((below, bound))
}
