//! Rows of CSV, JSON lines or Parquet, from one definition.
//!
//! CSV: provenance as comments, a header, shortest round-trip numbers. JSON lines: an object per
//! row, the first of them carrying the provenance too. Parquet: [`crate::columns`].

use crate::cli::Format;
use crate::columns;
use crate::failure::Failure;
use crate::output::WriteError;
use crate::provenance::Provenance;
use serde::Serialize;
use std::io::Write;

/// Writes rows as they come; `header` names the columns. Returns how many there were.
///
/// # Errors
/// What a row or the writer says.
pub fn write<R: Serialize>(
    out: &mut dyn Write,
    rows: impl Iterator<Item = Result<R, Failure>>,
    layout: &Layout<'_>,
) -> Result<usize, WriteError> {
    match layout.format {
        Format::Csv => csv_rows(out, rows, layout),
        Format::Jsonl => json_rows(out, rows, layout),
        Format::Parquet => columns::write(out, rows, layout),
        Format::C => Err(WriteError::Failed(alone("c", "vectors"))),
        Format::Aem => Err(WriteError::Failed(alone("aem", "pointing"))),
    }
}

fn alone(format: &str, verb: &str) -> Failure {
    Failure::Input(format!(
        "--format {format} is a form of {verb} alone: csv, jsonl or parquet is needed"
    ))
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

fn csv_rows<R: Serialize>(
    mut out: &mut dyn Write,
    rows: impl Iterator<Item = Result<R, Failure>>,
    layout: &Layout<'_>,
) -> Result<usize, WriteError> {
    out.write_all(layout.provenance.comment().as_bytes())?;
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(&mut out);
    writer.write_record(layout.header).map_err(csv_error)?;
    let mut count = 0;
    for row in rows {
        writer.serialize(row?).map_err(csv_error)?;
        count += 1;
    }
    writer.flush()?;
    Ok(count)
}

fn csv_error(error: csv::Error) -> WriteError {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => WriteError::Io(error),
        other => WriteError::Failed(Failure::internal(format!("{other:?}"))),
    }
}

fn json_rows<R: Serialize>(
    out: &mut dyn Write,
    rows: impl Iterator<Item = Result<R, Failure>>,
    layout: &Layout<'_>,
) -> Result<usize, WriteError> {
    let mut count = 0;
    for row in rows {
        let row = row?;
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
