//! An event of a sequencer as a payload of 96 bytes.

use super::code::{self, Reason};
use super::report::{HEAD_SIZES, Origin, instant};
use super::words::{group, seal};
use crate::clock::ClockCorrelation;
use crate::sequencer::{Event, Stamped};
use crate::uplink::SessionRecord;

/// Bytes of an event's payload.
pub const EVENT_BYTES: usize = 96;

/// Words of a session's record.
pub(super) const RECORD: usize = 8;
/// Their bytes: start, end, first entry, last exit, body, turn, telescope, passes.
pub(super) const RECORD_SIZES: [u8; RECORD] = [8, 8, 8, 8, 4, 4, 2, 2];

/// An event of a sequencer, and whose and of when it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EventReport {
    /// Whose and of when.
    pub origin: Origin,
    /// What happened.
    pub event: Event,
}

impl EventReport {
    /// Of an event out of a sequencer's queue; `clock` is the correlation in use, if there is one.
    #[must_use]
    pub fn new(
        stamped: &Stamped,
        spacecraft: u32,
        telescope: u16,
        clock: Option<&ClockCorrelation>,
    ) -> Self {
        let origin = Origin::new(spacecraft, telescope, stamped.ticks, clock);
        Self { origin, event: stamped.event }
    }

    /// The payload.
    #[must_use]
    #[inline(never)]
    // REQ-TLM-1.
    pub fn to_be_bytes(&self) -> [u8; EVENT_BYTES] {
        let mut record = [0; RECORD];
        let (state, session, reason) = match self.event {
            Event::Entered(state) => code::state(state),
            Event::Started(session, planned) => {
                record = words(&planned);
                (0, session, Reason::NONE)
            }
            Event::Ended(session) => (0, session, Reason::NONE),
            Event::Skipped(session, why) => (0, session, code::skip(why)),
            Event::Aborted(session, why) => (0, session, code::abort(why)),
            Event::Safe(why) => (0, 0, code::safe(why)),
            Event::Tables(sequence) => (0, 0, Reason { value: sequence.into(), ..Reason::NONE }),
            Event::TimeJumped { from, to } => {
                (0, 0, Reason { code: 0, value: from.tai_ns(), second: to.tai_ns() })
            }
        };
        let kind = code::event(self.event.kind());
        let head = self.origin.head((kind, 0), (state, session, reason));
        let mut payload = [0; EVENT_BYTES];
        seal(&mut payload, &[group(&HEAD_SIZES, &head), group(&RECORD_SIZES, &record)]);
        payload
    }
}

fn words(record: &SessionRecord) -> [u64; RECORD] {
    [
        instant(record.start),
        instant(record.end),
        instant(record.first_entry),
        instant(record.last_exit),
        record.body.cast_unsigned().into(),
        record.turn.into(),
        record.telescope.into(),
        record.passes.into(),
    ]
}
