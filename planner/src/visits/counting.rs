//! How long from one visit to the next, by crossings or by samples.
//!
//! By crossings: revisit is the next entry less this entry, gap the next entry less this exit. By
//! samples, as [Takase2024, section 6.2] counts: sample j lies at `j/f_s` from the start, a visit is a
//! run of consecutive samples inside, and differences of samples inside that are at least two sampling
//! periods apart are the revisit times. Such a difference runs from the last sample of a run, so both
//! revisit and gap are that difference then.
//!
//! Method: samples follow from the crossings, for the samples inside are those between an entry and
//! its exit; index and instant are exact ratios of integers.
//!
//! Limits: an edge at the search's start or end is not the visit's own, and gives no revisit or gap.
//! A sample within a nanosecond of a crossing may go either way.

use super::visit::Visit;
use onboard_core::time::{Duration, Instant};
use std::num::NonZeroU64;

/// Samples at even spans from a start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// Instant of sample 0.
    pub start: Instant,
    /// Samples, and in how many seconds: the rate as a ratio.
    pub rate_hz: (NonZeroU64, NonZeroU64),
}

/// What is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counting {
    /// Entries and exits.
    Crossings,
    /// Samples inside.
    Samples,
}

/// From one visit to the next of the same place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wait {
    /// Next entry less this entry; by samples as the gap.
    pub revisit: Option<Duration>,
    /// Next entry less this exit.
    pub gap: Option<Duration>,
}

const NS: i128 = 1_000_000_000;

impl Sampling {
    fn ratio(&self) -> (i128, i128) {
        (i128::from(self.rate_hz.0.get()), i128::from(self.rate_hz.1.get()) * NS)
    }

    /// Index of the first sample at or after `at`.
    fn first_from(&self, at: Instant) -> i128 {
        let (above, below) = self.ratio();
        let scaled = i128::from(at.since(self.start).ns()) * above;
        -(-scaled).div_euclid(below)
    }

    /// Index of the last sample at or before `at`.
    fn last_until(&self, at: Instant) -> i128 {
        let (above, below) = self.ratio();
        (i128::from(at.since(self.start).ns()) * above).div_euclid(below)
    }

    /// Instant of a sample, to the nearest nanosecond.
    fn instant(&self, index: i128) -> Instant {
        let (above, below) = self.ratio();
        let ns = (2 * index * below + above).div_euclid(2 * above);
        self.start.plus(Duration::from_ns(i64::try_from(ns).unwrap_or(i64::MAX)))
    }
}

/// Visits as runs of consecutive samples: from the first to the last sample inside. Visits without a
/// sample vanish, and such as have no sample between them are one.
#[must_use]
pub fn sampled(visits: &[Visit], sampling: &Sampling) -> Vec<Visit> {
    let mut runs: Vec<(i128, i128, Visit)> = Vec::new();
    for visit in visits {
        let (first, last) = (sampling.first_from(visit.entry), sampling.last_until(visit.exit));
        if first > last {
            continue;
        }
        match runs.last_mut() {
            Some((_, end, run)) if first - *end < 2 => {
                *end = last;
                run.exit = sampling.instant(last);
                run.exit_clipped = visit.exit_clipped;
            }
            _ => {
                let (entry, exit) = (sampling.instant(first), sampling.instant(last));
                runs.push((first, last, Visit { entry, exit, ..*visit }));
            }
        }
    }
    runs.into_iter().map(|(_, _, run)| run).collect()
}

/// The wait after each visit; none after the last.
#[must_use]
pub fn waits(visits: &[Visit], counting: Counting) -> Vec<Wait> {
    let mut waits: Vec<Wait> = visits
        .windows(2)
        .map(|pair| {
            let [this, next] = [pair[0], pair[1]];
            let gap =
                (!this.exit_clipped && !next.entry_clipped).then(|| next.entry.since(this.exit));
            let revisit = match counting {
                Counting::Samples => gap,
                Counting::Crossings => (!this.entry_clipped && !next.entry_clipped)
                    .then(|| next.entry.since(this.entry)),
            };
            Wait { revisit, gap }
        })
        .collect();
    waits.resize(visits.len(), Wait::default());
    waits
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn visit(entry: i64, exit: i64) -> Visit {
        Visit {
            entry: Instant::from_tai_ns(entry),
            exit: Instant::from_tai_ns(exit),
            entry_clipped: false,
            exit_clipped: false,
        }
    }

    fn sampling(above: u64, below: u64) -> Sampling {
        let ratio = |value| NonZeroU64::new(value).unwrap();
        Sampling { start: Instant::from_tai_ns(1000), rate_hz: (ratio(above), ratio(below)) }
    }

    #[test]
    fn waits_run_between_whole_edges() {
        let clipped_entry = Visit { entry_clipped: true, ..visit(0, 10) };
        let clipped_exit = Visit { exit_clipped: true, ..visit(90, 99) };
        let visits = [clipped_entry, visit(30, 50), clipped_exit];
        let ns = |value| Some(Duration::from_ns(value));
        assert_eq!(
            waits(&visits, Counting::Crossings),
            [
                Wait { revisit: None, gap: ns(20) },
                Wait { revisit: ns(60), gap: ns(40) },
                Wait::default()
            ]
        );
        assert_eq!(waits(&visits, Counting::Samples)[1], Wait { revisit: ns(40), gap: ns(40) });
        assert!(waits(&[], Counting::Crossings).is_empty());
    }

    #[test]
    fn a_run_joins_visits_without_a_sample_between() {
        // A sample every 100 ns from 1000.
        let every = sampling(10_000_000, 1);
        let visits = [visit(950, 1050), visit(1060, 1110), visit(1120, 1190), visit(1290, 1410)];
        assert_eq!(sampled(&visits, &every), [visit(1000, 1100), visit(1300, 1400)]);
    }

    proptest! {
        #[test]
        fn runs_are_the_samples_inside(
            above in 1_u64..2_000, below in 1_u64..2_000, spans in proptest::collection::vec(1..5_000_i64, 2..40),
        ) {
            // Edges off any sample by half a nanosecond at least: compare with a plain count.
            let sampling = sampling(above * 1_000_000, below);
            let mut now = 1000;
            let mut visits = Vec::new();
            for pair in spans.chunks_exact(2) {
                visits.push(visit(now + pair[0], now + pair[0] + pair[1]));
                now += pair[0] + pair[1] + 1;
            }
            let mut inside = Vec::new();
            for index in 0.. {
                let scaled = index * i128::from(below) * 1_000_000_000;
                let within = |v: &Visit| {
                    let offset = |at: Instant| i128::from(at.tai_ns() - 1000) * i128::from(above) * 1_000_000;
                    offset(v.entry) <= scaled && scaled <= offset(v.exit)
                };
                if visits.iter().any(within) {
                    inside.push(index);
                }
                if scaled > i128::from(now) * i128::from(above) * 1_000_000 {
                    break;
                }
            }
            let mut runs: Vec<(i128, i128)> = Vec::new();
            for index in inside {
                match runs.last_mut() {
                    Some(run) if index - run.1 < 2 => run.1 = index,
                    _ => runs.push((index, index)),
                }
            }
            let found = sampled(&visits, &sampling);
            prop_assert_eq!(found.len(), runs.len());
            for (visit, (first, last)) in found.iter().zip(runs) {
                prop_assert_eq!(visit.entry, sampling.instant(first));
                prop_assert_eq!(visit.exit, sampling.instant(last));
            }
        }
    }
}
