//! Every numeric conversion that the language spells `as`.
//!
//! Answers: the one place where an integer becomes a float or narrows. All functions are total;
//! float to integer saturates and takes NaN to 0, as the language defines.

#![expect(
    clippy::as_conversions,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "the conversions of the crate live here, each with its meaning in the name"
)]

/// 2^32.
const HALVES: f64 = 4_294_967_296.0;

/// Nearest f64 to an i64: both halves are exact, their sum is rounded once. A 32-bit FPU converts
/// halves by itself, the whole only in software.
pub(crate) const fn f64_from_i64(value: i64) -> f64 {
    (value >> 32) as i32 as f64 * HALVES + value as u32 as f64
}

/// Nearest f64 to a u64, as [`f64_from_i64`].
pub(crate) const fn f64_from_u64(value: u64) -> f64 {
    (value >> 32) as u32 as f64 * HALVES + value as u32 as f64
}

/// Nearest f64 to a u128.
pub(crate) const fn f64_from_u128(value: u128) -> f64 {
    value as f64
}

/// Integer part of an f64, saturating; NaN gives 0.
pub(crate) const fn i64_from_f64(value: f64) -> i64 {
    value as i64
}

/// Integer part of an f64, saturating; NaN gives 0.
pub(crate) const fn i32_from_f64(value: f64) -> i32 {
    value as i32
}

/// The last two bits of a number of quarter turns.
pub(crate) const fn quarter_from_u64(value: u64) -> i32 {
    (value & 3) as i32
}

/// Integer part of an f64, saturating; NaN gives 0.
pub(crate) const fn u32_from_f64(value: f64) -> u32 {
    value as u32
}

/// The same bits read as two's complement.
pub(crate) const fn signed_from_u64(bits: u64) -> i64 {
    bits as i64
}

/// Two's complement bits of an i64.
pub(crate) const fn bits_from_i64(value: i64) -> u64 {
    value as u64
}

/// An i64 sign-extended to 128 bits, as two's complement bits.
pub(crate) const fn wide_bits_from_i64(value: i64) -> u128 {
    value as i128 as u128
}

/// Integer part of an f64 as 128 bits of two's complement, saturating; NaN gives 0.
pub(crate) const fn wide_bits_from_f64(value: f64) -> u128 {
    value as i128 as u128
}

/// Upper 64 bits of a u128.
pub(crate) const fn high_half(value: u128) -> u64 {
    (value >> 64) as u64
}

/// Lower 64 bits of a u128.
pub(crate) const fn low_half(value: u128) -> u64 {
    value as u64
}

/// A u64 widened to 128 bits.
pub(crate) const fn wide(value: u64) -> u128 {
    value as u128
}

/// A table offset or count as an index; on a 16-bit machine it saturates, and the look-up fails.
pub(crate) const fn index_from_u32(value: u32) -> usize {
    if value as usize as u32 == value { value as usize } else { usize::MAX }
}

/// A granule number as an index; saturates where it does not fit, and the look-up fails.
pub(crate) const fn index_from_u64(value: u64) -> usize {
    if value as usize as u64 == value { value as usize } else { usize::MAX }
}

/// In a loop: on a flight computer, whose code is short of room, it stays one; no instruction of its
/// own.
#[inline]
pub(crate) fn rolled() {
    if cfg!(target_os = "none") {
        core::hint::black_box(());
    }
}

/// The same count, which the compiler on a flight computer does not know: a loop up to it is not
/// written out count times.
pub(crate) fn uncounted(count: usize) -> usize {
    if cfg!(target_os = "none") { core::hint::black_box(count) } else { count }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn halves_make_the_nearest(bits: u64, shift in 0_u32..64) {
            for value in [bits >> shift, u64::MAX - (bits >> shift)] {
                let signed = signed_from_u64(value);
                prop_assert_eq!(f64_from_u64(value).to_bits(), (value as f64).to_bits());
                prop_assert_eq!(f64_from_i64(signed).to_bits(), (signed as f64).to_bits());
            }
        }
    }
}
