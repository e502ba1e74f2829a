//! When is each target seen next, and how sure is that.
//!
//! A [`Forecast`] runs one [`Channel`] per target until each has its next visit, with the
//! [`Confidence`] that follows from how well the scan's angles are known then. A step does the
//! bounded work of [`TransitFinder::step`], or evaluates one visit's confidence. A target that has
//! its visit is searched no more, so that several targets take as many steps together as one by one.
//!
//! Limits: a visit in progress at the search's start counts as the next one.

use crate::ephemeris::EphemerisError;
use crate::time::Instant;
use crate::transit::{Channel, Confidence, Step, Transit, TransitFinder};
use crate::uncertainty::ScanCovariance;

/// A predicted visit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NextVisit {
    /// The visit; its channel is the target's index.
    pub transit: Transit,
    /// How sure it is.
    pub confidence: Confidence,
}

/// What one step of a forecast brought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ForecastStep {
    /// The target of this index has its next visit.
    Found(usize),
    /// No visit that is still to come begins before this instant.
    Searched(Instant),
    /// Every target has its next visit, or none within its search's span.
    Done,
    /// A channel (its index) could not be evaluated; it stands where it was, and the others go on.
    Failed {
        /// Index of the channel.
        channel: usize,
        /// Why.
        error: EphemerisError,
    },
}

/// The next visit of each target, in lent memory.
#[derive(Debug)]
pub struct Forecast<'c, 'a, 'm> {
    finder: TransitFinder<'c, 'a>,
    next: &'m mut [Option<NextVisit>],
    /// A visit whose confidence is still to be evaluated.
    waiting: Option<Transit>,
}

impl<'c, 'a, 'm> Forecast<'c, 'a, 'm> {
    /// A forecast over these channels, one per target; `next` is cleared.
    ///
    /// Channels beyond the length of `next` are not searched.
    #[must_use]
    pub fn new(channels: &'c mut [Channel<'a>], next: &'m mut [Option<NextVisit>]) -> Self {
        next.fill(None);
        let finder = TransitFinder::of_first(channels, next.len());
        Self { finder, next, waiting: None }
    }

    /// A forecast that goes on from what an earlier one over the same channels left: its `next` and
    /// its [`Self::waiting`].
    #[must_use]
    pub fn resume(
        channels: &'c mut [Channel<'a>],
        next: &'m mut [Option<NextVisit>],
        waiting: Option<Transit>,
    ) -> Self {
        Self { finder: TransitFinder::resume(channels), next, waiting }
    }

    /// The visit whose confidence is still to be evaluated.
    #[must_use]
    pub const fn waiting(&self) -> Option<Transit> {
        self.waiting
    }

    /// The next visits known so far, by target.
    #[must_use]
    pub const fn next(&self) -> &[Option<NextVisit>] {
        self.next
    }

    /// Searches on, or evaluates a visit's confidence; `covariance` is asked for the instant of its
    /// entry, as [`Tracker::covariance_at`](crate::tracking::Tracker::covariance_at) answers.
    // REQ-FORECAST-1.
    pub fn step(&mut self, covariance: impl FnOnce(Instant) -> ScanCovariance) -> ForecastStep {
        if let Some(transit) = self.waiting.take() {
            return self.judge(transit, &covariance(transit.entry));
        }
        match self.finder.step() {
            Step::Transit(transit) => {
                self.finder.retire(transit.channel);
                self.waiting = Some(transit);
                ForecastStep::Searched(transit.entry)
            }
            Step::Searched(until) => ForecastStep::Searched(until),
            Step::Done => ForecastStep::Done,
            Step::Failed { channel, error } => ForecastStep::Failed { channel, error },
        }
    }

    #[inline(never)]
    fn judge(&mut self, transit: Transit, covariance: &ScanCovariance) -> ForecastStep {
        let index = transit.channel;
        let (Some(channel), Some(next)) =
            (self.finder.channels().get(index), self.next.get_mut(index))
        else {
            return ForecastStep::Searched(transit.entry);
        };
        match channel.confidence(&transit, covariance) {
            Ok(confidence) => {
                *next = Some(NextVisit { transit, confidence });
                ForecastStep::Found(index)
            }
            Err(error) => {
                self.finder.take_back(transit);
                ForecastStep::Failed { channel: index, error }
            }
        }
    }
}
