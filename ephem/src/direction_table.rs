//! Directions that the user tabulates.
//!
//! A CSV file with the columns `elapsed_s, x, y, z` (a header names them, in any order; `#` begins a
//! comment): seconds on the scan clock since the mission's start, read exactly to nine decimals, and
//! unit vectors in the ecliptic of J2000. They are used as given: no aberration is added.
//!
//! Method: Lagrange interpolation over the ten rows around an instant (all rows of a shorter table),
//! then normalisation. Six-hourly directions of planets and the Moon come out to 1e-12 rad
//! (`tests/sources.rs`).
//!
//! Limits: eight rows or more, times strictly rising, norms one within 1e-6. Nothing is
//! extrapolated. Between the first rows, or the last, their noise grows up to eighteenfold.

use crate::convert::f64_from_i64;
use crate::interpolation::{central_window, lagrange_weights};
use crate::time::exact_ns;
use nalgebra::Vector3;
use onboard_core::time::NS_PER_SECOND;
use thiserror::Error;

/// Rows of an interpolation.
const WINDOW: usize = 10;
/// Fewest rows of a table.
const FEWEST_ROWS: usize = 8;
const NORM_SLACK: f64 = 1e-6;
const COLUMNS: [&str; 4] = ["elapsed_s", "x", "y", "z"];

/// Why a direction table is refused; lines count from 1.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TableError {
    /// Not a CSV file.
    #[error("line {line}: {reason}")]
    Csv {
        /// Line number.
        line: u64,
        /// What the reader said.
        reason: String,
    },
    /// The header does not name the columns.
    #[error("the header is '{found}'; legal are the columns elapsed_s, x, y, z, once each")]
    Header {
        /// The header.
        found: String,
    },
    /// A field is not a number.
    #[error("line {line}: {column} is '{value}'; legal is {legal}")]
    Number {
        /// Line number.
        line: u64,
        /// Column.
        column: &'static str,
        /// The field.
        value: String,
        /// What it may be.
        legal: &'static str,
    },
    /// Times do not rise.
    #[error("line {line}: elapsed_s is '{value}', not later than the row before")]
    Order {
        /// Line number.
        line: u64,
        /// The field.
        value: String,
    },
    /// A vector is not of length one.
    #[error("line {line}: (x, y, z) has length {norm}; legal is 1 within 1e-6")]
    Norm {
        /// Line number.
        line: u64,
        /// Its length.
        norm: f64,
    },
    /// Too few rows.
    #[error("the table has {found} rows; legal is 8 or more")]
    Few {
        /// Rows found.
        found: usize,
    },
}

/// Tabulated ecliptic unit vectors.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectionTable {
    elapsed_ns: Vec<i64>,
    vectors: Vec<Vector3<f64>>,
}

impl DirectionTable {
    /// The table in the text of a CSV file.
    ///
    /// # Errors
    /// [`TableError`] with the line and what would be legal.
    pub fn from_csv(text: &str) -> Result<Self, TableError> {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
        let refuse = |error: &csv::Error| TableError::Csv {
            line: error.position().map_or(0, csv::Position::line),
            reason: error.to_string(),
        };
        let header = reader.headers().map_err(|error| refuse(&error))?.clone();
        let place = |column: &str| header.iter().position(|name| name == column);
        let places: Vec<usize> = COLUMNS.iter().filter_map(|column| place(column)).collect();
        let (&[time, x, y, z], 4) = (places.as_slice(), header.len()) else {
            let found = header.iter().collect::<Vec<_>>().join(",");
            return Err(TableError::Header { found });
        };
        let mut table = Self { elapsed_ns: Vec::new(), vectors: Vec::new() };
        for record in reader.records() {
            let record = record.map_err(|error| refuse(&error))?;
            let line = record.position().map_or(0, csv::Position::line);
            let field = |place: usize| record.get(place).unwrap_or_default();
            table.push_time(line, field(time))?;
            table.push_vector(line, [field(x), field(y), field(z)])?;
        }
        if table.vectors.len() < FEWEST_ROWS {
            return Err(TableError::Few { found: table.vectors.len() });
        }
        Ok(table)
    }

    fn push_time(&mut self, line: u64, text: &str) -> Result<(), TableError> {
        let value = || text.to_owned();
        let legal = "a number of seconds with up to nine decimals";
        let elapsed = ns_from_seconds(text).ok_or_else(|| TableError::Number {
            line,
            column: "elapsed_s",
            value: value(),
            legal,
        })?;
        if self.elapsed_ns.last().is_some_and(|before| elapsed <= *before) {
            return Err(TableError::Order { line, value: value() });
        }
        self.elapsed_ns.push(elapsed);
        Ok(())
    }

    fn push_vector(&mut self, line: u64, fields: [&str; 3]) -> Result<(), TableError> {
        let mut vector = Vector3::zeros();
        for ((column, text), slot) in ["x", "y", "z"].into_iter().zip(fields).zip(vector.iter_mut())
        {
            let value = text.to_owned();
            let legal = "a finite number";
            *slot = text
                .parse::<f64>()
                .ok()
                .filter(|number| number.is_finite())
                .ok_or(TableError::Number { line, column, value, legal })?;
        }
        let norm = vector.norm();
        if (norm - 1.0).abs() > NORM_SLACK {
            return Err(TableError::Norm { line, norm });
        }
        self.vectors.push(vector);
        Ok(())
    }

    /// First and last time, ns since the mission's start.
    #[must_use]
    pub fn span_ns(&self) -> (i64, i64) {
        let end = |time: Option<&i64>| time.copied().unwrap_or(0);
        (end(self.elapsed_ns.first()), end(self.elapsed_ns.last()))
    }

    /// Times of the rows, ns since the mission's start.
    pub(crate) fn nodes_ns(&self) -> &[i64] {
        &self.elapsed_ns
    }

    /// The direction at `elapsed_ns` since the mission's start, not normalised; `None` outside.
    pub(crate) fn at(&self, elapsed_ns: i64) -> Option<Vector3<f64>> {
        let (first, last) = self.span_ns();
        if !(first..=last).contains(&elapsed_ns) {
            return None;
        }
        let after = self.elapsed_ns.partition_point(|time| *time <= elapsed_ns);
        let count = self.elapsed_ns.len();
        let from = central_window(count, after.saturating_sub(1), WINDOW);
        let range = from..count.min(from + WINDOW);
        let times: Vec<f64> = self
            .elapsed_ns
            .get(range.clone())?
            .iter()
            .map(|time| f64_from_i64(time - elapsed_ns))
            .collect();
        let weights: [f64; WINDOW] = lagrange_weights(&times, 0.0);
        let rows = self.vectors.get(range)?;
        Some(rows.iter().zip(weights).map(|(row, weight)| row * weight).sum())
    }
}

/// A decimal number of seconds as ns, exactly; `None` with more than nine decimals or an exponent.
fn ns_from_seconds(text: &str) -> Option<i64> {
    let (negative, digits) = match text.strip_prefix('-') {
        Some(digits) => (true, digits),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let legal = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if !legal(whole) || whole.len() + fraction.len() == 0 {
        return None;
    }
    let whole = if whole.is_empty() { "0" } else { whole };
    let fraction = if fraction.is_empty() { "0" } else { fraction };
    let ns = whole.parse::<i64>().ok()?.checked_mul(NS_PER_SECOND)?;
    let ns = ns.checked_add(exact_ns(fraction)?)?;
    Some(if negative { -ns } else { ns })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_read_exactly() {
        for (text, ns) in [
            ("0", Some(0)),
            ("-43200", Some(-43_200_000_000_000)),
            ("1.000000001", Some(1_000_000_001)),
            ("-0.5", Some(-500_000_000)),
            (".25", Some(250_000_000)),
            ("3.", Some(3_000_000_000)),
            ("94672800.1234567890", Some(94_672_800_123_456_789)),
            ("0.0000000001", None),
            ("1e3", None),
            ("nan", None),
            ("", None),
            ("-", None),
            ("99999999999", None),
        ] {
            let read = ns_from_seconds(text);
            assert_eq!(read, ns, "{text}");
        }
    }
}
