//! Many channels, one stream of transits in order.

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
    /// A channel (its index) could not be evaluated; the search stands where it was.
    Failed {
        /// Index of the channel.
        channel: usize,
        /// Why.
        error: EphemerisError,
    },
}

/// A search over channels in lent memory, emitting transits by entry, then by channel.
#[derive(Debug)]
pub struct TransitFinder<'c, 'a> {
    channels: &'c mut [Channel<'a>],
    /// Working memory of a step, here to spare the stack; nothing in it outlives the step.
    seen: Seen,
}

impl<'c, 'a> TransitFinder<'c, 'a> {
    /// A search over these channels; their order breaks ties.
    #[must_use]
    pub fn new(channels: &'c mut [Channel<'a>]) -> Self {
        Self { channels, seen: Seen::NOTHING }
    }

    /// The channels, for saving their states.
    #[must_use]
    pub fn channels(&self) -> &[Channel<'a>] {
        self.channels
    }

    /// Advances the channel that is furthest behind, or hands out the next transit.
    ///
    /// At most [`MAX_EVALUATIONS_PER_STEP`](super::MAX_EVALUATIONS_PER_STEP) evaluations.
    #[inline(never)]
    pub fn step(&mut self) -> Step {
        // Earliest frontier first; at a tie a channel that may still find something goes before
        // one that waits with a transit, so that equal entries come out in channel order.
        let mut next: Option<(Instant, bool, usize, &mut Channel<'a>)> = None;
        let mut index = 0_usize;
        for channel in self.channels.iter_mut() {
            if let Some(frontier) = channel.frontier() {
                let found = channel.has_found();
                let first =
                    next.as_ref().is_none_or(|(at, waits, _, _)| (frontier, found) < (*at, *waits));
                if first {
                    next = Some((frontier, found, index, channel));
                }
            }
            index = index.wrapping_add(1);
        }
        let Some((frontier, _, index, channel)) = next else { return Step::Done };
        if let Some(transit) = channel.take() {
            return Step::Transit(Transit { channel: index, ..transit });
        }
        match channel.advance(&mut self.seen) {
            Ok(()) => Step::Searched(frontier),
            Err(error) => Step::Failed { channel: index, error },
        }
    }
}
