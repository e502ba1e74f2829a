//! Directions that do not move, as a table that the flight core's search reads.
//!
//! Frame: `Ecliptic`; geometric, nothing is corrected.
//!
//! Method: one span of one granule with one coefficient per direction; the bounds on its motion are
//! zero, so that only the Sun's motion limits the search's steps.

use onboard_core::direction::{Direction, MotionBounds};
use onboard_core::ephemeris::{
    BodyRecord, EphemerisError, EphemerisTable, FIRST_USER_BODY, Span, table_header,
};
use onboard_core::frame::Ecliptic;
use onboard_core::time::Instant;
use std::num::NonZeroU64;

/// One fixed direction over a span of time, as table bytes.
#[derive(Debug, Clone)]
pub(super) struct FixedDirection {
    bytes: Vec<u8>,
}

/// The body number of the direction in its table.
pub(super) const BODY: i32 = FIRST_USER_BODY;

impl FixedDirection {
    /// The table of `direction` from `start` to `end`; an empty span is taken as one nanosecond.
    #[must_use]
    pub(super) fn new(direction: Direction<Ecliptic>, (start, end): (Instant, Instant)) -> Self {
        let length = u64::try_from(end.since(start).ns()).ok().and_then(NonZeroU64::new);
        let span = Span {
            body: BODY,
            coefficients: 1,
            granules: 1,
            first: 0,
            start,
            granule_ns: length.unwrap_or(NonZeroU64::MIN),
            bounds: MotionBounds { rate_rad_s: 0.0, acceleration_per_s2: 0.0, max_abs_z: 1.0 },
        };
        let record = BodyRecord { body: BODY, spans: 1, first: 0, bounds: span.bounds };
        let mut bytes = table_header(1, 1, 3).to_vec();
        bytes.extend(record.to_le_bytes());
        bytes.extend(span.to_le_bytes());
        for component in direction.xyz() {
            bytes.extend(component.to_le_bytes());
        }
        Self { bytes }
    }

    /// The table as the search reads it.
    ///
    /// # Errors
    /// [`EphemerisError`] where the span is beyond the time scale.
    pub(super) fn table(&self) -> Result<EphemerisTable<'_>, EphemerisError> {
        EphemerisTable::parse(&self.bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_gives_the_direction_back() {
        let direction = Direction::from_longitude_latitude(2.0, -0.7);
        let ends = (Instant::from_tai_ns(-5), Instant::from_tai_ns(1_000_000_000_000));
        let fixed = FixedDirection::new(direction, ends);
        let body = fixed.table().unwrap().body(BODY).unwrap();
        for at in [ends.0, Instant::from_tai_ns(77), ends.1] {
            let state = body.state(at).unwrap();
            assert!(state.direction.separation_rad(direction) < 1e-15);
            assert!(state.rate_per_s.iter().all(|rate| rate.abs() < 1e-300));
        }
    }
}
