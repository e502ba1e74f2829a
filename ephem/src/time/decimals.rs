//! The decimals of a second as ns.
//!
//! Read from their digits, so that nine places are exact; what stands beyond the ninth is refused
//! by [`exact_ns`] and rounded to the nearest ns, half of one upwards, by [`rounded_ns`].

const PLACES: usize = 9;

/// The decimals as ns; `None` where digits beyond the ninth are not zero.
pub(crate) fn exact_ns(fraction: &str) -> Option<i64> {
    let (ns, beyond) = split(fraction)?;
    beyond.bytes().all(|byte| byte == b'0').then_some(ns)
}

/// The decimals rounded to ns: 0 to a whole second.
pub(super) fn rounded_ns(fraction: &str) -> Option<i64> {
    let (ns, beyond) = split(fraction)?;
    Some(ns + i64::from(beyond.starts_with(['5', '6', '7', '8', '9'])))
}

/// The first nine digits as ns, and those beyond.
fn split(fraction: &str) -> Option<(i64, &str)> {
    if fraction.is_empty() || !fraction.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let (kept, beyond) = fraction.split_at_checked(PLACES).unwrap_or((fraction, ""));
    Some((format!("{kept:0<PLACES$}").parse().ok()?, beyond))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_beyond_the_ninth_are_refused_or_rounded() {
        for (fraction, exact, rounded) in [
            ("5", Some(500_000_000), Some(500_000_000)),
            ("000000001", Some(1), Some(1)),
            ("1234567890", Some(123_456_789), Some(123_456_789)),
            ("1856655959", None, Some(185_665_596)),
            ("1856655954999", None, Some(185_665_595)),
            ("0000000005", None, Some(1)),
            ("9999999995", None, Some(1_000_000_000)),
            ("", None, None),
            ("12a", None, None),
            ("1234567890x", None, None),
        ] {
            assert_eq!((exact_ns(fraction), rounded_ns(fraction)), (exact, rounded), "{fraction}");
        }
    }
}
