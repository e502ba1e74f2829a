//! How far has a uniform rotation turned, without drift.
//!
//! A [`Phase`] is an angle as a binary fraction of a turn (64 bits, wrapping); a [`TurnRate`] is a
//! signed number of turns per nanosecond with 128 fractional bits. Their product with an integer
//! time is exact modulo one turn up to one unit of 2^-64 turn, so precession, spin, half-wave plate
//! and circular-orbit angles neither drift nor lose digits in decades.
//!
//! Method: `phase = (rate * elapsed_ns mod 2^128) >> 64`, two's complement for negative rates. Sine
//! and cosine reduce to an eighth of a turn in integers before any rounding.
//!
//! Limits: rates below one turn per 2 ns. A rate rounded to 2^-128 turn/ns is off by at most
//! 2^-129 * 3.2e17 ns = 5e-22 turn after ten years. `tests/tests/attitude.rs` holds the whole chain
//! to 1e-12 rad.

use crate::convert::{
    bits_from_i64, f64_from_i64, f64_from_u64, f64_from_u128, high_half, i64_from_f64, low_half,
    quarter_from_u64, signed_from_u64, wide, wide_bits_from_f64, wide_bits_from_i64,
};
use crate::time::Duration;
use crate::trigonometry;
use core::f64::consts::TAU;
use core::num::NonZeroU64;
use serde::{Deserialize, Serialize};

/// 2^-64 turn in radians.
const RADIANS_PER_BIT: f64 = TAU / 18_446_744_073_709_551_616.0;
/// One turn per nanosecond, over 2^128, in radians per second.
const RADIANS_PER_SECOND_PER_BIT: f64 = RADIANS_PER_BIT / 18_446_744_073_709_551_616.0 * 1e9;

/// An angle as a 64-bit binary fraction of a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Phase(u64);

impl Phase {
    /// The zero angle.
    pub const ZERO: Self = Self(0);

    /// The angle of `bits` / 2^64 turns.
    #[must_use]
    pub const fn from_bits(bits: u64) -> Self {
        Self(bits)
    }

    /// The angle as a multiple of 2^-64 turn.
    #[must_use]
    pub const fn bits(self) -> u64 {
        self.0
    }

    /// The binary angle nearest to `radians`, any number of turns; NaN and infinities give zero.
    #[must_use]
    #[inline(never)]
    pub fn from_radians(radians: f64) -> Self {
        let turns = radians / TAU;
        let fraction = turns - libm::round(turns);
        // Two steps keep the scale inside i64: fraction lies in [-0.5, 0.5].
        Self(bits_from_i64(i64_from_f64(fraction * 9_223_372_036_854_775_808.0)).wrapping_shl(1))
    }

    /// The angle in radians, in [-pi, pi]; pi only where an f64 cannot tell it from the last binary
    /// step.
    #[must_use]
    pub const fn radians(self) -> f64 {
        f64_from_i64(signed_from_u64(self.0)) * RADIANS_PER_BIT
    }

    /// The angle in turns, in [0, 1]; 1 only where an f64 cannot tell it from the last binary step.
    #[must_use]
    pub const fn turns(self) -> f64 {
        f64_from_u64(self.0) / 18_446_744_073_709_551_616.0
    }

    /// The sum of two angles.
    #[must_use]
    pub const fn plus(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }

    /// The opposite angle.
    #[must_use]
    pub const fn negated(self) -> Self {
        Self(self.0.wrapping_neg())
    }

    /// Half the angle taken in [0, 1) turn.
    #[must_use]
    pub const fn half(self) -> Self {
        Self(self.0 >> 1_u32)
    }

    /// Sine and cosine, each within an ulp of the exact angle's.
    #[must_use]
    pub fn sin_cos(self) -> (f64, f64) {
        let quarter = self.0.wrapping_add(1 << 61_u32) >> 62_u32;
        let rest = signed_from_u64(self.0.wrapping_sub(quarter.wrapping_shl(62)));
        trigonometry::sin_cos_of(f64_from_i64(rest) * RADIANS_PER_BIT, quarter_from_u64(quarter))
    }
}

/// A signed rotation rate in turns per nanosecond with 128 fractional bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct TurnRate(u128);

impl TurnRate {
    /// The rate of `bits` / 2^128 turns per nanosecond, two's complement.
    #[must_use]
    pub const fn from_bits(bits: u128) -> Self {
        Self(bits)
    }

    /// The rate nearest to `turns` / `seconds` turns per second, negative for the other sense; `None`
    /// at half a turn per ns or faster.
    ///
    /// A period of 192.348 min is 11540.88 s, so 100 turns in 1154088 s.
    #[must_use]
    pub const fn from_turns(turns: i64, seconds: NonZeroU64) -> Option<Self> {
        signed(
            nearest(turns.unsigned_abs(), wide(seconds.get()).wrapping_mul(1_000_000_000)),
            turns,
        )
    }

    /// The rate nearest to one turn in `period`, negative for the other sense; `None` for 2 ns or less.
    #[must_use]
    // REQ-PHASE-1.
    pub const fn from_period(period: Duration) -> Option<Self> {
        signed(nearest(1, wide(period.ns().unsigned_abs())), period.ns())
    }

    /// The rate nearest to `radians_per_second` that an f64 can tell; saturates at half a turn per
    /// ns, and NaN gives zero.
    #[must_use]
    #[inline(never)]
    pub fn from_radians_per_second(radians_per_second: f64) -> Self {
        Self(wide_bits_from_f64(libm::round(radians_per_second / RADIANS_PER_SECOND_PER_BIT)))
    }

    /// The rate as a multiple of 2^-128 turn per nanosecond, two's complement.
    #[must_use]
    pub const fn bits(self) -> u128 {
        self.0
    }

    /// The sum of two rates, modulo one turn per nanosecond.
    #[must_use]
    pub const fn plus(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }

    /// The same rate in the opposite sense.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self(self.0.wrapping_neg())
    }

    /// True for a rate in the negative sense.
    #[must_use]
    pub const fn is_negative(self) -> bool {
        self.0 >> 127_u32 == 1
    }

    const fn magnitude(self) -> u128 {
        if self.is_negative() { self.0.wrapping_neg() } else { self.0 }
    }

    /// The rate in radians per second, signed.
    #[must_use]
    #[inline(never)]
    pub const fn radians_per_second(self) -> f64 {
        let magnitude = f64_from_u128(self.magnitude()) * RADIANS_PER_SECOND_PER_BIT;
        if self.is_negative() { -magnitude } else { magnitude }
    }

    /// The angle turned in `elapsed`, modulo one turn.
    #[must_use]
    // REQ-PHASE-2.
    pub const fn after(self, elapsed: Duration) -> Phase {
        Phase(high_half(self.0.wrapping_mul(wide_bits_from_i64(elapsed.ns()))))
    }

    /// Completed turns in `elapsed`, whatever the sense.
    #[must_use]
    pub const fn completed_turns(self, elapsed: Duration) -> u64 {
        let magnitude = self.magnitude();
        let ns = wide(elapsed.ns().unsigned_abs());
        let high = wide(high_half(magnitude)).wrapping_mul(ns);
        let low = wide(low_half(magnitude)).wrapping_mul(ns);
        high_half(high.wrapping_add(low >> 64_u32))
    }
}

/// The integer nearest to 2^128 `above` / `below`, halves upwards; `None` unless the quotient is below
/// 2^127. `below` is at most 2^94.
#[inline(never)]
const fn nearest(above: u64, below: u128) -> Option<u128> {
    let mut rest = wide(above);
    if rest >= below {
        return None;
    }
    // Long division, a bit at a time: the rest stays below the divisor, its double below 2^95.
    let mut quotient = 0_u128;
    let mut bit = 1_u128 << 127_u32;
    while bit != 0 {
        rest = rest.wrapping_shl(1);
        if rest >= below {
            rest = rest.wrapping_sub(below);
            quotient |= bit;
        }
        bit >>= 1;
    }
    if rest.wrapping_shl(1) >= below {
        quotient = quotient.wrapping_add(1);
    }
    if quotient >> 127_u32 == 0 { Some(quotient) } else { None }
}

/// A rate of this magnitude in the sense of `sign`.
const fn signed(magnitude: Option<u128>, sign: i64) -> Option<TurnRate> {
    match magnitude {
        Some(bits) if sign < 0 => Some(TurnRate(bits.wrapping_neg())),
        Some(bits) => Some(TurnRate(bits)),
        None => None,
    }
}

/// A uniform rotation: a rate and the angle at the mission's start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Rotor {
    /// Rate, signed.
    pub rate: TurnRate,
    /// Angle at elapsed time zero.
    pub start: Phase,
}

impl Rotor {
    /// One turn in `period`, from this angle at elapsed time zero; `None` for 2 ns or less.
    #[must_use]
    pub const fn with_period(period: Duration, start: Phase) -> Option<Self> {
        match TurnRate::from_period(period) {
            Some(rate) => Some(Self { rate, start }),
            None => None,
        }
    }

    /// The angle after `elapsed`.
    #[must_use]
    pub const fn phase(self, elapsed: Duration) -> Phase {
        self.start.plus(self.rate.after(elapsed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn period_ns(ns: i64) -> TurnRate {
        TurnRate::from_period(Duration::from_ns(ns)).unwrap()
    }

    /// Against Python's integers: `round(2^128 turns / (seconds 10^9))`.
    #[test]
    // REQ-PHASE-1.
    fn rates_from_periods_are_rounded_once() {
        let turns = |turns, seconds: u64| {
            TurnRate::from_turns(turns, NonZeroU64::new(seconds).unwrap()).map(TurnRate::bits)
        };
        let minutes_192_348 = 29_484_958_419_196_669_878_152_672;
        assert_eq!(turns(100, 1_154_088), Some(minutes_192_348));
        assert_eq!(turns(-100, 1_154_088), Some(minutes_192_348.wrapping_neg()));
        assert_eq!(period_ns(11_540_880_000_000).bits(), minutes_192_348);
        assert_eq!(period_ns(-11_540_880_000_000).bits(), minutes_192_348.wrapping_neg());
        assert_eq!(period_ns(1_200_000_000_000).bits(), 283_568_639_100_782_052_886_145_506);
        assert_eq!(turns(1, 15_778_800), Some(21_565_795_049_112_636_161_392));
        assert_eq!(turns(61, 60), Some(345_953_739_702_954_104_521_097_517_556));
        assert_eq!(turns(20_000_000, 1 << 20), Some(6_490_371_073_168_534_535_663_120_411_525));
        let fast = 166_738_359_791_259_847_097_053_557_641_566_423_613;
        assert_eq!(turns(490_000_000, 1), Some(fast));
        assert_eq!(period_ns(i64::MAX).bits(), 36_893_488_147_419_103_236);
        assert_eq!(turns(1, u64::MAX), Some(18_446_744_074));
        assert_eq!(turns(i64::MAX, u64::MAX), Some(170_141_183_460_469_231_722_463_931_679));
        assert_eq!(turns(0, 1), Some(0));
    }

    #[test]
    fn rates_that_do_not_fit_are_none() {
        let one = NonZeroU64::new(1).unwrap();
        let period = |ns| TurnRate::from_period(Duration::from_ns(ns)).map(TurnRate::bits);
        assert_eq!(TurnRate::from_turns(500_000_000, one), None);
        assert_eq!(TurnRate::from_turns(i64::MIN, one), None);
        assert!(TurnRate::from_turns(499_999_999, one).is_some());
        assert_eq!([period(0), period(1), period(-2), period(2)], [None; 4]);
        assert_eq!(period(4), Some(1 << 126));
        let third = u128::MAX / 3;
        assert_eq!([period(3), period(-3)], [Some(third), Some(third.wrapping_neg())]);
        let rotor = Rotor::with_period(Duration::from_ns(4), Phase::from_bits(5)).unwrap();
        assert_eq!((rotor.rate.bits(), rotor.start.bits()), (1 << 126, 5));
        assert_eq!(Rotor::with_period(Duration::ZERO, Phase::ZERO), None);
    }

    #[test]
    fn a_quarter_turn_is_exact() {
        let rate = period_ns(1_200_000_000_000);
        let quarter = rate.after(Duration::from_ns(300_000_000_000));
        assert!((quarter.radians() - core::f64::consts::FRAC_PI_2).abs() < 1e-15);
        let (sin, cos) = quarter.sin_cos();
        assert!((sin - 1.0).abs() < 1e-15 && cos.abs() < 1e-15);
        assert!((rate.radians_per_second() - TAU / 1200.0).abs() < 1e-18);
        assert!((rate.reversed().radians_per_second() + TAU / 1200.0).abs() < 1e-18);
    }

    #[test]
    fn the_last_binary_steps_round_up_to_the_ends() {
        use core::f64::consts::PI;
        let radians = |bits: u64| Phase::from_bits(bits).radians().to_bits();
        assert_eq!(radians(1 << 63), (-PI).to_bits());
        assert_eq!(radians((1 << 63) - 1), PI.to_bits());
        // Half an ulp of 2^63 below, and an ulp.
        assert_eq!(radians((1 << 63) - 512), PI.to_bits());
        assert!(Phase::from_bits((1 << 63) - 1_024).radians() < PI);
        let turns = |bits: u64| Phase::from_bits(bits).turns().to_bits();
        assert_eq!(turns(u64::MAX), 1.0_f64.to_bits());
        assert!(Phase::from_bits(u64::MAX - 2_048).turns() < 1.0);
    }

    #[test]
    fn turns_are_counted_in_both_senses() {
        let rate = period_ns(1_200_000_000_000);
        for rate in [rate, rate.reversed()] {
            assert_eq!(rate.completed_turns(Duration::from_ns(1_199_999_999_999)), 0);
            assert_eq!(rate.completed_turns(Duration::from_ns(1_200_000_000_001)), 1);
            assert_eq!(rate.completed_turns(Duration::from_ns(94_672_800_000_000_001)), 78_894);
        }
    }

    #[test]
    fn rates_come_from_radians_per_second() {
        let rate = |rad_s| TurnRate::from_radians_per_second(rad_s);
        assert_eq!(rate(0.0).bits(), 0);
        assert_eq!(rate(f64::NAN).bits(), 0);
        assert_eq!(rate(f64::INFINITY).bits(), u128::MAX >> 1);
        assert_eq!(rate(f64::NEG_INFINITY).bits(), 1 << 127);
        // 2^-20 turn per ns, up to the rounding of 2 pi.
        let coarse = TurnRate::from_bits(1 << 108);
        let off = rate(TAU * 1e9 / 1_048_576.0).bits().abs_diff(coarse.bits());
        assert!(off < 1 << 57, "{off}");
        // A correction of 1e-5 of LiteBIRD's spin turns 0.864 mrad in 33,000 s.
        let turned = rate(1e-5 * TAU / 1200.0).after(Duration::from_ns(33_000_000_000_000));
        assert!((turned.radians() - 1e-5 * TAU * 27.5).abs() < 1e-17);
        assert_eq!(rate(1e-9).plus(rate(-1e-9)).bits(), 0);
    }

    proptest! {
        #[test]
        fn rates_round_trip(magnitude in -18.0..9.0_f64, negative: bool) {
            let rad_s = libm::pow(10.0, magnitude) * if negative { -1.0 } else { 1.0 };
            let rate = TurnRate::from_radians_per_second(rad_s);
            prop_assert_eq!(rate.is_negative(), negative);
            // Half a unit of 2^-128 turn/ns, or rounding.
            let off = rate.radians_per_second() - rad_s;
            prop_assert!(off.abs() <= 1e-29 + 4e-16 * rad_s.abs(), "{off:e}");
        }

        #[test]
        fn sine_and_cosine_agree_with_the_plain_functions(bits: u64) {
            let phase = Phase::from_bits(bits);
            let (sin, cos) = phase.sin_cos();
            prop_assert!((sin - libm::sin(phase.radians())).abs() < 1e-15);
            prop_assert!((cos - libm::cos(phase.radians())).abs() < 1e-15);
        }

        #[test]
        fn radians_round_trip(bits: u64) {
            let phase = Phase::from_bits(bits);
            let back = Phase::from_radians(phase.radians());
            let off = back.plus(phase.negated()).radians();
            prop_assert!(off.abs() < 1e-15, "{off:e}");
        }

        #[test]
        // REQ-PHASE-2.
        fn going_back_in_time_undoes_a_rotation(rate: u128, ns in -(1_i64 << 60)..(1_i64 << 60)) {
            let rate = TurnRate::from_bits(rate);
            let there = rate.after(Duration::from_ns(ns));
            let back = rate.after(Duration::from_ns(-ns));
            prop_assert!(there.plus(back).bits().wrapping_add(1) <= 2);
        }
    }
}
