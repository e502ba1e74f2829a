//! Every numeric conversion that the language spells `as`.
//!
//! All functions are total: float to integer saturates and takes NaN to 0, integer to float rounds
//! to nearest.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "the conversions of the crate live here, each with its meaning in the name"
)]

/// Nearest f64 to an i64.
pub(crate) const fn f64_from_i64(value: i64) -> f64 {
    value as f64
}

/// Nearest f64 to a u64.
pub(crate) const fn f64_from_u64(value: u64) -> f64 {
    value as f64
}

/// Nearest f64 to a usize.
pub(crate) const fn f64_from_usize(value: usize) -> f64 {
    value as f64
}

/// The i64 nearest to a float, saturating.
pub(crate) fn i64_from_f64(value: f64) -> i64 {
    libm::round(value) as i64
}

/// The count that a float holds exactly, if it is a whole number in 0 to 2^48.
pub(crate) fn count_from_f64(value: f64) -> Option<usize> {
    const LARGEST: f64 = 281_474_976_710_656.0;
    let whole = libm::trunc(value);
    let exact = (value - whole).to_bits() << 1 == 0;
    (exact && (0.0..=LARGEST).contains(&value)).then_some(whole as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_whole_and_small() {
        assert_eq!(count_from_f64(0.0), Some(0));
        assert_eq!(count_from_f64(25.0), Some(25));
        for value in [-1.0, 0.5, 1e300, f64::NAN, f64::INFINITY] {
            assert_eq!(count_from_f64(value), None);
        }
    }
}
