//! Arithmetic that compilers turn into vector instructions: plain loops over arrays, no branches.
//!
//! Everything here and in what calls it is inlined into one function per instruction set
//! ([`crate::survey::isa`]). `FUSED` allows fused multiply-add where the hardware has it.
//!
//! Limits: results differ between instruction sets in the last bits; decisions that such bits could
//! turn are taken by the flight core ([`crate::survey::plain`]).

use std::f64::consts::FRAC_2_PI;

/// `a b + c`.
#[inline(always)]
pub(super) fn madd<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// Product of two complex numbers.
#[inline(always)]
pub(super) fn times<const FUSED: bool>(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (madd::<FUSED>(a.0, b.0, -(a.1 * b.1)), madd::<FUSED>(a.0, b.1, a.1 * b.0))
}

/// A number of samples.
#[expect(clippy::cast_precision_loss, reason = "runs are far shorter than 2^53 samples")]
pub(super) fn offset(samples: u64) -> f64 {
    samples as f64
}

/// Coefficients of `atan(sqrt(s)) / sqrt(s)` in powers of s: interpolation at the Chebyshev points of
/// [0, tan^2(pi/8)], 4e-18 off.
const ARCTANGENT: [f64; 12] = [
    1.0,
    -0.333_333_333_333_331_2,
    0.199_999_999_999_408_93,
    -0.142_857_142_792_502_45,
    0.111_111_107_449_196_58,
    -0.090_908_968_090_640_27,
    0.076_920_453_309_022_25,
    -0.066_629_518_136_291_91,
    0.058_468_782_973_308_72,
    -0.050_351_024_566_015_52,
    0.037_965_257_453_865_93,
    -0.017_805_397_205_419_446,
];

/// Largest tangent that the series takes: tan(pi/8).
const TAN_EIGHTH: f64 = 0.414_213_562_373_095_03;

/// The angle of (x, y) from x towards y in quarter turns, in [0, 4); 0 at the origin.
///
/// The ratio of the smaller to the larger component lies in [0, 1]; above tan(pi/8) it is turned
/// back by an eighth: `atan(t) = pi/4 + atan((t - 1) / (t + 1))`. One division.
#[inline(always)]
pub(super) fn quarter_turns<const FUSED: bool>(x: f64, y: f64) -> f64 {
    let (ax, ay) = (x.abs(), y.abs());
    let steep = ay > ax;
    let (small, large) = if steep { (ax, ay) } else { (ay, ax) };
    let turned = small > TAN_EIGHTH * large;
    let top = if turned { small - large } else { small };
    let bottom = if turned { small + large } else { large };
    let t = top / if bottom > 0.0 { bottom } else { 1.0 };
    let s = t * t;
    let mut series = ARCTANGENT[11];
    series = madd::<FUSED>(series, s, ARCTANGENT[10]);
    series = madd::<FUSED>(series, s, ARCTANGENT[9]);
    series = madd::<FUSED>(series, s, ARCTANGENT[8]);
    series = madd::<FUSED>(series, s, ARCTANGENT[7]);
    series = madd::<FUSED>(series, s, ARCTANGENT[6]);
    series = madd::<FUSED>(series, s, ARCTANGENT[5]);
    series = madd::<FUSED>(series, s, ARCTANGENT[4]);
    series = madd::<FUSED>(series, s, ARCTANGENT[3]);
    series = madd::<FUSED>(series, s, ARCTANGENT[2]);
    series = madd::<FUSED>(series, s, ARCTANGENT[1]);
    series = madd::<FUSED>(series, s, ARCTANGENT[0]);
    let angle = madd::<FUSED>(series * t, FRAC_2_PI, if turned { 0.5 } else { 0.0 });
    let angle = if steep { 1.0 - angle } else { angle };
    let angle = if x < 0.0 { 2.0 - angle } else { angle };
    if y < 0.0 { 4.0 - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn quarter_turns_are_those_of_the_library(angle in -3.2..3.2_f64, r in 1e-9..2.0_f64) {
            let (y, x) = (r * angle.sin(), r * angle.cos());
            let expected = (y.atan2(x) * FRAC_2_PI).rem_euclid(4.0);
            for found in [quarter_turns::<true>(x, y), quarter_turns::<false>(x, y)] {
                let off = (found - expected + 2.0).rem_euclid(4.0) - 2.0;
                prop_assert!(off.abs() < 1e-15, "{found} {expected}");
            }
        }
    }

    #[test]
    fn axes_are_whole_quarters() {
        for (x, y, quarters) in
            [(1.0, 0.0, 0.0), (0.0, 1.0, 1.0), (-1.0, 0.0, 2.0), (0.0, -1.0, 3.0), (0.0, 0.0, 0.0)]
        {
            assert!((quarter_turns::<false>(x, y) - quarters).abs() < 1e-15);
        }
    }
}
