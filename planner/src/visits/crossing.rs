//! When does the line of sight enter and leave a pixel.
//!
//! Frames: the line of sight is a detector's z axis in `Ecliptic`; the pixel too.
//!
//! Method: the flight core's search on the circle that holds the pixel gives the intervals in which
//! the pixel can be visited, none missed. Inside each, from every instant a span is skipped in which
//! no edge can be crossed: [`Boundary::clearance_rad`] over the largest speed of the line of sight,
//! `|w_b| sin beta_d + |w_a| + the anti-Sun frame's`. Where that span is short, the path over the next
//! piece is a cubic whose error is bounded (module `arc`), the clearance is reduced by that error,
//! and attitudes are needed at the piece's ends only. Steps shrink towards an edge; once they are
//! shorter than the tolerance, one step of that length is made, and a change of side is confirmed by
//! the attitude and closed in on by bisection to a nanosecond. So every corner cut deeper than the
//! tolerance is found.
//!
//! Limits: visits that reach less deep than [`DEPTH_TOLERANCE_RAD`] may be missed, as may absences
//! of that depth. `planner/tests/pixel_visits.rs` compares with dense sampling.

use super::arc::{self, Arc, ERROR_RAD, Motion};
use super::boundary::Boundary;
use super::line_of_sight::{LineOfSight, Sight, VisitsError};
use super::visit::Visit;
use onboard_core::ephemeris::EphemerisError;
use onboard_core::time::{Duration, Instant};

/// Depth below which a visit, or an absence between two, may be missed.
pub const DEPTH_TOLERANCE_RAD: f64 = 1e-9;

impl LineOfSight {
    /// All visits of a pixel, in order.
    ///
    /// # Errors
    /// [`VisitsError`].
    pub fn pixel_visits(&self, pixel: &Boundary) -> Result<Vec<Visit>, VisitsError> {
        let sight = &self.sight()?;
        let (centre, radius_rad) = pixel.enclosing_circle();
        let near = sight.circle_visits(centre, radius_rad)?;
        let walk = Walk {
            line: sight,
            pixel,
            speed: sight.largest_speed_rad_s(),
            longest: arc::longest(sight),
        };
        let mut visits = Vec::new();
        for interval in &near {
            walk.inside(interval, &mut visits)?;
        }
        Ok(visits)
    }
}

/// The way along a line of sight near a pixel.
struct Walk<'w, 'a> {
    line: &'w Sight<'a>,
    pixel: &'w Boundary,
    /// Largest speed in rad/s.
    speed: f64,
    /// Longest piece of the path.
    longest: Duration,
}

/// A visit in progress: its first instant, and whether that is the search's start.
type Entry = Option<(Instant, bool)>;

impl Walk<'_, '_> {
    fn clearance(&self, at: Instant) -> Result<f64, EphemerisError> {
        Ok(self.pixel.clearance_rad(self.line.direction(at)?))
    }

    /// From a clearance, how long surely no edge is crossed; of the tolerance's order at least.
    fn step(&self, clearance: f64) -> Duration {
        let certain = clearance.max(DEPTH_TOLERANCE_RAD) / self.speed;
        Duration::from_ns(Duration::from_seconds_floor(certain).ns().max(1))
    }

    /// The visits within one interval near the pixel.
    fn inside(&self, interval: &Visit, visits: &mut Vec<Visit>) -> Result<(), EphemerisError> {
        let mut here = Motion::of(self.line, interval.entry)?;
        let mut clearance = self.pixel.clearance_rad(here.direction);
        // Inside at the start of the interval: only where that is the search's start.
        let mut entry: Entry = (clearance >= 0.0).then_some((here.at, interval.entry_clipped));
        while here.at < interval.exit {
            let free = self.step(clearance.abs());
            let leap = free >= self.longest && clearance.abs() > DEPTH_TOLERANCE_RAD;
            let span = if leap { free } else { self.longest };
            let next = Motion::of(self.line, here.at.plus(span).min(interval.exit))?;
            if !leap {
                self.along(&here, &next, &mut entry, visits)?;
            }
            here = next;
            clearance = self.pixel.clearance_rad(here.direction);
        }
        if let Some((entry, entry_clipped)) = entry {
            let exit_clipped = interval.exit_clipped;
            visits.push(Visit { entry, exit: interval.exit, entry_clipped, exit_clipped });
        }
        Ok(())
    }

    /// Changes of side along one piece; at its ends the side is the attitude's own.
    fn along(
        &self,
        from: &Motion,
        to: &Motion,
        entry: &mut Entry,
        visits: &mut Vec<Visit>,
    ) -> Result<(), EphemerisError> {
        let arc = Arc::between(from, to);
        // The last instant at which the side is certain, and where the walk stands.
        let (mut sure, mut at) = (from.at, from.at);
        let mut clearance = self.pixel.clearance_rad(from.direction).abs();
        while at < to.at {
            at = at.plus(self.step(clearance - ERROR_RAD)).min(to.at);
            let inside = entry.is_some();
            let seen = self.pixel.clearance_rad(arc.direction(at));
            clearance = seen.abs();
            let certain = clearance > ERROR_RAD;
            let side = seen >= 0.0;
            if certain && side == inside {
                sure = at;
            } else if (side != inside || at == to.at) && (self.clearance(at)? >= 0.0) != inside {
                let (before, after) = bisect(|at| self.clearance(at), sure, at, inside)?;
                match entry.take() {
                    // First instant inside, last instant inside.
                    None => *entry = Some((after, false)),
                    Some((entry, entry_clipped)) => visits.push(Visit {
                        entry,
                        exit: before,
                        entry_clipped,
                        exit_clipped: false,
                    }),
                }
                sure = at;
            }
        }
        Ok(())
    }
}

/// Two instants one nanosecond apart with a change of side between them.
fn bisect(
    clearance: impl Fn(Instant) -> Result<f64, EphemerisError>,
    mut before: Instant,
    mut after: Instant,
    inside_before: bool,
) -> Result<(Instant, Instant), EphemerisError> {
    while after.since(before).ns() > 1 {
        let middle = before.plus(Duration::from_ns(after.since(before).ns() / 2));
        if (clearance(middle)? >= 0.0) == inside_before {
            before = middle;
        } else {
            after = middle;
        }
    }
    Ok((before, after))
}
