//! How strong is a target in a receiver at any time: tables of distances, and what does not change.
//!
//! Method: antenna temperatures are those of [`worth::strength`](mod@crate::worth::strength), the distance
//! interpolated by cubics through one value a day, which is exact to 1e-7 for planets
//! (`distances_between_days_are_the_ephemeris`).
//!
//! Limits: those of the table of sources. The angle of a source's polarisation is taken as along the
//! ecliptic's east; where a plate turns or crossing angles spread it does not matter.

use crate::world::World;
use crate::worth::flux;
use crate::worth::strength::{Beam, Strength};
use ephem::apparent::SkyError;
use ephem::source::Source;
use onboard_core::time::{Duration, Instant};

/// Longest time between distances, and the fewest intervals.
const STEP_S: f64 = 86_400.0;
const INTERVALS: u32 = 8;

/// A target's distances over the mission, or none where it has none.
#[derive(Debug, Clone)]
pub(super) struct Distances {
    start: Instant,
    step_s: f64,
    km: Vec<f64>,
}

impl Distances {
    /// At least one value a day over the mission's span, evenly.
    pub(super) fn of(world: &World, source: &Source) -> Result<Self, SkyError> {
        let span_s = world.end.since(world.start).seconds();
        let intervals = whole((span_s / STEP_S).ceil()).max(INTERVALS);
        let step_s = span_s / f64::from(intervals);
        let mut km = Vec::new();
        for index in 0..=intervals {
            let at = world.start.plus(Duration::from_seconds(f64::from(index) * step_s));
            match world.sky.distance_km(source, at.min(world.end))? {
                Some(distance) => km.push(distance),
                None => break,
            }
        }
        Ok(Self { start: world.start, step_s, km })
    }

    /// The distance at an instant in km.
    pub(super) fn at(&self, at: Instant) -> Option<f64> {
        let last = u32::try_from(self.km.len().checked_sub(4)?).unwrap_or(u32::MAX);
        let steps = at.since(self.start).seconds() / self.step_s;
        let first = whole(steps - 1.0).min(last);
        let place = steps - f64::from(first);
        let km = self.km.get(usize::try_from(first).ok()?..)?.first_chunk::<4>()?;
        // Lagrange's cubic through 0, 1, 2, 3.
        let [zero, one, two, three] = [0.0, 1.0, 2.0, 3.0].map(|node| place - node);
        Some(
            -km[0] * one * two * three / 6.0 + km[1] * zero * two * three / 2.0
                - km[2] * zero * one * three / 2.0
                + km[3] * zero * one * two / 6.0,
        )
    }
}

/// Whole steps, 0 for what is before the start.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float saturates, and a mission is shorter than 2^32 days"
)]
fn whole(steps: f64) -> u32 {
    steps as u32
}

/// The strength of a target in a beam at a distance.
pub(super) fn strength(world: &World, source: &Source, beam: Beam, km: Option<f64>) -> Strength {
    let own = world.mission.calibration.sources.iter().find(|own| own.name == source.name());
    match own {
        Some(own) => flux(own).map_or_else(Strength::default, |flux| beam.strength_of_flux(&flux)),
        None => beam.strength_of(source.name(), km),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mission::{Mission, Override};

    #[test]
    fn distances_between_days_are_the_ephemeris() {
        let days = Override::set("span.duration_days=40.3").unwrap();
        let world = World::open(Mission::load("litebird", &[days]).unwrap(), None).unwrap();
        for source in &world.targets {
            let distances = Distances::of(&world, source).unwrap();
            for days in [0.0, 0.4, 1.9, 17.53, 38.6, 39.9, 40.25] {
                let at = world.start.plus(Duration::from_seconds(days * STEP_S));
                let expected = world.sky.distance_km(source, at).unwrap().unwrap();
                let found = distances.at(at).unwrap();
                assert!((found / expected - 1.0).abs() < 1e-7, "{} {days}", source.name());
            }
        }
    }
}
