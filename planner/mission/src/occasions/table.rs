//! The rows of a CSV of spans: start, end, and one more column.

use super::error::{OccasionError, OccasionFault};
use ephem::time::parse_time;
use onboard_core::time::Instant;
use std::path::Path;

/// One row.
pub(super) struct Row {
    pub(super) from: Instant,
    pub(super) until: Instant,
    /// The third column as written.
    pub(super) third: String,
    pub(super) line: u64,
}

/// A file's bytes.
pub(super) fn bytes_of(path: &Path) -> Result<Vec<u8>, OccasionError> {
    std::fs::read(path)
        .map_err(|error| OccasionFault::Unreadable { reason: error.to_string() }.of(path, None))
}

/// A file's text.
fn text_of(path: &Path) -> Result<String, OccasionError> {
    std::fs::read_to_string(path)
        .map_err(|error| OccasionFault::Unreadable { reason: error.to_string() }.of(path, None))
}

/// The rows of a file whose third column has this name, by start.
pub(super) fn rows(path: &Path, third: &str) -> Result<Vec<Row>, OccasionError> {
    let text = text_of(path)?;
    let csv = |line: u64, error: &csv::Error| {
        OccasionFault::Csv { reason: error.to_string() }.of(path, Some(line))
    };
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| csv(1, &error))?.clone();
    let names = ["start_utc", "end_utc", third];
    let place = |name: &str| header.iter().position(|it| it == name);
    let [Some(start), Some(end), Some(last)] = names.map(place) else {
        let found = header.iter().collect::<Vec<_>>().join(", ");
        return Err(OccasionFault::Header { found, needed: names.join(", ") }.of(path, Some(1)));
    };
    let mut rows = Vec::new();
    for record in reader.records() {
        let record =
            record.map_err(|error| csv(error.position().map_or(0, csv::Position::line), &error))?;
        let line = record.position().map_or(0, csv::Position::line);
        let cell = |at: usize| record.get(at).unwrap_or_default();
        let time = |at: usize| {
            let column = || header.get(at).unwrap_or_default().to_owned();
            parse_time(cell(at)).map_err(|error| {
                OccasionFault::Time { column: column(), error }.of(path, Some(line))
            })
        };
        let (from, until) = (time(start)?, time(end)?);
        if until <= from {
            let (start, end) = (cell(start).to_owned(), cell(end).to_owned());
            return Err(OccasionFault::Reversed { start, end }.of(path, Some(line)));
        }
        rows.push(Row { from, until, third: cell(last).to_owned(), line });
    }
    rows.sort_by_key(|it| (it.from, it.until));
    Ok(rows)
}

/// A number that a range has checked, as a whole one.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "not negative and at most 1e18"
)]
pub(super) const fn whole(number: f64) -> u64 {
    number as u64
}
