//! Rows of CSV or JSON lines, from one definition.
//!
//! CSV: provenance as comments, a header, shortest round-trip numbers. JSON lines: an object per
//! row, the first of them carrying the provenance too.

use crate::cli::Format;
use crate::failure::Failure;
use crate::provenance::Provenance;
use serde::Serialize;

/// The rows as bytes; `header` names the columns, for a table without rows.
///
/// # Errors
/// [`Failure::Internal`] where a row cannot be written.
pub fn write<R: Serialize>(
    rows: impl Iterator<Item = R>,
    format: Format,
    provenance: &Provenance,
    header: &[&str],
) -> Result<Vec<u8>, Failure> {
    match format {
        Format::Csv => csv_rows(rows, provenance, header),
        Format::Jsonl => json_rows(rows, provenance),
    }
}

fn csv_rows<R: Serialize>(
    rows: impl Iterator<Item = R>,
    provenance: &Provenance,
    header: &[&str],
) -> Result<Vec<u8>, Failure> {
    let mut writer =
        csv::WriterBuilder::new().has_headers(false).from_writer(provenance.comment().into_bytes());
    writer.write_record(header).map_err(Failure::internal)?;
    for row in rows {
        writer.serialize(row).map_err(Failure::internal)?;
    }
    writer.into_inner().map_err(|error| Failure::internal(error.error()))
}

fn json_rows<R: Serialize>(
    rows: impl Iterator<Item = R>,
    provenance: &Provenance,
) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let mut provenance = Some(provenance);
    for row in rows {
        match provenance.take() {
            None => serde_json::to_writer(&mut bytes, &row),
            Some(provenance) => serde_json::to_writer(&mut bytes, &First { row, provenance }),
        }
        .map_err(Failure::internal)?;
        bytes.push(b'\n');
    }
    Ok(bytes)
}

/// The first row of JSON lines.
#[derive(Serialize)]
struct First<'p, R> {
    #[serde(flatten)]
    row: R,
    provenance: &'p Provenance,
}
