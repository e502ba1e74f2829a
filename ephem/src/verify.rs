//! Does a table say what the sky says.
//!
//! [`verify`] compares a table with a [`Sky`] at pseudo-random epochs, body by body: the largest
//! angle between the two, and whether the motion stays within the table's own bounds.
//!
//! Method: epochs from the splitmix64 generator, so that equal seeds give equal reports; the second
//! derivative is a difference of rates within one granule.
//!
//! Limits: sampling finds typical errors, not every peak; a hundred samples per granule come within
//! a few per cent.
//!
//! # Example
//! ```
//! use ephem::apparent::Sky;
//! use ephem::fit::{FitOptions, MILLIARCSECOND_RAD, fit};
//! use ephem::source::Source;
//! use ephem::time::parse_time;
//! use ephem::verify::verify;
//! use onboard_core::ephemeris::EphemerisTable;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let span = (parse_time("2032-04-01T00:00:00 TDB")?, parse_time("2032-05-01T00:00:00 TDB")?);
//! let sky = Sky::from_l2(span.0);
//! let sources = [Source::by_name("mars")?];
//! let fitted = fit(&sky, &sources, span, &FitOptions::UPLINK)?;
//! let table = EphemerisTable::parse(&fitted.bytes).map_err(|error| format!("{error:?}"))?;
//! for check in verify(table, &sky, &sources, 200, 1)? {
//!     assert!(check.max_error_rad < MILLIARCSECOND_RAD && check.bounds_hold, "{check:?}");
//! }
//! # Ok(())
//! # }
//! ```

use crate::apparent::{Sky, SkyError};
use crate::convert::i64_from_f64;
use crate::random::SplitMix64;
use crate::sight::Sight;
use crate::source::Source;
use nalgebra::Vector3;
use onboard_core::ephemeris::{EphemerisError, EphemerisTable, Span};
use onboard_core::time::{Duration, Instant};
use thiserror::Error;

/// Rounding allowed when motion is held against its bounds.
const SLACK: f64 = 1.0 + 1e-9;

/// Why a table cannot be verified.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum VerifyError {
    /// The table holds a body that is neither the Sun nor one of the sources.
    #[error("the table holds body {0}, which is not among the mission's sources")]
    UnknownBody(i32),
    /// The sky has no answer.
    #[error(transparent)]
    Sky(#[from] SkyError),
    /// The table has no answer.
    #[error("the table fails: {0:?}")]
    Table(EphemerisError),
}

/// How one body's part of a table compares with the sky.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyCheck {
    /// Body number in the table.
    pub body: i32,
    /// The source's name; `sun_to_spacecraft` for the Sun's.
    pub name: String,
    /// Largest angle found between table and sky, in radians.
    pub max_error_rad: f64,
    /// Where it was found.
    pub worst_at: Instant,
    /// Largest rate found over the bound stored.
    pub rate_over_bound: f64,
    /// Largest second derivative found over the bound stored.
    pub acceleration_over_bound: f64,
    /// Whether rate, second derivative and |z| stayed within the bounds stored.
    pub bounds_hold: bool,
}

/// Compares every body of a table with the sky at `samples` epochs each.
///
/// # Errors
/// [`VerifyError`]: a body that is not among the sources, or a sky that does not reach over it.
pub fn verify(
    table: EphemerisTable<'_>,
    sky: &Sky,
    sources: &[Source],
    samples: usize,
    seed: u64,
) -> Result<Vec<BodyCheck>, VerifyError> {
    let sights = Sight::all(sources);
    let mut bodies: Vec<(i32, Vec<Span>)> = Vec::new();
    for span in table.spans() {
        match bodies.last_mut() {
            Some((body, spans)) if *body == span.body => spans.push(span),
            _ => bodies.push((span.body, vec![span])),
        }
    }
    let mut random = SplitMix64(seed);
    let mut checks = Vec::with_capacity(bodies.len());
    for (body, spans) in bodies {
        let sight = sights.iter().find(|sight| sight.body() == body);
        let sight = sight.ok_or(VerifyError::UnknownBody(body))?;
        let comparison = Comparison { table, sky, sight: *sight, spans: &spans };
        checks.push(comparison.check(samples, &mut random)?);
    }
    Ok(checks)
}

struct Comparison<'a> {
    table: EphemerisTable<'a>,
    sky: &'a Sky,
    sight: Sight<'a>,
    spans: &'a [Span],
}

impl Comparison<'_> {
    fn check(&self, samples: usize, random: &mut SplitMix64) -> Result<BodyCheck, VerifyError> {
        let body = self.table.body(self.sight.body()).map_err(VerifyError::Table)?;
        let bounds = body.bounds();
        let (start, end) =
            body.coverage().unwrap_or((Instant::from_tai_ns(0), Instant::from_tai_ns(0)));
        let length = end.since(start).seconds();
        let mut check = BodyCheck {
            body: self.sight.body(),
            name: self.sight.name().to_owned(),
            max_error_rad: 0.0,
            worst_at: start,
            rate_over_bound: 0.0,
            acceleration_over_bound: 0.0,
            bounds_hold: true,
        };
        for _ in 0..samples {
            // The last granule may reach a few ns beyond the span that was fitted.
            let offset = i64_from_f64((length * random.unit() - 1e-6).max(0.0) * 1e9);
            let at = start.plus(Duration::from_ns(offset));
            let state = body.state(at).map_err(VerifyError::Table)?;
            let seen = Vector3::from(state.direction.xyz());
            let error = (seen - self.sight.vector(self.sky, at)?).norm();
            if error > check.max_error_rad {
                (check.max_error_rad, check.worst_at) = (error, at);
            }
            let rate = Vector3::from(state.rate_per_s);
            let share = rate.norm() / bounds.rate_rad_s;
            check.rate_over_bound = check.rate_over_bound.max(share);
            check.bounds_hold &= rate.norm() <= bounds.rate_rad_s * SLACK;
            check.bounds_hold &= seen.z.abs() <= bounds.max_abs_z * SLACK;
            if let Some(later) = self.later_in_granule(at) {
                let next = body.state(later).map_err(VerifyError::Table)?;
                let step_s = later.since(at).seconds();
                let change = (Vector3::from(next.rate_per_s) - rate).norm() / step_s;
                // Rates carry rounding of 1e-16 of the coefficients' slopes.
                let noise = 1e-12 * bounds.rate_rad_s / step_s;
                let share = change / bounds.acceleration_per_s2;
                check.acceleration_over_bound = check.acceleration_over_bound.max(share);
                check.bounds_hold &= change <= bounds.acceleration_per_s2 * SLACK + noise;
            }
        }
        Ok(check)
    }

    /// An instant a thousandth of a granule later, if that lies in the same granule.
    fn later_in_granule(&self, at: Instant) -> Option<Instant> {
        let span = self.spans.iter().rev().find(|span| span.start <= at)?;
        let granule_ns = i64::try_from(span.granule_ns.get()).ok()?;
        let later = at.plus(Duration::from_ns((granule_ns / 1000).max(1)));
        let granule = |at: Instant| at.since(span.start).ns() / granule_ns;
        (granule(at) == granule(later)).then_some(later)
    }
}
