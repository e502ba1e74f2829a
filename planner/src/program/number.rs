//! The few conversions between integers and f64 that values, prices and counts need.

/// The f64 nearest to an integer.
#[expect(clippy::cast_precision_loss, reason = "the rounding is what is asked for")]
pub(crate) const fn f64_from_i64(value: i64) -> f64 {
    value as f64
}

/// The f64 nearest to a wide integer.
#[expect(clippy::cast_precision_loss, reason = "the rounding is what is asked for")]
pub(crate) const fn f64_from_i128(value: i128) -> f64 {
    value as f64
}

/// The integer part of a number; saturates, and NaN gives zero.
#[expect(clippy::cast_possible_truncation, reason = "saturation is what is asked for")]
pub(crate) const fn i64_from_f64(value: f64) -> i64 {
    value as i64
}

/// The integer part of a number; saturates, and NaN gives zero.
#[expect(clippy::cast_possible_truncation, reason = "saturation is what is asked for")]
pub(crate) const fn i128_from_f64(value: f64) -> i128 {
    value as i128
}

/// The low 64 bits of a number that fits, saturating where it does not.
pub(crate) fn i64_from_i128(value: i128) -> i64 {
    i64::try_from(value).unwrap_or(if value < 0 { i64::MIN } else { i64::MAX })
}

/// A count as a signed number.
pub(crate) fn i64_from_usize(value: usize) -> i64 {
    i64::try_from(value).unwrap_or(i64::MAX)
}

/// A count as an unsigned number of 64 bits.
pub(crate) fn u64_from_usize(value: usize) -> u64 {
    u64::try_from(value).unwrap_or(u64::MAX)
}

/// The f64 nearest to a count.
pub(crate) fn f64_from_usize(value: usize) -> f64 {
    f64_from_i64(i64_from_usize(value))
}
