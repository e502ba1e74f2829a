//! How saved states are told from damage, and from those of another kind, version or spacecraft.
//!
//! Whatever is written in one run and read in a later one is a record of fixed bytes, little-endian:
//!
//! | bytes | field |
//! |---|---|
//! | 0..4 | the kind, four letters |
//! | 4..6 | version of its layout, u16 |
//! | 6..8 | zero |
//! | 8..12 | identity of the spacecraft, u32, as in a container's header |
//! | 12.. | contents |
//! | last 4 | CRC-32 of all before |
//!
//! A record of another kind, version or spacecraft, or with one flipped bit, is refused: begin anew
//! then.
//!
//! Limits: a CRC guards against damage, not against forgery.

use crate::bytes::{field, put, u16_at, u32_at};
use crate::uplink::checksum;

/// Bytes of head and CRC.
pub(crate) const FRAME_BYTES: usize = 16;

/// Why a saved state is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum RecordError {
    /// It has this many bytes, another number than its kind takes.
    Length(usize),
    /// It is of another kind.
    Kind,
    /// The CRC does not match, or a field has no meaning.
    Damaged,
    /// Another version of the layout (the one found).
    Version(u16),
    /// It is another spacecraft's (identities).
    OtherSpacecraft {
        /// The record's.
        record: u32,
        /// The one that is flown.
        flown: u32,
    },
    /// It belongs to another search or another log than the one that is to go on.
    OtherOrigin,
}

/// What a kind of record is known by.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kind {
    /// Its letters.
    pub(crate) letters: [u8; 4],
    /// Its layout's version.
    pub(crate) version: u16,
}

impl Kind {
    /// Fills in head and CRC of a record whose contents are there.
    #[inline(never)]
    pub(crate) fn seal(self, record: &mut [u8], spacecraft: u32) {
        put(record, 0, self.letters);
        put(record, 4, self.version.to_le_bytes());
        put(record, 8, spacecraft.to_le_bytes());
        if let Some((covered, crc)) = record.split_last_chunk_mut::<4>() {
            *crc = checksum(covered).to_le_bytes();
        }
    }

    /// Checks head and CRC.
    #[inline(never)]
    pub(crate) fn open(self, record: &[u8], spacecraft: u32) -> Result<(), RecordError> {
        let length = RecordError::Length(record.len());
        let (covered, crc) = record.split_last_chunk::<4>().ok_or(length)?;
        if field(record, 0) != Some(self.letters) {
            return Err(RecordError::Kind);
        }
        if u32::from_le_bytes(*crc) != checksum(covered) {
            return Err(RecordError::Damaged);
        }
        let version = u16_at(record, 4).ok_or(length)?;
        if version != self.version || u16_at(record, 6) != Some(0) {
            return Err(RecordError::Version(version));
        }
        let found = u32_at(record, 8).ok_or(length)?;
        if found != spacecraft {
            return Err(RecordError::OtherSpacecraft { record: found, flown: spacecraft });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KIND: Kind = Kind { letters: *b"TEST", version: 3 };

    #[test]
    fn each_part_of_the_head_has_its_refusal() {
        let mut record = [7; 24];
        record[6..8].fill(0);
        KIND.seal(&mut record, 5);
        assert_eq!(KIND.open(&record, 5), Ok(()));
        let other = RecordError::OtherSpacecraft { record: 5, flown: 6 };
        assert_eq!(KIND.open(&record, 6), Err(other));
        let newer = Kind { version: 4, ..KIND };
        assert_eq!(newer.open(&record, 5), Err(RecordError::Version(3)));
        let kind = Kind { letters: *b"TESS", ..KIND };
        assert_eq!(kind.open(&record, 5), Err(RecordError::Kind));
        assert_eq!(KIND.open(&record[..3], 5), Err(RecordError::Length(3)));
        assert_eq!(KIND.open(&record[..20], 5), Err(RecordError::Damaged));
        for bit in 0..record.len() * 8 {
            let mut bad = record;
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(KIND.open(&bad, 5).is_err(), "bit {bit}");
        }
    }
}
