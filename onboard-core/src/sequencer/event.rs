//! What the sequencer reports, and the bounded queue that carries it.
//!
//! A full queue keeps what matters most: an event takes the place of the newest of those that matter
//! least, if they matter less than it does, and is lost otherwise. What is lost is counted by kind.
//!
//! | rank | kinds |
//! |---|---|
//! | 3 | safe |
//! | 2 | aborted |
//! | 1 | started, ended, tables, time jumped |
//! | 0 | entered, skipped |
//!
//! Limits: a queue that is full takes time proportional to its capacity for each event.

use super::reason::{AbortReason, SafeReason, SkipReason, State};
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
    /// The state is left for safe, or is safe from the first tick on.
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

/// Which kind of event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    /// [`Event::Entered`].
    Entered,
    /// [`Event::Started`].
    Started,
    /// [`Event::Ended`].
    Ended,
    /// [`Event::Skipped`].
    Skipped,
    /// [`Event::Aborted`].
    Aborted,
    /// [`Event::Safe`].
    Safe,
    /// [`Event::Tables`].
    Tables,
    /// [`Event::TimeJumped`].
    TimeJumped,
}

impl Event {
    /// Its kind.
    #[must_use]
    #[inline(never)]
    pub const fn kind(&self) -> EventKind {
        match self {
            Self::Entered(_) => EventKind::Entered,
            Self::Started(..) => EventKind::Started,
            Self::Ended(_) => EventKind::Ended,
            Self::Skipped(..) => EventKind::Skipped,
            Self::Aborted(..) => EventKind::Aborted,
            Self::Safe(_) => EventKind::Safe,
            Self::Tables(_) => EventKind::Tables,
            Self::TimeJumped { .. } => EventKind::TimeJumped,
        }
    }
}

impl EventKind {
    /// How much it matters in a full queue, 3 the most.
    #[must_use]
    #[inline(never)]
    pub const fn rank(self) -> u8 {
        match self {
            Self::Safe => 3,
            Self::Aborted => 2,
            Self::Started | Self::Ended | Self::Tables | Self::TimeJumped => 1,
            Self::Entered | Self::Skipped => 0,
        }
    }
}

/// An event and the on-board counter when it happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stamped {
    /// The on-board counter.
    pub ticks: u64,
    /// What happened.
    pub event: Event,
}

/// How many events of each kind were lost; each number stays at its largest value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Lost {
    /// [`Event::Entered`].
    pub entered: u32,
    /// [`Event::Started`].
    pub started: u32,
    /// [`Event::Ended`].
    pub ended: u32,
    /// [`Event::Skipped`].
    pub skipped: u32,
    /// [`Event::Aborted`].
    pub aborted: u32,
    /// [`Event::Safe`].
    pub safe: u32,
    /// [`Event::Tables`].
    pub tables: u32,
    /// [`Event::TimeJumped`].
    pub time_jumped: u32,
}

impl Lost {
    /// None.
    pub const NONE: Self = Self {
        entered: 0,
        started: 0,
        ended: 0,
        skipped: 0,
        aborted: 0,
        safe: 0,
        tables: 0,
        time_jumped: 0,
    };

    /// All kinds together; stays at its largest value.
    #[must_use]
    pub const fn total(&self) -> u32 {
        self.entered
            .saturating_add(self.started)
            .saturating_add(self.ended)
            .saturating_add(self.skipped)
            .saturating_add(self.aborted)
            .saturating_add(self.safe)
            .saturating_add(self.tables)
            .saturating_add(self.time_jumped)
    }

    #[inline(never)]
    const fn count(&mut self, kind: EventKind) {
        let number = match kind {
            EventKind::Entered => &mut self.entered,
            EventKind::Started => &mut self.started,
            EventKind::Ended => &mut self.ended,
            EventKind::Skipped => &mut self.skipped,
            EventKind::Aborted => &mut self.aborted,
            EventKind::Safe => &mut self.safe,
            EventKind::Tables => &mut self.tables,
            EventKind::TimeJumped => &mut self.time_jumped,
        };
        *number = number.saturating_add(1);
    }
}

/// A queue of at most `N` events in the order that they happened.
#[derive(Debug, Clone, Default)]
pub struct EventQueue<const N: usize> {
    events: Deque<Stamped, N>,
    lost: Lost,
}

impl<const N: usize> EventQueue<N> {
    /// An empty queue.
    #[must_use]
    pub const fn new() -> Self {
        Self { events: Deque::new(), lost: Lost::NONE }
    }

    /// The oldest event, taken out.
    pub fn pop(&mut self) -> Option<Stamped> {
        self.events.pop_front()
    }

    /// Events lost so far, by kind.
    #[must_use]
    pub const fn lost(&self) -> Lost {
        self.lost
    }

    /// Adds an event, or counts what is lost.
    pub fn push(&mut self, stamped: Stamped) {
        self.log(stamped.ticks).add(stamped.event);
    }

    /// Where events of this instant go.
    pub(super) fn log(&mut self, ticks: u64) -> Log<'_> {
        Log { ticks, events: self.events.as_mut_view(), lost: &mut self.lost }
    }
}

/// A queue of any capacity, and the on-board counter now.
pub(super) struct Log<'q> {
    ticks: u64,
    events: &'q mut DequeView<Stamped>,
    lost: &'q mut Lost,
}

impl Log<'_> {
    #[inline(never)]
    pub(super) fn add(&mut self, event: Event) {
        let stamped = Stamped { ticks: self.ticks, event };
        if let Err(stamped) = self.events.push_back(stamped) {
            self.make_room(stamped);
        }
    }

    /// Into a full queue: the newest of the events that matter least goes, if it matters less.
    ///
    /// By turning the queue once round to find it and once to leave it out: its iterators reach a panic.
    #[inline(never)]
    // REQ-SEQ-11.
    fn make_room(&mut self, newest: Stamped) {
        let held = self.events.storage_capacity();
        let mut least = newest.event.kind().rank();
        let mut place = None;
        for index in 0..held {
            let Some(kind) = self.turn(false) else { return };
            let rank = kind.rank();
            if rank < least || (rank == least && place.is_some()) {
                (least, place) = (rank, Some(index));
            }
        }
        if place.is_none() {
            self.lost.count(newest.event.kind());
            return;
        }
        for index in 0..held {
            if self.turn(place == Some(index)).is_none() {
                return;
            }
        }
        self.keep(newest);
    }

    /// Puts the oldest event at the end, or leaves it out; which kind it is.
    #[inline(never)]
    fn turn(&mut self, goes: bool) -> Option<EventKind> {
        let stamped = self.events.pop_front()?;
        let kind = stamped.event.kind();
        if goes {
            self.lost.count(kind);
        } else {
            self.keep(stamped);
        }
        Some(kind)
    }

    /// At the end, where there is room.
    #[inline(never)]
    fn keep(&mut self, stamped: Stamped) {
        if let Err(stamped) = self.events.push_back(stamped) {
            self.lost.count(stamped.event.kind());
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    fn queue<const N: usize>(events: &[Event]) -> EventQueue<N> {
        let mut queue = EventQueue::<N>::new();
        for (ticks, event) in (0_u64..).zip(events) {
            queue.push(Stamped { ticks, event: *event });
        }
        queue
    }

    fn left<const N: usize>(mut queue: EventQueue<N>) -> Vec<u64> {
        core::iter::from_fn(|| queue.pop()).map(|it| it.ticks).collect()
    }

    const SAFE: Event = Event::Safe(SafeReason::NoClock);
    const ABORTED: Event = Event::Aborted(7, AbortReason::Safe);
    const ENTERED: Event = Event::Entered(State::Idle);
    const SKIPPED: Event = Event::Skipped(3, SkipReason::NotChecked);

    #[test]
    // REQ-SEQ-11.
    fn among_equals_a_full_queue_keeps_the_oldest_and_counts_the_rest() {
        let queue = queue::<2>(&[Event::Ended(0), Event::Ended(1), Event::Ended(2), ENTERED]);
        assert_eq!(queue.lost(), Lost { ended: 1, entered: 1, ..Lost::NONE });
        assert_eq!(queue.lost().total(), 2);
        assert_eq!(left(queue), [0, 1]);
    }

    #[test]
    // REQ-SEQ-11.
    fn what_matters_more_takes_the_place_of_the_newest_that_matters_least() {
        let full = [ENTERED, Event::Ended(1), SKIPPED, Event::Ended(2)];
        let with = |more: &[Event]| queue::<4>(&[&full, more].concat());
        // A safe event finds room; order stays.
        let safe = with(&[SAFE]);
        assert_eq!(safe.lost(), Lost { skipped: 1, ..Lost::NONE });
        assert_eq!(left(safe), [0, 1, 3, 4]);
        let more = with(&[SAFE, ABORTED, Event::Tables(9)]);
        assert_eq!(more.lost(), Lost { skipped: 1, entered: 1, tables: 1, ..Lost::NONE });
        assert_eq!(left(more), [1, 3, 4, 5]);
        // Safe before aborted, aborted before started and ended.
        let most = with(&[ABORTED, ABORTED, ABORTED, ABORTED, SAFE, ABORTED]);
        assert_eq!(
            most.lost(),
            Lost { skipped: 1, entered: 1, ended: 2, aborted: 2, ..Lost::NONE }
        );
        assert_eq!(left(most), [4, 5, 6, 8]);
    }
}
