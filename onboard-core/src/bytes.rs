//! Little-endian fields out of, and into, borrowed bytes, without alignment and without panics.

use crate::convert::index_from_u32;
use crate::phase::{Phase, Rotor, TurnRate};
use crate::time::Instant;

/// The `N` bytes at `offset`, if they are there.
pub(crate) fn field<const N: usize>(bytes: &[u8], offset: usize) -> Option<[u8; N]> {
    bytes.get(offset..)?.first_chunk::<N>().copied()
}

/// The little-endian u16 at `offset`.
pub(crate) fn u16_at(bytes: &[u8], offset: usize) -> Option<u16> {
    field(bytes, offset).map(u16::from_le_bytes)
}

/// The little-endian u32 at `offset`.
pub(crate) fn u32_at(bytes: &[u8], offset: usize) -> Option<u32> {
    field(bytes, offset).map(u32::from_le_bytes)
}

/// The little-endian i32 at `offset`.
pub(crate) fn i32_at(bytes: &[u8], offset: usize) -> Option<i32> {
    field(bytes, offset).map(i32::from_le_bytes)
}

/// The little-endian u64 at `offset`.
pub(crate) fn u64_at(bytes: &[u8], offset: usize) -> Option<u64> {
    field(bytes, offset).map(u64::from_le_bytes)
}

/// The little-endian i64 at `offset`.
pub(crate) fn i64_at(bytes: &[u8], offset: usize) -> Option<i64> {
    field(bytes, offset).map(i64::from_le_bytes)
}

/// The little-endian u128 at `offset`.
pub(crate) fn u128_at(bytes: &[u8], offset: usize) -> Option<u128> {
    field(bytes, offset).map(u128::from_le_bytes)
}

/// The instant at `offset`, i64 ns of TAI.
pub(crate) fn instant_at(bytes: &[u8], offset: usize) -> Option<Instant> {
    i64_at(bytes, offset).map(Instant::from_tai_ns)
}

/// The rotor at `offset`: rate u128 (2^-128 turn/ns), start phase u64 (2^-64 turn).
#[inline(never)]
pub(crate) fn rotor_at(bytes: &[u8], offset: usize) -> Option<Rotor> {
    Some(Rotor {
        rate: TurnRate::from_bits(u128_at(bytes, offset)?),
        start: Phase::from_bits(u64_at(bytes, offset.wrapping_add(16))?),
    })
}

/// Writes the rotor at `offset`, as [`rotor_at`] reads it.
#[inline(never)]
pub(crate) fn put_rotor(bytes: &mut [u8], offset: usize, rotor: Rotor) {
    put(bytes, offset, rotor.rate.bits().to_le_bytes());
    put(bytes, offset.wrapping_add(16), rotor.start.bits().to_le_bytes());
}

/// The little-endian f64 at `offset`.
pub(crate) fn f64_at(bytes: &[u8], offset: usize) -> Option<f64> {
    field(bytes, offset).map(f64::from_le_bytes)
}

/// `length` bytes at `offset`, both as they stand in a table.
pub(crate) fn span(bytes: &[u8], offset: u32, length: u32) -> Option<&[u8]> {
    let start = index_from_u32(offset);
    bytes.get(start..start.checked_add(index_from_u32(length))?)
}

/// Writes `value` at `offset` of a fixed record; false when it does not fit.
pub(crate) fn put<const N: usize>(record: &mut [u8], offset: usize, value: [u8; N]) -> bool {
    match record.get_mut(offset..).and_then(|rest| rest.first_chunk_mut::<N>()) {
        Some(slot) => {
            *slot = value;
            true
        }
        None => false,
    }
}
