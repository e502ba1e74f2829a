//! How do exact numbers become the flight core's: rates, phases, angles, durations.
//!
//! Signs: a rate or a phase keeps the sign of its number; negative rates are two's complement.
//!
//! Method: each is rounded once, to the nearest, from the rational. Pi enters as a rational of 110
//! decimals, so that an angle in radians is the nearest f64 to the exact product.
//!
//! Limits: `rates_match_big_integers` and its neighbours hold them to values computed apart from
//! this code.
//!
//! # Example
//! A spin of 20 min as the flight core counts it, in 2^-128 turns per ns:
//! ```
//! use mission::{number::Number, rounding};
//!
//! let period_s = Number::parse("20")?.times(60, 1);
//! let rate = rounding::turn_rate_of_period(&period_s, 1).ok_or("too fast")?;
//! assert_eq!(rate.bits(), 283_568_639_100_782_052_886_145_506);
//! let quarter = rounding::phase(&Number::parse("-270")?.times(1, 360));
//! assert_eq!(quarter.bits(), 1 << 62);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::number::{Number, nearest};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};
use onboard_core::phase::{Phase, TurnRate};
use onboard_core::time::Duration;
use std::sync::LazyLock;

/// Pi to 110 decimals.
const PI_DIGITS: &str = "3.14159265358979323846264338327950288419716939937510582097494459230781\
                         640628620899862803482534211706798214808651";

static PI: LazyLock<BigRational> =
    LazyLock::new(|| Number::parse(PI_DIGITS).unwrap_or_else(|_| Number::zero()).exact().clone());

/// The f64 nearest to an exact angle of `degrees`, in radians.
#[must_use]
pub fn radians(degrees: &BigRational) -> f64 {
    nearest(&(degrees * &*PI / BigRational::from_integer(180.into())))
}

/// The exact degrees in `radians`, to the 110 digits of pi.
#[must_use]
pub fn degrees(radians: &BigRational) -> BigRational {
    radians * BigRational::from_integer(180.into()) / &*PI
}

/// The binary angle nearest to `turns`, modulo one turn.
#[must_use]
pub fn phase(turns: &BigRational) -> Phase {
    let fraction = turns - turns.floor();
    let bits: BigInt = scaled(&fraction, 64) % (BigInt::one() << 64_u32);
    Phase::from_bits(bits.to_u64().unwrap_or(0))
}

/// The turn rate nearest to `turns_per_second`; `None` at half a turn per nanosecond or faster.
#[must_use]
pub fn turn_rate(turns_per_second: &BigRational) -> Option<TurnRate> {
    let per_ns = turns_per_second / BigRational::from_integer(1_000_000_000.into());
    let bits = scaled(&per_ns, 128).to_i128()?;
    Some(TurnRate::from_bits(bits.cast_unsigned()))
}

/// The turn rate of one turn per `period_s`, in the sense of `sign`; `None` for a period of zero or
/// too short.
#[must_use]
pub fn turn_rate_of_period(period_s: &BigRational, sign: i8) -> Option<TurnRate> {
    if period_s.is_zero() {
        return None;
    }
    turn_rate(&(BigRational::from_integer(sign.into()) / period_s))
}

/// The whole nanoseconds nearest to `seconds`; `None` beyond 292 years.
#[must_use]
pub fn duration(seconds: &BigRational) -> Option<Duration> {
    let ns = seconds * BigRational::from_integer(1_000_000_000.into());
    ns.round().to_integer().to_i64().map(Duration::from_ns)
}

/// `value` * 2^`bits`, rounded to the nearest integer, halves away from zero.
fn scaled(value: &BigRational, bits: u32) -> BigInt {
    (value * BigRational::from_integer(BigInt::one() << bits)).round().to_integer()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::num::NonZeroU64;

    // From Python's integers and mpmath at 400 bits: round(2^128 / period in ns), round(2^128 turns
    // per ns), round(2^64 turns), and the bits of the f64 nearest to degrees * pi / 180.
    const RATE_192_348_MIN: u128 = 29_484_958_419_196_669_878_152_672;
    const RATE_20_MIN: u128 = 283_568_639_100_782_052_886_145_506;
    const RATE_262980_MIN: u128 = 21_565_795_049_112_636_161_392;
    const RATE_61_RPM: u128 = 345_953_739_702_954_104_521_097_517_556;
    const RATE_20E6_OVER_2_20_HZ: u128 = 6_490_371_073_168_534_535_663_120_411_525;
    const PHASE_191: u64 = 9_806_278_608_756_667_519;
    const RAD_47_5: u64 = 0x3fea_876c_d8f2_a161;
    const RAD_0_1: u64 = 0x3f5c_9871_03b7_61f5;

    fn number(text: &str) -> Number {
        Number::parse(text).unwrap()
    }

    #[test]
    fn rates_match_big_integers() {
        let minutes = |text: &str| turn_rate_of_period(&number(text).times(60, 1), 1).unwrap();
        assert_eq!(minutes("192.348").bits(), RATE_192_348_MIN);
        assert_eq!(minutes("20").bits(), RATE_20_MIN);
        assert_eq!(minutes("262980").bits(), RATE_262980_MIN);
        let reversed = turn_rate_of_period(&number("192.348").times(60, 1), -1).unwrap();
        assert_eq!(reversed.bits(), RATE_192_348_MIN.wrapping_neg());
        assert_eq!(turn_rate(&number("61").times(1, 60)).unwrap().bits(), RATE_61_RPM);
        assert_eq!(
            turn_rate(number("20e6/1048576").exact()).unwrap().bits(),
            RATE_20E6_OVER_2_20_HZ
        );
    }

    #[test]
    fn rates_agree_with_the_flight_core() {
        for (turns, seconds) in [(100_i64, 1_154_088_u64), (-61, 60), (20_000_000, 1 << 20), (7, 3)]
        {
            let exact = BigRational::new(turns.into(), seconds.into());
            let core = TurnRate::from_turns(turns, NonZeroU64::new(seconds).unwrap());
            assert_eq!(turn_rate(&exact), core);
        }
    }

    #[test]
    fn rates_end_where_they_no_longer_fit() {
        assert_eq!(turn_rate(number("5e8").exact()), None);
        assert!(turn_rate(number("4.9e8").exact()).is_some());
        assert_eq!(turn_rate_of_period(&BigRational::zero(), 1), None);
    }

    #[test]
    fn phases_wrap_and_round_once() {
        let degrees = |text: &str| phase(&number(text).times(1, 360)).bits();
        assert_eq!(degrees("180"), 1 << 63);
        assert_eq!(degrees("-90"), 3 << 62);
        assert_eq!(degrees("450.0"), 1 << 62);
        assert_eq!(degrees("191.37579428901796"), PHASE_191);
        assert_eq!(degrees("359.99999999999999999999"), 0);
    }

    #[test]
    fn angles_are_the_nearest_f64() {
        use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
        let rad = |text: &str| radians(number(text).exact()).to_bits();
        assert_eq!(rad("45"), FRAC_PI_4.to_bits());
        assert_eq!(rad("90"), FRAC_PI_2.to_bits());
        assert_eq!(rad("180"), PI.to_bits());
        assert_eq!(rad("47.5"), RAD_47_5);
        assert_eq!(rad("0.1"), RAD_0_1);
        let back = radians(&degrees(number("0.3").exact()));
        assert_eq!(back.to_bits(), 0.3_f64.to_bits());
    }

    #[test]
    fn durations_round_to_nanoseconds() {
        assert_eq!(duration(number("1.0000000006").exact()).unwrap().ns(), 1_000_000_001);
        assert_eq!(
            duration(&number("1095.75").times(86400, 1)).unwrap().ns(),
            94_672_800_000_000_000
        );
        assert_eq!(duration(number("1e10").exact()), None);
    }
}
