//! One body's series over a mission.
//!
//! Between two breaks: sample the sky into a master, search for the shortest series, compare them
//! with the sky between their nodes, and go tighter if they miss.
//!
//! Where tabulated data is too rough for that (its interpolation bends at every row by its own
//! noise): a body seen from a rough trajectory is fitted to a tenfold tolerance, up to the one for
//! rough trajectories; a user's direction table, or anything else that fails, is fitted between its
//! rows, each of which becomes a break.

use super::error::FitError;
use super::master::{Master, MasterError};
use super::options::FitOptions;
use super::shape::{Search, Tables};
use crate::apparent::{Sky, SkyError};
use crate::chebyshev::{Transform, value, zeros};
use crate::convert::{f64_from_i64, i64_from_f64};
use crate::sight::Sight;
use crate::source::Place;
use nalgebra::Vector3;
use onboard_core::time::{Duration, Instant};

/// Points at which a granule is compared with the sky, per coefficient.
const POINTS_PER_COEFFICIENT: usize = 4;
/// Shares of the tolerance that are tried in turn.
const SHARES: [f64; 4] = [0.97, 0.75, 0.5, 0.25];
/// Breaks closer than this to the one before are passed over.
const SHORTEST_SPAN_NS: i64 = 1_000_000;

/// One span's series, ready to be written.
pub(super) struct FittedSpan {
    pub(super) start: Instant,
    pub(super) granule_ns: i64,
    pub(super) granules: Vec<Vec<Vector3<f64>>>,
    pub(super) max_error_rad: f64,
}

impl FittedSpan {
    /// End of the last granule.
    fn end(&self) -> Instant {
        let count = i64::try_from(self.granules.len()).unwrap_or(i64::MAX);
        self.start.plus(Duration::from_ns(self.granule_ns.saturating_mul(count)))
    }

    pub(super) fn coefficients(&self) -> usize {
        self.granules.first().map_or(0, Vec::len)
    }
}

/// One body's fit.
pub(super) struct Job<'a> {
    pub(super) sky: &'a Sky,
    pub(super) sight: Sight<'a>,
    pub(super) tables: &'a Tables,
    /// The masters' transform.
    pub(super) transform: &'a Transform,
}

impl Job<'_> {
    /// Fits the body from `start` to `end`.
    pub(super) fn fit(
        &self,
        start: Instant,
        end: Instant,
        options: &FitOptions,
    ) -> Result<Vec<FittedSpan>, FitError> {
        let inside = |edges: Vec<Instant>| {
            edges.into_iter().filter(move |edge| *edge > start && *edge < end)
        };
        let mut breaks: Vec<Instant> = inside(self.sky.trajectory.breaks()).collect();
        let tabulated = matches!(self.sight, Sight::Source(source) if matches!(source.place(), Place::Table(_)));
        let mut tolerance_rad = options.tolerance_rad;
        let rough = loop {
            match self.spans(start, end, &breaks, tolerance_rad) {
                Err(rough @ FitError::TooRough { .. }) => {
                    if tabulated || tolerance_rad >= options.rough_tolerance_rad {
                        break rough;
                    }
                    tolerance_rad = (10.0 * tolerance_rad).min(options.rough_tolerance_rad);
                }
                other => return other,
            }
        };
        let smooth = breaks.len();
        breaks.extend(inside(self.sight.joints(self.sky)));
        if breaks.len() == smooth {
            return Err(rough);
        }
        breaks.sort_unstable();
        self.spans(start, end, &breaks, options.tolerance_rad)
    }

    fn spans(
        &self,
        start: Instant,
        end: Instant,
        breaks: &[Instant],
        tolerance_rad: f64,
    ) -> Result<Vec<FittedSpan>, FitError> {
        let mut spans: Vec<FittedSpan> = Vec::with_capacity(breaks.len() + 1);
        let mut from = start;
        for edge in breaks {
            if edge.since(from).ns() < SHORTEST_SPAN_NS {
                continue;
            }
            let span = self.span(from, *edge, false, tolerance_rad)?;
            from = span.end();
            spans.push(span);
        }
        spans.push(self.span(from, end, true, tolerance_rad)?);
        Ok(spans)
    }

    /// Fits one smooth span; the last one covers its end.
    fn span(
        &self,
        start: Instant,
        end: Instant,
        last: bool,
        tolerance_rad: f64,
    ) -> Result<FittedSpan, FitError> {
        let length_ns = end.since(start).ns();
        let at = |offset_ns: i64| start.plus(Duration::from_ns(offset_ns));
        let truth = |offset_ns: i64| self.sight.vector(self.sky, at(offset_ns));
        let too_rough = |at_ns: i64, reached_rad: f64| FitError::TooRough {
            name: self.sight.name().to_owned(),
            at: at(at_ns),
            reached_rad,
            tolerance_rad,
        };
        let master =
            Master::build(self.transform, truth, length_ns, tolerance_rad).map_err(|error| {
                match error {
                    MasterError::Sample(fault) => FitError::Sky(fault),
                    MasterError::Rough(rough) => too_rough(rough.at_ns, rough.reached_rad),
                }
            })?;
        let search = Search { tables: self.tables, master: &master, length_ns };
        let mut worst = (0, f64::INFINITY);
        for share in SHARES {
            let Some(shape) = search.shortest(share * tolerance_rad) else { break };
            let granule_ns = search.granule_ns(shape.granules, last);
            let granules: Vec<Vec<Vector3<f64>>> =
                (0..shape.granules).map(|index| search.series(shape, index, granule_ns)).collect();
            let span = FittedSpan { start, granule_ns, granules, max_error_rad: 0.0 };
            worst = self.worst(&span, length_ns)?;
            if worst.1 <= tolerance_rad {
                return Ok(FittedSpan { max_error_rad: worst.1, ..span });
            }
        }
        Err(too_rough(worst.0, worst.1))
    }

    /// Where, and by how much, a span differs most from the sky, between the nodes.
    fn worst(&self, span: &FittedSpan, length_ns: i64) -> Result<(i64, f64), SkyError> {
        let length = f64_from_i64(span.granule_ns);
        let mut worst = (0, 0.0);
        for (index, series) in span.granules.iter().enumerate() {
            let origin = span.granule_ns.saturating_mul(i64::try_from(index).unwrap_or(i64::MAX));
            for x in zeros(POINTS_PER_COEFFICIENT * series.len() + 1) {
                let offset = (origin + i64_from_f64(length * (1.0 + x) / 2.0)).min(length_ns);
                let x = 2.0 * f64_from_i64(offset - origin) / length - 1.0;
                let at = span.start.plus(Duration::from_ns(offset));
                let truth = self.sight.vector(self.sky, at)?;
                let error = (value(series, x).normalize() - truth).norm();
                if error > worst.1 {
                    worst = (offset, error);
                }
            }
        }
        Ok(worst)
    }
}
