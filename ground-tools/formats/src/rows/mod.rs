//! Rows of CSV, JSON lines or Parquet, from one definition of their columns.
//!
//! A table is a list of [`Column`]s: each has a name, a kind and what it takes from a row.
//!
//! CSV: provenance as comments, a header, shortest round-trip numbers, nothing for what is not known.
//! JSON lines: an object per row, null for what is not known, the first row with the provenance too.
//! Parquet: typed columns, times as TIMESTAMP, provenance as key-value metadata (`parquet.rs`).
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

mod column;
mod layout;
mod parquet;

pub use column::{Cell, Column, Field};
pub use layout::{Format, Layout, RowError};

use crate::error::WriteError;
use planner::provenance::Provenance;
use serde::ser::{SerializeMap, SerializeSeq};
use serde::{Serialize, Serializer};
use std::io::Write;

/// Writes rows as they come; returns how many there were.
///
/// # Errors
/// What a row or the writer says.
pub fn write<R, E: Into<RowError>>(
    out: &mut dyn Write,
    rows: impl Iterator<Item = Result<R, E>>,
    layout: &Layout<'_, R>,
) -> Result<usize, WriteError> {
    match layout.format {
        Format::Csv => csv_rows(out, rows, layout),
        Format::Jsonl => json_lines(out, rows, layout.columns, Some(layout.provenance)),
        Format::Parquet => parquet::write(out, rows, layout),
    }
}

fn csv_rows<R, E: Into<RowError>>(
    mut out: &mut dyn Write,
    rows: impl Iterator<Item = Result<R, E>>,
    layout: &Layout<'_, R>,
) -> Result<usize, WriteError> {
    out.write_all(layout.provenance.comment().as_bytes())?;
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(&mut out);
    writer.write_record(layout.columns.iter().map(|it| it.name)).map_err(csv_error)?;
    let mut count = 0;
    for row in rows {
        let row = row.map_err(WriteError::row)?;
        writer.serialize(Record { row: &row, columns: layout.columns }).map_err(csv_error)?;
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

/// Writes rows as JSON lines, the first of them with the provenance, where there is one; returns how
/// many there were. Rows of other columns may follow.
///
/// # Errors
/// What a row or the writer says.
pub fn json_lines<R, E: Into<RowError>>(
    out: &mut dyn Write,
    rows: impl Iterator<Item = Result<R, E>>,
    columns: &[Column<R>],
    provenance: Option<&Provenance>,
) -> Result<usize, WriteError> {
    let mut count = 0;
    for row in rows {
        let row = row.map_err(WriteError::row)?;
        let provenance = provenance.filter(|_| count == 0);
        serde_json::to_writer(&mut *out, &Object { row: &row, columns, provenance })
            .map_err(std::io::Error::from)?;
        out.write_all(b"\n")?;
        count += 1;
    }
    Ok(count)
}

/// A row without names.
struct Record<'r, R> {
    row: &'r R,
    columns: &'r [Column<R>],
}

impl<R> Serialize for Record<'_, R> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut cells = serializer.serialize_seq(Some(self.columns.len()))?;
        for column in self.columns {
            cells.serialize_element(&column.field.of(self.row))?;
        }
        cells.end()
    }
}

/// A row with names.
struct Object<'r, R> {
    row: &'r R,
    columns: &'r [Column<R>],
    provenance: Option<&'r Provenance>,
}

impl<R> Serialize for Object<'_, R> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut entries = serializer.serialize_map(None)?;
        for column in self.columns {
            entries.serialize_entry(column.name, &column.field.of(self.row))?;
        }
        if let Some(provenance) = self.provenance {
            entries.serialize_entry("provenance", provenance)?;
        }
        entries.end()
    }
}
