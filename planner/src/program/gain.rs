//! The worth of a cell: a concave function of an integer sum.
//!
//! Method: the worth at sum s is an integer number of units, rounded down where it is not one. For any
//! slope g >= 0 the concave worth stays at or below `reserve(g) + g s`; `reserve` is the convex
//! conjugate of its negative, computed so that rounding can only raise it. Slopes carry
//! [`FRACTION_BITS`] fractional bits.
//!
//! Limits: the logarithm is the platform's, good to some ulp; a margin of [`MARGIN`] units covers it.

use super::number::{f64_from_i64, f64_from_i128, i64_from_f64, i128_from_f64};

/// Fractional bits of prices, slopes and of bounds in the making.
pub(crate) const FRACTION_BITS: u32 = 32;
/// 2^32.
pub(crate) const UNIT: f64 = 4_294_967_296.0;
/// Units added to a bound on the logarithm.
const MARGIN: i128 = 4;

/// How the worth of a cell grows with its sum s.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gain {
    /// `price * min(s, wanted)`: each unit short of what is wanted costs its price.
    Shortfall {
        /// The sum from which nothing is short, not negative.
        wanted: i64,
        /// Units of value per unit short, not negative.
        price: i64,
    },
    /// `scale * ln(1 + s / offset)`, rounded down.
    Log {
        /// Units of value per factor e, not negative.
        scale: i64,
        /// The sum that doubles the argument, positive.
        offset: i64,
    },
}

impl Gain {
    /// Worth of a sum, 0 at 0.
    pub(crate) fn at(self, sum: i64) -> i64 {
        match self {
            Self::Shortfall { wanted, price } => price.saturating_mul(sum.min(wanted)),
            Self::Log { scale, offset } => {
                i64_from_f64((f64_from_i64(scale) * ln_1p(sum, offset)).floor())
            }
        }
    }

    /// Worth of another unit of sum, in units of value.
    pub(crate) fn slope(self, sum: f64) -> f64 {
        match self {
            Self::Shortfall { wanted, price } => {
                if sum < f64_from_i64(wanted) {
                    f64_from_i64(price)
                } else {
                    0.0
                }
            }
            Self::Log { scale, offset } => f64_from_i64(scale) / (f64_from_i64(offset) + sum),
        }
    }

    /// At least the worth of s less that of `base`, less `slope * (s - base)`, for every s from
    /// `base` to `most`; in 2^-32 units, as `slope` is.
    pub(crate) fn reserve(self, base: i64, most: i64, slope: i128) -> i128 {
        let worth =
            |sum: i64| (i128::from(self.at(sum)) << FRACTION_BITS) - slope * i128::from(sum - base);
        let start = i128::from(self.at(base)) << FRACTION_BITS;
        match self {
            // Linear on either side of the sum wanted.
            Self::Shortfall { wanted, .. } => {
                worth(base).max(worth(most)).max(worth(wanted.clamp(base, most))) - start
            }
            Self::Log { scale, offset } => {
                // The tangent at any sum lies above; the one with this slope touches where
                // scale / (offset + s) = slope.
                let per_unit = f64_from_i128(slope) / UNIT;
                let touch = f64_from_i64(scale) / per_unit - f64_from_i64(offset);
                let touch = touch.clamp(f64_from_i64(base), f64_from_i64(most));
                let sum = i64_from_f64(touch).clamp(base, most);
                let tangent = self.slope(f64_from_i64(sum));
                // worth(s) <= worth(sum) + tangent (s - sum), so the excess over slope * s is
                // largest at one of the ends.
                let tilt = i128_from_f64((tangent * UNIT).ceil()) - slope;
                let low = tilt * i128::from(base - sum);
                let high = (tilt + 1) * i128::from(most - sum);
                let top = low.max(high).max(0);
                worth(sum) + top + (MARGIN << FRACTION_BITS) - start
            }
        }
    }
}

fn ln_1p(sum: i64, offset: i64) -> f64 {
    (f64_from_i64(sum) / f64_from_i64(offset)).ln_1p()
}
