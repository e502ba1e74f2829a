//! Which attitudes does a file hold: CSV, or a CCSDS Attitude Ephemeris Message.
//!
//! A row is an instant and a unit quaternion (x, y, z, w) that takes components in the file's body
//! frame to components in its reference frame: `v_reference = q v_body q*`. A CSV's reference is the
//! ecliptic of J2000 unless it is said to be ICRF; an AEM says so itself.
//!
//! Method: the text's first characters tell the form. Quaternions are normalised where they enter.
//!
//! Limits: quaternions whose norm is off by more than 1e-3 (four decimals) are refused. EME2000 and
//! J2000 are taken as ICRF (23 mas at most). Times must rise, in an AEM within each segment.

mod table;
mod meta;
mod kvn;
mod xml;

use ephem::time::TimeError;
use onboard_core::time::Instant;
use thiserror::Error;

/// Largest accepted distance of a quaternion's norm from one.
const NORM_SLACK: f64 = 1e-3;

/// Whose components a quaternion gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// DE440's axes.
    Icrf,
    /// Ecliptic of J2000.
    Ecliptic,
}

/// One attitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Line of the file, from 1.
    pub line: usize,
    /// When.
    pub at: Instant,
    /// Unit quaternion (x, y, z, w), body to reference.
    pub quaternion: [f64; 4],
}

/// The attitudes of a file, in time order.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// `CSV`, `AEM in KVN` or `AEM in XML`.
    pub form: &'static str,
    /// The reference that the file itself names; a CSV names none.
    pub reference: Option<Reference>,
    /// The attitudes.
    pub rows: Vec<Row>,
}

/// Why a file is refused; lines count from 1.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum HistoryError {
    /// No text at all.
    #[error(
        "the file is empty: a CSV with a time and q_x, q_y, q_z, q_w, or a CCSDS AEM, is needed"
    )]
    Empty,
    /// Nothing but a header.
    #[error("the file has no attitudes: rows after the header are needed")]
    NoRows,
    /// Not readable as CSV.
    #[error("line {line}: {reason}")]
    Csv {
        /// Line number.
        line: usize,
        /// What the reader said.
        reason: String,
    },
    /// The header lacks a column.
    #[error("line {line}: the header '{found}' has no column {column}: {legal}")]
    Column {
        /// Line number.
        line: usize,
        /// The header.
        found: String,
        /// The column.
        column: &'static str,
        /// What is needed.
        legal: &'static str,
    },
    /// A value is not one of those known.
    #[error("line {line}: {key} is '{value}'; legal is {legal}")]
    Value {
        /// Line number.
        line: usize,
        /// Column or keyword.
        key: String,
        /// Its value.
        value: String,
        /// Legal values.
        legal: String,
    },
    /// A keyword is not known where it stands.
    #[error("line {line}: unknown key '{key}'; legal are {legal}")]
    Key {
        /// Line number.
        line: usize,
        /// Keyword.
        key: String,
        /// Legal keywords.
        legal: String,
    },
    /// A block lacks a keyword.
    #[error("line {line}: the block that ends here has no {key}: it is needed")]
    Missing {
        /// Line number.
        line: usize,
        /// Keyword.
        key: &'static str,
    },
    /// A line is not what its place asks for.
    #[error("line {line}: '{text}' is not {expected}")]
    Line {
        /// Line number.
        line: usize,
        /// The line.
        text: String,
        /// What it should be.
        expected: String,
    },
    /// A time cannot be read.
    #[error("line {line}: {fault}")]
    Time {
        /// Line number.
        line: usize,
        /// Why.
        fault: TimeError,
    },
    /// A quaternion is not of length one.
    #[error("line {line}: the quaternion's norm is {norm}; legal is 1 within 0.001")]
    Norm {
        /// Line number.
        line: usize,
        /// Its norm.
        norm: f64,
    },
    /// Times do not rise.
    #[error(
        "line {line}: the time '{time}' is {}; times that rise from row to row are needed",
        if *repeated { "that of the row before" } else { "earlier than the row before" }
    )]
    Order {
        /// Line number.
        line: usize,
        /// The time as written.
        time: String,
        /// Equal to the one before.
        repeated: bool,
    },
    /// Segments in different frames.
    #[error("line {line}: this segment is in another frame than the first: one frame is needed")]
    Frames {
        /// Line number.
        line: usize,
    },
    /// Not XML.
    #[error("not readable as XML: {0}")]
    Xml(String),
    /// The file ends too early.
    #[error("the file ends {0}")]
    Ended(&'static str),
}

impl History {
    /// Reads a file's text; `start` is the zero of `elapsed_s`.
    ///
    /// # Errors
    /// [`HistoryError`] with the line, the value and what would be legal.
    pub fn parse(text: &str, start: Instant) -> Result<Self, HistoryError> {
        let text = text.trim_start_matches('\u{feff}');
        let mut history = match text.trim_start() {
            "" => return Err(HistoryError::Empty),
            rest if rest.starts_with('<') => xml::read(text)?,
            rest if rest.starts_with("CCSDS_AEM_VERS") || rest.starts_with("COMMENT") => {
                kvn::read(text)?
            }
            _ => table::read(text, start)?,
        };
        if history.rows.is_empty() {
            return Err(HistoryError::NoRows);
        }
        // Segments may overlap; rows within each rise.
        history.rows.sort_by_key(|row| row.at);
        Ok(history)
    }
}

/// A finite number.
fn number(line: usize, key: &str, text: &str) -> Result<f64, HistoryError> {
    let read = text.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    read.ok_or_else(|| HistoryError::Value {
        line,
        key: key.to_owned(),
        value: text.to_owned(),
        legal: "a finite number".to_owned(),
    })
}

/// The quaternion, normalised.
fn unit(line: usize, quaternion: [f64; 4]) -> Result<[f64; 4], HistoryError> {
    let norm = quaternion.iter().map(|it| it * it).sum::<f64>().sqrt();
    let near = (norm - 1.0).abs() <= NORM_SLACK;
    if near { Ok(quaternion.map(|it| it / norm)) } else { Err(HistoryError::Norm { line, norm }) }
}

/// The same rotation in the other sense.
const fn conjugate([x, y, z, w]: [f64; 4]) -> [f64; 4] {
    [-x, -y, -z, w]
}

/// Refuses a time that does not rise.
fn rising(rows: &[Row], at: Instant, line: usize, time: &str) -> Result<(), HistoryError> {
    match rows.last() {
        Some(before) if at <= before.at => {
            Err(HistoryError::Order { line, time: time.to_owned(), repeated: at == before.at })
        }
        _ => Ok(()),
    }
}
