//! What is the time, from the on-board clock's ticks.
//!
//! A [`ClockCorrelation`] says that the counter stood at `ticks` at a TAI instant and how long a
//! tick is, and for how long that may be believed. The ground measures and uplinks it; it is a
//! record of its own, since it changes more often than the tables.
//!
//! | bytes | field |
//! |---|---|
//! | 0..8 | magic `GYRCLOCK` |
//! | 8..12 | sequence number, u32 |
//! | 12..16 | standard uncertainty at the reference, ns, u32 |
//! | 16..24 | counter at the reference, u64 |
//! | 24..32 | reference, i64 ns of TAI |
//! | 32..48 | length of a tick, u128 in 2^-64 ns |
//! | 48..56, 56..64 | valid from and until, i64 ns of TAI |
//! | 64..68 | identity of the spacecraft, u32 |
//! | 68..72 | CRC-32 of bytes 0..68 |
//!
//! Method: integers only, exact to one ns: the tick's length times the signed difference of the
//! counter, which may wrap.
//!
//! Limits: ticks up to 584 years long and differences below 2^63 ticks; the drift beyond the stated
//! rate is the ground's to bound, by the validity.

use crate::bytes::{field, i64_at, put, u32_at, u64_at, u128_at};
use crate::convert::{high_half, low_half, signed_from_u64, wide};
use crate::time::Instant;
use crate::uplink::{SequenceError, check_sequence, checksum};

/// Bytes of a correlation record.
pub const CLOCK_BYTES: usize = 72;
const MAGIC: [u8; 8] = *b"GYRCLOCK";

/// Why a record is refused, or has no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ClockError {
    /// The first bytes are not the magic.
    NotACorrelation,
    /// The CRC does not match.
    Damaged,
    /// A tick of no length, or a validity that ends before it begins.
    Illegal,
    /// Its sequence number does not follow the active record's.
    Sequence(SequenceError),
    /// The record is another spacecraft's (identities).
    OtherSpacecraft {
        /// The record's.
        record: u32,
        /// The one that is flown.
        flown: u32,
    },
    /// The counter's time lies before the validity, which begins at this instant.
    NotYetValid(Instant),
    /// The counter's time lies behind the validity, which ended at this instant.
    Expired(Instant),
    /// The counter's time lies beyond the time scale.
    BeyondScale,
}

/// How the on-board counter relates to TAI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClockCorrelation {
    /// Grows with every record, by at most [`MAX_SEQUENCE_STEP`](crate::uplink::MAX_SEQUENCE_STEP).
    pub sequence: u32,
    /// Identity of the spacecraft, as in a container's header.
    pub spacecraft: u32,
    /// Standard uncertainty at the reference in ns.
    pub uncertainty_ns: u32,
    /// Counter at the reference.
    pub ticks: u64,
    /// The reference.
    pub at: Instant,
    /// Length of a tick in 2^-64 ns.
    pub tick_bits: u128,
    /// First instant at which the record may be used.
    pub valid_from: Instant,
    /// Last instant at which the record may be used.
    pub valid_until: Instant,
}

impl ClockCorrelation {
    /// Reads and checks a record.
    ///
    /// # Errors
    /// [`ClockError`], the first thing found wrong.
    #[inline(never)]
    pub fn from_le_bytes(bytes: &[u8; CLOCK_BYTES]) -> Result<Self, ClockError> {
        if field(bytes, 0) != Some(MAGIC) {
            return Err(ClockError::NotACorrelation);
        }
        let damaged = ClockError::Damaged;
        let covered = bytes.first_chunk::<68>().ok_or(damaged)?;
        if u32_at(bytes, 68) != Some(checksum(covered)) {
            return Err(damaged);
        }
        let instant = |offset| i64_at(bytes, offset).map(Instant::from_tai_ns).ok_or(damaged);
        let record = Self {
            sequence: u32_at(bytes, 8).ok_or(damaged)?,
            spacecraft: u32_at(bytes, 64).ok_or(damaged)?,
            uncertainty_ns: u32_at(bytes, 12).ok_or(damaged)?,
            ticks: u64_at(bytes, 16).ok_or(damaged)?,
            at: instant(24)?,
            tick_bits: u128_at(bytes, 32).ok_or(damaged)?,
            valid_from: instant(48)?,
            valid_until: instant(56)?,
        };
        if record.tick_bits == 0 || record.valid_until < record.valid_from {
            return Err(ClockError::Illegal);
        }
        Ok(record)
    }

    /// The record's bytes.
    #[must_use]
    pub fn to_le_bytes(&self) -> [u8; CLOCK_BYTES] {
        let mut bytes = [0; CLOCK_BYTES];
        put(&mut bytes, 0, MAGIC);
        put(&mut bytes, 8, self.sequence.to_le_bytes());
        put(&mut bytes, 12, self.uncertainty_ns.to_le_bytes());
        put(&mut bytes, 16, self.ticks.to_le_bytes());
        put(&mut bytes, 24, self.at.tai_ns().to_le_bytes());
        put(&mut bytes, 32, self.tick_bits.to_le_bytes());
        put(&mut bytes, 48, self.valid_from.tai_ns().to_le_bytes());
        put(&mut bytes, 56, self.valid_until.tai_ns().to_le_bytes());
        put(&mut bytes, 64, self.spacecraft.to_le_bytes());
        let crc = bytes.first_chunk::<68>().map_or(0, |covered| checksum(covered));
        put(&mut bytes, 68, crc.to_le_bytes());
        bytes
    }

    /// This record, where it is that spacecraft's and follows the one in use; without one in use it
    /// may have any number up to the largest step.
    ///
    /// # Errors
    /// [`ClockError::OtherSpacecraft`] or [`ClockError::Sequence`].
    pub fn replacing(self, active: Option<&Self>, spacecraft: u32) -> Result<Self, ClockError> {
        if self.spacecraft != spacecraft {
            return Err(ClockError::OtherSpacecraft { record: self.spacecraft, flown: spacecraft });
        }
        let newest = active.map(|active| active.sequence);
        check_sequence(self.sequence, newest).map_err(ClockError::Sequence)?;
        Ok(self)
    }

    /// The TAI instant at which the counter stands at `ticks`, to the ns below.
    ///
    /// # Errors
    /// [`ClockError::Expired`], [`ClockError::NotYetValid`] or [`ClockError::BeyondScale`].
    #[inline(never)]
    // REQ-CLOCK-1.
    pub fn instant(&self, ticks: u64) -> Result<Instant, ClockError> {
        let beyond = ClockError::BeyondScale;
        let difference = signed_from_u64(ticks.wrapping_sub(self.ticks));
        let count = difference.unsigned_abs();
        let whole = u64::try_from(wide(high_half(self.tick_bits)).wrapping_mul(wide(count)));
        let part = wide(low_half(self.tick_bits)).wrapping_mul(wide(count));
        // Behind the reference, the ns below is one further back unless the product is whole.
        let carry = u64::from(difference < 0 && low_half(part) != 0);
        let ns = whole
            .ok()
            .and_then(|whole| whole.checked_add(high_half(part)))
            .and_then(|ns| ns.checked_add(carry))
            .and_then(|ns| i64::try_from(ns).ok())
            .ok_or(beyond)?;
        let signed = if difference < 0 { ns.wrapping_neg() } else { ns };
        let at = self.at.tai_ns().checked_add(signed).map(Instant::from_tai_ns).ok_or(beyond)?;
        if at > self.valid_until {
            Err(ClockError::Expired(self.valid_until))
        } else if at < self.valid_from {
            Err(ClockError::NotYetValid(self.valid_from))
        } else {
            Ok(at)
        }
    }

    /// The length of a tick of `ns` whole ns and `fraction` 2^-64 ns, as the record holds it.
    #[must_use]
    pub const fn tick_of(ns: u64, fraction: u64) -> u128 {
        wide(ns).wrapping_shl(64).wrapping_add(wide(fraction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RECORD: ClockCorrelation = ClockCorrelation {
        sequence: 3,
        spacecraft: 8,
        uncertainty_ns: 500,
        ticks: 1_000_000,
        at: Instant::from_tai_ns(5_000_000_000),
        tick_bits: ClockCorrelation::tick_of(1000, 1 << 62),
        valid_from: Instant::from_tai_ns(0),
        valid_until: Instant::from_tai_ns(9_000_000_000_000),
    };

    #[test]
    fn a_record_comes_back_and_no_flipped_bit_passes() {
        let good = RECORD.to_le_bytes();
        assert_eq!(ClockCorrelation::from_le_bytes(&good), Ok(RECORD));
        for bit in 0..CLOCK_BYTES * 8 {
            let mut bad = good;
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(ClockCorrelation::from_le_bytes(&bad).is_err(), "bit {bit}");
        }
        let still = ClockCorrelation { tick_bits: 0, ..RECORD }.to_le_bytes();
        assert_eq!(ClockCorrelation::from_le_bytes(&still), Err(ClockError::Illegal));
    }

    #[test]
    // REQ-CLOCK-1.
    fn ticks_become_time_both_ways_from_the_reference() {
        let ns = |ticks| RECORD.instant(ticks).map(Instant::tai_ns);
        assert_eq!(ns(1_000_000), Ok(5_000_000_000));
        assert_eq!(ns(1_000_004), Ok(5_000_004_001));
        assert_eq!(ns(1_000_001), Ok(5_000_001_000), "1000.25 ns, to the ns below");
        assert_eq!(ns(999_999), Ok(4_999_998_999), "-1000.25 ns, to the ns below");
        assert_eq!(ns(999_996), Ok(4_999_995_999));
    }

    #[test]
    // REQ-CLOCK-1.
    fn the_validity_and_the_scale_end() {
        let ends = RECORD.valid_until;
        assert_eq!(RECORD.instant(u64::MAX / 2_000_000), Err(ClockError::Expired(ends)));
        let early = ClockCorrelation { valid_from: Instant::from_tai_ns(4_999_999_000), ..RECORD };
        assert_eq!(early.instant(0), Err(ClockError::NotYetValid(early.valid_from)));
        assert_eq!(RECORD.instant(u64::MAX / 2), Err(ClockError::BeyondScale));
    }

    #[test]
    // REQ-CLOCK-1.
    fn both_ends_of_the_validity_are_valid() {
        let tick_bits = ClockCorrelation::tick_of(1, 0);
        let ends = (Instant::from_tai_ns(4_000), Instant::from_tai_ns(6_000));
        let record = ClockCorrelation {
            ticks: 5_000,
            at: Instant::from_tai_ns(5_000),
            tick_bits,
            valid_from: ends.0,
            valid_until: ends.1,
            ..RECORD
        };
        assert_eq!(record.instant(6_000), Ok(ends.1));
        assert_eq!(record.instant(6_001), Err(ClockError::Expired(ends.1)));
        assert_eq!(record.instant(4_000), Ok(ends.0));
        assert_eq!(record.instant(3_999), Err(ClockError::NotYetValid(ends.0)));
        let read = |valid_until| {
            let record = ClockCorrelation { valid_until, ..record };
            ClockCorrelation::from_le_bytes(&record.to_le_bytes()).map(|_| ())
        };
        assert_eq!(read(ends.0), Ok(()), "valid at one instant");
        assert_eq!(read(Instant::from_tai_ns(3_999)), Err(ClockError::Illegal));
        assert_eq!(read(ends.1), Ok(()));
    }

    #[test]
    // REQ-NUMBER-1.
    fn only_the_next_record_of_the_same_spacecraft_replaces() {
        let sequence = |error| Err(ClockError::Sequence(error));
        assert_eq!(RECORD.replacing(None, 8), Ok(RECORD));
        let older = SequenceError::Older { candidate: 3, newest: 3 };
        assert_eq!(RECORD.replacing(Some(&RECORD), 8), sequence(older));
        let newer = ClockCorrelation { sequence: 4, ..RECORD };
        assert_eq!(newer.replacing(Some(&RECORD), 8), Ok(newer));
        let last = ClockCorrelation { sequence: u32::MAX, ..RECORD };
        let far = SequenceError::StepTooLarge { candidate: u32::MAX, newest: 3 };
        assert_eq!(last.replacing(Some(&RECORD), 8), sequence(far));
        let far = SequenceError::StepTooLarge { candidate: u32::MAX, newest: 0 };
        assert_eq!(last.replacing(None, 8), sequence(far));
        let other = ClockError::OtherSpacecraft { record: 8, flown: 9 };
        assert_eq!(newer.replacing(Some(&RECORD), 9), Err(other));
    }

    proptest! {
        #[test]
        fn agrees_with_wide_arithmetic(ticks: u64, tick in 1_u128..(1 << 94), at in -(1_i64 << 62)..(1_i64 << 62)) {
            let record = ClockCorrelation {
                ticks: 77,
                tick_bits: tick,
                at: Instant::from_tai_ns(at),
                valid_from: Instant::from_tai_ns(i64::MIN),
                valid_until: Instant::from_tai_ns(i64::MAX),
                ..RECORD
            };
            let difference = i128::from(ticks.wrapping_sub(77).cast_signed());
            // The difference in two halves of 32 bits keeps every product inside i128.
            let (high, low) = (difference >> 32, difference & 0xffff_ffff);
            let tick = i128::try_from(tick).unwrap();
            let carried = high * (tick & 0xffff_ffff) + ((low * tick) >> 32);
            let expected = i128::from(at) + high * (tick >> 32) + (carried >> 32);
            match record.instant(ticks) {
                Ok(instant) => {
                    prop_assert!((i128::from(instant.tai_ns()) - expected).abs() <= 1);
                }
                Err(error) => {
                    prop_assert_eq!(error, ClockError::BeyondScale);
                    prop_assert!(i64::try_from(expected).is_err() || i64::try_from(expected - i128::from(at)).is_err());
                }
            }
        }
    }
}
