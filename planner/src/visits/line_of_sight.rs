//! A detector's line of sight over a span of time, and its visits of directions that do not move.
//!
//! Frame: `Ecliptic`, geometric, without aberration.
//!
//! Method: circles and fields of view by the flight core's certified search ([`transits`]) on a table
//! of the fixed direction.
//!
//! Limits: those of `onboard_core::transit`.

use super::fixed::{BODY, FixedDirection};
use super::visit::{Visit, transits};
use crate::survey::SunTable;
use onboard_core::attitude::attitude;
use onboard_core::direction::Direction;
use onboard_core::ephemeris::EphemerisError;
use onboard_core::field_of_view::FieldOfView;
use onboard_core::frame::{Boresight, Detector, Ecliptic};
use onboard_core::phase::Rotor;
use onboard_core::rotation::Rotation;
use onboard_core::scan::ScanStrategy;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use onboard_core::transit::Channel;
use thiserror::Error;

/// A line of sight over a span of time.
#[derive(Debug, Clone)]
pub struct LineOfSight {
    /// The scanning strategy.
    pub scan: ScanStrategy,
    /// Where the Sun is.
    pub sun: Sun,
    /// The detector's frame in the boresight frame; its z is the line of sight.
    pub detector: Rotation<Detector, Boresight>,
    /// First and last instant.
    pub ends: (Instant, Instant),
}

/// Where the Sun-to-spacecraft direction of a line of sight comes from.
#[derive(Debug, Clone)]
pub enum Sun {
    /// Uniform longitude on the scan clock, latitude 0.
    Circular(Rotor),
    /// From a table.
    Table(SunTable),
}

/// Why visits cannot be found.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum VisitsError {
    /// A table does not serve the span.
    #[error("the table does not serve the span: {0:?}")]
    Ephemeris(EphemerisError),
    /// The circle's radius (radians) is not in (0, pi].
    #[error("a circle of {0} rad: a radius above 0 and at most pi is needed")]
    Radius(f64),
}

impl From<EphemerisError> for VisitsError {
    fn from(error: EphemerisError) -> Self {
        Self::Ephemeris(error)
    }
}

impl LineOfSight {
    /// Where it points at `at`.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] beyond the Sun's table.
    pub fn direction(&self, at: Instant) -> Result<Direction<Ecliptic>, EphemerisError> {
        self.sight()?.direction(at)
    }

    /// No line of sight of this detector moves faster, in rad/s.
    ///
    /// # Errors
    /// [`EphemerisError`] where the Sun's table is none.
    pub fn largest_speed_rad_s(&self) -> Result<f64, EphemerisError> {
        Ok(self.sight()?.largest_speed_rad_s())
    }

    /// All visits of the circle of `radius_rad` about a fixed direction, in order.
    ///
    /// # Errors
    /// [`VisitsError`].
    pub fn circle_visits(
        &self,
        centre: Direction<Ecliptic>,
        radius_rad: f64,
    ) -> Result<Vec<Visit>, VisitsError> {
        self.sight()?.circle_visits(centre, radius_rad)
    }

    /// All intervals with a fixed direction inside a field of view, in order.
    ///
    /// # Errors
    /// [`VisitsError::Ephemeris`].
    pub fn field_visits(
        &self,
        centre: Direction<Ecliptic>,
        field: &FieldOfView,
    ) -> Result<Vec<Visit>, VisitsError> {
        self.sight()?.field_visits(centre, field)
    }

    /// The line of sight with its Sun as the flight core evaluates it.
    pub(super) fn sight(&self) -> Result<Sight<'_>, EphemerisError> {
        let sun = match &self.sun {
            Sun::Circular(longitude) => SunModel::Circular(*longitude),
            Sun::Table(table) => table.model()?,
        };
        Ok(Sight { scan: &self.scan, sun, detector: self.detector, ends: self.ends })
    }
}

/// A line of sight with the Sun's table open.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight<'t> {
    pub(super) scan: &'t ScanStrategy,
    pub(super) sun: SunModel<'t>,
    pub(super) detector: Rotation<Detector, Boresight>,
    pub(super) ends: (Instant, Instant),
}

impl Sight<'_> {
    pub(super) fn direction(&self, at: Instant) -> Result<Direction<Ecliptic>, EphemerisError> {
        let boresight = attitude(self.scan, &self.sun, at)?;
        Ok(boresight.apply(self.detector.apply(Direction::Z)))
    }

    pub(super) fn largest_speed_rad_s(&self) -> f64 {
        let parameters = self.scan.parameters();
        let bounds = self.sun.bounds();
        let cos_latitude = (1.0 - bounds.max_abs_z * bounds.max_abs_z).max(1e-12).sqrt();
        let turning = parameters.spin.rate.radians_per_second().abs() * self.sine_from_spin_axis()
            + parameters.precession.rate.radians_per_second().abs()
            + bounds.rate_rad_s / cos_latitude;
        turning * (1.0 + 1e-9)
    }

    /// Sine of the angle between the spin axis and the line of sight.
    pub(super) fn sine_from_spin_axis(&self) -> f64 {
        let [x, y, _] =
            self.scan.boresight_in_spin().apply(self.detector.apply(Direction::Z)).xyz();
        x.hypot(y)
    }

    pub(super) fn circle_visits(
        &self,
        centre: Direction<Ecliptic>,
        radius_rad: f64,
    ) -> Result<Vec<Visit>, VisitsError> {
        let field = FieldOfView::circle(self.detector, radius_rad)
            .map_err(|_| VisitsError::Radius(radius_rad))?;
        self.field_visits(centre, &field)
    }

    fn field_visits(
        &self,
        centre: Direction<Ecliptic>,
        field: &FieldOfView,
    ) -> Result<Vec<Visit>, VisitsError> {
        let fixed = FixedDirection::new(centre, self.ends);
        let body = fixed.table()?.body(BODY)?;
        let found = transits(Channel::new(self.scan, self.sun, body, field, self.ends))?;
        Ok(found.iter().map(Visit::from).collect())
    }
}
