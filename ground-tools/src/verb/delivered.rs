//! Where results go: a file, or standard output.

use super::told::print_json;
use crate::cli::{Format, SharedArgs};
use crate::failure::Failure;
use crate::output::Sink;
use formats::rows::{self, Column, Layout};
use planner::provenance::Provenance;
use serde::Serialize;

/// Where rows go.
pub(super) fn sink(shared: &SharedArgs) -> Sink {
    shared.out.as_deref().map_or(Sink::Stdout, Sink::at)
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
        let format = shared.format.unwrap_or(Format::Csv).of_rows()?;
        let layout = Layout { format, provenance, columns };
        sink.write_with(|out| rows::write(out, rows, &layout))?;
    }
    if shared.json { print_json(&summary()?) } else { Ok(()) }
}
