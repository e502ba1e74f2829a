//! A payload, where it stood, and the words for its numbers.

use super::words::{KINDS, REASONS, STATES, Value, word};
use onboard_core::sequencer::{Event, State};
use onboard_core::telemetry::{Housekeeping, PacketHeader, Payload};
use onboard_core::time::Instant;
use onboard_core::uplink::SessionRecord;
use std::sync::Arc;

/// A payload of a file.
#[derive(Debug, Clone)]
pub struct Row {
    /// The first byte of the payload, or of its packet.
    pub offset: u64,
    /// The packet that it came in.
    pub packet: Option<PacketHeader>,
    /// What it holds.
    pub payload: Payload,
    /// The mission's telescopes, by index.
    pub(super) telescopes: Arc<[String]>,
    pub(super) kind: u8,
    pub(super) state: u8,
    pub(super) reason: u16,
    pub(super) values: [i64; 2],
}

impl Row {
    /// Its kind's word.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        word(&KINDS, self.kind)
    }

    /// The word of the state entered, or of the state that housekeeping tells.
    #[must_use]
    pub fn state(&self) -> Option<&'static str> {
        (self.state != 0).then(|| word(&STATES, self.state))
    }

    /// The word of the reason.
    #[must_use]
    pub fn reason(&self) -> Option<&'static str> {
        REASONS.iter().find(|it| it.0 == self.reason).map(|it| it.1)
    }

    /// Index of the session in the plan.
    #[must_use]
    pub const fn session(&self) -> Option<u32> {
        let state = match &self.payload {
            Payload::Event(report) => match report.event {
                Event::Started(session, _)
                | Event::Ended(session)
                | Event::Skipped(session, _)
                | Event::Aborted(session, _) => return Some(session),
                Event::Entered(state) => state,
                Event::Safe(_) | Event::Tables(_) | Event::TimeJumped { .. } => return None,
            },
            Payload::Housekeeping(report) => report.tick.state,
        };
        match state {
            State::Setup(session) | State::Calibrating(session) | State::Cooldown(session) => {
                Some(session)
            }
            State::Idle | State::Safe(_) => None,
        }
    }

    /// The telescope's name, where the mission has the index.
    #[must_use]
    pub fn telescope(&self) -> Option<&str> {
        let index = usize::from(self.payload.origin().telescope);
        self.telescopes.get(index).map(String::as_str)
    }

    /// What both values are.
    fn meanings(&self) -> [Value; 2] {
        match &self.payload {
            Payload::Event(report) => match report.event {
                Event::Tables(_) => return [Value::Number, Value::None],
                Event::TimeJumped { .. } => return [Value::Instant; 2],
                _ => {}
            },
            Payload::Housekeeping(_) => {}
        }
        let reason = REASONS.iter().find(|it| it.0 == self.reason);
        reason.map_or([Value::None; 2], |it| [it.2, it.3])
    }

    /// The first or second value, where there is one.
    pub(super) fn value(&self, index: usize) -> Option<i64> {
        (self.meanings()[index] != Value::None).then(|| self.values[index])
    }

    /// The first or second value, where it is an instant.
    pub(super) fn instant(&self, index: usize) -> Option<Instant> {
        let is_instant = self.meanings()[index] == Value::Instant;
        is_instant.then(|| Instant::from_tai_ns(self.values[index]))
    }

    /// The record of a session that begins.
    pub(super) const fn record(&self) -> Option<&SessionRecord> {
        match &self.payload {
            Payload::Event(report) => match &report.event {
                Event::Started(_, record) => Some(record),
                _ => None,
            },
            Payload::Housekeeping(_) => None,
        }
    }

    pub(super) const fn housekeeping(&self) -> Option<&Housekeeping> {
        match &self.payload {
            Payload::Event(_) => None,
            Payload::Housekeeping(report) => Some(report),
        }
    }
}
