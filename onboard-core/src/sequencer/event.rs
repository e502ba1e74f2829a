//! What the sequencer reports, and the bounded queue that carries it.

use super::{AbortReason, SafeReason, SkipReason, State};
use crate::time::Instant;
use crate::uplink::SessionRecord;
use heapless::Deque;
use heapless::deque::DequeView;

/// Something that happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// The state changed to this one.
    Entered(State),
    /// A session (its index in the plan) begins.
    Started(u32, SessionRecord),
    /// A session is over, cooldown included.
    Ended(u32),
    /// A session is not begun.
    Skipped(u32, SkipReason),
    /// A running session is given up.
    Aborted(u32, AbortReason),
    /// The state is left for safe.
    Safe(SafeReason),
    /// Other tables are in use (their sequence number).
    Tables(u32),
    /// Time moved on by more than the longest gap between ticks.
    TimeJumped {
        /// Before.
        from: Instant,
        /// After.
        to: Instant,
    },
}

/// An event and the on-board counter when it happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stamped {
    /// The on-board counter.
    pub ticks: u64,
    /// What happened.
    pub event: Event,
}

/// A queue of at most `N` events; when it is full the newest are dropped and counted.
#[derive(Debug, Clone, Default)]
pub struct EventQueue<const N: usize> {
    events: Deque<Stamped, N>,
    dropped: u32,
}

impl<const N: usize> EventQueue<N> {
    /// An empty queue.
    #[must_use]
    pub const fn new() -> Self {
        Self { events: Deque::new(), dropped: 0 }
    }

    /// The oldest event, taken out.
    pub fn pop(&mut self) -> Option<Stamped> {
        self.events.pop_front()
    }

    /// Events dropped so far; stays at its largest value.
    #[must_use]
    pub const fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Adds an event, or counts it as dropped.
    pub fn push(&mut self, stamped: Stamped) {
        self.log(stamped.ticks).add(stamped.event);
    }

    /// Where events of this instant go.
    pub(super) fn log(&mut self, ticks: u64) -> Log<'_> {
        Log { ticks, events: self.events.as_mut_view(), dropped: &mut self.dropped }
    }
}

/// A queue of any capacity, and the on-board counter now.
pub(super) struct Log<'q> {
    ticks: u64,
    events: &'q mut DequeView<Stamped>,
    dropped: &'q mut u32,
}

impl Log<'_> {
    #[inline(never)]
    pub(super) fn add(&mut self, event: Event) {
        if self.events.push_back(Stamped { ticks: self.ticks, event }).is_err() {
            *self.dropped = self.dropped.saturating_add(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_queue_keeps_the_oldest_and_counts_the_rest() {
        let mut queue = EventQueue::<2>::new();
        for index in 0..5 {
            queue.push(Stamped { ticks: u64::from(index), event: Event::Ended(index) });
        }
        assert_eq!(queue.dropped(), 3);
        assert_eq!(queue.pop().map(|it| it.ticks), Some(0));
        assert_eq!(queue.pop().map(|it| it.ticks), Some(1));
        assert_eq!(queue.pop(), None);
    }
}
