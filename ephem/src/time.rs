//! What time is it on TDB, UTC, TT and TAI, and in text.
//!
//! [`Instant`](onboard_core::time::Instant) counts ns of TAI since 2000-01-01T12:00:00 TAI. TDB
//! counts ns since 2000-01-01T12:00:00 TDB, days of UTC since 2000-01-01.
//!
//! Method: integers throughout. TDB is SPICE's ephemeris time, TDB - TAI = 32.184 s + K sin E with
//! hifitime's NAIF constants, rounded once to the ns; leap seconds are hifitime's table of IERS.
//!
//! Limits: this TDB lies within 35 us of the full theory, 17 us rms (`tests/time.rs`). UTC exists
//! from 1972; earlier instants are written with the first offset, 10 s. Years 1708 to 2291.
//!
//! # Example
//! ```
//! use ephem::time::{TimeError, format_tdb, format_utc, parse_time, utc_day, utc_midnight};
//!
//! let start = parse_time("2032-04-01T00:00:00 TDB")?;
//! assert_eq!(format_tdb(start), "2032-04-01T00:00:00.000000000");
//! assert!(format_utc(start).starts_with("2032-03-31T23:58:50.8143"));
//! assert_eq!(format_utc(utc_midnight(utc_day(start))), "2032-03-31T00:00:00.000000000Z");
//! // By day of the year too; a text without its scale is refused.
//! assert_eq!(parse_time("2032-092T00:00:00 TDB")?, start);
//! assert!(matches!(parse_time("2032-04-01T00:00:00"), Err(TimeError::NoScale(_))));
//! # Ok::<(), TimeError>(())
//! ```

mod calendar;
mod decimals;
mod scale;
mod tdb;
mod utc;
mod text;

pub use calendar::civil_from_day;
pub use scale::Scale;
pub use tdb::{from_epoch, from_tdb_ns, tdb_ns, tdb_seconds, to_epoch};
pub use text::{TimeError, format_tdb, format_utc, parse_in_scale, parse_time};
pub use utc::{last_leap_second, utc_day, utc_midnight};

pub(crate) use decimals::exact_ns;
pub(crate) use tdb::from_tdb_seconds;
