//! What the visits of one place come to: counts, dwell, how revisits and gaps are spread.
//!
//! Method: exact sums of nanoseconds; a median of an even number of values is the mean of the two in
//! the middle.
//!
//! Limits: edges at the search's start or end enter only with what is whole, as
//! [`counting`](super::counting) says; the total dwell counts what was seen of every visit.

use super::counting::{Counting, Wait, waits};
use super::histogram::Histogram;
use super::visit::Visit;
use onboard_core::time::{Duration, Instant};

/// Longest gaps that are kept with their times.
pub const LONGEST_GAPS: usize = 5;

/// Least, middle and largest of some spans of time, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// How many.
    pub count: usize,
    /// The shortest.
    pub shortest_s: f64,
    /// The median.
    pub median_s: f64,
    /// The mean.
    pub mean_s: f64,
    /// The longest.
    pub longest_s: f64,
}

/// A gap with its times.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gap {
    /// Exit of the visit before.
    pub from: Instant,
    /// Entry of the visit after.
    pub until: Instant,
}

/// Spans of one kind: how they are spread.
#[derive(Debug, Clone, PartialEq)]
pub struct Spans {
    /// None where there are no values.
    pub spread: Option<Spread>,
    /// In fixed logarithmic bins.
    pub logarithmic: Histogram,
    /// In linear bins.
    pub linear: Histogram,
}

/// The visits of one place.
#[derive(Debug, Clone, PartialEq)]
pub struct VisitStatistics {
    /// Visits, clipped ones included.
    pub visits: usize,
    /// Visits whose entry or exit is the search's start or end.
    pub clipped: usize,
    /// Visits per day of 86,400 s.
    pub per_day: f64,
    /// Time inside altogether.
    pub total_dwell: Duration,
    /// Of whole visits.
    pub dwell: Spans,
    /// Between whole entries.
    pub revisit: Spans,
    /// Between whole exits and entries.
    pub gap: Spans,
    /// The longest gaps, the longest first, at a tie the earlier.
    pub longest_gaps: Vec<Gap>,
}

impl Gap {
    /// Its length.
    #[must_use]
    pub const fn length(&self) -> Duration {
        self.until.since(self.from)
    }
}

impl Spread {
    /// Of some spans; none of none.
    #[must_use]
    pub fn of(values: &[Duration]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_unstable();
        let (shortest, longest) = (sorted.first()?, sorted.last()?);
        let total: i128 = sorted.iter().map(|value| i128::from(value.ns())).sum();
        let middle = sorted.len() / 2;
        let pair = if sorted.len().is_multiple_of(2) { middle - 1 } else { middle };
        let between = i128::from(sorted[pair].ns()) + i128::from(sorted[middle].ns());
        Some(Self {
            count: sorted.len(),
            shortest_s: shortest.seconds(),
            median_s: seconds(between) / 2.0,
            mean_s: seconds(total) / count(sorted.len()),
            longest_s: longest.seconds(),
        })
    }
}

impl Spans {
    fn of(values: &[Duration]) -> Self {
        Self {
            spread: Spread::of(values),
            logarithmic: Histogram::logarithmic(values),
            linear: Histogram::linear(values),
        }
    }
}

impl VisitStatistics {
    /// Of visits in order, over a search of `span`.
    #[must_use]
    pub fn of(visits: &[Visit], counting: Counting, span: Duration) -> Self {
        let waits = waits(visits, counting);
        let chosen = |pick: fn(&Wait) -> Option<Duration>| -> Vec<Duration> {
            waits.iter().filter_map(pick).collect()
        };
        let whole: Vec<Duration> = visits
            .iter()
            .filter(|visit| !visit.entry_clipped && !visit.exit_clipped)
            .map(Visit::dwell)
            .collect();
        let total = visits.iter().map(|visit| visit.dwell().ns()).sum();
        Self {
            visits: visits.len(),
            clipped: visits.len() - whole.len(),
            per_day: count(visits.len()) / (span.seconds() / 86_400.0),
            total_dwell: Duration::from_ns(total),
            dwell: Spans::of(&whole),
            revisit: Spans::of(&chosen(|wait| wait.revisit)),
            gap: Spans::of(&chosen(|wait| wait.gap)),
            longest_gaps: longest(visits, &waits),
        }
    }
}

fn longest(visits: &[Visit], waits: &[Wait]) -> Vec<Gap> {
    let mut gaps: Vec<Gap> = visits
        .windows(2)
        .zip(waits)
        .filter(|(_, wait)| wait.gap.is_some())
        .map(|(pair, _)| Gap { from: pair[0].exit, until: pair[1].entry })
        .collect();
    gaps.sort_by_key(|gap| (std::cmp::Reverse(gap.length()), gap.from));
    gaps.truncate(LONGEST_GAPS);
    gaps
}

#[expect(clippy::cast_precision_loss, reason = "sums of ns, shown in seconds")]
fn seconds(ns: i128) -> f64 {
    ns as f64 / 1e9
}

#[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
fn count(number: usize) -> f64 {
    number as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn visit(entry_s: i64, exit_s: i64) -> Visit {
        Visit {
            entry: Instant::from_tai_ns(entry_s * 1_000_000_000),
            exit: Instant::from_tai_ns(exit_s * 1_000_000_000),
            entry_clipped: false,
            exit_clipped: false,
        }
    }

    #[test]
    fn a_plain_case_by_hand() {
        let last = Visit { exit_clipped: true, ..visit(1000, 1010) };
        let visits = [visit(0, 2), visit(100, 104), visit(110, 113), last];
        let day = Duration::from_seconds(86_400.0 / 2.0);
        let found = VisitStatistics::of(&visits, Counting::Crossings, day);
        assert_eq!((found.visits, found.clipped), (4, 1));
        assert_eq!(found.total_dwell, Duration::from_seconds(19.0));
        assert!((found.per_day - 8.0).abs() < 1e-12);
        let revisit = found.revisit.spread.unwrap();
        assert_eq!(revisit.count, 3);
        for (value, expected) in [
            (revisit.shortest_s, 10.0),
            (revisit.median_s, 100.0),
            (revisit.mean_s, 1000.0 / 3.0),
            (revisit.longest_s, 890.0),
            (found.dwell.spread.unwrap().median_s, 3.0),
            (found.gap.spread.unwrap().median_s, 98.0),
        ] {
            assert!((value - expected).abs() < 1e-9, "{value} {expected}");
        }
        let lengths: Vec<f64> =
            found.longest_gaps.iter().map(|gap| gap.length().seconds()).collect();
        assert_eq!(lengths.len(), 3);
        assert!(lengths.is_sorted_by(|a, b| a >= b));
        assert_eq!(found.longest_gaps[0].from, visits[2].exit);
    }

    #[test]
    fn no_visit_has_no_spread() {
        let found = VisitStatistics::of(&[], Counting::Samples, Duration::from_seconds(1.0));
        assert_eq!((found.visits, found.dwell.spread, found.gap.spread), (0, None, None));
        assert!(found.longest_gaps.is_empty());
        assert!(found.per_day.abs() < 1e-300);
    }

    #[test]
    fn an_even_number_has_its_median_between() {
        let values: Vec<Duration> =
            [4.0, 1.0, 3.0, 10.0].into_iter().map(Duration::from_seconds).collect();
        assert!((Spread::of(&values).unwrap().median_s - 3.5).abs() < 1e-12);
    }
}
