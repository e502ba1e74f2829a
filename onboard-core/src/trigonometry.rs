//! Sine and cosine together, in little stack.
//!
//! Method: the nearest multiple of a quarter turn is taken away in two pieces of pi/2, the first
//! short enough that its product with the multiple is exact (Cody and Waite's reduction); then Taylor's series to
//! x^17 and x^18, whose next terms are below 1e-19 at an eighth of a turn.
//!
//! Limits: up to [`LONGEST_RAD`] both are within 2.5e-16, and near 0 the sine is within 4.5e-16 of
//! itself. Near their other zeros, k quarter turns away, the reduction leaves an absolute error of k
//! times 2e-26, which is not small against results as small as the 1.2e-16 at pi's nearest f64: there
//! 10 digits hold. Beyond, the angle is first rounded as a number
//! of turns and loses digits in proportion. `libm` is exact to any size, for about
//! 1 KiB of stack; no angle of this crate needs that (`docs/decisions/0005-own-sine.md`). Tested
//! against `libm` below, and through the attitude against 50-digit arithmetic.

use crate::convert::i32_from_f64;
use core::f64::consts::{FRAC_2_PI, TAU};

/// Largest angle that is reduced without loss, rad.
const LONGEST_RAD: f64 = 1e6;
/// The first 33 bits of pi/2.
const QUARTER_HIGH: f64 = 1.570_796_326_734_125_6;
/// The rest of it.
const QUARTER_LOW: f64 = 6.077_100_506_506_192e-11;

/// Sine and cosine of an angle in radians; NaN for what is not finite.
#[must_use]
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn sin_cos(angle_rad: f64) -> (f64, f64) {
    let angle = if libm::fabs(angle_rad) > LONGEST_RAD {
        let turns = angle_rad / TAU;
        (turns - libm::rint(turns)) * TAU
    } else {
        angle_rad
    };
    let quarters = libm::rint(angle * FRAC_2_PI);
    let rest = (angle - quarters * QUARTER_HIGH) - quarters * QUARTER_LOW;
    sin_cos_of(rest, i32_from_f64(quarters) & 3)
}

/// Sine of an angle in radians.
#[must_use]
pub(crate) fn sin(angle_rad: f64) -> f64 {
    sin_cos(angle_rad).0
}

/// Cosine of an angle in radians.
#[must_use]
pub(crate) fn cos(angle_rad: f64) -> f64 {
    sin_cos(angle_rad).1
}

/// The sine and cosine of an angle that is greater by so many quarter turns, 0 to 3.
const fn turned((sin, cos): (f64, f64), quarters: i32) -> (f64, f64) {
    match quarters {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Sine and cosine of an angle of at most an eighth of a turn and so many quarter turns, 0 to 3.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) const fn sin_cos_of(rest_rad: f64, quarters: i32) -> (f64, f64) {
    turned(sin_cos_eighth(rest_rad), quarters)
}

/// Sine and cosine of an angle of at most an eighth of a turn.
const fn sin_cos_eighth(x: f64) -> (f64, f64) {
    let z = x * x;
    let odd = series(
        z,
        [
            1.0 / 355_687_428_096_000.0,
            -1.0 / 1_307_674_368_000.0,
            1.0 / 6_227_020_800.0,
            -1.0 / 39_916_800.0,
            1.0 / 362_880.0,
            -1.0 / 5_040.0,
            1.0 / 120.0,
            -1.0 / 6.0,
        ],
    );
    let even = series(
        z,
        [
            -1.0 / 6_402_373_705_728_000.0,
            1.0 / 20_922_789_888_000.0,
            -1.0 / 87_178_291_200.0,
            1.0 / 479_001_600.0,
            -1.0 / 3_628_800.0,
            1.0 / 40_320.0,
            -1.0 / 720.0,
            1.0 / 24.0,
        ],
    );
    // 1 - z/2 is rounded; what the rounding took away is added with the small terms.
    let half = 0.5 * z;
    let near = 1.0 - half;
    let small = (1.0 - near) - half;
    (x + x * z * odd, near + (small + z * z * even))
}

/// The polynomial in z with these coefficients, the highest first.
// REQ-ATT-2.
const fn series(z: f64, [first, second, rest @ ..]: [f64; 8]) -> f64 {
    let [third, fourth, fifth, sixth, seventh, last] = rest;
    let upper = ((first * z + second) * z + third) * z + fourth;
    (((upper * z + fifth) * z + sixth) * z + seventh) * z + last
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_not_finite_has_no_sine() {
        for angle in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let (sin, cos) = sin_cos(angle);
            assert!(sin.is_nan() && cos.is_nan());
        }
        assert_eq!(sin_cos(0.0).0.to_bits(), 0);
        assert!((sin_cos(1e300).0).abs() <= 1.0);
    }

    #[test]
    // REQ-ATT-2.
    fn near_its_zeros_the_error_is_that_of_the_reduction() {
        let mut largest = 0.0_f64;
        for k in 1..20_000_i32 {
            let quarters = f64::from(k);
            let zero = quarters * core::f64::consts::FRAC_PI_2;
            for angle in [zero, zero.next_down(), zero.next_up(), zero + 1e-9, zero - 1e-6] {
                let (sin, cos) = sin_cos(angle);
                let off = (sin - libm::sin(angle), cos - libm::cos(angle));
                let small = if k % 2 == 0 { (off.0, sin) } else { (off.1, cos) };
                let allowed = 2e-26 * quarters + 4.5e-16 * small.1.abs();
                assert!(small.0.abs() <= allowed, "{angle}: {:e}", small.0);
                if angle.to_bits() == core::f64::consts::PI.to_bits() {
                    largest = small.0.abs() / sin.abs();
                }
            }
        }
        // More than any number of ulp would say, less than ten digits.
        assert!(largest > 1e-12 && largest < 1e-10, "{largest:e}");
    }

    proptest! {
        #[test]
        // REQ-ATT-2.
        fn agrees_with_libm(angle in -7.0..7.0_f64) {
            let (sin, cos) = sin_cos(angle);
            prop_assert!((sin - libm::sin(angle)).abs() < 2.5e-16, "{:e}", sin - libm::sin(angle));
            prop_assert!((cos - libm::cos(angle)).abs() < 2.5e-16, "{:e}", cos - libm::cos(angle));
        }

        #[test]
        fn agrees_with_libm_far_out(angle in -1e6..1e6_f64) {
            let (sin, cos) = sin_cos(angle);
            prop_assert!((sin - libm::sin(angle)).abs() < 2.5e-16, "{:e}", sin - libm::sin(angle));
            prop_assert!((cos - libm::cos(angle)).abs() < 2.5e-16, "{:e}", cos - libm::cos(angle));
        }

        #[test]
        fn small_angles_keep_their_digits(exponent in -300.0..-0.2_f64) {
            let angle = libm::pow(10.0, exponent);
            let (sin, _) = sin_cos(angle);
            prop_assert!((sin / libm::sin(angle) - 1.0).abs() < 4.5e-16);
        }
    }
}
