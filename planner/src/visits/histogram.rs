//! How waits are spread: counts in bins of equal ratio or of equal width.
//!
//! Logarithmic bins have fixed edges, [`BINS_PER_DECADE`] in each decade from 1 ms to 1e8 s (3.2 y), so
//! that missions compare bin by bin. Linear bins run from 0 to above the longest value, at most
//! [`MOST_LINEAR_BINS`] of a width of 1, 2 or 5 times a power of ten seconds.
//!
//! Method: the flight core's [`Bins`]; a value belongs to the bin whose edges hold it, the lower one
//! included.

use onboard_core::time::Duration;
use onboard_core::visits::{Bins, HistogramBin, Spacing};

/// Logarithmic bins in a decade.
pub const BINS_PER_DECADE: usize = 10;
/// Most linear bins.
pub const MOST_LINEAR_BINS: usize = 50;
/// Decades of logarithmic bins.
const DECADES: usize = 11;
const LOG_LOW_S: f64 = 1e-3;
const LOG_HIGH_S: f64 = 1e8;

/// Counts by bin.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// How bins are spaced.
    pub spacing: Spacing,
    /// Edges in seconds, one more than bins.
    pub edges_s: Vec<f64>,
    /// Values in each bin.
    pub counts: Vec<u64>,
    /// Values below the first bin.
    pub under: u64,
    /// Values at or above the end of the last bin.
    pub over: u64,
}

impl Histogram {
    /// In the fixed logarithmic bins.
    #[must_use]
    pub fn logarithmic(values: &[Duration]) -> Self {
        let count = BINS_PER_DECADE * DECADES;
        Self::of(values, Spacing::Logarithmic, (LOG_LOW_S, LOG_HIGH_S), count)
    }

    /// In linear bins of a round width; one bin of a second without values.
    #[must_use]
    pub fn linear(values: &[Duration]) -> Self {
        let longest = values.iter().max().map_or(0.0, |value| value.seconds());
        let (width, count) = round_bins(longest);
        Self::of(values, Spacing::Linear, (0.0, width * real(count)), count)
    }

    fn of(values: &[Duration], spacing: Spacing, (low, high): (f64, f64), count: usize) -> Self {
        let mut histogram =
            Self { spacing, edges_s: Vec::new(), counts: vec![0; count], under: 0, over: 0 };
        // The ends are in order and finite by construction.
        let Ok(bins) = Bins::new(spacing, low, high) else { return histogram };
        histogram.edges_s = (0..=count).map(|index| bins.edge_s(index, count)).collect();
        for value in values {
            match bins.bin(value.seconds(), count) {
                HistogramBin::Underflow => histogram.under += 1,
                HistogramBin::Overflow => histogram.over += 1,
                HistogramBin::Bin(index) => histogram.counts[index] += 1,
            }
        }
        histogram
    }
}

/// Width in seconds and number of bins from 0 to above `longest` seconds.
fn round_bins(longest: f64) -> (f64, usize) {
    let mut decade = 1e-6;
    loop {
        for step in [1.0, 2.0, 5.0] {
            let width = step * decade;
            if longest < width * real(MOST_LINEAR_BINS) {
                let count = (1..=MOST_LINEAR_BINS).find(|count| longest < width * real(*count));
                return (width, count.unwrap_or(MOST_LINEAR_BINS));
            }
        }
        decade *= 10.0;
    }
}

#[expect(clippy::cast_precision_loss, reason = "at most a few dozen")]
fn real(count: usize) -> f64 {
    count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(values: &[f64]) -> Vec<Duration> {
        values.iter().map(|value| Duration::from_seconds(*value)).collect()
    }

    #[test]
    fn logarithmic_edges_are_tenths_of_decades() {
        let histogram = Histogram::logarithmic(&seconds(&[0.5e-3, 1.0, 1.3, 1200.0, 2e8]));
        assert_eq!((histogram.counts.len(), histogram.edges_s.len()), (110, 111));
        for (index, edge) in histogram.edges_s.iter().enumerate() {
            let expected = 10.0_f64.powf(real(index) / 10.0 - 3.0);
            assert!((edge / expected - 1.0).abs() < 1e-14);
        }
        assert_eq!((histogram.under, histogram.over), (1, 1));
        let filled: Vec<usize> = (0..110).filter(|index| histogram.counts[*index] > 0).collect();
        assert_eq!(filled, [30, 31, 60]);
    }

    #[test]
    fn linear_bins_are_round_and_hold_everything() {
        for longest in [0.02, 0.99, 1.0, 7.0, 49.9, 50.0, 1200.0, 1.6e7, 9e7] {
            let histogram = Histogram::linear(&seconds(&[longest, 0.5 * longest]));
            assert!(histogram.counts.len() <= MOST_LINEAR_BINS);
            assert!(histogram.counts.len() > MOST_LINEAR_BINS / 3, "{longest}");
            assert_eq!((histogram.under, histogram.over), (0, 0));
            assert_eq!(histogram.counts.iter().sum::<u64>(), 2);
            assert_eq!(histogram.counts.last(), Some(&1));
        }
        assert_eq!(Histogram::linear(&[]).counts.iter().sum::<u64>(), 0);
    }
}
