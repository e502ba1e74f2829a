//! Why a history is refused, in sentences; lines count from 1.

use ephem::ccsds::CcsdsError;
use ephem::time::TimeError;
use thiserror::Error;

/// Why a file is refused; lines count from 1.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum HistoryError {
    /// No text at all.
    #[error(
        "the file is empty: a CSV with a time and q_x, q_y, q_z, q_w, or a CCSDS AEM, is needed"
    )]
    Empty,
    /// Nothing but a header.
    #[error("the file has no attitudes: rows after the header are needed")]
    NoRows,
    /// Not readable as CSV.
    #[error("line {line}: {reason}")]
    Csv {
        /// Line number.
        line: usize,
        /// What the reader said.
        reason: String,
    },
    /// The header lacks a column.
    #[error("line {line}: the header '{found}' has no column {column}: {legal}")]
    Column {
        /// Line number.
        line: usize,
        /// The header.
        found: String,
        /// The column.
        column: &'static str,
        /// What is needed.
        legal: &'static str,
    },
    /// An AEM's headers, metadata or lines are wrong.
    #[error(transparent)]
    Ccsds(#[from] CcsdsError),
    /// A field is not one of those legal.
    #[error("line {line}: {key} is '{value}'; legal is {legal}")]
    Value {
        /// Line number.
        line: usize,
        /// Column or keyword.
        key: &'static str,
        /// Its value.
        value: String,
        /// What it may be.
        legal: &'static str,
    },
    /// A time cannot be read.
    #[error("line {line}: {fault}")]
    Time {
        /// Line number.
        line: usize,
        /// Why.
        fault: TimeError,
    },
    /// A quaternion is not of length one.
    #[error("line {line}: the quaternion's norm is {norm}; legal is 1 within 0.001")]
    Norm {
        /// Line number.
        line: usize,
        /// Its norm.
        norm: f64,
    },
    /// Times do not rise.
    #[error(
        "line {line}: the time '{time}' is {}; times that rise from row to row are needed",
        if *repeated { "that of the row before" } else { "earlier than the row before" }
    )]
    Order {
        /// Line number.
        line: usize,
        /// The time as written.
        time: String,
        /// Equal to the one before.
        repeated: bool,
    },
    /// Segments in different frames.
    #[error("line {line}: this segment is in another frame than the first: one frame is needed")]
    Frames {
        /// Line number.
        line: usize,
    },
}
