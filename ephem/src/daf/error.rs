//! Why a file is not a usable DAF/SPK, in sentences that follow its name.

use core::fmt;
use thiserror::Error;

/// Why a file is not a usable SPK.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DafError {
    /// Shorter than a DAF can be.
    #[error("is too short to be an SPK: {0} bytes, and the file record alone takes 1024")]
    TooShort(usize),
    /// Not a DAF at all.
    #[error("is not a SPICE DAF: it begins with '{0}' instead of 'DAF/SPK'")]
    NotDaf(String),
    /// A DAF of another kind.
    #[error("is a SPICE file of type '{0}', not an SPK ('DAF/SPK')")]
    NotSpk(String),
    /// No known byte order.
    #[error("has the unknown byte order '{0}': legal are LTL-IEEE and BIG-IEEE")]
    ByteOrder(String),
    /// Line ends were translated on the way.
    #[error("was damaged by a transfer in text mode: copy it again in binary mode")]
    TextTransfer,
    /// The file ends before what it describes.
    #[error("is truncated: {part} ends at byte {needed}, the file at byte {found}")]
    Truncated {
        /// What lies beyond the end.
        part: FilePart,
        /// Bytes needed.
        needed: usize,
        /// Bytes there.
        found: usize,
    },
    /// Summaries are not made of two doubles and six integers.
    #[error("is damaged: the summary format (ND, NI) is ({nd}, {ni}); legal is (2, 6)")]
    SummaryFormat {
        /// Doubles.
        nd: i32,
        /// Integers.
        ni: i32,
    },
    /// The first free address is none.
    #[error("is damaged: the first free address is {0}; legal is positive")]
    FreeAddress(i32),
    /// The first or last summary record is not one of the file's records.
    #[error(
        "is damaged: the {end} summary record's number is {found}; legal is 2 to {records} (the file's records)"
    )]
    SummaryRecord {
        /// `first` or `last`.
        end: &'static str,
        /// Its number.
        found: i32,
        /// Records of the file.
        records: usize,
    },
    /// The chain of summary records ends elsewhere.
    #[error(
        "is damaged: the last summary record's number is {found}; legal is {end}, where the chain ends"
    )]
    ChainEnd {
        /// The last record's number in the file record.
        found: usize,
        /// Where the chain ends.
        end: usize,
    },
    /// The chain of summary records does not end.
    #[error("is damaged: the chain of summary records is a loop; legal is a chain that ends")]
    ChainLoop,
    /// A control number of a summary record is impossible.
    #[error(
        "is damaged: {what} of summary record {record} is {found}; legal is a whole number, 0 to {last}"
    )]
    Control {
        /// Which number.
        what: &'static str,
        /// The record.
        record: usize,
        /// Its value.
        found: f64,
        /// Largest legal value.
        last: usize,
    },
    /// A summary record names another one before it than the one that led to it.
    #[error(
        "is damaged: the previous record of summary record {record} is {found}; legal is {previous}"
    )]
    Previous {
        /// The record.
        record: usize,
        /// The one it names.
        found: usize,
        /// The one before it.
        previous: usize,
    },
    /// A segment's coverage is impossible.
    #[error(
        "is damaged: the coverage of segment {segment} (TDB seconds) is {start_s} to {end_s}; legal is finite, the end after the start"
    )]
    Coverage {
        /// Segment, counted from 1.
        segment: usize,
        /// Its start.
        start_s: f64,
        /// Its end.
        end_s: f64,
    },
    /// A segment's addresses are impossible.
    #[error(
        "is damaged: the addresses of segment {segment} is {first} to {last}; legal is {legal}"
    )]
    Addresses {
        /// Segment, counted from 1.
        segment: usize,
        /// Its first double.
        first: i32,
        /// Its last.
        last: i32,
        /// What they may be.
        legal: &'static str,
    },
    /// A segment begins within the file's first records.
    #[error(
        "is damaged: the first address of segment {segment} is {first}; legal is beyond the file's first records (257 or more)"
    )]
    FirstAddress {
        /// Segment, counted from 1.
        segment: usize,
        /// Its first double.
        first: usize,
    },
}

/// A part of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilePart {
    /// Everything that the file record counts.
    Data,
    /// The summary record of this number.
    SummaryRecord(usize),
    /// The segment of this number, counted from 1.
    Segment(usize),
}

impl fmt::Display for FilePart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Data => f.write_str("its data"),
            Self::SummaryRecord(record) => write!(f, "summary record {record}"),
            Self::Segment(segment) => write!(f, "segment {segment}"),
        }
    }
}
