//! The table that tells the flight core where everything is.
//!
//! [`fit`] turns a [`Sky`] into the bytes of `onboard_core::ephemeris`: the geometric
//! Sun-to-spacecraft direction and the directions of the sources over a span, as Chebyshev series in
//! the ecliptic of J2000, with bounds on their motion.
//!
//! Method: between two breaks of the trajectory, granules of equal length; their number and order
//! make the fewest bytes within the tolerance (`shape`). Series meet at joints, so that a table is
//! continuous but for its breaks. The error stated is measured against the sky itself between the
//! nodes (`body`), which also says what happens where tabulated data is rough.
//!
//! Limits: tolerances from 1e-12 rad. A break is moved earlier by less than a ns per granule of the
//! span before it, so that spans meet. A granule shorter than 60 s is refused. Default: the Sun and
//! five planets over three years within 1 mas take 14.6 KiB (`tests/fit.rs`).
//!
//! # Example
//! ```
//! use ephem::apparent::Sky;
//! use ephem::fit::{FitOptions, MILLIARCSECOND_RAD, fit};
//! use ephem::source::Source;
//! use ephem::time::parse_time;
//! use onboard_core::ephemeris::EphemerisTable;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let span = (parse_time("2032-04-01T00:00:00 TDB")?, parse_time("2032-05-01T00:00:00 TDB")?);
//! let sky = Sky::from_l2(span.0);
//! let jupiter = Source::by_name("jupiter")?;
//! let fitted = fit(&sky, std::slice::from_ref(&jupiter), span, &FitOptions::UPLINK)?;
//! assert!(fitted.bodies.iter().all(|body| body.max_error_rad <= MILLIARCSECOND_RAD));
//! let table = EphemerisTable::parse(&fitted.bytes).map_err(|error| format!("{error:?}"))?;
//! let state = table.body(jupiter.body()).and_then(|body| body.state(span.0));
//! let onboard = state.map_err(|error| format!("{error:?}"))?.direction;
//! assert!(onboard.separation_rad(sky.direction(&jupiter, span.0)?) < 2.0 * MILLIARCSECOND_RAD);
//! # Ok(())
//! # }
//! ```

mod error;
mod options;
mod bounds;
mod master;
mod shape;
mod body;

pub use error::FitError;
pub use options::{FitOptions, MILLIARCSECOND_RAD};

use crate::apparent::Sky;
use crate::chebyshev::Transform;
use crate::sight::Sight;
use crate::source::Source;
use body::{FittedSpan, Job};
use core::num::NonZeroU64;
use onboard_core::direction::MotionBounds;
use onboard_core::ephemeris::{BodyRecord, HEADER_BYTES, SPAN_BYTES, Span, table_header};
use onboard_core::time::Instant;
use shape::Tables;

/// How one body was fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyFit {
    /// Body number in the table.
    pub body: i32,
    /// The source's name; `sun_to_spacecraft` for the Sun's.
    pub name: String,
    /// Spans, between breaks.
    pub spans: usize,
    /// Coefficients per component; of the largest span.
    pub coefficients: usize,
    /// Granules of all spans.
    pub granules: usize,
    /// Bytes in the table.
    pub bytes: usize,
    /// Largest angle measured between table and sky.
    pub max_error_rad: f64,
}

/// A table and how it was fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedTable {
    /// The table, as `onboard_core::ephemeris::EphemerisTable::parse` reads it.
    pub bytes: Vec<u8>,
    /// Its bodies, by number.
    pub bodies: Vec<BodyFit>,
}

/// Fits the Sun-to-spacecraft direction and the sources over a span.
///
/// # Errors
/// [`FitError`]: illegal options, a sky that does not reach over the span, or directions too rough.
pub fn fit(
    sky: &Sky,
    sources: &[Source],
    span: (Instant, Instant),
    options: &FitOptions,
) -> Result<FittedTable, FitError> {
    let (start, end) = span;
    options.check()?;
    if start >= end {
        return Err(FitError::Span { start, end });
    }
    let sights = Sight::all(sources);
    if let Some([_, second]) =
        sights.windows(2).find(|w| matches!(w, [a, b] if a.body() == b.body()))
    {
        return Err(FitError::Twice { name: second.name().to_owned(), body: second.body() });
    }
    // An instant outside kernel, trajectory or table is best named before any work.
    for sight in &sights {
        sight.vector(sky, start)?;
        sight.vector(sky, end)?;
    }
    let tables = Tables::new(usize::from(options.max_coefficients));
    let transform = Transform::new(master::ORDERS);
    let mut fitted = Vec::with_capacity(sights.len());
    for sight in sights {
        let job = Job { sky, sight, tables: &tables, transform: &transform };
        fitted.push((sight, job.fit(start, end, options)?));
    }
    write(&fitted)
}

/// Writes the table's bytes and sums up its bodies.
fn write(fitted: &[(Sight<'_>, Vec<FittedSpan>)]) -> Result<FittedTable, FitError> {
    let (mut records, mut data, mut bodies) = (Vec::new(), Vec::<u8>::new(), Vec::new());
    let mut directory = Vec::new();
    let too_large = |bytes: usize| FitError::TooLarge(u64::try_from(bytes / 8).unwrap_or(u64::MAX));
    for (sight, spans) in fitted {
        let size_before = directory.len() + records.len() + data.len();
        let first_span = records.len() / SPAN_BYTES;
        let mut largest = MotionBounds::NONE;
        for span in spans {
            let first = u32::try_from(data.len() / 8).map_err(|_| too_large(data.len()))?;
            let granules = span.granules.len();
            let (Ok(coefficients), Ok(count), Some(granule_ns)) = (
                u16::try_from(span.coefficients()),
                u32::try_from(granules),
                u64::try_from(span.granule_ns).ok().and_then(NonZeroU64::new),
            ) else {
                return Err(too_large(granules.saturating_mul(span.coefficients())));
            };
            let record = Span {
                body: sight.body(),
                coefficients,
                granules: count,
                first,
                start: span.start,
                granule_ns,
                bounds: bounds::motion_bounds(&span.granules, span.granule_ns),
            };
            largest = largest.and(&record.bounds);
            records.extend(record.to_le_bytes());
            for number in span.granules.iter().flatten().flat_map(|c| [c.x, c.y, c.z]) {
                data.extend(number.to_le_bytes());
            }
        }
        let (Ok(count), Ok(first)) = (u32::try_from(spans.len()), u32::try_from(first_span)) else {
            return Err(too_large(data.len()));
        };
        let body = BodyRecord { body: sight.body(), spans: count, first, bounds: largest };
        directory.extend(body.to_le_bytes());
        bodies.push(BodyFit {
            body: sight.body(),
            name: sight.name().to_owned(),
            spans: spans.len(),
            coefficients: spans.iter().map(FittedSpan::coefficients).max().unwrap_or(0),
            granules: spans.iter().map(|span| span.granules.len()).sum(),
            bytes: directory.len() + records.len() + data.len() - size_before,
            max_error_rad: spans.iter().map(|span| span.max_error_rad).fold(0.0, f64::max),
        });
    }
    let numbers = u32::try_from(data.len() / 8).map_err(|_| too_large(data.len()))?;
    let spans = u32::try_from(records.len() / SPAN_BYTES).map_err(|_| too_large(data.len()))?;
    let count = u32::try_from(bodies.len()).map_err(|_| too_large(data.len()))?;
    let size = HEADER_BYTES + directory.len() + records.len() + data.len();
    let mut bytes = Vec::with_capacity(size);
    bytes.extend(table_header(count, spans, numbers));
    bytes.extend(directory);
    bytes.extend(records);
    bytes.extend(data);
    Ok(FittedTable { bytes, bodies })
}
