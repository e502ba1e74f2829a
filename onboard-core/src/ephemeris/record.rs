//! The records of an ephemeris table: of a body, and of a span.

use crate::bytes::{f64_at, i32_at, i64_at, put, u16_at, u32_at, u64_at};
use crate::direction::MotionBounds;
use crate::time::Instant;
use core::num::NonZeroU64;

/// Bytes of one body record.
pub const BODY_BYTES: usize = 40;
/// Bytes of one span record.
pub const SPAN_BYTES: usize = 56;
/// Most Chebyshev coefficients per component.
pub const MAX_COEFFICIENTS: u16 = 64;

/// One body record, read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyRecord {
    /// Body number.
    pub body: i32,
    /// Spans of the body, at least one.
    pub spans: u32,
    /// Index of its first span.
    pub first: u32,
    /// Bounds on the motion over all of its spans: in each, the largest of the spans'.
    pub bounds: MotionBounds,
}

impl BodyRecord {
    /// Reads a record; `None` when a field is out of its range.
    #[must_use]
    #[inline(never)]
    pub fn from_le_bytes(record: &[u8; BODY_BYTES]) -> Option<Self> {
        let spans = u32_at(record, 4)?;
        let bounds = bounds_at(record, 16)?;
        (spans > 0 && u32_at(record, 12)? == 0).then_some(Self {
            body: i32_at(record, 0)?,
            spans,
            first: u32_at(record, 8)?,
            bounds,
        })
    }

    /// The record of a body.
    #[must_use]
    pub fn to_le_bytes(&self) -> [u8; BODY_BYTES] {
        let mut record = [0; BODY_BYTES];
        put(&mut record, 0, self.body.to_le_bytes());
        put(&mut record, 4, self.spans.to_le_bytes());
        put(&mut record, 8, self.first.to_le_bytes());
        put_bounds(&mut record, 16, &self.bounds);
        record
    }
}

/// Bounds of three f64 at `offset`; `None` where one is negative or not finite.
#[inline(never)]
fn bounds_at(record: &[u8], offset: usize) -> Option<MotionBounds> {
    Some(MotionBounds {
        rate_rad_s: bound_at(record, offset)?,
        acceleration_per_s2: bound_at(record, offset.wrapping_add(8))?,
        max_abs_z: bound_at(record, offset.wrapping_add(16))?,
    })
}

#[inline(never)]
fn bound_at(record: &[u8], offset: usize) -> Option<f64> {
    f64_at(record, offset).filter(|bound| *bound >= 0.0 && *bound < f64::INFINITY)
}

fn put_bounds(record: &mut [u8], offset: usize, bounds: &MotionBounds) {
    let mut at = offset;
    for bound in [bounds.rate_rad_s, bounds.acceleration_per_s2, bounds.max_abs_z] {
        put(record, at, bound.to_le_bytes());
        at = at.wrapping_add(8);
    }
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
        let bounds = bounds_at(record, 32)?;
        let legal = (1..=MAX_COEFFICIENTS).contains(&coefficients)
            && granules > 0
            && u16_at(record, 6)? == 0;
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
        put(&mut record, 0, self.body.to_le_bytes());
        put(&mut record, 4, self.coefficients.to_le_bytes());
        put(&mut record, 8, self.granules.to_le_bytes());
        put(&mut record, 12, self.first.to_le_bytes());
        put(&mut record, 16, self.start.tai_ns().to_le_bytes());
        put(&mut record, 24, self.granule_ns.get().to_le_bytes());
        put_bounds(&mut record, 32, &self.bounds);
        record
    }

    /// End of the last granule; `None` beyond the time scale.
    #[must_use]
    pub fn end(&self) -> Option<Instant> {
        let length = self.granule_ns.get().checked_mul(u64::from(self.granules))?;
        self.start.tai_ns().checked_add_unsigned(length).map(Instant::from_tai_ns)
    }
}
