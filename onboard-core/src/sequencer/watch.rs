//! Avoidance while a session runs: looked at, not predicted.
//!
//! Each tick looks at a bounded number of pairs of limit and field, in turn, at the instant of the
//! tick, from the strategy as it is known then. Setup and cooldown count.
//!
//! Limits: with more pairs than looks, a violation is seen when its pair's turn comes: after
//! `pairs / MAX_LOOKS_PER_TICK` ticks at the latest. A violation shallower than
//! [`SEPARATION_TOLERANCE_RAD`] is none, as in the check.

use super::reason::AbortReason;
use crate::attitude::attitude;
use crate::convert::uncounted;
use crate::direction::Direction;
use crate::ephemeris::EphemerisError;
use crate::frame::{Boresight, Ecliptic};
use crate::rotation::Rotation;
use crate::scan::ScanStrategy;
use crate::time::Instant;
use crate::transit::SEPARATION_TOLERANCE_RAD;
use crate::uplink::{AvoidanceRecord, Tables};

/// Most pairs of limit and field looked at in one tick, each an evaluation.
pub const MAX_LOOKS_PER_TICK: u32 = 4;

/// Most rounds of one tick: where a limit's fields end, no look is made.
const MOST_ROUNDS: usize = 8;

/// Which pair is next.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watch {
    limit: u16,
    field: u16,
}

impl Watch {
    /// From the first pair on.
    pub(super) const FIRST: Self = Self { limit: 0, field: 0 };

    /// The looks made, and whether the session must be given up.
    #[inline(never)]
    pub(super) fn look(
        &mut self,
        strategy: &ScanStrategy,
        tables: &Tables<'_>,
        telescope: u16,
        now: Instant,
    ) -> (u32, Option<AbortReason>) {
        let mut looks = 0_u32;
        if tables.mission().avoidance_limit(0).is_none() {
            return (looks, None);
        }
        let attitude = match attitude_now(strategy, tables, now) {
            Ok(attitude) => attitude,
            Err(error) => return (looks, Some(AbortReason::Ephemeris(error))),
        };
        for _ in 0..uncounted(MOST_ROUNDS) {
            if looks >= MAX_LOOKS_PER_TICK {
                break;
            }
            let Some(record) = tables.mission().avoidance_limit(self.limit) else {
                *self = Self::FIRST;
                continue;
            };
            match too_close(&record, (telescope, self.field), tables, &attitude, now) {
                None => *self = Self { limit: self.limit.wrapping_add(1), field: 0 },
                Some(seen) => {
                    looks = looks.saturating_add(1);
                    self.field = self.field.saturating_add(1);
                    match seen {
                        Ok(false) => {}
                        Ok(true) => return (looks, Some(AbortReason::Avoidance(record.body))),
                        Err(error) => return (looks, Some(AbortReason::Ephemeris(error))),
                    }
                }
            }
        }
        (looks, None)
    }
}

#[inline(never)]
fn attitude_now(
    strategy: &ScanStrategy,
    tables: &Tables<'_>,
    now: Instant,
) -> Result<Rotation<Ecliptic, Boresight>, EphemerisError> {
    Ok(attitude(strategy, &tables.sun()?, now)?.inverse())
}

/// Whether the limit's body is too close to the field of this telescope and index; none where there
/// is no such field.
#[inline(never)]
fn too_close(
    record: &AvoidanceRecord,
    (telescope, index): (u16, u16),
    tables: &Tables<'_>,
    attitude: &Rotation<Ecliptic, Boresight>,
    now: Instant,
) -> Option<Result<bool, EphemerisError>> {
    // Borrowed, not moved out of the option: a copy less on the stack.
    let field = tables.mission().calibration_field(telescope, index);
    let field = field.as_ref()?;
    let seen = direction(record.body, tables, attitude, now);
    let limit = record.angle_rad - SEPARATION_TOLERANCE_RAD;
    Some(seen.map(|direction| field.angle_to_rad(direction) < limit))
}

#[inline(never)]
fn direction(
    body: i32,
    tables: &Tables<'_>,
    attitude: &Rotation<Ecliptic, Boresight>,
    now: Instant,
) -> Result<Direction<Boresight>, EphemerisError> {
    Ok(attitude.apply(tables.ephemeris().body(body)?.state(now)?.direction))
}

#[cfg(test)]
mod tests {
    use super::super::trial::{Board, RADIUS_RAD};
    use super::*;
    use std::vec;

    extern crate std;

    #[test]
    // REQ-SEQ-9.
    fn a_body_is_too_close_below_the_limit_less_the_tolerance() {
        let body = Direction::from_longitude_latitude(0.3, 1.0);
        let board = Board { bodies: vec![body], ..Board::default() };
        let bytes = board.uplink(1, &[]);
        let tables = Tables::load(&bytes).unwrap();
        let now = Instant::from_tai_ns(0);
        let attitude = Rotation::IDENTITY;
        let seen_rad = {
            let field = tables.mission().calibration_field(0, 0).unwrap();
            field.angle_to_rad(direction(Board::number(0), &tables, &attitude, now).unwrap())
        };
        assert!((seen_rad - (core::f64::consts::FRAC_PI_2 - 1.0 - RADIUS_RAD)).abs() < 1e-12);
        let close = |angle_rad: f64| {
            let record = AvoidanceRecord { body: Board::number(0), angle_rad };
            too_close(&record, (0, 0), &tables, &attitude, now).unwrap().unwrap()
        };
        assert!(close(seen_rad + 1.1 * SEPARATION_TOLERANCE_RAD));
        assert!(!close(seen_rad + 0.9 * SEPARATION_TOLERANCE_RAD));
        assert!(!close(seen_rad));
        // The limit itself, to the last bit.
        let mut limit_rad = seen_rad + SEPARATION_TOLERANCE_RAD;
        while limit_rad - SEPARATION_TOLERANCE_RAD > seen_rad {
            limit_rad = limit_rad.next_down();
        }
        while limit_rad - SEPARATION_TOLERANCE_RAD < seen_rad {
            limit_rad = limit_rad.next_up();
        }
        assert!(!close(limit_rad));
        let record = AvoidanceRecord { body: Board::number(0), angle_rad: limit_rad };
        assert!(too_close(&record, (0, 1), &tables, &attitude, now).is_none(), "one field only");
    }
}
