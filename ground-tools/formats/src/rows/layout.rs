//! What a table of rows is written as, and from what.

use super::column::Column;
use planner::provenance::Provenance;
use std::error::Error;

/// Why a row could not be made, as whoever makes it says.
pub type RowError = Box<dyn Error + Send + Sync>;

/// The form of rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values.
    Csv,
    /// One JSON object per line.
    Jsonl,
    /// Apache Parquet.
    Parquet,
}

/// How rows are written.
#[derive(Debug)]
pub struct Layout<'l, R> {
    /// CSV, JSON lines or Parquet.
    pub format: Format,
    /// Where the rows come from.
    pub provenance: &'l Provenance,
    /// What they hold.
    pub columns: &'l [Column<R>],
}
