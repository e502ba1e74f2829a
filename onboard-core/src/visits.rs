//! How often is each target visited, for how long, and after what pause again.
//!
//! A [`VisitLog`] takes each target's transits in order of entry and keeps, per target, counts, sums and
//! histograms of dwell (exit less entry), revisit (next entry less entry) and gap (next entry less
//! exit) in lent memory. [`Forecast`](crate::forecast::Forecast) has the next visits.
//!
//! Method: [`Bins`] of equal width or equal ratio; a value belongs to the bin whose edges, as
//! [`Bins::edge_s`] gives them, hold it, the lower one included. Counters stop at their largest value.
//!
//! Limits: an edge at a search's start or end is not the visit's own: such a visit is counted, but
//! enters a histogram only with what its whole edges tell. A [`Histogram`] takes `4 BINS + 8` bytes,
//! a target three of them and at most 80 bytes more, a log 128 bytes beside its targets
//! (`tests/tests/visits.rs`).

use crate::bytes::put;
use crate::convert::{f64_from_u64, i64_from_f64};
use crate::time::{Duration, Instant};
use crate::transit::Transit;

/// How bins are spaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spacing {
    /// Equal widths.
    Linear,
    /// Equal ratios.
    Logarithmic,
}

/// The range of a histogram and how it is divided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bins {
    spacing: Spacing,
    low_s: f64,
    high_s: f64,
}

/// Why a range cannot be divided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BinsError {
    /// The lower end (seconds) is not finite and >= 0, or for logarithmic bins not above 1e-9.
    Low(f64),
    /// The upper end (seconds) is not finite or not above the lower end.
    High(f64),
}

/// Where a value falls.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HistogramBin {
    /// Below the first bin, or not a number.
    Underflow,
    /// In the bin of this index.
    Bin(usize),
    /// At or above the end of the last bin.
    Overflow,
}

/// Shortest lower end of logarithmic bins in seconds: the resolution of time.
const SHORTEST_LOW_S: f64 = 1e-9;

/// Bytes of a [`Bins`] in a record.
const BINS_BYTES: usize = 17;

impl Bins {
    /// Spacing and ends as bytes.
    pub(crate) fn to_le_bytes(self) -> [u8; BINS_BYTES] {
        let mut bytes = [0; BINS_BYTES];
        put(&mut bytes, 0, self.low_s.to_le_bytes());
        put(&mut bytes, 8, self.high_s.to_le_bytes());
        put(&mut bytes, 16, [u8::from(self.spacing == Spacing::Logarithmic)]);
        bytes
    }

    /// Bins from `low_s` to `high_s` in seconds.
    ///
    /// # Errors
    /// [`BinsError`] when an end is out of range.
    pub fn new(spacing: Spacing, low_s: f64, high_s: f64) -> Result<Self, BinsError> {
        let least = match spacing {
            Spacing::Linear => 0.0,
            Spacing::Logarithmic => SHORTEST_LOW_S,
        };
        if !(low_s.is_finite() && low_s >= least) {
            return Err(BinsError::Low(low_s));
        }
        if !(high_s.is_finite() && high_s > low_s) {
            return Err(BinsError::High(high_s));
        }
        Ok(Self { spacing, low_s, high_s })
    }

    /// Lower edge in seconds of bin `index` of `count`; the upper end for `index == count`.
    #[must_use]
    #[inline(never)]
    pub fn edge_s(&self, index: usize, count: usize) -> f64 {
        if index == 0 {
            return self.low_s;
        }
        if index >= count {
            return self.high_s;
        }
        let share = real(index) / real(count);
        match self.spacing {
            Spacing::Linear => self.low_s + (self.high_s - self.low_s) * share,
            Spacing::Logarithmic => {
                self.low_s * libm::exp(share * libm::log(self.high_s / self.low_s))
            }
        }
    }

    /// Where `seconds` falls among `count` bins.
    #[must_use]
    #[inline(never)]
    pub fn bin(&self, seconds: f64, count: usize) -> HistogramBin {
        if seconds >= self.high_s {
            return HistogramBin::Overflow;
        }
        if seconds < self.low_s || seconds.is_nan() || count == 0 {
            return HistogramBin::Underflow;
        }
        let share = match self.spacing {
            Spacing::Linear => (seconds - self.low_s) / (self.high_s - self.low_s),
            Spacing::Logarithmic => {
                libm::log(seconds / self.low_s) / libm::log(self.high_s / self.low_s)
            }
        };
        let last = count.saturating_sub(1);
        let guess = usize::try_from(i64_from_f64(share * real(count))).unwrap_or(0).min(last);
        // Rounding may miss by one; the edges decide.
        if seconds < self.edge_s(guess, count) {
            HistogramBin::Bin(guess.saturating_sub(1))
        } else if guess < last && seconds >= self.edge_s(guess.saturating_add(1), count) {
            HistogramBin::Bin(guess.saturating_add(1))
        } else {
            HistogramBin::Bin(guess)
        }
    }
}

/// A count as a number.
fn real(count: usize) -> f64 {
    f64_from_u64(u64::try_from(count).unwrap_or(u64::MAX))
}

/// Counts of values by bin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Histogram<const BINS: usize> {
    /// Values in each bin.
    pub counts: [u32; BINS],
    /// Values below the first bin.
    pub under: u32,
    /// Values at or above the end of the last bin.
    pub over: u32,
}

impl<const BINS: usize> Histogram<BINS> {
    pub(crate) const EMPTY: Self = Self { counts: [0; BINS], under: 0, over: 0 };

    fn count(&mut self, bins: &Bins, value: Duration) {
        count(bins, value, &mut self.counts, [&mut self.under, &mut self.over]);
    }

    /// All values counted, saturating.
    #[must_use]
    pub fn total(&self) -> u32 {
        let outside = self.under.saturating_add(self.over);
        self.counts.iter().fold(outside, |sum, count| sum.saturating_add(*count))
    }
}

/// Counts a value in its bin, or under or over all bins.
#[inline(never)]
fn count(bins: &Bins, value: Duration, counts: &mut [u32], [under, over]: [&mut u32; 2]) {
    let counter = match bins.bin(value.seconds(), counts.len()) {
        HistogramBin::Underflow => under,
        HistogramBin::Overflow => over,
        HistogramBin::Bin(index) => match counts.get_mut(index) {
            Some(counter) => counter,
            None => return,
        },
    };
    *counter = counter.saturating_add(1);
}

/// What is known of one target's visits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetVisits<const BINS: usize> {
    /// Visits, clipped ones included.
    pub visits: u32,
    /// Visits whose entry or exit is a search's start or end.
    pub clipped: u32,
    /// Sum of the dwells of whole visits.
    pub dwell_sum: Duration,
    /// Longest gap between an exit and the next entry, both whole.
    pub longest_gap: Option<Duration>,
    /// The last visit.
    pub last: Option<LastVisit>,
    /// Dwells of whole visits.
    pub dwell: Histogram<BINS>,
    /// Spans from entry to next entry, both whole.
    pub revisit: Histogram<BINS>,
    /// Spans from exit to next entry, both whole.
    pub gap: Histogram<BINS>,
}

/// Entry and exit of the last visit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LastVisit {
    /// Entry.
    pub entry: Instant,
    /// Exit.
    pub exit: Instant,
    /// The entry is the search's start.
    pub entry_clipped: bool,
    /// The exit is the search's end.
    pub exit_clipped: bool,
}

impl<const BINS: usize> TargetVisits<BINS> {
    /// No visit yet.
    pub const EMPTY: Self = Self {
        visits: 0,
        clipped: 0,
        dwell_sum: Duration::ZERO,
        longest_gap: None,
        last: None,
        dwell: Histogram::EMPTY,
        revisit: Histogram::EMPTY,
        gap: Histogram::EMPTY,
    };

    fn add(&mut self, transit: &Transit, divisions: &Divisions) {
        self.visits = self.visits.saturating_add(1);
        if transit.entry_clipped || transit.exit_clipped {
            self.clipped = self.clipped.saturating_add(1);
        } else {
            let dwell = transit.dwell();
            self.dwell_sum = Duration::from_ns(self.dwell_sum.ns().saturating_add(dwell.ns()));
            self.dwell.count(&divisions.dwell, dwell);
        }
        if let Some(last) = self.last
            && !transit.entry_clipped
        {
            if !last.entry_clipped {
                self.revisit.count(&divisions.revisit, transit.entry.since(last.entry));
            }
            if !last.exit_clipped {
                let gap = transit.entry.since(last.exit);
                self.gap.count(&divisions.gap, gap);
                self.longest_gap = Some(self.longest_gap.map_or(gap, |longest| longest.max(gap)));
            }
        }
        self.last = Some(LastVisit {
            entry: transit.entry,
            exit: transit.exit,
            entry_clipped: transit.entry_clipped,
            exit_clipped: transit.exit_clipped,
        });
    }
}

/// The bins of the three histograms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Divisions {
    /// Of dwells.
    pub dwell: Bins,
    /// Of revisits.
    pub revisit: Bins,
    /// Of gaps.
    pub gap: Bins,
}

/// Why a visit is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum VisitError {
    /// No target has this index.
    NoSuchTarget(usize),
    /// The exit lies before the entry.
    Reversed {
        /// Entry.
        entry: Instant,
        /// Exit.
        exit: Instant,
    },
    /// The entry lies before one of the same target that was taken already. Targets do not wait for
    /// each other: one whose tables ended early is searched, and counted, later.
    OutOfOrder {
        /// Entry.
        entry: Instant,
        /// The target's latest entry taken.
        latest: Instant,
    },
    /// The entry lies before the same target's last exit.
    Overlap {
        /// Entry.
        entry: Instant,
        /// The target's last exit.
        exit: Instant,
    },
}

/// Running statistics of visits, in histograms of `BINS` bins, in memory that the caller lends.
#[derive(Debug)]
pub struct VisitLog<'m, const BINS: usize> {
    targets: &'m mut [TargetVisits<BINS>],
    divisions: Divisions,
}

impl<'m, const BINS: usize> VisitLog<'m, BINS> {
    /// A log that goes on from what the memory holds: [`TargetVisits::EMPTY`] for each target, or
    /// what an earlier log with the same divisions left there
    /// ([`TargetVisits::to_record`], [`TargetVisits::from_record`]).
    #[must_use]
    pub const fn new(divisions: &Divisions, targets: &'m mut [TargetVisits<BINS>]) -> Self {
        Self { targets, divisions: *divisions }
    }

    /// Counts a visit; a refused one leaves the log as it was.
    ///
    /// # Errors
    /// [`VisitError`].
    // REQ-VISIT-1.
    pub fn record(&mut self, target: usize, transit: &Transit) -> Result<(), VisitError> {
        let (entry, exit) = (transit.entry, transit.exit);
        let Some(visits) = self.targets.get_mut(target) else {
            return Err(VisitError::NoSuchTarget(target));
        };
        if exit < entry {
            return Err(VisitError::Reversed { entry, exit });
        }
        if let Some(last) = visits.last {
            if entry < last.entry {
                return Err(VisitError::OutOfOrder { entry, latest: last.entry });
            }
            if entry < last.exit {
                return Err(VisitError::Overlap { entry, exit: last.exit });
            }
        }
        visits.add(transit, &self.divisions);
        Ok(())
    }

    /// The targets' statistics, by index.
    #[must_use]
    pub const fn targets(&self) -> &[TargetVisits<BINS>] {
        self.targets
    }

    /// The bins of the histograms.
    #[must_use]
    pub const fn divisions(&self) -> &Divisions {
        &self.divisions
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use HistogramBin::{Bin, Overflow, Underflow};

    #[test]
    fn bins_hold_their_lower_edge() {
        let linear = Bins::new(Spacing::Linear, 10.0, 30.0).unwrap();
        let edges: [f64; 5] = core::array::from_fn(|index| linear.edge_s(index, 4));
        assert_eq!(edges.map(f64::to_bits), [10.0, 15.0, 20.0, 25.0, 30.0].map(f64::to_bits));
        assert_eq!(linear.edge_s(9, 4).to_bits(), 30.0_f64.to_bits());
        let logarithmic = Bins::new(Spacing::Logarithmic, 1.0, 1e4).unwrap();
        for (index, edge) in [1.0, 10.0, 100.0, 1e3, 1e4].into_iter().enumerate() {
            assert!((logarithmic.edge_s(index, 4) / edge - 1.0).abs() < 1e-14);
        }
        for bins in [linear, logarithmic, Bins::new(Spacing::Logarithmic, 0.3, 77.7).unwrap()] {
            for count in [1, 4, 7, 1_000] {
                for index in 0..count {
                    let (low, high) = (bins.edge_s(index, count), bins.edge_s(index + 1, count));
                    assert!(low < high);
                    assert_eq!(bins.bin(low, count), Bin(index), "{bins:?} {count}");
                    assert_eq!(bins.bin(0.5 * (low + high), count), Bin(index));
                    assert_eq!(bins.bin(high.next_down(), count), Bin(index));
                }
                assert_eq!(bins.bin(bins.edge_s(count, count), count), Overflow);
                assert_eq!(bins.bin(bins.edge_s(0, count).next_down(), count), Underflow);
                assert_eq!(bins.bin(f64::NAN, count), Underflow);
            }
            assert_eq!(bins.bin(bins.edge_s(0, 1), 0), Underflow, "no bins");
        }
    }

    #[test]
    fn ends_are_checked() {
        let linear = |low, high| Bins::new(Spacing::Linear, low, high).map(|_| ());
        let logarithmic = |low, high| Bins::new(Spacing::Logarithmic, low, high).map(|_| ());
        assert_eq!(linear(0.0, 1.0), Ok(()));
        assert_eq!(logarithmic(1e-9, 1.0), Ok(()));
        let below = 1e-9_f64.next_down();
        assert_eq!(logarithmic(below, 1.0), Err(BinsError::Low(below)));
        assert_eq!(linear(-1e-300, 1.0), Err(BinsError::Low(-1e-300)));
        assert_eq!(linear(f64::INFINITY, 1.0), Err(BinsError::Low(f64::INFINITY)));
        assert_eq!(linear(1.0, 1.0), Err(BinsError::High(1.0)));
        assert_eq!(linear(1.0, 0.5), Err(BinsError::High(0.5)));
        assert_eq!(linear(1.0, f64::INFINITY), Err(BinsError::High(f64::INFINITY)));
    }

    #[test]
    fn a_record_tells_spacing_and_ends() {
        let bytes = |spacing, low, high| Bins::new(spacing, low, high).unwrap().to_le_bytes();
        let own = bytes(Spacing::Linear, 1.0, 2.0);
        assert_eq!(own[..8], 1.0_f64.to_le_bytes());
        assert_eq!(own[8..16], 2.0_f64.to_le_bytes());
        assert_eq!(own[16], 0);
        assert_eq!(bytes(Spacing::Logarithmic, 1.0, 2.0)[16], 1);
    }

    fn at(seconds: i64) -> Instant {
        Instant::from_tai_ns(seconds * 1_000_000_000)
    }

    fn visit(entry: i64, exit: i64, clipped: (bool, bool)) -> Transit {
        Transit {
            channel: 0,
            entry: at(entry),
            exit: at(exit),
            closest: at(entry),
            min_separation_rad: 0.0,
            entry_clipped: clipped.0,
            exit_clipped: clipped.1,
        }
    }

    /// Bins of 10 s from 10 s to 40 s.
    fn logged(visits: &[Transit]) -> TargetVisits<3> {
        let bins = Bins::new(Spacing::Linear, 10.0, 40.0).unwrap();
        let divisions = Divisions { dwell: bins, revisit: bins, gap: bins };
        let mut targets = [TargetVisits::EMPTY];
        let mut log = VisitLog::new(&divisions, &mut targets);
        assert_eq!(log.divisions(), &divisions);
        for it in visits {
            log.record(0, it).unwrap();
        }
        log.targets()[0]
    }

    const WHOLE: (bool, bool) = (false, false);

    #[test]
    // REQ-VISIT-1.
    fn whole_visits_tell_dwell_revisit_and_gap() {
        // Dwells 15, 25, 5, 45 s; revisits 35, 65, 15 s; gaps 20, 40, 10 s.
        let told = logged(&[
            visit(0, 15, WHOLE),
            visit(35, 60, WHOLE),
            visit(100, 105, WHOLE),
            visit(115, 160, WHOLE),
        ]);
        assert_eq!((told.visits, told.clipped), (4, 0));
        assert_eq!(told.dwell_sum, Duration::from_ns(90_000_000_000));
        assert_eq!(told.longest_gap, Some(Duration::from_ns(40_000_000_000)));
        assert_eq!(told.dwell, Histogram { counts: [1, 1, 0], under: 1, over: 1 });
        assert_eq!(told.revisit, Histogram { counts: [1, 0, 1], under: 0, over: 1 });
        assert_eq!(told.gap, Histogram { counts: [1, 1, 0], under: 0, over: 1 });
        assert_eq!((told.dwell.total(), told.gap.total()), (4, 3));
        let last =
            LastVisit { entry: at(115), exit: at(160), entry_clipped: false, exit_clipped: false };
        assert_eq!(told.last, Some(last));
    }

    #[test]
    // REQ-VISIT-1.
    fn cut_edges_tell_nothing() {
        let after = visit(30, 50, WHOLE);
        for (clipped, revisits, gaps) in
            [((true, false), 0, 1), ((false, true), 1, 0), ((true, true), 0, 0), (WHOLE, 1, 1)]
        {
            let told = logged(&[visit(0, 15, clipped), after]);
            let cut = u32::from(clipped != WHOLE);
            assert_eq!((told.visits, told.clipped), (2, cut));
            assert_eq!(told.dwell.total(), 2 - cut);
            assert_eq!((told.revisit.total(), told.gap.total()), (revisits, gaps), "{clipped:?}");
            assert_eq!(told.longest_gap.is_some(), gaps > 0);
        }
        let told = logged(&[visit(0, 15, WHOLE), visit(30, 50, (true, false))]);
        assert_eq!((told.revisit.total(), told.gap.total(), told.clipped), (0, 0, 1));
        let told = logged(&[visit(0, 15, WHOLE), visit(30, 50, (false, true))]);
        assert_eq!((told.revisit.total(), told.gap.total(), told.clipped), (1, 1, 1));
        assert_eq!(told.last.map(|it| (it.entry_clipped, it.exit_clipped)), Some((false, true)));
    }

    #[test]
    // REQ-VISIT-1.
    fn visits_come_in_order_and_do_not_overlap() {
        let bins = Bins::new(Spacing::Linear, 10.0, 40.0).unwrap();
        let divisions = Divisions { dwell: bins, revisit: bins, gap: bins };
        let mut targets = [TargetVisits::<3>::EMPTY];
        let mut log = VisitLog::new(&divisions, &mut targets);
        let mut told = |entry, exit| log.record(0, &visit(entry, exit, WHOLE));
        assert_eq!(told(10, 10), Ok(()), "an instant is a visit");
        assert_eq!(told(10, 20), Ok(()), "it begins where the last ended");
        let reversed = VisitError::Reversed { entry: at(30), exit: at(29) };
        assert_eq!(told(30, 29), Err(reversed));
        let early = VisitError::OutOfOrder { entry: at(9), latest: at(10) };
        assert_eq!(told(9, 40), Err(early));
        for entry in [10, 19] {
            let overlap = VisitError::Overlap { entry: at(entry), exit: at(20) };
            assert_eq!(told(entry, 40), Err(overlap));
        }
        assert_eq!(told(20, 40), Ok(()));
        let nobody = log.record(1, &visit(50, 60, WHOLE));
        assert_eq!(nobody, Err(VisitError::NoSuchTarget(1)));
        assert_eq!(log.targets()[0].visits, 3);
    }
}
