//! Where is each body, from a compact table.
//!
//! A table holds, in [`Ecliptic`](crate::frame::Ecliptic), the unit geometric Sun-to-spacecraft vector
//! ([`SUN`]) and the unit apparent directions of the targets, as Chebyshev series over granules of equal length. The
//! ground fits it (crate `ephem`); it is read in place from borrowed bytes.
//!
//! Layout, little-endian, no alignment:
//!
//! | bytes | field |
//! |---|---|
//! | 0..4 | number of bodies, u32 |
//! | 4..8 | number of spans, u32 |
//! | 8..12 | number of f64 coefficients, u32 |
//! | 12..16 | zero |
//! | 16.. | bodies of [`BODY_BYTES`], by number |
//! | then | spans of [`SPAN_BYTES`], by body, then start |
//! | then | coefficients, f64: granule after granule, order after order, x y z |
//!
//! | bytes of a body | field |
//! |---|---|
//! | 0..4 | body number, i32 |
//! | 4..8 | number of its spans, u32, at least 1 |
//! | 8..12 | index of its first span, u32: where the body before ends |
//! | 12..16 | zero |
//! | 16..40 | bounds over all of its spans: in each field the largest of the spans' |
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
//! Method: `body.rs`. A body's bounds are held against its spans' when the table is parsed, so that
//! to take up a body afterwards is a binary search among bodies, whatever the number of its spans.
//!
//! Limits: the position error is the fit's (1 mas for uplinked tables, shown by
//! `ephem/tests/fit.rs`). The spans' bounds are the ground's word; `gyrfalcon table verify` checks
//! them.

mod error;
mod record;
mod body;

pub use body::BodyTable;
pub use error::EphemerisError;
pub use record::{BODY_BYTES, BodyRecord, MAX_COEFFICIENTS, SPAN_BYTES, Span};

use crate::bytes::{i32_at, u32_at};
use crate::convert::index_from_u32;
use crate::direction::MotionBounds;
use crate::time::Instant;
use body::ORDER_BYTES;

/// Body number of the geometric Sun-to-spacecraft direction (NAIF's number of the Sun).
pub const SUN: i32 = 10;
/// Body numbers from here up are the mission's own fixed sources and direction tables.
pub const FIRST_USER_BODY: i32 = 1_000_000;
/// Bytes of the header.
pub const HEADER_BYTES: usize = 16;

/// A checked ephemeris table in borrowed bytes.
#[derive(Debug, Clone, Copy)]
pub struct EphemerisTable<'a> {
    bodies: &'a [[u8; BODY_BYTES]],
    spans: &'a [[u8; SPAN_BYTES]],
    data: &'a [u8],
}

/// The header of a table with so many bodies, spans and f64 coefficients.
#[must_use]
pub fn table_header(bodies: u32, spans: u32, coefficients: u32) -> [u8; HEADER_BYTES] {
    let counts = [bodies, spans, coefficients].map(u128::from);
    let [bodies, spans, coefficients] = counts;
    (bodies | spans << 32_u32 | coefficients << 64_u32).to_le_bytes()
}

impl<'a> EphemerisTable<'a> {
    /// Checks and borrows a table.
    ///
    /// # Errors
    /// [`EphemerisError::WrongLength`], [`EphemerisError::BadSpan`], [`EphemerisError::BadBody`] or
    /// [`EphemerisError::BadCoefficient`].
    #[inline(never)]
    pub fn parse(bytes: &'a [u8]) -> Result<Self, EphemerisError> {
        let wrong = EphemerisError::WrongLength;
        let count = |offset| u32_at(bytes, offset).ok_or(wrong);
        let (bodies, spans, numbers) = (count(0)?, count(4)?, count(8)?);
        let rest = bytes.get(HEADER_BYTES..).ok_or(wrong)?;
        let size =
            |records: u32, each: usize| index_from_u32(records).checked_mul(each).ok_or(wrong);
        let (bodies, rest) = rest.split_at_checked(size(bodies, BODY_BYTES)?).ok_or(wrong)?;
        let (spans, data) = rest.split_at_checked(size(spans, SPAN_BYTES)?).ok_or(wrong)?;
        if size(numbers, 8)? != data.len() || numbers % 3 != 0 || count(12)? != 0 {
            return Err(wrong);
        }
        let table = Self {
            bodies: bodies.as_chunks::<BODY_BYTES>().0,
            spans: spans.as_chunks::<SPAN_BYTES>().0,
            data,
        };
        table.check_bodies(numbers)?;
        let mut index = 0_u32;
        for number in data.as_chunks::<8>().0 {
            if !f64::from_le_bytes(*number).is_finite() {
                return Err(EphemerisError::BadCoefficient(index));
            }
            index = index.wrapping_add(1);
        }
        Ok(table)
    }

    /// Bodies are ordered, and each has the spans of its number and the largest of their bounds.
    #[inline(never)]
    // REQ-EPH-2.
    fn check_bodies(self, numbers: u32) -> Result<(), EphemerisError> {
        let (mut index, mut first) = (0_u32, 0_u32);
        let mut spans = self.spans;
        let mut before: Option<i32> = None;
        for record in self.bodies {
            let bad = EphemerisError::BadBody(index);
            let body = BodyRecord::from_le_bytes(record).ok_or(bad)?;
            let (own, others) = spans.split_at_checked(index_from_u32(body.spans)).ok_or(bad)?;
            if body.first != first || before.is_some_and(|before| before >= body.body) {
                return Err(bad);
            }
            if check_spans(own, &body, numbers)? != body.bounds {
                return Err(bad);
            }
            first = first.wrapping_add(body.spans);
            before = Some(body.body);
            spans = others;
            index = index.wrapping_add(1);
        }
        // No span is left over.
        if spans.is_empty() { Ok(()) } else { Err(EphemerisError::BadBody(index)) }
    }

    /// The spans, by body, then start.
    pub fn spans(self) -> impl Iterator<Item = Span> + 'a {
        self.spans.iter().filter_map(Span::from_le_bytes)
    }

    /// The bodies, by number.
    pub fn bodies(self) -> impl Iterator<Item = BodyRecord> + 'a {
        self.bodies.iter().filter_map(BodyRecord::from_le_bytes)
    }

    /// One body's part of the table: a binary search among the bodies.
    ///
    /// # Errors
    /// [`EphemerisError::NoSuchBody`].
    #[inline(never)]
    pub fn body(self, body: i32) -> Result<BodyTable<'a>, EphemerisError> {
        self.find(body).ok_or(EphemerisError::NoSuchBody(body))
    }

    fn find(self, body: i32) -> Option<BodyTable<'a>> {
        let number = |record: &[u8; BODY_BYTES]| i32_at(record, 0).unwrap_or(i32::MAX);
        let record = self.bodies.get(self.bodies.partition_point(|it| number(it) < body))?;
        if number(record) != body {
            return None;
        }
        let first = index_from_u32(u32_at(record, 8)?);
        let spans = self.spans.get(first..)?.get(..index_from_u32(u32_at(record, 4)?))?;
        Some(BodyTable { record, spans, data: self.data.as_chunks::<ORDER_BYTES>().0 })
    }
}

/// The largest of the bounds of a body's spans, which must be legal, of its number, inside the data,
/// and ordered without overlap.
#[inline(never)]
// REQ-EPH-1.
fn check_spans(
    own: &[[u8; SPAN_BYTES]],
    body: &BodyRecord,
    numbers: u32,
) -> Result<MotionBounds, EphemerisError> {
    let mut largest = MotionBounds::NONE;
    let mut end: Option<Instant> = None;
    let mut index = body.first;
    for record in own {
        let bad = EphemerisError::BadSpan(index);
        let span = Span::from_le_bytes(record).ok_or(bad)?;
        let size = u32::from(span.coefficients)
            .checked_mul(3)
            .and_then(|granule| granule.checked_mul(span.granules))
            .and_then(|size| size.checked_add(span.first))
            .ok_or(bad)?;
        let overlaps = end.is_some_and(|end| span.start < end);
        if size > numbers || span.first % 3 != 0 || span.body != body.body || overlaps {
            return Err(bad);
        }
        end = span.end();
        largest = largest.and(&span.bounds);
        index = index.wrapping_add(1);
    }
    Ok(largest)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::direction::DirectionState;
    use core::num::NonZeroU64;
    use proptest::prelude::*;
    use std::vec::Vec;

    /// Where the coefficients of [`table`] begin.
    const DATA: usize = HEADER_BYTES + BODY_BYTES + SPAN_BYTES;

    fn span(body: i32, start_ns: i64, rate_rad_s: f64) -> Span {
        Span {
            body,
            coefficients: 2,
            granules: 2,
            first: 0,
            start: Instant::from_tai_ns(start_ns),
            granule_ns: NonZeroU64::new(1_000_000_000_000).unwrap(),
            bounds: MotionBounds { rate_rad_s, acceleration_per_s2: 1e-11, max_abs_z: 1.0 },
        }
    }

    /// A table of these bodies, all on the same two granules of 1000 s: z = 1, x = 1e-3 (u + granule),
    /// so the direction is known.
    fn table_of(bodies: &[&[Span]]) -> Vec<u8> {
        let count = |length: usize| u32::try_from(length).unwrap();
        let spans: Vec<Span> = bodies.iter().copied().flatten().copied().collect();
        let mut bytes = table_header(count(bodies.len()), count(spans.len()), 12).to_vec();
        let mut first = 0;
        for own in bodies {
            let bounds = own.iter().fold(MotionBounds::NONE, |sum, span| sum.and(&span.bounds));
            let record = BodyRecord { body: own[0].body, spans: count(own.len()), first, bounds };
            bytes.extend(record.to_le_bytes());
            first += record.spans;
        }
        bytes.extend(spans.iter().flat_map(Span::to_le_bytes));
        for c in [0.0, 0.0, 1.0, 1e-3, 0.0, 0.0, 2e-3, 0.0, 1.0, 1e-3, 0.0, 0.0_f64] {
            bytes.extend(c.to_le_bytes());
        }
        bytes
    }

    fn table() -> Vec<u8> {
        table_of(&[&[span(5, -500, 2.1e-6)]])
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
        for (offset, number) in [(DATA + 16, 0.0), (DATA + 24, 1e308)] {
            let mut bytes = table();
            bytes[offset..offset + 8].copy_from_slice(&f64::to_le_bytes(number));
            bytes[DATA + 24..DATA + 32].copy_from_slice(&f64::to_le_bytes(number));
            let body = EphemerisTable::parse(&bytes).unwrap().body(5).unwrap();
            assert_eq!(body.state(at).unwrap_err(), EphemerisError::OutOfSpan(at));
        }
    }

    #[test]
    // REQ-EPH-1.
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
        let span = HEADER_BYTES + BODY_BYTES;
        assert_eq!(with(span + 4, &0_u16.to_le_bytes()), EphemerisError::BadSpan(0));
        assert_eq!(with(span + 8, &9_u32.to_le_bytes()), EphemerisError::BadSpan(0));
        assert_eq!(with(span + 24, &0_u64.to_le_bytes()), EphemerisError::BadSpan(0));
        assert_eq!(with(span + 32, &f64::NAN.to_le_bytes()), EphemerisError::BadSpan(0));
        assert_eq!(with(DATA, &f64::INFINITY.to_le_bytes()), EphemerisError::BadCoefficient(0));
        assert_eq!(with(12, &1_u32.to_le_bytes()), EphemerisError::WrongLength);
    }

    #[test]
    // REQ-EPH-2.
    fn a_bodys_record_must_be_that_of_its_spans() {
        let good = table_of(&[
            &[span(4, 0, 1e-6), span(4, 2_000_000_000_000, 3e-6), span(4, 1 << 50, 2e-6)],
            &[span(5, 0, 4e-6)],
            &[span(7, -5, 5e-6), span(7, 1 << 60, 1e-6)],
        ]);
        let parsed = EphemerisTable::parse(&good).unwrap();
        for (body, rate, spans) in [(4, 3e-6, 3), (5, 4e-6, 1), (7, 5e-6, 2)] {
            let own = parsed.body(body).unwrap();
            assert_eq!(own.bounds(), MotionBounds { rate_rad_s: rate, ..span(0, 0, 0.0).bounds });
            assert_eq!(own.spans.len(), spans);
            assert_eq!(Span::from_le_bytes(&own.spans[0]).unwrap().body, body);
        }
        for absent in [i32::MIN, 3, 6, 8, i32::MAX] {
            assert_eq!(parsed.body(absent).unwrap_err(), EphemerisError::NoSuchBody(absent));
        }
        assert_eq!(parsed.bodies().map(|it| it.first).collect::<Vec<_>>(), [0, 3, 4]);
        let with = |body: usize, offset: usize, bytes: &[u8]| {
            let mut table = good.clone();
            let at = HEADER_BYTES + body * BODY_BYTES + offset;
            table[at..at + bytes.len()].copy_from_slice(bytes);
            EphemerisTable::parse(&table).map(|_| ()).unwrap_err()
        };
        let bad = EphemerisError::BadBody;
        // Number, spans too few, too many, none; first span; zero field; each bound below and above.
        assert_eq!(with(0, 0, &3_i32.to_le_bytes()), EphemerisError::BadSpan(0));
        assert_eq!(with(1, 0, &4_i32.to_le_bytes()), bad(1));
        assert_eq!(with(0, 4, &2_u32.to_le_bytes()), bad(1));
        assert_eq!(with(1, 4, &2_u32.to_le_bytes()), EphemerisError::BadSpan(4));
        assert_eq!(with(2, 4, &0_u32.to_le_bytes()), bad(2));
        assert_eq!(with(2, 4, &1_u32.to_le_bytes()), bad(3));
        assert_eq!(with(2, 4, &3_u32.to_le_bytes()), bad(2));
        assert_eq!(with(1, 8, &2_u32.to_le_bytes()), bad(1));
        assert_eq!(with(1, 12, &1_u32.to_le_bytes()), bad(1));
        for (offset, bound) in [(16, 3e-6_f64), (24, 1e-11), (32, 1.0)] {
            assert_eq!(with(0, offset, &bound.next_down().to_le_bytes()), bad(0));
            assert_eq!(with(0, offset, &bound.next_up().to_le_bytes()), bad(0));
        }
        // A body record too few leaves a span over, one too many has none.
        let mut short = good[..HEADER_BYTES + 2 * BODY_BYTES].to_vec();
        short.extend(&good[HEADER_BYTES + 3 * BODY_BYTES..]);
        short[0] = 2;
        assert_eq!(EphemerisTable::parse(&short).unwrap_err(), bad(2));
        let mut long = good[..HEADER_BYTES + 3 * BODY_BYTES].to_vec();
        long.extend(&good[HEADER_BYTES + 2 * BODY_BYTES..]);
        long[0] = 4;
        assert_eq!(EphemerisTable::parse(&long).unwrap_err(), bad(3));
    }

    #[test]
    // REQ-EPH-2.
    fn bounds_of_ten_thousand_spans_are_read_from_the_bodys_record_alone() {
        let spans: Vec<Span> = (0..10_000_u32)
            .map(|index| {
                let start_ns = 2_000_000_000_000 * i64::from(index);
                span(4, start_ns, if index == 7_000 { 3e-6 } else { 1e-6 })
            })
            .collect();
        let bytes = table_of(&[&spans]);
        let body = EphemerisTable::parse(&bytes).unwrap().body(4).unwrap();
        // Without any span the answer is the same: none is read, however many there are.
        let blind = BodyTable { spans: &[], data: &[], ..body };
        assert_eq!(blind.bounds(), body.bounds());
        assert_eq!(body.bounds().rate_rad_s.to_bits(), 3e-6_f64.to_bits());
    }

    #[test]
    // REQ-EPH-1.
    fn spans_of_a_body_must_not_overlap() {
        let overlapping = table_of(&[&[span(4, 0, 1e-6), span(4, 1_999_999_999_999, 1e-6)]]);
        assert_eq!(EphemerisTable::parse(&overlapping).unwrap_err(), EphemerisError::BadSpan(1));
        let meeting = table_of(&[&[span(4, 0, 1e-6), span(4, 2_000_000_000_000, 1e-6)]]);
        assert!(EphemerisTable::parse(&meeting).is_ok());
        let reversed = table_of(&[&[span(5, 0, 1e-6)], &[span(4, 0, 1e-6)]]);
        assert_eq!(EphemerisTable::parse(&reversed).unwrap_err(), EphemerisError::BadBody(1));
    }

    #[test]
    // REQ-EPH-1.
    fn spans_may_touch_but_not_overlap() {
        let first = span(5, 0, 2.1e-6);
        let granules = 2_000_000_000_000;
        let parse = |start_ns: i64, change: fn(&mut Span)| {
            let mut second = Span { first: 0, ..span(5, start_ns, 2.1e-6) };
            change(&mut second);
            let bytes = table_of(&[&[first, second]]);
            EphemerisTable::parse(&bytes).map(|_| ())
        };
        assert_eq!(parse(granules, |_| {}), Ok(()));
        assert_eq!(parse(granules + 1, |_| {}), Ok(()), "a gap");
        let bad = Err(EphemerisError::BadSpan(1));
        assert_eq!(parse(granules - 1, |_| {}), bad);
        assert_eq!(parse(0, |_| {}), bad);
        // Where its coefficients lie: whole triples, inside the data.
        for first in [1, 2, 3, 12] {
            let bytes = table_of(&[&[Span { first, ..span(5, 0, 2.1e-6) }]]);
            let refused = EphemerisTable::parse(&bytes).map(|_| ());
            assert_eq!(refused, Err(EphemerisError::BadSpan(0)), "{first}");
        }
        let one = Span { first: 6, granules: 1, ..span(5, 0, 2.1e-6) };
        assert_eq!(EphemerisTable::parse(&table_of(&[&[one]])).map(|_| ()), Ok(()));
        for (coefficients, granules) in [(0, 2), (2, 0), (MAX_COEFFICIENTS + 1, 1)] {
            let record = Span { coefficients, granules, ..first }.to_le_bytes();
            assert!(Span::from_le_bytes(&record).is_none(), "{coefficients} {granules}");
        }
    }

    #[test]
    // REQ-EPH-3.
    fn a_state_follows_its_series_in_value_and_rate() {
        // Four orders in each component, on one granule of 100 s.
        let coefficients: [f64; 12] =
            [0.6, 0.3, 0.7, 0.05, -0.2, 0.1, 0.03, 0.04, -0.02, -0.01, 0.02, 0.015];
        let bounds = MotionBounds { rate_rad_s: 1.0, acceleration_per_s2: 1.0, max_abs_z: 1.0 };
        let own = Span {
            coefficients: 4,
            granules: 1,
            granule_ns: NonZeroU64::new(100_000_000_000).unwrap(),
            bounds,
            ..span(5, 0, 1.0)
        };
        let mut bytes = table_header(1, 1, 12).to_vec();
        bytes.extend(BodyRecord { body: 5, spans: 1, first: 0, bounds }.to_le_bytes());
        bytes.extend(own.to_le_bytes());
        bytes.extend(coefficients.iter().flat_map(|number| number.to_le_bytes()));
        let body = EphemerisTable::parse(&bytes).unwrap().body(5).unwrap();
        for ns in (1_000_000_000..100_000_000_000).step_by(7_000_000_000) {
            let x = 2.0 * f64::from(u32::try_from(ns / 1_000_000).unwrap()) / 1e5 - 1.0;
            let orders = [1.0, x, 2.0 * x * x - 1.0, 4.0 * x * x * x - 3.0 * x];
            let component = |axis: usize| -> f64 {
                (0..4).map(|order| coefficients[3 * order + axis] * orders[order]).sum()
            };
            let v = nalgebra::Vector3::new(component(0), component(1), component(2));
            let (length, v) = (v.norm(), v.normalize());
            let at = |ns: i64| body.state(Instant::from_tai_ns(ns)).unwrap();
            let state = at(ns);
            assert!((state.direction.vector() - v).norm() < 1e-15);
            let moved =
                at(ns + 1_000_000).direction.vector() - at(ns - 1_000_000).direction.vector();
            let rate = nalgebra::Vector3::from(state.rate_per_s);
            // The motion is that of the series, whose length is taken as one.
            assert!((moved * (length / 2e-3) - rate).norm() < 1e-9 + 1e-6 * rate.norm(), "{ns}");
            let mut placed = DirectionState::NOWHERE;
            let end = body.place_state(Instant::from_tai_ns(ns), &mut placed).unwrap();
            let numbers = |it: &DirectionState<_>| (it.direction.vector(), it.rate_per_s);
            assert_eq!(numbers(&placed), numbers(&state));
            assert_eq!(end, Instant::from_tai_ns(100_000_000_000));
        }
        let reach = (Instant::from_tai_ns(0), Instant::from_tai_ns(100_000_000_000));
        assert_eq!(body.coverage(), Some(reach));
    }
}
