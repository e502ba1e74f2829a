//! Why there is no table, in sentences.

use crate::apparent::SkyError;
use crate::time::format_tdb;
use onboard_core::time::Instant;
use thiserror::Error;

/// Why there is no table.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FitError {
    /// The tolerance is out of range.
    #[error("the table's tolerance is {0} rad; legal is 1e-12 to 1e-3")]
    Tolerance(f64),
    /// The tolerance for rough trajectories is out of range.
    #[error(
        "the table's tolerance for rough trajectories is {found} rad; legal is {least} to 1e-3"
    )]
    RoughTolerance {
        /// Its value.
        found: f64,
        /// The other tolerance.
        least: f64,
    },
    /// The number of coefficients is out of range.
    #[error("the table's most coefficients are {0}; legal is 4 to 64")]
    Coefficients(u16),
    /// The span is empty.
    #[error(
        "the table's span runs from {} to {} TDB; the end must be later than the start",
        format_tdb(*start), format_tdb(*end)
    )]
    Span {
        /// Its start.
        start: Instant,
        /// Its end.
        end: Instant,
    },
    /// Two sources have one body number.
    #[error("the source '{name}' is given twice (body number {body})")]
    Twice {
        /// Its name.
        name: String,
        /// The number.
        body: i32,
    },
    /// The sky has no answer within the span.
    #[error(transparent)]
    Sky(#[from] SkyError),
    /// No granule of 60 s or more is good enough.
    #[error(
        "the direction of '{name}' is too rough at {} TDB: granules of 60 s reach {reached_rad:.1e} rad, not {tolerance_rad:.1e}",
        format_tdb(*at)
    )]
    TooRough {
        /// The source.
        name: String,
        /// Where.
        at: Instant,
        /// Error reached.
        reached_rad: f64,
        /// Tolerance asked for.
        tolerance_rad: f64,
    },
    /// More numbers than a table can count.
    #[error("the table would hold {0} coefficients; legal is below 4294967296")]
    TooLarge(u64),
}
