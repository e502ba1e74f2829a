//! Where is each body, from a compact table.
//!
//! A table holds, in [`Ecliptic`], the unit geometric Sun-to-spacecraft vector ([`SUN`]) and the
//! unit apparent directions of the targets, as Chebyshev series over granules of equal length. The
//! ground fits it (crate `ephem`); it is read in place from borrowed bytes.
//!
//! Layout, little-endian, no alignment:
//!
//! | bytes | field |
//! |---|---|
//! | 0..4 | number of spans, u32 |
//! | 4..8 | number of f64 coefficients, u32 |
//! | 8.. | spans of [`SPAN_BYTES`], by body, then start |
//! | then | coefficients, f64: granule after granule, order after order, x y z |
//!
//! | bytes of a span | field |
//! |---|---|
//! | 0..4 | body number, i32 (NAIF; the ground numbers others from [`FIRST_USER_BODY`]) |
//! | 4..6 | coefficients per component, u16, 1 to [`MAX_COEFFICIENTS`] |
//! | 6..8 | zero |
//! | 8..12 | granules, u32 |
//! | 12..16 | first coefficient's index, u32 |
//! | 16..24 | start, i64 ns of TAI |
//! | 24..32 | granule length, u64 ns |
//! | 32..56 | bounds over the span: rate rad/s, acceleration 1/s^2, largest abs z; f64 |
//!
//! Method: the recurrences of Chebyshev's polynomials of both kinds, for the series and its
//! derivative, then renormalisation.
//!
//! Limits: the position error is the fit's (1 mas for uplinked tables, shown by
//! `ephem/tests/fit.rs`). The bounds are the ground's word; `gyrfalcon table verify` checks them.

use crate::bytes::{f64_at, i32_at, i64_at, u16_at, u32_at, u64_at};
use crate::convert::{f64_from_u64, index_from_u32, index_from_u64, u32_from_f64};
use crate::direction::{Direction, DirectionState, MotionBounds};
use crate::frame::Ecliptic;
use crate::time::{Duration, Instant};
use core::num::NonZeroU64;
use nalgebra::Vector3;

/// Body number of the geometric Sun-to-spacecraft direction (NAIF's number of the Sun).
pub const SUN: i32 = 10;
/// Body numbers from here up are the mission's own fixed sources and direction tables.
pub const FIRST_USER_BODY: i32 = 1_000_000;
/// Bytes of one span record.
pub const SPAN_BYTES: usize = 56;
/// Most Chebyshev coefficients per component.
pub const MAX_COEFFICIENTS: u16 = 64;

const HEADER_BYTES: usize = 8;
/// Bytes of one order's three coefficients.
const ORDER_BYTES: usize = 24;

/// Why a table cannot be used, or has no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EphemerisError {
    /// Fewer or more bytes than the counts say.
    WrongLength,
    /// A span record (its index) has an illegal count, length, bound or order.
    BadSpan(u32),
    /// A coefficient (its index) is NaN or infinite.
    BadCoefficient(u32),
    /// The body is not in the table.
    NoSuchBody(i32),
    /// The instant lies outside the body's spans.
    OutOfSpan(Instant),
}

/// A checked ephemeris table in borrowed bytes.
#[derive(Debug, Clone, Copy)]
pub struct EphemerisTable<'a> {
    spans: &'a [u8],
    data: &'a [u8],
}

/// One body's part of a table.
#[derive(Debug, Clone, Copy)]
pub struct BodyTable<'a> {
    spans: &'a [[u8; SPAN_BYTES]],
    data: &'a [[u8; ORDER_BYTES]],
}

/// One span record, read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Body number.
    pub body: i32,
    /// Coefficients per component.
    pub coefficients: u16,
    /// Granules of equal length.
    pub granules: u32,
    /// Index of the first coefficient in the data.
    pub first: u32,
    /// Start of the first granule.
    pub start: Instant,
    /// Length of a granule in ns.
    pub granule_ns: NonZeroU64,
    /// Bounds on the motion over the span.
    pub bounds: MotionBounds,
}

impl Span {
    /// Reads a record; `None` when a field is out of its range.
    #[must_use]
    #[inline(never)]
    pub fn from_le_bytes(record: &[u8; SPAN_BYTES]) -> Option<Self> {
        let coefficients = u16_at(record, 4)?;
        let granules = u32_at(record, 8)?;
        let bounds = MotionBounds {
            rate_rad_s: f64_at(record, 32)?,
            acceleration_per_s2: f64_at(record, 40)?,
            max_abs_z: f64_at(record, 48)?,
        };
        let in_range = |value: f64| value.is_finite() && value >= 0.0;
        let legal = (1..=MAX_COEFFICIENTS).contains(&coefficients)
            && granules > 0
            && u16_at(record, 6)? == 0
            && in_range(bounds.rate_rad_s)
            && in_range(bounds.acceleration_per_s2)
            && in_range(bounds.max_abs_z);
        let span = Self {
            body: i32_at(record, 0)?,
            coefficients,
            granules,
            first: u32_at(record, 12)?,
            start: Instant::from_tai_ns(i64_at(record, 16)?),
            granule_ns: NonZeroU64::new(u64_at(record, 24)?)?,
            bounds,
        };
        (legal && span.end().is_some()).then_some(span)
    }

    /// The record of a span.
    #[must_use]
    pub fn to_le_bytes(&self) -> [u8; SPAN_BYTES] {
        let mut record = [0; SPAN_BYTES];
        crate::bytes::put(&mut record, 0, self.body.to_le_bytes());
        crate::bytes::put(&mut record, 4, self.coefficients.to_le_bytes());
        crate::bytes::put(&mut record, 8, self.granules.to_le_bytes());
        crate::bytes::put(&mut record, 12, self.first.to_le_bytes());
        crate::bytes::put(&mut record, 16, self.start.tai_ns().to_le_bytes());
        crate::bytes::put(&mut record, 24, self.granule_ns.get().to_le_bytes());
        crate::bytes::put(&mut record, 32, self.bounds.rate_rad_s.to_le_bytes());
        crate::bytes::put(&mut record, 40, self.bounds.acceleration_per_s2.to_le_bytes());
        crate::bytes::put(&mut record, 48, self.bounds.max_abs_z.to_le_bytes());
        record
    }

    /// End of the last granule; `None` beyond the time scale.
    #[must_use]
    pub fn end(&self) -> Option<Instant> {
        let length = self.granule_ns.get().checked_mul(u64::from(self.granules))?;
        self.start.tai_ns().checked_add_unsigned(length).map(Instant::from_tai_ns)
    }
}

impl<'a> EphemerisTable<'a> {
    /// Checks and borrows a table.
    ///
    /// # Errors
    /// [`EphemerisError::WrongLength`], [`EphemerisError::BadSpan`] or
    /// [`EphemerisError::BadCoefficient`].
    #[inline(never)]
    pub fn parse(bytes: &'a [u8]) -> Result<Self, EphemerisError> {
        let count = u32_at(bytes, 0).ok_or(EphemerisError::WrongLength)?;
        let numbers = u32_at(bytes, 4).ok_or(EphemerisError::WrongLength)?;
        let body = bytes.get(HEADER_BYTES..).ok_or(EphemerisError::WrongLength)?;
        let span_bytes =
            index_from_u32(count).checked_mul(SPAN_BYTES).ok_or(EphemerisError::WrongLength)?;
        let (spans, data) = body.split_at_checked(span_bytes).ok_or(EphemerisError::WrongLength)?;
        if index_from_u32(numbers).checked_mul(8) != Some(data.len()) || numbers % 3 != 0 {
            return Err(EphemerisError::WrongLength);
        }
        let table = Self { spans, data };
        table.check_spans(numbers)?;
        let mut index = 0_u32;
        for number in data.as_chunks::<8>().0 {
            if !f64::from_le_bytes(*number).is_finite() {
                return Err(EphemerisError::BadCoefficient(index));
            }
            index = index.wrapping_add(1);
        }
        Ok(table)
    }

    /// Spans are legal, lie inside the data, and are ordered by body and time without overlap.
    fn check_spans(self, numbers: u32) -> Result<(), EphemerisError> {
        let mut previous: Option<Span> = None;
        let mut index = 0_u32;
        for record in self.spans.as_chunks::<SPAN_BYTES>().0 {
            let bad = EphemerisError::BadSpan(index);
            let span = Span::from_le_bytes(record).ok_or(bad)?;
            let size = u32::from(span.coefficients)
                .checked_mul(3)
                .and_then(|granule| granule.checked_mul(span.granules))
                .and_then(|size| size.checked_add(span.first))
                .ok_or(bad)?;
            if size > numbers || span.first % 3 != 0 {
                return Err(bad);
            }
            if let Some(before) = previous {
                let after = before.body < span.body
                    || (before.body == span.body
                        && before.end().is_some_and(|end| end <= span.start));
                if !after {
                    return Err(bad);
                }
            }
            previous = Some(span);
            index = index.wrapping_add(1);
        }
        Ok(())
    }

    /// The spans, by body, then start.
    pub fn spans(self) -> impl Iterator<Item = Span> + 'a {
        self.spans.as_chunks::<SPAN_BYTES>().0.iter().filter_map(Span::from_le_bytes)
    }

    /// One body's part of the table.
    ///
    /// # Errors
    /// [`EphemerisError::NoSuchBody`].
    #[inline(never)]
    pub fn body(self, body: i32) -> Result<BodyTable<'a>, EphemerisError> {
        let records = self.spans.as_chunks::<SPAN_BYTES>().0;
        let number = |record: &[u8; SPAN_BYTES]| i32_at(record, 0).unwrap_or(i32::MAX);
        let first = records.partition_point(|record| number(record) < body);
        let last = records.partition_point(|record| number(record) <= body);
        match records.get(first..last) {
            Some(spans) if !spans.is_empty() => {
                Ok(BodyTable { spans, data: self.data.as_chunks::<ORDER_BYTES>().0 })
            }
            _ => Err(EphemerisError::NoSuchBody(body)),
        }
    }
}

impl BodyTable<'_> {
    /// The body's direction at `at`, and how it moves.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] outside the body's spans, in a gap between two, or where the
    /// series has no direction.
    pub fn state(self, at: Instant) -> Result<DirectionState<Ecliptic>, EphemerisError> {
        Ok(self.state_until(at)?.0)
    }

    /// As [`Self::state`], with the end of the granule: up to it, the end itself excluded unless the
    /// body's tables end there, direction and motion follow one series and obey the bounds.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] as [`Self::state`].
    pub(crate) fn state_until(
        self,
        at: Instant,
    ) -> Result<(DirectionState<Ecliptic>, Instant), EphemerisError> {
        self.evaluate(at).ok_or(EphemerisError::OutOfSpan(at))
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
    #[inline(never)]
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
        let rest_ns = i64::try_from(length_ns.wrapping_sub(within)).unwrap_or(i64::MAX);
        Some(Series {
            orders,
            x: 2.0 * (f64_from_u64(within) / length) - 1.0,
            length,
            end: at.plus(Duration::from_ns(rest_ns)),
        })
    }

    #[inline(never)]
    fn evaluate(self, at: Instant) -> Option<(DirectionState<Ecliptic>, Instant)> {
        let series = self.series(at)?;
        let (value, slope) = chebyshev(series.orders, series.x);
        let direction = Direction::from_nearly_unit(value)?;
        // d(v/|v|)/dt = (v' - n (n . v')) / |v|; |v| is one within the fit's error.
        let unit = direction.vector();
        let per_second = slope * (2.0e9 / series.length);
        let along = unit.x * per_second.x + unit.y * per_second.y + unit.z * per_second.z;
        let rate = per_second - unit * along;
        // A series of huge coefficients has a direction, but its motion overflows.
        if !(rate.x + rate.y + rate.z).is_finite() {
            return None;
        }
        Some((DirectionState { direction, rate_per_s: [rate.x, rate.y, rate.z] }, series.end))
    }

    /// First and last instant of the body's spans; a gap between spans is not seen here.
    #[must_use]
    #[inline(never)]
    pub fn coverage(self) -> Option<(Instant, Instant)> {
        let first = Span::from_le_bytes(self.spans.first()?)?;
        let last = Span::from_le_bytes(self.spans.last()?)?;
        Some((first.start, last.end()?))
    }

    /// Bounds on the motion over all of the body's spans.
    #[must_use]
    #[inline(never)]
    pub fn bounds(self) -> MotionBounds {
        let none = MotionBounds { rate_rad_s: 0.0, acceleration_per_s2: 0.0, max_abs_z: 0.0 };
        self.spans.iter().filter_map(Span::from_le_bytes).fold(none, |a, span| MotionBounds {
            rate_rad_s: libm::fmax(a.rate_rad_s, span.bounds.rate_rad_s),
            acceleration_per_s2: libm::fmax(a.acceleration_per_s2, span.bounds.acceleration_per_s2),
            max_abs_z: libm::fmax(a.max_abs_z, span.bounds.max_abs_z),
        })
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

/// `sum_k c_k T_k(x)`, with the bits of [`chebyshev`].
fn chebyshev_value(series: &[[u8; ORDER_BYTES]], x: f64) -> Vector3<f64> {
    let Some((constant, higher)) = series.split_first() else {
        return Vector3::new(0.0, 0.0, 0.0);
    };
    let two_x = 2.0 * x;
    let mut value = coefficient(constant);
    let (mut first, mut first_before) = (x, 1.0);
    for order in higher {
        value += coefficient(order) * first;
        (first_before, first) = (first, two_x * first - first_before);
    }
    value
}

/// `sum_k c_k T_k(x)` and its derivative `sum_k c_k k U_{k-1}(x)`, by the recurrences of both kinds.
#[inline(never)]
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
        value += c * first;
        slope += c * (degree * second);
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
    extern crate std;
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    /// Two granules of 1000 s: z = 1, x = 1e-3 (u + granule), so the direction is known.
    fn table() -> Vec<u8> {
        let span = Span {
            body: 5,
            coefficients: 2,
            granules: 2,
            first: 0,
            start: Instant::from_tai_ns(-500),
            granule_ns: NonZeroU64::new(1_000_000_000_000).unwrap(),
            bounds: MotionBounds { rate_rad_s: 2.1e-6, acceleration_per_s2: 1e-11, max_abs_z: 1.0 },
        };
        let mut bytes = Vec::new();
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend(12_u32.to_le_bytes());
        bytes.extend(span.to_le_bytes());
        for c in [0.0, 0.0, 1.0, 1e-3, 0.0, 0.0, 2e-3, 0.0, 1.0, 1e-3, 0.0, 0.0_f64] {
            bytes.extend(c.to_le_bytes());
        }
        bytes
    }

    #[test]
    fn a_straight_track_comes_back() {
        let bytes = table();
        let body = EphemerisTable::parse(&bytes).unwrap().body(5).unwrap();
        for (ns, x) in [(-500, -1e-3), (499_999_999_500, 0.0), (1_999_999_999_500, 3e-3)] {
            let state = body.state(Instant::from_tai_ns(ns)).unwrap();
            let [sx, _, sz] = state.direction.xyz();
            assert!((sx / sz - x).abs() < 1e-15, "{sx} {x}");
            assert!((state.rate_per_s[0] - 2e-6).abs() < 1e-10);
        }
        for ns in [-501, 1_999_999_999_501] {
            let at = Instant::from_tai_ns(ns);
            assert_eq!(body.state(at).unwrap_err(), EphemerisError::OutOfSpan(at));
        }
    }

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

        #[test]
        fn the_direction_alone_has_the_states_bits(ns in -500_i64..=1_999_999_999_500) {
            let bytes = table();
            let body = EphemerisTable::parse(&bytes).unwrap().body(5).unwrap();
            let at = Instant::from_tai_ns(ns);
            let (alone, state) = (body.direction(at).unwrap(), body.state(at).unwrap());
            prop_assert_eq!(alone.xyz().map(f64::to_bits), state.direction.xyz().map(f64::to_bits));
        }
    }

    #[test]
    fn a_series_without_a_direction_or_a_rate_has_no_answer() {
        let at = Instant::from_tai_ns(0);
        // The first granule is (c0 + c1 x, 0, 1): its constant's z, and its slope's x.
        for (offset, number) in [(64 + 16, 0.0), (64 + 24, 1e308)] {
            let mut bytes = table();
            bytes[offset..offset + 8].copy_from_slice(&f64::to_le_bytes(number));
            bytes[64 + 24..64 + 32].copy_from_slice(&f64::to_le_bytes(number));
            let body = EphemerisTable::parse(&bytes).unwrap().body(5).unwrap();
            assert_eq!(body.state(at).unwrap_err(), EphemerisError::OutOfSpan(at));
        }
    }

    #[test]
    fn refuses_damage() {
        let good = table();
        assert_eq!(
            EphemerisTable::parse(&good).unwrap().body(4).unwrap_err(),
            EphemerisError::NoSuchBody(4)
        );
        for length in 0..good.len() {
            assert_eq!(
                EphemerisTable::parse(&good[..length]).unwrap_err(),
                EphemerisError::WrongLength
            );
        }
        let with = |offset: usize, bytes: &[u8]| {
            let mut table = good.clone();
            table[offset..offset + bytes.len()].copy_from_slice(bytes);
            EphemerisTable::parse(&table).map(|_| ()).unwrap_err()
        };
        assert_eq!(with(12, &0_u16.to_le_bytes()), EphemerisError::BadSpan(0));
        assert_eq!(with(16, &9_u32.to_le_bytes()), EphemerisError::BadSpan(0));
        assert_eq!(with(32, &0_u64.to_le_bytes()), EphemerisError::BadSpan(0));
        assert_eq!(with(40, &f64::NAN.to_le_bytes()), EphemerisError::BadSpan(0));
        assert_eq!(with(64, &f64::INFINITY.to_le_bytes()), EphemerisError::BadCoefficient(0));
    }
}
