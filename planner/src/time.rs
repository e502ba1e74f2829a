//! What is an instant called: the instants and durations of plans, and their civil times.
//!
//! An [`Instant`] counts ns of TAI since 2000-01-01T12:00:00 TAI. Its text is UTC or TDB to the ns; a
//! text that is read names its scale. These are the flight core's and `ephem`'s own, here so that a
//! reader of plans needs neither crate.
//!
//! Limits: those of [`ephem::time`].
//!
//! # Example
//! ```
//! use planner::time::{Duration, format_tdb, format_utc, parse_time};
//!
//! let start = parse_time("2032-04-01T00:00:00 TDB")?;
//! assert_eq!(format_utc(start), "2032-03-31T23:58:50.814344741Z");
//! let later = start.plus(Duration::from_seconds(3600.0));
//! assert_eq!(format_tdb(later), "2032-04-01T01:00:00.000000055");
//! # Ok::<(), planner::time::TimeError>(())
//! ```

pub use ephem::time::{TimeError, format_tdb, format_utc, parse_time};
pub use onboard_core::time::{Duration, Instant};
