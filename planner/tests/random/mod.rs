//! Whole numbers of a range, drawn as those were drawn whose optima are stored.

use ephem::random::SplitMix64;

/// A number in `low..=high`.
pub(crate) fn between(random: &mut SplitMix64, low: i64, high: i64) -> i64 {
    low + i64::try_from(random.bits() % u64::try_from(high - low + 1).unwrap()).unwrap()
}
