//! The rules of telemetry, on a million random events and on every bit.

extern crate std;

use super::*;
use crate::clock::ClockError;
use crate::ephemeris::EphemerisError;
use crate::sequencer::{AbortReason, Event, Lost, Progress, SafeReason, SkipReason, State, Tick};
use crate::time::{Duration, Instant};
use crate::uncertainty::ScanCovariance;
use crate::uplink::{ScrubProgress, SequenceError, SessionRecord, checksum};
use std::vec::Vec;

/// Numbers of a linear congruential generator, their upper halves.
struct Random(u64);

impl Random {
    fn word(&mut self) -> u64 {
        let mut half = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            self.0 >> 32
        };
        (half() << 32) | half()
    }

    /// Below `end`.
    fn below(&mut self, end: u64) -> u64 {
        self.word() % end
    }

    fn u32(&mut self) -> u32 {
        let [word, special] = [self.word(), self.below(8)];
        match special {
            0 => 0,
            1 => u32::MAX,
            _ => u32::try_from(word >> 32).unwrap(),
        }
    }

    fn u16(&mut self) -> u16 {
        u16::try_from(self.word() >> 48).unwrap()
    }

    fn i32(&mut self) -> i32 {
        self.u32().cast_signed()
    }

    fn ns(&mut self) -> i64 {
        let (word, special) = (self.word().cast_signed(), self.below(8));
        match special {
            0 => 0,
            1 => i64::MIN,
            2 => i64::MAX,
            _ => word,
        }
    }

    fn at(&mut self) -> Instant {
        Instant::from_tai_ns(self.ns())
    }

    fn span(&mut self) -> Duration {
        Duration::from_ns(self.ns())
    }

    fn number(&mut self) -> f64 {
        // Any finite number, or an infinity: NaN equals nothing.
        let number = f64::from_bits(self.word());
        if number.is_nan() { f64::INFINITY } else { number }
    }

    fn ephemeris(&mut self) -> EphemerisError {
        match self.below(6) {
            0 => EphemerisError::WrongLength,
            1 => EphemerisError::BadSpan(self.u32()),
            2 => EphemerisError::BadBody(self.u32()),
            3 => EphemerisError::BadCoefficient(self.u32()),
            4 => EphemerisError::NoSuchBody(self.i32()),
            _ => EphemerisError::OutOfSpan(self.at()),
        }
    }

    fn clock(&mut self) -> ClockError {
        let [candidate, newest] = [self.u32(), self.u32()];
        match self.below(9) {
            0 => ClockError::NotACorrelation,
            1 => ClockError::Damaged,
            2 => ClockError::Illegal,
            3 => ClockError::Sequence(SequenceError::Older { candidate, newest }),
            4 => ClockError::Sequence(SequenceError::StepTooLarge { candidate, newest }),
            5 => ClockError::OtherSpacecraft { record: candidate, flown: newest },
            6 => ClockError::NotYetValid(self.at()),
            7 => ClockError::Expired(self.at()),
            _ => ClockError::BeyondScale,
        }
    }

    fn safe(&mut self) -> SafeReason {
        match self.below(10) {
            0 => SafeReason::Boot,
            1 => SafeReason::Commanded,
            2 => SafeReason::NoClock,
            3 => SafeReason::Clock(self.clock()),
            4 => SafeReason::NoTables,
            5 => SafeReason::TablesDamaged,
            6 => SafeReason::TablesNotYetValid(self.at()),
            7 => SafeReason::TablesExpired(self.at()),
            8 => SafeReason::NoSuchTelescope,
            _ => SafeReason::TimeReversed(self.span()),
        }
    }

    fn skip(&mut self) -> SkipReason {
        match self.below(10) {
            0 => SkipReason::Missed,
            1 => SkipReason::Overlap,
            2 => SkipReason::NotChecked,
            3 => SkipReason::NoPass,
            4 => SkipReason::Entry(self.span()),
            5 => SkipReason::Exit(self.span()),
            6 => SkipReason::Passes(self.u16()),
            7 => SkipReason::Uncertain(self.span()),
            8 => SkipReason::Avoidance(self.i32()),
            _ => SkipReason::Ephemeris(self.ephemeris()),
        }
    }

    fn abort(&mut self) -> AbortReason {
        match self.below(5) {
            0 => AbortReason::Safe,
            1 => AbortReason::Tables,
            2 => AbortReason::TimeJumped,
            3 => AbortReason::Avoidance(self.i32()),
            _ => AbortReason::Ephemeris(self.ephemeris()),
        }
    }

    fn state(&mut self) -> State {
        match self.below(5) {
            0 => State::Idle,
            1 => State::Setup(self.u32()),
            2 => State::Calibrating(self.u32()),
            3 => State::Cooldown(self.u32()),
            _ => State::Safe(self.safe()),
        }
    }

    fn record(&mut self) -> SessionRecord {
        SessionRecord {
            start: self.at(),
            end: self.at(),
            first_entry: self.at(),
            last_exit: self.at(),
            body: self.i32(),
            turn: self.u32(),
            telescope: self.u16(),
            passes: self.u16(),
        }
    }

    fn event(&mut self) -> Event {
        match self.below(8) {
            0 => Event::Entered(self.state()),
            1 => Event::Started(self.u32(), self.record()),
            2 => Event::Ended(self.u32()),
            3 => Event::Skipped(self.u32(), self.skip()),
            4 => Event::Aborted(self.u32(), self.abort()),
            5 => Event::Safe(self.safe()),
            6 => Event::Tables(self.u32()),
            _ => Event::TimeJumped { from: self.at(), to: self.at() },
        }
    }

    fn origin(&mut self) -> Origin {
        Origin {
            spacecraft: self.u32(),
            telescope: self.u16(),
            ticks: self.word(),
            at: (self.below(2) == 0).then(|| self.at()),
        }
    }

    fn report(&mut self) -> EventReport {
        EventReport { origin: self.origin(), event: self.event() }
    }

    /// Each part there or not.
    fn housekeeping(&mut self) -> Housekeeping {
        let parts = self.below(64);
        let has = |bit: u32| parts >> bit & 1 == 1;
        Housekeeping {
            origin: self.origin(),
            tick: Tick {
                state: self.state(),
                evaluations: u32::from(self.u16()),
                check: [Progress::Waiting, Progress::UnderWay, Progress::Done]
                    [usize::try_from(self.below(3)).unwrap()],
            },
            tables: has(0).then(|| TablesInUse {
                sequence: self.u32(),
                set_digest: self.word(),
                valid_until: self.at(),
            }),
            tables_damaged: has(1),
            clock: has(2).then(|| ClockInUse {
                sequence: self.u32(),
                uncertainty_ns: self.u32(),
                valid_until: self.at(),
            }),
            lost: Lost {
                entered: self.u32(),
                started: self.u32(),
                ended: self.u32(),
                skipped: self.u32(),
                aborted: self.u32(),
                safe: self.u32(),
                tables: self.u32(),
                time_jumped: self.u32(),
            },
            tracker: has(3).then(|| TrackerHealth {
                epoch: self.at(),
                accepted: self.u32(),
                refused_in_a_row: self.u32(),
                covariance: ScanCovariance {
                    variances: [(); 3].map(|()| self.number()),
                    covariances: [(); 3].map(|()| self.number()),
                },
                rate_sigmas_rad_s: [(); 2].map(|()| self.number()),
            }),
            scrub: has(4).then(|| ScrubProgress { at: self.u32(), length: self.u32() }),
            visit: has(5).then(|| VisitToCome {
                body: self.i32(),
                entry: self.at(),
                exit: self.at(),
                entry_clipped: self.below(2) == 0,
                exit_clipped: self.below(2) == 0,
                earliest_entry: self.at(),
                latest_exit: self.at(),
                probability: self.number(),
                entry_sigma_s: self.number(),
            }),
        }
    }
}

/// A payload with a byte set and its CRC made to match.
fn with(payload: &[u8], at: usize, byte: u8) -> Vec<u8> {
    let mut bytes = payload.to_vec();
    bytes[at] = byte;
    let end = bytes.len() - 4;
    let crc = checksum(&bytes[..end]).to_be_bytes();
    bytes[end..].copy_from_slice(&crc);
    bytes
}

fn refused(bytes: &[u8]) -> TelemetryError {
    Payload::from_be_bytes(bytes).unwrap_err()
}

const ORIGIN: Origin =
    Origin { spacecraft: 7, telescope: 1, ticks: 99, at: Some(Instant::from_tai_ns(-3)) };

fn of(event: Event) -> [u8; EVENT_BYTES] {
    EventReport { origin: ORIGIN, event }.to_be_bytes()
}

#[test]
// REQ-TLM-1, REQ-TLM-2.
fn a_million_random_events_come_back() {
    let mut random = Random(1);
    for _ in 0..1_000_000 {
        let report = random.report();
        let read = Payload::from_be_bytes(&report.to_be_bytes());
        assert_eq!(read, Ok(Payload::Event(report)));
    }
}

#[test]
// REQ-TLM-1, REQ-TLM-2.
fn random_housekeeping_comes_back_with_any_part_missing() {
    let mut random = Random(2);
    for _ in 0..100_000 {
        let report = random.housekeeping();
        let read = Payload::from_be_bytes(&report.to_be_bytes());
        assert_eq!(read, Ok(Payload::Housekeeping(report)));
    }
}

#[test]
// REQ-TLM-2.
fn no_flipped_bit_passes_and_no_other_length() {
    let mut random = Random(3);
    for _ in 0..60 {
        for payload in
            [random.report().to_be_bytes().to_vec(), random.housekeeping().to_be_bytes().to_vec()]
        {
            for bit in 0..payload.len() * 8 {
                let mut bad = payload.clone();
                bad[bit / 8] ^= 1 << (bit % 8);
                assert!(Payload::from_be_bytes(&bad).is_err(), "bit {bit}");
            }
            let short = &payload[..payload.len() - 1];
            assert_eq!(refused(short), TelemetryError::Length(short.len()));
            assert_eq!(
                refused(&[&payload[..], &[0]].concat()),
                TelemetryError::Length(payload.len() + 1)
            );
        }
    }
    assert_eq!(refused(&[LAYOUT_VERSION]), TelemetryError::Length(1));
    let mut bad = of(Event::Ended(4));
    bad[40] ^= 1;
    assert_eq!(refused(&bad), TelemetryError::Damaged);
}

#[test]
// REQ-TLM-3.
fn what_is_unknown_is_refused_with_its_number() {
    let payload = of(Event::Entered(State::Safe(SafeReason::Boot)));
    assert_eq!(refused(&with(&payload, 0, 0xa2)), TelemetryError::Version(0xa2));
    for kind in (0..=u8::MAX).filter(|kind| !(1..=8).contains(kind) && *kind != 16) {
        assert_eq!(refused(&with(&payload, 1, kind)), TelemetryError::Kind(kind));
        assert_eq!(payload_bytes(kind), None);
    }
    for state in [0, 6, 255] {
        assert_eq!(refused(&with(&payload, 25, state)), TelemetryError::State(state));
    }
    // 169 follows the last reason to be safe, 180 is one to skip, 200 one to give up.
    for reason in [0, 169, 180, 200] {
        assert_eq!(refused(&with(&payload, 27, reason)), TelemetryError::Reason(reason.into()));
    }
    let skipped = of(Event::Skipped(3, SkipReason::Missed));
    assert_eq!(refused(&with(&skipped, 27, 160)), TelemetryError::Reason(160));
    let aborted = of(Event::Aborted(3, AbortReason::Safe));
    assert_eq!(refused(&with(&aborted, 27, 180)), TelemetryError::Reason(180));
    let report = Random(4).housekeeping().to_be_bytes();
    assert_eq!(refused(&with(&report, 51, 4)), TelemetryError::Check(4));
}

/// Every byte that an event does not use.
#[test]
// REQ-TLM-3.
fn what_is_not_used_must_be_zero() {
    let ended = of(Event::Ended(9));
    for at in (25..28).chain(32..92) {
        assert_eq!(refused(&with(&ended, at, 1)), TelemetryError::Illegal, "byte {at}");
    }
    // The instant is known, no other bit has a meaning there.
    assert_eq!(refused(&with(&ended, 24, 3)), TelemetryError::Illegal);
    let unknown = EventReport { origin: Origin { at: None, ..ORIGIN }, event: Event::Ended(9) };
    assert_eq!(refused(&with(&unknown.to_be_bytes(), 23, 1)), TelemetryError::Illegal);
    // A number that the reason's width does not hold.
    let passes = of(Event::Skipped(3, SkipReason::Passes(u16::MAX)));
    assert_eq!(refused(&with(&passes, 37, 1)), TelemetryError::Illegal);
}

#[test]
// REQ-TLM-1.
fn words_are_big_endian_at_fixed_offsets() {
    let record = SessionRecord {
        start: Instant::from_tai_ns(0x0102_0304_0506_0708),
        body: -2,
        passes: 0x0a0b,
        ..Random(5).record()
    };
    let payload = of(Event::Started(0x0c0d_0e0f, record));
    assert_eq!(payload[..8], [0xa1, 2, 0, 1, 0, 0, 0, 7]);
    assert_eq!(payload[8..16], [0, 0, 0, 0, 0, 0, 0, 99]);
    assert_eq!(payload[16..25], [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfd, 1]);
    assert_eq!(payload[28..32], [0x0c, 0x0d, 0x0e, 0x0f]);
    assert_eq!(payload[48..56], [1, 2, 3, 4, 5, 6, 7, 8]);
    assert_eq!(payload[80..84], [0xff, 0xff, 0xff, 0xfe]);
    assert_eq!(payload[90..92], [0x0a, 0x0b]);
    assert_eq!(payload[92..], checksum(&payload[..92]).to_be_bytes());
}
