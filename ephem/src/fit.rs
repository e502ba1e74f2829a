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
//! five planets over three years within 1 mas take 12.4 KiB (`tests/fit.rs`).

mod body;
mod bounds;
mod master;
mod shape;

use crate::apparent::{Sky, SkyError};
use crate::chebyshev::Transform;
use crate::sight::Sight;
use crate::source::Source;
use crate::time::format_tdb;
use body::{FittedSpan, Job};
use core::f64::consts::PI;
use core::num::NonZeroU64;
use onboard_core::ephemeris::{MAX_COEFFICIENTS, SPAN_BYTES, Span};
use onboard_core::time::Instant;
use shape::Tables;
use thiserror::Error;

/// One milliarcsecond in radians.
pub const MILLIARCSECOND_RAD: f64 = PI / (180.0 * 3_600_000.0);

/// Smallest tolerance that the rounding of times and states allows.
const SMALLEST_TOLERANCE_RAD: f64 = 1e-12;
const LARGEST_TOLERANCE_RAD: f64 = 1e-3;
const FEWEST_COEFFICIENTS: u16 = 4;

/// How well to fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// Largest angle between table and sky in radians, 1e-12 to 1e-3.
    pub tolerance_rad: f64,
    /// Largest angle where a tabulated trajectory is too rough for that one; not below it.
    ///
    /// The tolerance then grows tenfold up to this, for the bodies concerned.
    pub rough_tolerance_rad: f64,
    /// Most coefficients of a granule, 4 to 64: fewer are quicker to evaluate, more take less space.
    pub max_coefficients: u16,
}

impl FitOptions {
    /// For uplink: within 1 mas, few bytes, and short enough series to be quick on board.
    pub const UPLINK: Self = Self {
        tolerance_rad: MILLIARCSECOND_RAD,
        rough_tolerance_rad: MILLIARCSECOND_RAD,
        max_coefficients: 24,
    };
    /// For the ground: as exact as the sky itself, quick to evaluate; 1 mas on a rough trajectory.
    pub const GROUND: Self = Self {
        tolerance_rad: 5e-12,
        rough_tolerance_rad: MILLIARCSECOND_RAD,
        max_coefficients: 16,
    };
}

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
    let tolerance = options.tolerance_rad;
    if !(SMALLEST_TOLERANCE_RAD..=LARGEST_TOLERANCE_RAD).contains(&tolerance) {
        return Err(FitError::Tolerance(tolerance));
    }
    let found = options.rough_tolerance_rad;
    if !(tolerance..=LARGEST_TOLERANCE_RAD).contains(&found) {
        return Err(FitError::RoughTolerance { found, least: tolerance });
    }
    if !(FEWEST_COEFFICIENTS..=MAX_COEFFICIENTS).contains(&options.max_coefficients) {
        return Err(FitError::Coefficients(options.max_coefficients));
    }
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
    let too_large = |bytes: usize| FitError::TooLarge(u64::try_from(bytes / 8).unwrap_or(u64::MAX));
    for (sight, spans) in fitted {
        let size_before = records.len() + data.len();
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
            records.extend(record.to_le_bytes());
            for number in span.granules.iter().flatten().flat_map(|c| [c.x, c.y, c.z]) {
                data.extend(number.to_le_bytes());
            }
        }
        bodies.push(BodyFit {
            body: sight.body(),
            name: sight.name().to_owned(),
            spans: spans.len(),
            coefficients: spans.iter().map(FittedSpan::coefficients).max().unwrap_or(0),
            granules: spans.iter().map(|span| span.granules.len()).sum(),
            bytes: records.len() + data.len() - size_before,
            max_error_rad: spans.iter().map(|span| span.max_error_rad).fold(0.0, f64::max),
        });
    }
    let numbers = u32::try_from(data.len() / 8).map_err(|_| too_large(data.len()))?;
    let spans = u32::try_from(records.len() / SPAN_BYTES).map_err(|_| too_large(data.len()))?;
    let mut bytes = Vec::with_capacity(8 + records.len() + data.len());
    bytes.extend(spans.to_le_bytes());
    bytes.extend(numbers.to_le_bytes());
    bytes.extend(records);
    bytes.extend(data);
    Ok(FittedTable { bytes, bodies })
}
