//! Many channels, one stream of transits in order.

use super::channel::Part;
use super::sight::Seen;
use super::{Channel, Transit};
use crate::ephemeris::EphemerisError;
use crate::time::Instant;

/// What one step of a search brought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// The next transit in order.
    Transit(Transit),
    /// Nothing yet: no transit that is still to come begins before this instant.
    Searched(Instant),
    /// All channels have reached their end.
    Done,
    /// A channel (its index) could not be evaluated; it stands where it was, and the others go on.
    Failed {
        /// Index of the channel.
        channel: usize,
        /// Why.
        error: EphemerisError,
    },
}

/// A search over channels in lent memory, emitting transits by entry, then by channel.
///
/// Each channel that still searches holds the others back until its frontier has passed their
/// transits, since it may yet find an earlier one. A channel that is finished, that could not be
/// evaluated, or that is no longer wanted holds back none.
#[derive(Debug)]
pub struct TransitFinder<'c, 'a> {
    channels: &'c mut [Channel<'a>],
    /// Working memory of a step, here to spare the stack; nothing in it outlives the step.
    seen: Seen,
}

impl<'c, 'a> TransitFinder<'c, 'a> {
    /// A search over all of these channels; their order breaks ties.
    #[must_use]
    pub fn new(channels: &'c mut [Channel<'a>]) -> Self {
        Self::of_first(channels, usize::MAX)
    }

    /// A search that goes on with channels as an earlier finder over them left them: which could not
    /// be evaluated and which are no longer wanted stays as it is.
    #[must_use]
    pub const fn resume(channels: &'c mut [Channel<'a>]) -> Self {
        Self { channels, seen: Seen::NOTHING }
    }

    /// A search over the first `count` of these channels; the others are not wanted.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn of_first(channels: &'c mut [Channel<'a>], count: usize) -> Self {
        let mut left = count;
        for channel in channels.iter_mut() {
            channel.set_part(if left > 0 { Part::Active } else { Part::Retired });
            left = left.saturating_sub(1);
        }
        Self { channels, seen: Seen::NOTHING }
    }

    /// The channels, for saving their states.
    #[must_use]
    pub fn channels(&self) -> &[Channel<'a>] {
        self.channels
    }

    /// Advances the channel that is furthest behind, or hands out the next transit.
    ///
    /// A channel that could not be evaluated is told of once and then left behind; it is tried again,
    /// and told of again, once all others are done.
    ///
    /// At most [`MAX_EVALUATIONS_PER_STEP`](super::MAX_EVALUATIONS_PER_STEP) evaluations.
    #[cfg_attr(target_os = "none", inline(never))]
    // REQ-TRANSIT-7.
    pub fn step(&mut self) -> Step {
        let Some((frontier, index)) = self.next() else { return Step::Done };
        let Some(channel) = self.channels.get_mut(index) else { return Step::Done };
        if let Some(transit) = channel.take() {
            return Step::Transit(Transit { channel: index, ..transit });
        }
        match channel.advance(&mut self.seen) {
            Ok(()) => Step::Searched(frontier),
            Err(error) => {
                channel.set_part(Part::Failed);
                Step::Failed { channel: index, error }
            }
        }
    }

    /// Frontier and index of the channel to go on with; one that failed only where no other is left.
    ///
    /// Earliest frontier first; at a tie a channel that may still find something goes before one that
    /// waits with a transit, so that equal entries come out in channel order.
    #[cfg_attr(target_os = "none", inline(never))]
    fn next(&self) -> Option<(Instant, usize)> {
        let mut next = None;
        let mut first = (Part::Retired, Instant::from_tai_ns(i64::MAX), true);
        let mut index = 0_usize;
        for channel in self.channels.iter() {
            if let Some(frontier) = channel.frontier() {
                let key = (channel.part(), frontier, channel.has_found());
                if key < first {
                    first = key;
                    next = Some((frontier, index));
                }
            }
            index = index.wrapping_add(1);
        }
        if first.0 == Part::Retired { None } else { next }
    }

    /// Searches this channel no more.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn retire(&mut self, channel: usize) {
        if let Some(channel) = self.channels.get_mut(channel) {
            channel.set_part(Part::Retired);
        }
    }

    /// Takes back a transit handed out just before, whose channel could not be evaluated for it: it
    /// is handed out again once all other channels are done.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn take_back(&mut self, transit: Transit) {
        if let Some(channel) = self.channels.get_mut(transit.channel) {
            channel.take_back(transit);
            channel.set_part(Part::Failed);
        }
    }
}
