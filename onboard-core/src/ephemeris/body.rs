//! One body's part of a table: where it is, and how it moves.
//!
//! Method: the recurrences of Chebyshev's polynomials of both kinds, for the series and its
//! derivative, then renormalisation.

use super::error::EphemerisError;
use super::record::{BODY_BYTES, SPAN_BYTES, Span};
use crate::bytes::{f64_at, i64_at, u16_at, u32_at, u64_at};
use crate::convert::{f64_from_u64, index_from_u32, index_from_u64, rolled, u32_from_f64};
use crate::direction::{Direction, DirectionState, MotionBounds};
use crate::frame::Ecliptic;
use crate::time::Instant;
use crate::vector::{dot, minus, plus, times};
use nalgebra::Vector3;

/// Bytes of one order's three coefficients.
pub(super) const ORDER_BYTES: usize = 24;

/// One body's part of a table.
#[derive(Debug, Clone, Copy)]
pub struct BodyTable<'a> {
    pub(super) record: &'a [u8; BODY_BYTES],
    pub(super) spans: &'a [[u8; SPAN_BYTES]],
    pub(super) data: &'a [[u8; ORDER_BYTES]],
}

impl BodyTable<'_> {
    /// The body's direction at `at`, and how it moves.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] outside the body's spans, in a gap between two, or where the
    /// series has no direction.
    pub fn state(self, at: Instant) -> Result<DirectionState<Ecliptic>, EphemerisError> {
        let mut state = DirectionState::NOWHERE;
        self.place_state(at, &mut state)?;
        Ok(state)
    }

    /// As [`Self::state`], written in place, with the end of the granule: up to it, the end itself excluded unless the
    /// body's tables end there, direction and motion follow one series and obey the bounds.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] as [`Self::state`].
    // REQ-EPH-3.
    pub(crate) fn place_state(
        &self,
        at: Instant,
        state: &mut DirectionState<Ecliptic>,
    ) -> Result<Instant, EphemerisError> {
        self.evaluate(at, state).ok_or(EphemerisError::OutOfSpan(at))
    }

    /// The body's direction at `at`, for less work than [`Self::state`] and with the same bits.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] as [`Self::state`].
    pub(crate) fn direction(self, at: Instant) -> Result<Direction<Ecliptic>, EphemerisError> {
        let series = self.series(at).ok_or(EphemerisError::OutOfSpan(at))?;
        let value = chebyshev_value(series.orders, series.x);
        Direction::from_nearly_unit(value).ok_or(EphemerisError::OutOfSpan(at))
    }

    /// The series that holds `at`, and where `at` lies in it.
    #[cfg_attr(target_os = "none", inline(never))]
    fn series(&self, at: Instant) -> Option<Series<'_>> {
        // The last span that starts at or before `at`; its far end is inclusive.
        let after = self
            .spans
            .partition_point(|record| i64_at(record, 16).is_some_and(|ns| ns <= at.tai_ns()));
        // Records were checked when the table was; only what is needed is read again.
        let record = self.spans.get(after.checked_sub(1)?)?;
        let (orders, granules) = (usize::from(u16_at(record, 4)?), u32_at(record, 8)?);
        let length_ns = u64_at(record, 24)?;
        let length = f64_from_u64(length_ns);
        let offset = u64::try_from(at.tai_ns().checked_sub(i64_at(record, 16)?)?).ok()?;
        let last = u64::from(granules).wrapping_sub(1);
        let (mut granule, mut within) = split(offset, length_ns, length)?;
        if granule > last {
            // The end of the last granule belongs to it.
            if within > 0 || granule != u64::from(granules) {
                return None;
            }
            (granule, within) = (last, length_ns);
        }
        let first = index_from_u32(u32_at(record, 12)?.checked_div(3)?)
            .checked_add(index_from_u64(granule).checked_mul(orders)?)?;
        let orders = self.data.get(first..first.checked_add(orders)?)?;
        Some(Series {
            orders,
            x: 2.0 * (f64_from_u64(within) / length) - 1.0,
            length,
            end: Instant::from_tai_ns(
                at.tai_ns().saturating_add_unsigned(length_ns.wrapping_sub(within)),
            ),
        })
    }

    #[cfg_attr(target_os = "none", inline(never))]
    fn evaluate(&self, at: Instant, state: &mut DirectionState<Ecliptic>) -> Option<Instant> {
        let series = self.series(at)?;
        let (value, slope) = chebyshev(series.orders, series.x);
        moving(value, slope, series.length, state)?;
        Some(series.end)
    }

    /// First and last instant of the body's spans; a gap between spans is not seen here.
    #[must_use]
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn coverage(self) -> Option<(Instant, Instant)> {
        let first = Span::from_le_bytes(self.spans.first()?)?;
        let last = Span::from_le_bytes(self.spans.last()?)?;
        Some((first.start, last.end()?))
    }

    /// Bounds on the motion within all of the body's spans, as the body's record states them and
    /// [`EphemerisTable::parse`](super::EphemerisTable::parse) has checked: no span is read. Where one
    /// span or granule follows another, direction and rate may jump, which they do not bound.
    #[must_use]
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn bounds(self) -> MotionBounds {
        let bound = |offset| f64_at(self.record, offset).unwrap_or(f64::INFINITY);
        MotionBounds { rate_rad_s: bound(16), acceleration_per_s2: bound(24), max_abs_z: bound(32) }
    }
}

/// Coefficients of one granule, and where an instant lies in it.
struct Series<'a> {
    orders: &'a [[u8; ORDER_BYTES]],
    /// In [-1, 1].
    x: f64,
    /// Length of the granule in ns.
    length: f64,
    /// End of the granule.
    end: Instant,
}

/// Quotient and rest of `offset / length_ns`; `length` is `length_ns` as f64. `None` where the
/// quotient is above 2^32, which no granule is.
///
/// The quotient of the two as f64, up to 2^32, is off by at most one, which the rest tells; a 64-bit
/// division in software would cost more than all of this.
fn split(offset: u64, length_ns: u64, length: f64) -> Option<(u64, u64)> {
    let guess = u64::from(u32_from_f64(f64_from_u64(offset) / length));
    let rest = offset.wrapping_sub(guess.wrapping_mul(length_ns));
    if rest < length_ns {
        return Some((guess, rest));
    }
    if rest.wrapping_sub(length_ns) < length_ns {
        return Some((guess.wrapping_add(1), rest.wrapping_sub(length_ns)));
    }
    let before = rest.wrapping_add(length_ns);
    (before < length_ns).then_some((guess.wrapping_sub(1), before))
}

/// The state that a series' value and slope are, of granules of this length in ns; apart, so that it
/// does not lie on the stack below the series.
#[cfg_attr(target_os = "none", inline(never))]
fn moving(
    value: Vector3<f64>,
    slope: Vector3<f64>,
    length: f64,
    state: &mut DirectionState<Ecliptic>,
) -> Option<()> {
    let direction = Direction::from_nearly_unit(value)?;
    // d(v/|v|)/dt = (v' - n (n . v')) / |v|; |v| is one within the fit's error.
    let unit = direction.vector();
    let per_second = times(slope, 2.0e9 / length);
    let along = dot(unit, per_second);
    let rate = minus(per_second, times(unit, along));
    // A series of huge coefficients has a direction, but its motion overflows.
    if !(rate.x + rate.y + rate.z).is_finite() {
        return None;
    }
    *state = DirectionState { direction, rate_per_s: [rate.x, rate.y, rate.z] };
    Some(())
}

/// `sum_k c_k T_k(x)`, with the bits of [`chebyshev`].
#[cfg_attr(target_os = "none", inline(never))]
fn chebyshev_value(series: &[[u8; ORDER_BYTES]], x: f64) -> Vector3<f64> {
    let Some((constant, higher)) = series.split_first() else {
        return Vector3::new(0.0, 0.0, 0.0);
    };
    let two_x = 2.0 * x;
    let mut value = coefficient(constant);
    let (mut first, mut first_before) = (x, 1.0);
    for order in higher {
        rolled();
        value = plus(value, times(coefficient(order), first));
        (first_before, first) = (first, two_x * first - first_before);
    }
    value
}

/// `sum_k c_k T_k(x)` and its derivative `sum_k c_k k U_{k-1}(x)`, by the recurrences of both kinds.
#[cfg_attr(target_os = "none", inline(never))]
fn chebyshev(series: &[[u8; ORDER_BYTES]], x: f64) -> (Vector3<f64>, Vector3<f64>) {
    let zero = Vector3::new(0.0, 0.0, 0.0);
    let Some((constant, higher)) = series.split_first() else { return (zero, zero) };
    let two_x = 2.0 * x;
    let (mut value, mut slope) = (coefficient(constant), zero);
    // T_0 = 1, T_1 = x, U_{-1} = 0, U_0 = 1; both go on with y_{k+1} = 2 x y_k - y_{k-1}.
    let (mut first, mut first_before) = (x, 1.0);
    let (mut second, mut second_before) = (1.0, 0.0);
    let mut degree = 1.0;
    for order in higher {
        let c = coefficient(order);
        value = plus(value, times(c, first));
        slope = plus(slope, times(c, degree * second));
        (first_before, first) = (first, two_x * first - first_before);
        (second_before, second) = (second, two_x * second - second_before);
        degree += 1.0;
    }
    (value, slope)
}

fn coefficient(order: &[u8; ORDER_BYTES]) -> Vector3<f64> {
    let number = |offset| f64_at(order, offset).unwrap_or(0.0);
    Vector3::new(number(0), number(8), number(16))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn split_is_division(offset: u64, length in 1..u64::MAX, small in 1_u64..1 << 20, k: u32) {
            let lengths = [length, small, length >> 30 | 1, length >> 12 | 1];
            for length in lengths {
                let edge = length.wrapping_mul(u64::from(k));
                for offset in [offset, edge, edge.wrapping_sub(1), offset >> 20] {
                    let quotient = offset / length;
                    let expected = (quotient <= 1 << 32).then_some((quotient, offset % length));
                    prop_assert_eq!(split(offset, length, f64_from_u64(length)), expected);
                }
            }
        }
    }
}
