//! Which attitudes does a file hold: CSV, or a CCSDS Attitude Ephemeris Message.
//!
//! A row is an instant and a unit quaternion (x, y, z, w) that takes components in the file's body
//! frame to components in its reference frame: `v_reference = q v_body q*`. A CSV's reference is the
//! ecliptic of J2000 unless it is said to be ICRF; an AEM says so itself.
//!
//! Method: the text's first characters tell the form; AEM are read by [`ephem::ccsds`], which reads
//! OEM too. Quaternions are normalised where they enter.
//!
//! Limits: quaternions whose norm is off by more than 1e-3 (four decimals) are refused. GCRF, EME2000
//! and J2000 are taken as ICRF (23 mas at most). Times must rise, in an AEM within each segment.
//!
//! # Example
//! Two attitudes of a CSV, the second 4 s later and a quarter turn about z further:
//! ```
//! use formats::history::History;
//! use planner::time::{Instant, parse_time};
//!
//! let text = "\
//! time_utc,q_x,q_y,q_z,q_w
//! 2032-04-01T00:00:00Z,0,0,0,1
//! 2032-04-01T00:00:04Z,0,0,0.7071,0.7071
//! ";
//! let history = History::parse(text, Instant::from_tai_ns(0))?;
//! let [first, second] = &history.rows[..] else { return Err("two rows".into()) };
//! assert_eq!((history.form, first.at), ("CSV", parse_time("2032-04-01T00:00:00Z")?));
//! assert_eq!((second.line, second.at.since(first.at).seconds()), (3, 4.0));
//! assert!((second.quaternion[2] - 0.5_f64.sqrt()).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod row;
mod table;
mod meta;
mod aem;
mod residuals;

pub use error::HistoryError;
pub use residuals::{ARCSECONDS_PER_RADIAN, Residual, residual_columns, residuals};
pub use row::Row;

use ephem::ccsds::Axes;
use onboard_core::time::Instant;

/// Whose components a quaternion gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// DE440's axes.
    Icrf,
    /// Ecliptic of J2000.
    Ecliptic,
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

impl History {
    /// Reads a file's text; `start` is the zero of `elapsed_s`.
    ///
    /// # Errors
    /// [`HistoryError`] with the line, the value and what would be legal.
    pub fn parse(text: &str, start: Instant) -> Result<Self, HistoryError> {
        let text = text.trim_start_matches('\u{feff}');
        let content = text.trim_start();
        if content.is_empty() {
            return Err(HistoryError::Empty);
        }
        let is_aem = ["<", "CCSDS_AEM_VERS", "COMMENT"].iter().any(|it| content.starts_with(it));
        let mut history = if is_aem {
            let aem = aem::read(text)?;
            let reference = aem.axes.map(|axes| match axes {
                Axes::Icrf => Reference::Icrf,
                Axes::Ecliptic => Reference::Ecliptic,
            });
            Self { form: aem.form, reference, rows: aem.rows }
        } else {
            Self { form: "CSV", reference: None, rows: table::read(text, start)? }
        };
        if history.rows.is_empty() {
            return Err(HistoryError::NoRows);
        }
        // Segments may overlap; rows within each rise.
        history.rows.sort_by_key(|row| row.at);
        Ok(history)
    }
}
