//! Why an ephemeris table cannot be used, or has no answer.

use crate::time::Instant;

/// Why a table cannot be used, or has no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum EphemerisError {
    /// Fewer or more bytes than the counts say.
    WrongLength,
    /// A span record (its index) has an illegal count, length, bound or order.
    BadSpan(u32),
    /// A body record (its index) is out of order, or its spans or bounds are not those that follow.
    BadBody(u32),
    /// A coefficient (its index) is NaN or infinite.
    BadCoefficient(u32),
    /// The body is not in the table.
    NoSuchBody(i32),
    /// The instant lies outside the body's spans.
    OutOfSpan(Instant),
}
