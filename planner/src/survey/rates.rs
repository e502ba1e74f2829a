//! At which rate does a rotation turn, exactly, and what is that rate on the clock of samples.
//!
//! Rates are turns per second, periods seconds, both as rationals: 192.348 min is 1154088/100 s and
//! never the nearest f64, which in ten years would be 1e-11 rad off. A negative rate turns the other
//! way.
//!
//! Method: every rate is divided by the sampling rate and rounded once, to the nearest 2^-128 turns
//! per sample; negative rates are two's complement, and whole turns per sample are left out.
//!
//! Limits: test `rates_are_rounded_once` holds them to values computed apart from this code.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};
use onboard_core::phase::{Phase, Rotor, TurnRate};

/// A uniform rotation: precession, spin, half-wave plate, or the circular Sun's longitude.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExactRotor {
    /// Turns per second, negative for the other sense.
    pub turns_per_s: BigRational,
    /// The angle at sample 0.
    pub start: Phase,
}

impl ExactRotor {
    /// One turn in `period_s` seconds, backwards where it is negative; `None` for a period of zero.
    #[must_use]
    pub fn with_period(period_s: &BigRational, start: Phase) -> Option<Self> {
        (!period_s.is_zero()).then(|| Self { turns_per_s: period_s.recip(), start })
    }

    /// The same rotation on the clock of samples taken `hz` times a second.
    pub(super) fn sampled(&self, hz: &BigRational) -> Rotor {
        Rotor { rate: turns_per_sample(&self.turns_per_s, hz), start: self.start }
    }
}

/// The turns per sample nearest to `turns_per_s / hz`, modulo one turn; `hz` is not zero.
fn turns_per_sample(turns_per_s: &BigRational, hz: &BigRational) -> TurnRate {
    let turns = turns_per_s / hz;
    let fraction = &turns - turns.floor();
    let scaled = (fraction * BigRational::from_integer(BigInt::one() << 128_u32)).round();
    let bits = scaled.to_integer() % (BigInt::one() << 128_u32);
    TurnRate::from_bits(bits.to_u128().unwrap_or(0))
}

/// The time between samples in 2^-64 ns, rounded up; `None` for less than 2^-64 ns or over 292 years.
/// `hz` is not zero.
pub(super) fn sampling_period(hz: &BigRational) -> Option<u128> {
    let ns = BigRational::from_integer(1_000_000_000.into()) / hz;
    let exact = ns * BigRational::from_integer(BigInt::one() << 64_u32);
    if exact < BigRational::one() {
        return None;
    }
    exact.ceil().to_integer().to_u128().filter(|bits| *bits < 1 << 127)
}

#[cfg(test)]
mod tests {
    use super::*;

    // round(2^128 / (192.348 * 60 * 19)) from Python's integers.
    const TURNS_PER_SAMPLE_192_348_AT_19: u128 = 1_551_839_916_799_824_730_429_087_991_793_056;

    fn ratio(above: i64, below: i64) -> BigRational {
        BigRational::new(above.into(), below.into())
    }

    fn bits(turns_per_s: (i64, i64), hz: i64) -> u128 {
        turns_per_sample(&ratio(turns_per_s.0, turns_per_s.1), &ratio(hz, 1)).bits()
    }

    #[test]
    fn rates_are_rounded_once() {
        let precession = ExactRotor::with_period(&ratio(1_154_088, 100), Phase::ZERO).unwrap();
        let per_sample = precession.sampled(&ratio(19, 1)).rate;
        assert_eq!(per_sample.bits(), TURNS_PER_SAMPLE_192_348_AT_19);
        // A plate faster than the samples keeps what is beyond whole turns; backwards it complements.
        assert_eq!(bits((5, 4), 1), 1 << 126);
        assert_eq!(bits((-1, 4), 1), 3 << 126);
        assert_eq!(ExactRotor::with_period(&ratio(0, 1), Phase::ZERO), None);
    }

    #[test]
    fn ratios_are_rounded_to_the_nearest() {
        assert_eq!(bits((1, 4), 1), 1 << 126);
        assert_eq!(bits((9, 4), 1), 1 << 126);
        assert_eq!(bits((2, 1), 3), u128::MAX / 3 * 2 + 1);
    }

    #[test]
    fn periods_are_rounded_up() {
        assert_eq!(sampling_period(&ratio(1, 1)), Some(1_000_000_000 << 64));
        assert_eq!(sampling_period(&ratio(3, 1)), Some((1_000_000_000 << 64) / 3 + 1));
        let fast = num_traits::Pow::pow(ratio(1_000_000_000_000, 1), 3_u32);
        assert_eq!(sampling_period(&fast), None);
    }
}
