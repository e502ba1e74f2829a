//! A payload's words, big-endian, one after the other, and the CRC behind them.

use crate::uplink::checksum;

/// First byte of every payload: version 1. Its first three bits are no CCSDS packet's (000), so that
/// a file of payloads is told from a file of packets.
pub const LAYOUT_VERSION: u8 = 0xa1;

/// Words that belong together, and in how many bytes each is.
pub(super) struct Group<'w> {
    pub(super) sizes: &'w [u8],
    pub(super) words: &'w [u64],
}

/// A group of words of these sizes.
pub(super) const fn group<'w, const N: usize>(
    sizes: &'w [u8; N],
    words: &'w [u64; N],
) -> Group<'w> {
    Group { sizes, words }
}

/// Writes the groups' words one after the other, and the CRC into the last four bytes.
#[inline(never)]
pub(super) fn seal(payload: &mut [u8], groups: &[Group<'_>]) {
    let mut rest = &mut *payload;
    for (size, word) in groups.iter().flat_map(|group| group.sizes.iter().zip(group.words)) {
        let Some((field, behind)) = rest.split_at_mut_checked(usize::from(*size)) else { return };
        for (byte, value) in field.iter_mut().rev().zip(word.to_le_bytes()) {
            *byte = value;
        }
        rest = behind;
    }
    if let Some((covered, crc)) = payload.split_last_chunk_mut::<4>() {
        *crc = checksum(covered).to_be_bytes();
    }
}

/// Whether the CRC is that of the bytes before it.
#[cfg(not(target_os = "none"))]
pub(super) fn is_whole(payload: &[u8]) -> bool {
    let parts = payload.split_last_chunk::<4>();
    parts.is_some_and(|(covered, crc)| u32::from_be_bytes(*crc) == checksum(covered))
}

/// The words as [`seal`] wrote them, from the front.
#[cfg(not(target_os = "none"))]
pub(super) struct Words<'p>(pub(super) core::slice::Iter<'p, u8>);

#[cfg(not(target_os = "none"))]
impl Words<'_> {
    /// The next group.
    pub(super) fn group<const N: usize>(&mut self, sizes: &[u8; N]) -> [u64; N] {
        sizes.map(|size| {
            let field = self.0.by_ref().take(usize::from(size));
            field.fold(0, |word: u64, byte| word.wrapping_shl(8) | u64::from(*byte))
        })
    }
}
