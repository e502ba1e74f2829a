//! The numbers that stand for states and reasons.
//!
//! They are those of the C interface (`gyr_error_t`, `GYR_STATE_...`, `GYR_EVENT_...`), written out
//! one by one; `docs/telemetry.md` lists them. A number is never given to another meaning.

use crate::clock::ClockError;
use crate::ephemeris::EphemerisError;
use crate::sequencer::{AbortReason, EventKind, Progress, SafeReason, SkipReason, State};
use crate::uplink::SequenceError;

/// A reason's number and the values that go with it, 0 where there is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Reason {
    pub(super) code: u16,
    pub(super) value: i64,
    pub(super) second: i64,
}

impl Reason {
    /// No reason at all.
    pub(super) const NONE: Self = Self::bare(0);

    const fn bare(code: u16) -> Self {
        Self { code, value: 0, second: 0 }
    }

    fn with(code: u16, value: impl Into<i64>) -> Self {
        Self { code, value: value.into(), second: 0 }
    }

    fn pair(code: u16, value: u32, second: u32) -> Self {
        Self { code, value: value.into(), second: second.into() }
    }
}

/// An event's kind.
pub(super) const fn event(kind: EventKind) -> u8 {
    match kind {
        EventKind::Entered => 1,
        EventKind::Started => 2,
        EventKind::Ended => 3,
        EventKind::Skipped => 4,
        EventKind::Aborted => 5,
        EventKind::Safe => 6,
        EventKind::Tables => 7,
        EventKind::TimeJumped => 8,
    }
}

/// A state, its session and its reason.
pub(super) fn state(state: State) -> (u8, u32, Reason) {
    match state {
        State::Idle => (1, 0, Reason::NONE),
        State::Setup(session) => (2, session, Reason::NONE),
        State::Calibrating(session) => (3, session, Reason::NONE),
        State::Cooldown(session) => (4, session, Reason::NONE),
        State::Safe(reason) => (5, 0, safe(reason)),
    }
}

/// How far a check has come.
pub(super) const fn progress(check: Progress) -> u16 {
    match check {
        Progress::Waiting => 1,
        Progress::UnderWay => 2,
        Progress::Done => 3,
    }
}

/// Why it is safe.
#[inline(never)]
pub(super) fn safe(reason: SafeReason) -> Reason {
    match reason {
        SafeReason::Commanded => Reason::bare(160),
        SafeReason::NoClock => Reason::bare(161),
        SafeReason::NoTables => Reason::bare(162),
        SafeReason::TablesNotYetValid(from) => Reason::with(163, from.tai_ns()),
        SafeReason::TablesExpired(until) => Reason::with(164, until.tai_ns()),
        SafeReason::NoSuchTelescope => Reason::bare(165),
        SafeReason::TimeReversed(by) => Reason::with(166, by.ns()),
        SafeReason::Boot => Reason::bare(167),
        SafeReason::TablesDamaged => Reason::bare(168),
        SafeReason::Clock(error) => clock(error),
    }
}

fn clock(error: ClockError) -> Reason {
    match error {
        ClockError::NotACorrelation => Reason::bare(110),
        ClockError::Damaged => Reason::bare(111),
        ClockError::Illegal => Reason::bare(112),
        ClockError::Sequence(SequenceError::Older { candidate, newest }) => {
            Reason::pair(113, candidate, newest)
        }
        ClockError::NotYetValid(from) => Reason::with(114, from.tai_ns()),
        ClockError::Expired(until) => Reason::with(115, until.tai_ns()),
        ClockError::BeyondScale => Reason::bare(116),
        ClockError::Sequence(SequenceError::StepTooLarge { candidate, newest }) => {
            Reason::pair(117, candidate, newest)
        }
        ClockError::OtherSpacecraft { record, flown } => Reason::pair(118, record, flown),
    }
}

/// Why a session was not begun.
#[inline(never)]
pub(super) fn skip(reason: SkipReason) -> Reason {
    match reason {
        SkipReason::Missed => Reason::bare(180),
        SkipReason::Overlap => Reason::bare(181),
        SkipReason::NotChecked => Reason::bare(182),
        SkipReason::NoPass => Reason::bare(183),
        SkipReason::Entry(by) => Reason::with(184, by.ns()),
        SkipReason::Exit(by) => Reason::with(185, by.ns()),
        SkipReason::Passes(number) => Reason::with(186, number),
        SkipReason::Avoidance(body) => Reason::with(187, body),
        SkipReason::Uncertain(by) => Reason::with(188, by.ns()),
        SkipReason::Ephemeris(error) => ephemeris(error),
    }
}

/// Why a session was given up.
#[inline(never)]
pub(super) fn abort(reason: AbortReason) -> Reason {
    match reason {
        AbortReason::Safe => Reason::bare(200),
        AbortReason::Tables => Reason::bare(201),
        AbortReason::TimeJumped => Reason::bare(202),
        AbortReason::Avoidance(body) => Reason::with(203, body),
        AbortReason::Ephemeris(error) => ephemeris(error),
    }
}

#[inline(never)]
fn ephemeris(error: EphemerisError) -> Reason {
    match error {
        EphemerisError::WrongLength => Reason::bare(40),
        EphemerisError::BadSpan(index) => Reason::with(41, index),
        EphemerisError::BadCoefficient(index) => Reason::with(42, index),
        EphemerisError::NoSuchBody(body) => Reason::with(43, body),
        EphemerisError::OutOfSpan(at) => Reason::with(44, at.tai_ns()),
        EphemerisError::BadBody(index) => Reason::with(45, index),
    }
}
