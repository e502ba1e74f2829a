//! The windows in which drifting quantities are measured anew.
//!
//! Windows of one length follow each other from the mission's start; the last ends with the mission. A
//! month is 30.4375 d and a quarter 91.3125 d, a twelfth and a fourth of 365.25 d.
//!
//! Method: windows of several lengths stand in one list, so that a pass is added once per length.

use onboard_core::time::{Duration, Instant};

/// A month's days.
pub const MONTH_DAYS: f64 = 30.4375;
/// A quarter's days.
pub const QUARTER_DAYS: f64 = 91.3125;

/// The windows of some lengths over a span.
#[derive(Debug, Clone, PartialEq)]
pub struct Windows {
    start: Instant,
    end: Instant,
    /// Length of each kind and the index of its first window.
    kinds: Vec<(Duration, usize)>,
    count: usize,
}

impl Windows {
    /// Windows of these lengths; one longer than the span, or none at all (`None`), is the span.
    #[must_use]
    pub fn new((start, end): (Instant, Instant), lengths: &[Option<Duration>]) -> Self {
        let span = end.since(start).ns().max(1);
        let mut it = Self { start, end, kinds: Vec::new(), count: 0 };
        for length in lengths {
            let length = length.map_or(span, |it| it.ns().clamp(1, span));
            it.kinds.push((Duration::from_ns(length), it.count));
            let windows = (span - 1) / length + 1;
            it.count += usize::try_from(windows).unwrap_or(usize::MAX);
        }
        it
    }

    /// How many there are of all kinds.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// The windows that hold an instant, one of each kind.
    pub fn at(&self, at: Instant) -> impl Iterator<Item = usize> + '_ {
        let elapsed = at.since(self.start).ns();
        let last = self.end.since(self.start).ns() - 1;
        self.kinds.iter().map(move |(length, first)| {
            first + usize::try_from(elapsed.clamp(0, last.max(0)) / length.ns()).unwrap_or(0)
        })
    }

    /// The windows of one kind, by its index among the lengths.
    #[must_use]
    pub fn of_kind(&self, kind: usize) -> std::ops::Range<usize> {
        let first = self.kinds.get(kind).map_or(self.count, |it| it.1);
        first..self.kinds.get(kind + 1).map_or(self.count, |it| it.1)
    }

    /// Start and end of a window.
    #[must_use]
    pub fn span(&self, window: usize) -> (Instant, Instant) {
        let kind = self.kinds.iter().rfind(|it| it.1 <= window);
        let Some((length, first)) = kind else { return (self.start, self.end) };
        let number = i64::try_from(window - first).unwrap_or(0);
        let from = self.start.plus(Duration::from_ns(length.ns() * number));
        (from, from.plus(*length).min(self.end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(days: f64) -> Instant {
        Instant::from_tai_ns(5).plus(Duration::from_seconds(86_400.0 * days))
    }

    #[test]
    fn windows_follow_each_other_and_the_last_ends_with_the_mission() {
        let days = |days: f64| Duration::from_seconds(86_400.0 * days);
        let it = Windows::new((at(0.0), at(100.0)), &[None, Some(days(30.0)), Some(days(50.0))]);
        assert_eq!((it.count(), it.of_kind(1), it.of_kind(2)), (1 + 4 + 2, 1..5, 5..7));
        assert_eq!(it.at(at(0.0)).collect::<Vec<_>>(), [0, 1, 5]);
        assert_eq!(it.at(at(59.9)).collect::<Vec<_>>(), [0, 2, 6]);
        assert_eq!(it.at(at(100.0)).collect::<Vec<_>>(), [0, 4, 6]);
        assert_eq!(it.span(0), (at(0.0), at(100.0)));
        assert_eq!(it.span(4), (at(90.0), at(100.0)));
        assert_eq!(it.span(6), (at(50.0), at(100.0)));
    }
}
