//! Payloads read again, on the ground.
//!
//! A payload is refused whose CRC does not match, whose version, kind or codes are unknown, or in
//! which a word has a value that it cannot have or is not used: what is accepted is, byte for byte,
//! what was written.

use super::code::Reason;
use super::event::{EVENT_BYTES, EventReport, RECORD_SIZES};
use super::housekeeping::{
    CLOCK, CLOCK_SIZES, COVARIANCE_SIZES, ClockInUse, ENTRY_CLIPPED, EXIT_CLIPPED,
    HOUSEKEEPING_BYTES, HOUSEKEEPING_KIND, Housekeeping, LOST_SIZES, RATE_SIZES, SCRUB,
    SCRUB_SIZES, TABLES, TABLES_DAMAGED, TABLES_SIZES, TICK_SIZES, TRACKER, TRACKER_SIZES,
    TablesInUse, TrackerHealth, VISIT, VISIT_SIZES, VisitToCome,
};
use super::report::{HEAD_SIZES, INSTANT_KNOWN, Origin};
use super::words::{LAYOUT_VERSION, Words, is_whole};
use crate::clock::ClockError;
use crate::convert::signed_from_u64;
use crate::ephemeris::EphemerisError;
use crate::sequencer::{AbortReason, Event, Lost, Progress, SafeReason, SkipReason, State, Tick};
use crate::time::{Duration, Instant};
use crate::uncertainty::ScanCovariance;
use crate::uplink::{ScrubProgress, SequenceError, SessionRecord};

/// Why a payload is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum TelemetryError {
    /// It has this many bytes, another number than its kind takes.
    Length(usize),
    /// Its first byte is another version's.
    Version(u8),
    /// No kind has this number.
    Kind(u8),
    /// The CRC does not match.
    Damaged,
    /// No state has this number.
    State(u8),
    /// No reason of the event or the state has this number.
    Reason(u16),
    /// No stage of a check has this number.
    Check(u16),
    /// A word that is not used is not zero, or has a value that it cannot have.
    Illegal,
}

/// What a payload holds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "read one at a time, on the ground")]
pub enum Payload {
    /// An event.
    Event(EventReport),
    /// Housekeeping.
    Housekeeping(Housekeeping),
}

/// Bytes of a payload of this kind; `None` where no kind has the number.
#[must_use]
pub const fn payload_bytes(kind: u8) -> Option<usize> {
    match kind {
        1..=8 => Some(EVENT_BYTES),
        HOUSEKEEPING_KIND => Some(HOUSEKEEPING_BYTES),
        _ => None,
    }
}

impl Payload {
    /// Reads a payload.
    ///
    /// # Errors
    /// [`TelemetryError`], the first thing found wrong.
    // REQ-TLM-2, REQ-TLM-3.
    pub fn from_be_bytes(bytes: &[u8]) -> Result<Self, TelemetryError> {
        let short = TelemetryError::Length(bytes.len());
        let [version, kind] = *bytes.first_chunk().ok_or(short)?;
        if version != LAYOUT_VERSION {
            return Err(TelemetryError::Version(version));
        }
        if payload_bytes(kind).ok_or(TelemetryError::Kind(kind))? != bytes.len() {
            return Err(short);
        }
        if !is_whole(bytes) {
            return Err(TelemetryError::Damaged);
        }
        let mut words = Words(bytes.iter());
        let head = Head::read(&mut words)?;
        let (payload, same) = if kind == HOUSEKEEPING_KIND {
            let read = housekeeping(&head, &mut words)?;
            (Self::Housekeeping(read), read.to_be_bytes() == bytes)
        } else {
            let read = event(kind, &head, &mut words)?;
            (Self::Event(read), read.to_be_bytes() == bytes)
        };
        if same { Ok(payload) } else { Err(TelemetryError::Illegal) }
    }

    /// Whose it is, and of when.
    #[must_use]
    pub const fn origin(&self) -> &Origin {
        match self {
            Self::Event(report) => &report.origin,
            Self::Housekeeping(report) => &report.origin,
        }
    }
}

/// What every payload begins with.
struct Head {
    origin: Origin,
    there: u8,
    state: u8,
    session: u32,
    reason: Reason,
}

impl Head {
    fn read(words: &mut Words<'_>) -> Result<Self, TelemetryError> {
        let [_, _, telescope, spacecraft, ticks, at, there, state, reason, session, value, second] =
            words.group(&HEAD_SIZES);
        let there: u8 = narrow(there)?;
        Ok(Self {
            origin: Origin {
                spacecraft: narrow(spacecraft)?,
                telescope: narrow(telescope)?,
                ticks,
                at: (there & INSTANT_KNOWN != 0).then_some(instant(at)),
            },
            there,
            state: narrow(state)?,
            session: narrow(session)?,
            reason: Reason {
                code: narrow(reason)?,
                value: signed_from_u64(value),
                second: signed_from_u64(second),
            },
        })
    }
}

fn instant(word: u64) -> Instant {
    Instant::from_tai_ns(signed_from_u64(word))
}

/// A word or value in the width that it has.
fn narrow<W, T: TryFrom<W>>(word: W) -> Result<T, TelemetryError> {
    T::try_from(word).map_err(|_| TelemetryError::Illegal)
}

/// A signed number of four bytes.
fn signed(word: u64) -> Result<i32, TelemetryError> {
    narrow(word).map(u32::cast_signed)
}

fn event(kind: u8, head: &Head, words: &mut Words<'_>) -> Result<EventReport, TelemetryError> {
    let Reason { value, second, .. } = head.reason;
    let event = match kind {
        1 => Event::Entered(state(head)?),
        2 => Event::Started(head.session, record(words)?),
        3 => Event::Ended(head.session),
        4 => Event::Skipped(head.session, skip(head.reason)?),
        5 => Event::Aborted(head.session, abort(head.reason)?),
        6 => Event::Safe(safe(head.reason)?),
        7 => Event::Tables(narrow(value)?),
        8 => Event::TimeJumped {
            from: Instant::from_tai_ns(value),
            to: Instant::from_tai_ns(second),
        },
        other => return Err(TelemetryError::Kind(other)),
    };
    Ok(EventReport { origin: head.origin, event })
}

fn record(words: &mut Words<'_>) -> Result<SessionRecord, TelemetryError> {
    let [start, end, first_entry, last_exit, body, turn, telescope, passes] =
        words.group(&RECORD_SIZES);
    Ok(SessionRecord {
        start: instant(start),
        end: instant(end),
        first_entry: instant(first_entry),
        last_exit: instant(last_exit),
        body: signed(body)?,
        turn: narrow(turn)?,
        telescope: narrow(telescope)?,
        passes: narrow(passes)?,
    })
}

fn state(head: &Head) -> Result<State, TelemetryError> {
    Ok(match head.state {
        1 => State::Idle,
        2 => State::Setup(head.session),
        3 => State::Calibrating(head.session),
        4 => State::Cooldown(head.session),
        5 => State::Safe(safe(head.reason)?),
        other => return Err(TelemetryError::State(other)),
    })
}

fn safe(reason: Reason) -> Result<SafeReason, TelemetryError> {
    let Reason { code, value, .. } = reason;
    Ok(match code {
        160 => SafeReason::Commanded,
        161 => SafeReason::NoClock,
        162 => SafeReason::NoTables,
        163 => SafeReason::TablesNotYetValid(Instant::from_tai_ns(value)),
        164 => SafeReason::TablesExpired(Instant::from_tai_ns(value)),
        165 => SafeReason::NoSuchTelescope,
        166 => SafeReason::TimeReversed(Duration::from_ns(value)),
        167 => SafeReason::Boot,
        168 => SafeReason::TablesDamaged,
        _ => SafeReason::Clock(clock(reason)?),
    })
}

fn clock(Reason { code, value, second }: Reason) -> Result<ClockError, TelemetryError> {
    let numbers = || Ok((narrow(value)?, narrow(second)?));
    Ok(match code {
        110 => ClockError::NotACorrelation,
        111 => ClockError::Damaged,
        112 => ClockError::Illegal,
        113 => {
            let (candidate, newest) = numbers()?;
            ClockError::Sequence(SequenceError::Older { candidate, newest })
        }
        114 => ClockError::NotYetValid(Instant::from_tai_ns(value)),
        115 => ClockError::Expired(Instant::from_tai_ns(value)),
        116 => ClockError::BeyondScale,
        117 => {
            let (candidate, newest) = numbers()?;
            ClockError::Sequence(SequenceError::StepTooLarge { candidate, newest })
        }
        118 => {
            let (record, flown) = numbers()?;
            ClockError::OtherSpacecraft { record, flown }
        }
        other => return Err(TelemetryError::Reason(other)),
    })
}

fn skip(reason: Reason) -> Result<SkipReason, TelemetryError> {
    let Reason { code, value, .. } = reason;
    Ok(match code {
        180 => SkipReason::Missed,
        181 => SkipReason::Overlap,
        182 => SkipReason::NotChecked,
        183 => SkipReason::NoPass,
        184 => SkipReason::Entry(Duration::from_ns(value)),
        185 => SkipReason::Exit(Duration::from_ns(value)),
        186 => SkipReason::Passes(narrow(value)?),
        187 => SkipReason::Avoidance(narrow(value)?),
        188 => SkipReason::Uncertain(Duration::from_ns(value)),
        _ => SkipReason::Ephemeris(ephemeris(reason)?),
    })
}

fn abort(reason: Reason) -> Result<AbortReason, TelemetryError> {
    let Reason { code, value, .. } = reason;
    Ok(match code {
        200 => AbortReason::Safe,
        201 => AbortReason::Tables,
        202 => AbortReason::TimeJumped,
        203 => AbortReason::Avoidance(narrow(value)?),
        _ => AbortReason::Ephemeris(ephemeris(reason)?),
    })
}

fn ephemeris(Reason { code, value, .. }: Reason) -> Result<EphemerisError, TelemetryError> {
    Ok(match code {
        40 => EphemerisError::WrongLength,
        41 => EphemerisError::BadSpan(narrow(value)?),
        42 => EphemerisError::BadCoefficient(narrow(value)?),
        43 => EphemerisError::NoSuchBody(narrow(value)?),
        44 => EphemerisError::OutOfSpan(Instant::from_tai_ns(value)),
        45 => EphemerisError::BadBody(narrow(value)?),
        other => return Err(TelemetryError::Reason(other)),
    })
}

fn housekeeping(head: &Head, words: &mut Words<'_>) -> Result<Housekeeping, TelemetryError> {
    let has = |bit| head.there & bit != 0;
    let [evaluations, check] = words.group(&TICK_SIZES);
    let check = match check {
        1 => Progress::Waiting,
        2 => Progress::UnderWay,
        3 => Progress::Done,
        other => return Err(TelemetryError::Check(narrow(other)?)),
    };
    let tick = Tick { state: state(head)?, evaluations: narrow(evaluations)?, check };
    let [sequence, set_digest, until] = words.group(&TABLES_SIZES);
    let tables =
        TablesInUse { sequence: narrow(sequence)?, set_digest, valid_until: instant(until) };
    let [sequence, uncertainty, until] = words.group(&CLOCK_SIZES);
    let clock = ClockInUse {
        sequence: narrow(sequence)?,
        uncertainty_ns: narrow(uncertainty)?,
        valid_until: instant(until),
    };
    let lost = lost(words)?;
    let tracker = tracker(words)?;
    let [at, length] = words.group(&SCRUB_SIZES);
    let scrub = ScrubProgress { at: narrow(at)?, length: narrow(length)? };
    let visit = visit(words)?;
    Ok(Housekeeping {
        origin: head.origin,
        tick,
        tables: has(TABLES).then_some(tables),
        tables_damaged: has(TABLES_DAMAGED),
        clock: has(CLOCK).then_some(clock),
        lost,
        tracker: has(TRACKER).then_some(tracker),
        scrub: has(SCRUB).then_some(scrub),
        visit: has(VISIT).then_some(visit),
    })
}

fn lost(words: &mut Words<'_>) -> Result<Lost, TelemetryError> {
    let [entered, started, ended, skipped, aborted, safe, tables, jumped] =
        words.group(&LOST_SIZES);
    Ok(Lost {
        entered: narrow(entered)?,
        started: narrow(started)?,
        ended: narrow(ended)?,
        skipped: narrow(skipped)?,
        aborted: narrow(aborted)?,
        safe: narrow(safe)?,
        tables: narrow(tables)?,
        time_jumped: narrow(jumped)?,
    })
}

fn tracker(words: &mut Words<'_>) -> Result<TrackerHealth, TelemetryError> {
    let [epoch, accepted, refused] = words.group(&TRACKER_SIZES);
    let [variances, covariances] =
        [(); 2].map(|()| words.group(&COVARIANCE_SIZES).map(f64::from_bits));
    Ok(TrackerHealth {
        epoch: instant(epoch),
        accepted: narrow(accepted)?,
        refused_in_a_row: narrow(refused)?,
        covariance: ScanCovariance { variances, covariances },
        rate_sigmas_rad_s: words.group(&RATE_SIZES).map(f64::from_bits),
    })
}

fn visit(words: &mut Words<'_>) -> Result<VisitToCome, TelemetryError> {
    let [body, clipped, entry, exit, earliest, latest, probability, sigma] =
        words.group(&VISIT_SIZES);
    let is_clipped = |bit: u8| clipped & u64::from(bit) != 0;
    Ok(VisitToCome {
        body: signed(body)?,
        entry: instant(entry),
        exit: instant(exit),
        entry_clipped: is_clipped(ENTRY_CLIPPED),
        exit_clipped: is_clipped(EXIT_CLIPPED),
        earliest_entry: instant(earliest),
        latest_exit: instant(latest),
        probability: f64::from_bits(probability),
        entry_sigma_s: f64::from_bits(sigma),
    })
}
