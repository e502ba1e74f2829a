//! When does a bright body come too near to a field of view.
//!
//! An [`AvoidanceLimit`] keeps a body (the Sun, the Earth, the Moon) at an angle from every point of
//! a field of view; [`AvoidanceFinder`] predicts every interval in which it does not.
//!
//! Frames: directions in [`Boresight`]. The body is found in the tables by the limit's number: as a
//! target the Sun is 999999 there, the Earth 399, the Moon 301.
//!
//! Method: the directions within the limit of a field of view are that field, enlarged; a violation
//! is a transit through it, found by the same certified search. A circle enlarged is a circle. For a
//! rectangle `f = max over its points p of p . w - cos angle`: each point's second derivative is
//! bounded, so what the largest can be after h seconds is known and convex in h
//! (`transit/reach.rs`).
//!
//! Limits: as the transit finder's: violations shallower than
//! [`SEPARATION_TOLERANCE_RAD`](crate::transit::SEPARATION_TOLERANCE_RAD) may go either way; the
//! body counts as a point, so its radius belongs into the angle. Start and end are exact; the least
//! angle to a rectangle is that at an instant evaluated, at most a sixteenth of a turn apart. `tests/tests/avoidance.rs` compares
//! with dense sampling.

use crate::direction::Direction;
use crate::ephemeris::EphemerisError;
use crate::field_of_view::FieldOfView;
use crate::frame::Boresight;
use crate::time::Instant;
use crate::transit::{Channel, Step, Transit, TransitFinder};
use core::f64::consts::PI;
use serde::{Deserialize, Serialize};

/// Angle in radians from a direction to the nearest point of a field of view, 0 inside.
#[must_use]
// REQ-AVOID-1.
pub fn angle_to_field_rad(field: &FieldOfView, direction: Direction<Boresight>) -> f64 {
    field.angle_to_rad(direction)
}

/// Why a limit cannot be.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum AvoidanceError {
    /// The angle (radians) is not in (0, pi].
    Angle(f64),
}

/// A body must stay at least at an angle from every point of a field of view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AvoidanceLimit {
    body: i32,
    angle_rad: f64,
}

/// Where a limit is violated.
#[derive(Debug, Clone, Copy)]
pub enum Zone {
    /// At every direction: the body cannot be far enough from the field of view.
    Everywhere,
    /// While the body is inside this field of view, to be searched by a
    /// [`Channel`].
    Inside(FieldOfView),
}

impl AvoidanceLimit {
    /// Keeps `body` (its number in the tables) at `angle_rad` or more.
    ///
    /// # Errors
    /// [`AvoidanceError::Angle`].
    pub fn new(body: i32, angle_rad: f64) -> Result<Self, AvoidanceError> {
        if !(angle_rad > 0.0 && angle_rad <= PI) {
            return Err(AvoidanceError::Angle(angle_rad));
        }
        Ok(Self { body, angle_rad })
    }

    /// Number of the body in the tables.
    #[must_use]
    pub const fn body(&self) -> i32 {
        self.body
    }

    /// Least legal angle in radians.
    #[must_use]
    pub const fn angle_rad(&self) -> f64 {
        self.angle_rad
    }

    /// Where the body violates the limit for this field of view.
    #[must_use]
    // REQ-AVOID-1.
    pub fn zone(&self, field: &FieldOfView) -> Zone {
        field.enlarged(self.angle_rad).map_or(Zone::Everywhere, Zone::Inside)
    }

    /// Whether the body, seen in `direction`, is nearer to the field of view than the limit.
    #[must_use]
    pub fn is_violated(&self, field: &FieldOfView, direction: Direction<Boresight>) -> bool {
        angle_to_field_rad(field, direction) < self.angle_rad
    }
}

/// A maximal interval with a limit violated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Violation {
    /// Index of the channel that found it.
    pub channel: usize,
    /// First instant in violation, or the search's start.
    pub start: Instant,
    /// Last instant in violation, or the search's end.
    pub end: Instant,
    /// Instant of the smallest angle (the first that was evaluated, where the body goes inside).
    pub closest: Instant,
    /// Smallest angle between body and field of view in radians, 0 inside; of a rectangle the
    /// smallest that was evaluated, where the track approaches more than once in a step.
    pub least_angle_rad: f64,
    /// The limit was violated already at the search's start.
    pub start_clipped: bool,
    /// The limit was still violated at the search's end.
    pub end_clipped: bool,
}

impl Violation {
    const fn new(transit: &Transit) -> Self {
        Self {
            channel: transit.channel,
            start: transit.entry,
            end: transit.exit,
            closest: transit.closest,
            least_angle_rad: transit.min_separation_rad,
            start_clipped: transit.entry_clipped,
            end_clipped: transit.exit_clipped,
        }
    }
}

/// What one step of the search brought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AvoidanceStep {
    /// The next violation in order.
    Violation(Violation),
    /// Nothing yet: no violation that is still to come begins before this instant.
    Searched(Instant),
    /// All channels have reached their end.
    Done,
    /// A channel (its index) could not be evaluated; it stands where it was, and the others go on.
    Failed {
        /// Index of the channel.
        channel: usize,
        /// Why.
        error: EphemerisError,
    },
}

/// A search for violations over channels in lent memory, each on the field of a [`Zone::Inside`].
#[derive(Debug)]
pub struct AvoidanceFinder<'c, 'a> {
    finder: TransitFinder<'c, 'a>,
}

impl<'c, 'a> AvoidanceFinder<'c, 'a> {
    /// A search over these channels; their order breaks ties.
    #[must_use]
    pub fn new(channels: &'c mut [Channel<'a>]) -> Self {
        Self { finder: TransitFinder::new(channels) }
    }

    /// The channels, for saving their states and counting their evaluations.
    #[must_use]
    pub fn channels(&self) -> &[Channel<'a>] {
        self.finder.channels()
    }

    /// Advances the channel that is furthest behind, or hands out the next violation, as
    /// [`TransitFinder::step`] does.
    ///
    /// At most [`MAX_EVALUATIONS_PER_STEP`](crate::transit::MAX_EVALUATIONS_PER_STEP) evaluations.
    pub fn step(&mut self) -> AvoidanceStep {
        match self.finder.step() {
            Step::Transit(transit) => AvoidanceStep::Violation(Violation::new(&transit)),
            Step::Searched(until) => AvoidanceStep::Searched(until),
            Step::Done => AvoidanceStep::Done,
            Step::Failed { channel, error } => AvoidanceStep::Failed { channel, error },
        }
    }
}
