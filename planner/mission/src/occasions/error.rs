//! Why a file of contacts or blackouts is refused.

use super::calendar::CalendarError;
use ephem::time::TimeError;
use std::fmt;
use std::path::PathBuf;
use thiserror::Error;

/// A file of contacts or blackouts that is refused.
#[derive(Debug, Clone, PartialEq)]
pub struct OccasionError {
    /// The file.
    pub path: PathBuf,
    /// Its line, from 1; an event of a calendar has none.
    pub line: Option<u64>,
    /// What is wrong.
    pub fault: Box<OccasionFault>,
}

/// What is wrong with a file of contacts or blackouts.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OccasionFault {
    /// It cannot be read.
    #[error("{reason}")]
    Unreadable {
        /// What the system said.
        reason: String,
    },
    /// It is not a CSV.
    #[error("{reason}")]
    Csv {
        /// What the reader said.
        reason: String,
    },
    /// Its header lacks a column.
    #[error("the header is {found}: {needed} is needed")]
    Header {
        /// The header.
        found: String,
        /// The columns that are needed.
        needed: String,
    },
    /// A cell is no time.
    #[error("{column}: {error}")]
    Time {
        /// The column.
        column: String,
        /// What is wrong with it.
        error: TimeError,
    },
    /// A span ends before it begins.
    #[error("the end {end} does not come after the start {start}")]
    Reversed {
        /// The start as written.
        start: String,
        /// The end as written.
        end: String,
    },
    /// A rate that is none.
    #[error("bit_s is {value}: a rate from 0 to 1e18 is needed")]
    Rate {
        /// The rate as written.
        value: String,
    },
    /// Nothing can be sent.
    #[error("it has no contact with a rate above 0 bit/s: memory could never be emptied")]
    NoContact,
    /// A calendar that cannot be used.
    #[error(transparent)]
    Calendar(CalendarError),
}

impl fmt::Display for OccasionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.path.display();
        match (&*self.fault, self.line) {
            (fault @ OccasionFault::Unreadable { .. }, _) => {
                write!(f, "cannot read {path}: {fault}")
            }
            (fault, Some(line)) => write!(f, "{path}, line {line}: {fault}"),
            (fault, None) => write!(f, "{path}: {fault}"),
        }
    }
}

impl std::error::Error for OccasionError {}

impl OccasionFault {
    /// The fault of a file, at a line where it has one.
    pub(super) fn of(self, path: impl Into<PathBuf>, line: Option<u64>) -> OccasionError {
        OccasionError { path: path.into(), line, fault: Box::new(self) }
    }
}
