//! Why an SPK file is refused, in sentences that follow its name.

use crate::daf::DafError;
use core::fmt;
use thiserror::Error;

/// Why an SPK file is refused.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SpkError {
    /// Its structure as a DAF is wrong.
    #[error(transparent)]
    Daf(#[from] DafError),
    /// It holds no segment.
    #[error("holds no segment")]
    Empty,
    /// A number inside a segment is impossible.
    #[error("is damaged: in segment {segment} (body {body}), {what} is {found}; legal is {legal}")]
    Segment {
        /// Segment, counted from 1.
        segment: usize,
        /// Its body.
        body: i32,
        /// Which number.
        what: &'static str,
        /// Its value.
        found: f64,
        /// What it may be.
        legal: LegalNumber,
    },
    /// Two neighbouring records do not meet.
    #[error(
        "is damaged: in segment {segment} (body {body}), records {record} and {next} are {jump_km} km apart where they meet; legal is {legal_km} km",
        next = record + 1
    )]
    Joint {
        /// Segment, counted from 1.
        segment: usize,
        /// Its body.
        body: i32,
        /// The earlier record, counted from 1.
        record: usize,
        /// Distance of the two records' positions.
        jump_km: f64,
        /// Largest distance accepted.
        legal_km: f64,
    },
}

/// What a number inside a segment may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LegalNumber {
    /// Described in words.
    Such(&'static str),
    /// This number.
    Exactly(f64),
    /// This number or a smaller one.
    AtMost(f64),
    /// This number or a larger one.
    AtLeast(f64),
    /// 2 + `per_axis` n, n from 1 to `most`.
    RecordSize {
        /// Coefficients per order.
        per_axis: usize,
        /// Most orders.
        most: usize,
    },
    /// From 2 to this many states.
    States(usize),
}

impl fmt::Display for LegalNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Such(words) => f.write_str(words),
            Self::Exactly(number) => write!(f, "{number}"),
            Self::AtMost(number) => write!(f, "{number} or earlier"),
            Self::AtLeast(number) => write!(f, "{number} or later"),
            Self::RecordSize { per_axis, most } => {
                write!(f, "2 + {per_axis} n with n from 1 to {most}")
            }
            Self::States(most) => write!(f, "2 to {most} states"),
        }
    }
}
