//! Rows of CSV, JSON lines or Parquet, from one definition.
//!
//! CSV: provenance as comments, a header, shortest round-trip numbers. JSON lines: an object per
//! row, the first of them carrying the provenance too. Parquet: `columns`.
//!
//! # Example
//! The sessions of a day's plan as CSV: provenance, the columns' names, a row per session:
//! ```
//! use formats::{rows::Format, timeline::timeline};
//! use mission::{Mission, Override};
//! use planner::plan::{Revision, plan};
//! use planner::{progress::Quietly, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=1")?])?;
//! let world = World::open(mission, None)?;
//! let timeline = timeline(&world, &plan(&world, &Revision::default(), &Quietly)?, None)?;
//! let mut csv = Vec::new();
//! timeline.write_table(&mut csv, Format::Csv)?;
//! let csv = String::from_utf8(csv)?;
//! let rows: Vec<&str> = csv.lines().filter(|line| !line.starts_with('#')).collect();
//! assert!(csv.starts_with("# mission: LiteBIRD\n") && rows[0].starts_with("id,target,telescope,"));
//! assert!(rows[1].starts_with("MFT-jupiter-000003,jupiter,MFT,2032-04-01T11:48:29.455373650Z,"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod columns;
mod cells;

use crate::error::WriteError;
use planner::provenance::Provenance;
use serde::Serialize;
use std::error::Error;
use std::io::Write;

/// Why a row could not be made, as whoever makes it says.
pub type RowError = Box<dyn Error + Send + Sync>;

/// Writes rows as they come; `header` names the columns. Returns how many there were.
///
/// # Errors
/// What a row or the writer says.
pub fn write<R: Serialize, E: Into<RowError>>(
    out: &mut dyn Write,
    rows: impl Iterator<Item = Result<R, E>>,
    layout: &Layout<'_>,
) -> Result<usize, WriteError> {
    match layout.format {
        Format::Csv => csv_rows(out, rows, layout),
        Format::Jsonl => json_rows(out, rows, layout),
        Format::Parquet => columns::write(out, rows, layout),
    }
}

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
#[derive(Debug, Clone, Copy)]
pub struct Layout<'l> {
    /// CSV, JSON lines or Parquet.
    pub format: Format,
    /// Where the rows come from.
    pub provenance: &'l Provenance,
    /// The columns' names.
    pub header: &'l [&'l str],
}

fn csv_rows<R: Serialize, E: Into<RowError>>(
    mut out: &mut dyn Write,
    rows: impl Iterator<Item = Result<R, E>>,
    layout: &Layout<'_>,
) -> Result<usize, WriteError> {
    out.write_all(layout.provenance.comment().as_bytes())?;
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(&mut out);
    writer.write_record(layout.header).map_err(csv_error)?;
    let mut count = 0;
    for row in rows {
        writer.serialize(row.map_err(WriteError::row)?).map_err(csv_error)?;
        count += 1;
    }
    writer.flush()?;
    Ok(count)
}

fn csv_error(error: csv::Error) -> WriteError {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => WriteError::Io(error),
        other => WriteError::Refused(format!("{other:?}")),
    }
}

fn json_rows<R: Serialize, E: Into<RowError>>(
    out: &mut dyn Write,
    rows: impl Iterator<Item = Result<R, E>>,
    layout: &Layout<'_>,
) -> Result<usize, WriteError> {
    let mut count = 0;
    for row in rows {
        let row = row.map_err(WriteError::row)?;
        if count == 0 {
            serde_json::to_writer(&mut *out, &First { row, provenance: layout.provenance })
        } else {
            serde_json::to_writer(&mut *out, &row)
        }
        .map_err(std::io::Error::from)?;
        out.write_all(b"\n")?;
        count += 1;
    }
    Ok(count)
}

/// The first row of JSON lines.
#[derive(Serialize)]
struct First<'p, R> {
    #[serde(flatten)]
    row: R,
    provenance: &'p Provenance,
}
