//! How a slot of raw flash is divided, and what its words say.
//!
//! A slot is the caller's memory, which the flash controller erases to ones, by sectors, and in which
//! programming can only turn ones into zeros. Error-correcting codes cover words of 8, 16 or 32
//! bytes, and a word may be programmed once between two erases. A slot begins at a multiple of
//! [`WORD_BYTES`] (or of the controller's page, if that is longer) and shares no sector with anything
//! else; its head lies in one sector.
//!
//! | bytes | what |
//! |---|---|
//! | 0..32 | COMMIT word: programmed last of an upload |
//! | 32..64 | REVOKED word: left erased until the container is rolled back |
//! | 64..512 | [`FLOOR_WORDS`] floor words, left erased: each says up to which number the *other* slot is revoked |
//! | 512.. | the container, filled up with ones to a whole word |
//!
//! | bytes of the COMMIT word | field |
//! |---|---|
//! | 0..8 | `GYRCOMIT` |
//! | 8..12 | sequence number of the container, u32 |
//! | 12..16 | length of the container, u32 |
//! | 16..24 | set digest of the container, u64 |
//! | 24..28 | zero |
//! | 28..32 | CRC-32 of bytes 0..28 |
//!
//! | bytes of a floor word | field |
//! |---|---|
//! | 0..8 | `GYRFLOOR` |
//! | 8..12, 12..16 | the number, u32, and its complement |
//! | 16..28 | zero |
//! | 28..32 | CRC-32 of bytes 0..28 |
//!
//! A REVOKED word is zero. What a word means when its programming was cut short, whatever bits it
//! then shows: a COMMIT or floor word that is not whole does not count; a REVOKED word counts as soon
//! as one bit of it reads zero.
//!
//! Limits: flash that erases to ones. A word that the controller cannot correct must be handed in as
//! bytes (zeros, for instance), not as a fault.
//!
//! Requirements: REQ-SLOT-3.

use super::{HEADER_BYTES, MAGIC, checksum};
use crate::bytes::{field, put, u32_at, u64_at};
use crate::convert::uncounted;

/// Bytes of a slot's word: the longest span under one error-correcting code that is served.
pub const WORD_BYTES: usize = 32;
/// Where the COMMIT word lies in a slot.
pub const COMMIT_OFFSET: usize = 0;
/// Where the REVOKED word lies in a slot.
pub const REVOKED_OFFSET: usize = 32;
/// Where the floor words begin in a slot.
pub const FLOOR_OFFSET: usize = 64;
/// How many floor words a slot has: as often can its container be returned to.
pub const FLOOR_WORDS: usize = 14;
/// Where the container begins in a slot.
pub const CONTAINER_OFFSET: usize = 512;

/// A word of a slot.
pub type Word = [u8; WORD_BYTES];

/// A word that was not programmed since it was erased.
pub const ERASED: Word = [0xff; WORD_BYTES];
/// What is programmed into the REVOKED word.
pub(super) const REVOKED: Word = [0; WORD_BYTES];

const COMMIT_MAGIC: [u8; 8] = *b"GYRCOMIT";
const FLOOR_MAGIC: [u8; 8] = *b"GYRFLOOR";

/// One of the two places for a container.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    /// The first.
    A,
    /// The second.
    B,
}

impl Slot {
    /// The other place.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

/// The two slots as they read now, in borrowed bytes.
#[derive(Debug, Clone, Copy)]
pub struct Slots<'a> {
    /// The first.
    pub a: &'a [u8],
    /// The second.
    pub b: &'a [u8],
}

impl<'a> Slots<'a> {
    /// The bytes of one slot.
    #[must_use]
    pub const fn bytes(&self, slot: Slot) -> &'a [u8] {
        match slot {
            Slot::A => self.a,
            Slot::B => self.b,
        }
    }
}

/// Bytes that a slot needs for a container of this length; `None` beyond what can be addressed.
#[must_use]
pub fn slot_bytes(container: usize) -> Option<usize> {
    container.checked_next_multiple_of(WORD_BYTES)?.checked_add(CONTAINER_OFFSET)
}

/// Whether the word at `offset` is there and reads as this one.
#[inline(never)]
pub(super) fn reads(slot: &[u8], offset: usize, word: &Word) -> bool {
    slot.get(offset..).and_then(|rest| rest.first_chunk()) == Some(word)
}

/// Whether the word at `offset` is there and reads as erased.
pub(super) fn is_erased(slot: &[u8], offset: usize) -> bool {
    reads(slot, offset, &ERASED)
}

/// The COMMIT word of a container.
#[inline(never)]
pub(super) fn commit_word(sequence: u32, length: u32, set_digest: u64) -> Word {
    let mut word = [0; WORD_BYTES];
    put(&mut word, 0, COMMIT_MAGIC);
    put(&mut word, 8, sequence.to_le_bytes());
    put(&mut word, 12, length.to_le_bytes());
    put(&mut word, 16, set_digest.to_le_bytes());
    sealed(word)
}

/// The floor word of a number.
#[inline(never)]
pub(super) fn floor_word(number: u32) -> Word {
    let mut word = [0; WORD_BYTES];
    put(&mut word, 0, FLOOR_MAGIC);
    put(&mut word, 8, number.to_le_bytes());
    put(&mut word, 12, (!number).to_le_bytes());
    sealed(word)
}

fn sealed(mut word: Word) -> Word {
    let crc = word.first_chunk::<28>().map_or(0, |covered| checksum(covered));
    put(&mut word, 28, crc.to_le_bytes());
    word
}

/// The sequence number in a slot's COMMIT word, where that is whole.
#[inline(never)]
pub(super) fn committed_sequence(slot: &[u8]) -> Option<u32> {
    let number = u32_at(slot, COMMIT_OFFSET + 8)?;
    let (length, digest) = (u32_at(slot, COMMIT_OFFSET + 12)?, u64_at(slot, COMMIT_OFFSET + 16)?);
    reads(slot, COMMIT_OFFSET, &commit_word(number, length, digest)).then_some(number)
}

/// Whether any bit of a slot's REVOKED word was programmed.
pub(super) fn is_revoked(slot: &[u8]) -> bool {
    slot.len() >= REVOKED_OFFSET + WORD_BYTES && !is_erased(slot, REVOKED_OFFSET)
}

/// The floor words of a slot, in the order of their use.
fn floors(slot: &[u8]) -> impl Iterator<Item = &Word> {
    let words = slot.get(FLOOR_OFFSET..).unwrap_or(&[]).as_chunks().0;
    words.iter().take(uncounted(FLOOR_WORDS))
}

/// Up to which number a slot says that the other one is revoked.
#[inline(never)]
pub(super) fn floor(slot: &[u8]) -> Option<u32> {
    floors(slot)
        .filter_map(|word| {
            let number = u32_at(word, 8)?;
            (*word == floor_word(number)).then_some(number)
        })
        .max()
}

/// Where the next floor word of a slot is to be programmed; `None` when all are used.
pub(super) fn free_floor(slot: &[u8]) -> Option<usize> {
    let mut offset = FLOOR_OFFSET;
    for word in floors(slot) {
        if reads(word, 0, &ERASED) {
            return Some(offset);
        }
        offset = offset.wrapping_add(WORD_BYTES);
    }
    None
}

/// A slot from its container on: as long as the container's header says, where that fits.
pub(super) fn image(slot: &[u8]) -> &[u8] {
    let rest = slot.get(CONTAINER_OFFSET..).unwrap_or(&[]);
    let length = u32_at(rest, 12).and_then(|length| usize::try_from(length).ok());
    length.and_then(|length| rest.get(..length)).unwrap_or(rest)
}

/// The header of a slot's container, where its CRC matches, of any format version.
#[inline(never)]
pub(super) fn whole_header(slot: &[u8]) -> Option<&[u8; HEADER_BYTES]> {
    let header = slot.get(CONTAINER_OFFSET..)?.first_chunk::<HEADER_BYTES>()?;
    let covered = header.first_chunk::<60>()?;
    let whole = field(header, 0) == Some(MAGIC) && u32_at(header, 60) == Some(checksum(covered));
    whole.then_some(header)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    // REQ-SLOT-3.
    fn each_word_lies_in_a_word_of_its_own() {
        let floors = FLOOR_OFFSET + FLOOR_WORDS * WORD_BYTES;
        assert_eq!((COMMIT_OFFSET, REVOKED_OFFSET, FLOOR_OFFSET), (0, WORD_BYTES, 2 * WORD_BYTES));
        assert_eq!(floors, CONTAINER_OFFSET);
        for unit in [1, 2, 4, 8, 16, 32] {
            assert_eq!(WORD_BYTES % unit, 0);
        }
        assert_eq!(slot_bytes(0), Some(512));
        assert_eq!(slot_bytes(1), Some(544));
        assert_eq!(slot_bytes(64), Some(576));
        assert_eq!(slot_bytes(usize::MAX), None);
    }

    /// No subset of a word's bits, the word itself apart, is taken for a word.
    #[test]
    // REQ-SLOT-1.
    fn a_torn_word_is_no_word() {
        let mut slot = [0xff; CONTAINER_OFFSET];
        let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
        for number in [0, 1, 9, 77, u32::MAX] {
            for (word, offset) in
                [(commit_word(number, 800, 0x1234), COMMIT_OFFSET), (floor_word(number), 96)]
            {
                let read = |slot: &[u8]| (committed_sequence(slot), floor(slot));
                assert_eq!(read(&slot), (None, None));
                slot[offset..offset + WORD_BYTES].copy_from_slice(&word);
                let whole = read(&slot);
                assert_eq!(whole.0.max(whole.1), Some(number));
                for _ in 0..2000 {
                    let mut torn = word;
                    for byte in &mut torn {
                        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                        *byte |= bits.to_be_bytes()[0] & bits.to_be_bytes()[1];
                    }
                    slot[offset..offset + WORD_BYTES].copy_from_slice(&torn);
                    assert_eq!(read(&slot) != (None, None), torn == word);
                }
                for bit in 0..WORD_BYTES * 8 {
                    let mut torn = word;
                    torn[bit / 8] ^= 1 << (bit % 8);
                    slot[offset..offset + WORD_BYTES].copy_from_slice(&torn);
                    assert_eq!(read(&slot), (None, None), "bit {bit}");
                }
                slot[offset..offset + WORD_BYTES].fill(0xff);
            }
        }
    }

    #[test]
    fn one_programmed_bit_revokes() {
        let mut slot = [0xff; CONTAINER_OFFSET];
        assert!(!is_revoked(&slot));
        for bit in 0..WORD_BYTES * 8 {
            slot[REVOKED_OFFSET + bit / 8] = !(1 << (bit % 8));
            assert!(is_revoked(&slot), "bit {bit}");
            slot[REVOKED_OFFSET + bit / 8] = 0xff;
        }
    }

    #[test]
    fn the_highest_floor_counts_and_the_first_free_word_is_next() {
        let mut slot = [0xff; CONTAINER_OFFSET];
        assert_eq!((floor(&slot), free_floor(&slot)), (None, Some(64)));
        slot[64..96].copy_from_slice(&floor_word(9));
        slot[96..128].fill(0);
        slot[128..160].copy_from_slice(&floor_word(7));
        assert_eq!((floor(&slot), free_floor(&slot)), (Some(9), Some(160)));
        slot[64..].fill(0);
        assert_eq!((floor(&slot), free_floor(&slot)), (None, None));
    }
}
