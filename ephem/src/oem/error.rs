//! Why an OEM file is refused, in sentences; lines count from 1.

use crate::ccsds::CcsdsError;
use crate::time::format_tdb;
use onboard_core::time::Instant;
use thiserror::Error;

/// Why an OEM file is refused; lines count from 1.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OemError {
    /// Its headers, metadata or lines are wrong.
    #[error(transparent)]
    Ccsds(#[from] CcsdsError),
    /// Epochs do not rise.
    #[error("line {line}: the epoch '{epoch}' is not later than the one before")]
    Order {
        /// Line number.
        line: usize,
        /// The epoch.
        epoch: String,
    },
    /// A segment has fewer than two states.
    #[error("the segment that begins at line {line} has {count} states; legal is 2 or more")]
    Few {
        /// Line of `META_START`.
        line: usize,
        /// States found.
        count: usize,
    },
    /// A segment's useable span is empty, or has no states around it.
    #[error(
        "the segment that begins at line {line} has no useable span: {} to {} TDB, states considered",
        format_tdb(*start), format_tdb(*stop)
    )]
    EmptySpan {
        /// Line of `META_START`.
        line: usize,
        /// Its first useable instant.
        start: Instant,
        /// Its last.
        stop: Instant,
    },
    /// A segment begins before the one before it ends.
    #[error(
        "the segment that begins at line {line} is useable from {} TDB, but the one before runs to {} TDB: state USEABLE_START_TIME and USEABLE_STOP_TIME so that they do not overlap",
        format_tdb(*start), format_tdb(*stop)
    )]
    Overlap {
        /// Line of the later `META_START`.
        line: usize,
        /// Its first useable instant.
        start: Instant,
        /// The last one of the segment before.
        stop: Instant,
    },
    /// Nothing in it.
    #[error("the file holds no segment")]
    NoSegment,
}
