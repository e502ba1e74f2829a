//! How are samples cut into pieces of work: runs over which the Sun's direction is one arc, and tasks
//! that a thread takes at a time.
//!
//! Runs end at multiples of a number of samples and at the Sun's steps, so that they do not depend on
//! the number of threads.
//!
//! Limits: a run lasts at most [`LONGEST_ARC_S`].

use super::clock::SampleClock;
use super::sampled::Sampled;
use std::ops::Range;

/// Longest time of a run, in seconds.
const LONGEST_ARC_S: f64 = 7200.0;
/// Most samples of a run.
pub(super) const LONGEST_RUN: u64 = 1 << 14;
/// Samples that a thread takes at a time, about.
const TASK_SAMPLES: u64 = 1 << 19;

/// Consecutive samples, over which the Sun's direction is one arc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Run {
    pub(super) first: u64,
    pub(super) end: u64,
}

impl Run {
    /// How many.
    pub(crate) const fn samples(&self) -> u64 {
        self.end - self.first
    }
}

/// The samples `span` in runs, grouped into tasks.
pub(super) fn tasks(sampled: &Sampled<'_>, span: Range<u64>) -> Vec<Vec<Run>> {
    let longest = longest(&sampled.clock);
    let per_task = (TASK_SAMPLES / sampled.detectors.len().max(1) as u64).max(longest);
    let mut tasks = Vec::new();
    let mut task = Vec::new();
    let mut samples = 0;
    let mut first = span.start;
    while first < span.end {
        let grid = (first / longest + 1).saturating_mul(longest);
        let step = sampled.sun.next_step(&sampled.clock, first);
        let end = grid.min(step).min(span.end).max(first + 1);
        task.push(Run { first, end });
        samples += end - first;
        if samples >= per_task {
            tasks.push(std::mem::take(&mut task));
            samples = 0;
        }
        first = end;
    }
    if !task.is_empty() {
        tasks.push(task);
    }
    tasks
}

/// Most samples of a run on this clock.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positive, and below 2^14 where it is turned into a whole number"
)]
fn longest(clock: &SampleClock) -> u64 {
    let by_time = LONGEST_ARC_S / clock.period_s();
    if by_time >= LONGEST_RUN as f64 { LONGEST_RUN } else { (by_time as u64).max(1) }
}
