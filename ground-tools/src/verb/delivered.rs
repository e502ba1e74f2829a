//! Where results go: a file, or standard output.

use super::told::{json_line, print_json};
use crate::cli::{Format, SharedArgs};
use crate::failure::Failure;
use crate::output::{Sink, is_device};
use formats::rows::{self, Column, Layout};
use planner::provenance::Provenance;
use serde::Serialize;

/// Where rows go.
pub(super) fn sink(shared: &SharedArgs) -> Sink {
    shared.out.as_deref().map_or(Sink::Stdout, Sink::at)
}

/// A verb's whole answer goes to `--out` or standard output.
pub(super) fn answer(shared: &SharedArgs, text: &str) -> Result<(), Failure> {
    sink(shared).write(text.as_bytes())
}

/// The same as JSON, one line.
pub(super) fn answer_json(shared: &SharedArgs, value: &impl Serialize) -> Result<(), Failure> {
    answer(shared, &json_line(value)?)
}

/// The form of rows that was asked for, or that of `--out`'s ending.
///
/// # Errors
/// [`Failure::Input`] where the ending is none that is known.
pub(super) fn form(shared: &SharedArgs) -> Result<Format, Failure> {
    if let Some(format) = shared.format {
        return Ok(format);
    }
    let path = match sink(shared) {
        Sink::File(path) if !is_device(&path) => path,
        _ => return Ok(Format::Csv),
    };
    let Some(ending) = path.extension().map(|it| it.to_string_lossy().to_ascii_lowercase()) else {
        return Ok(Format::Csv);
    };
    match ending.as_str() {
        "csv" => Ok(Format::Csv),
        "jsonl" | "ndjson" => Ok(Format::Jsonl),
        "parquet" => Ok(Format::Parquet),
        "h" => Ok(Format::C),
        "aem" => Ok(Format::Aem),
        _ => Err(Failure::Input(format!(
            "--out {}: the ending .{ending} says no form of rows: csv, jsonl, parquet, aem or h, or \
             --format is needed",
            path.display()
        ))),
    }
}

/// Rows go to `--out` or standard output; with `--json` a summary goes to standard output, and rows
/// only to a file.
pub(super) fn deliver<R, S: Serialize>(
    shared: &SharedArgs,
    rows: impl Iterator<Item = Result<R, Failure>>,
    (provenance, columns): (&Provenance, &[Column<R>]),
    summary: impl FnOnce() -> Result<S, Failure>,
) -> Result<(), Failure> {
    let sink = sink(shared);
    if !(shared.json && sink == Sink::Stdout) {
        let format = form(shared)?.of_rows()?;
        let layout = Layout { format, provenance, columns };
        sink.write_with(|out| rows::write(out, rows, &layout))?;
    }
    if shared.json { print_json(&summary()?) } else { Ok(()) }
}
