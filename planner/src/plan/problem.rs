//! A mission's opportunities and rules as the scheduler takes them.

use crate::opportunities::Opportunities;
use crate::schedule::{Candidate, Demands, Exclusive, Problem, Rules, SessionCount};
use crate::world::World;
use ephem::time::{utc_day, utc_midnight};
use mission::schedule::Exclusive as ExclusiveKey;
use onboard_core::time::Instant;

/// The scheduling problem of a mission.
pub(crate) fn problem(world: &World, opportunities: &Opportunities, demands: Demands) -> Problem {
    let keys = &world.mission.calibration.schedule;
    let candidates = opportunities
        .list()
        .iter()
        .map(|it| Candidate {
            target: it.target,
            telescope: it.telescope,
            first_entry: it.first_entry,
            last_exit: it.last_exit,
            dwell: it.dwell,
        })
        .collect();
    Problem {
        span: (world.start, world.end),
        candidates,
        weights: world.targets.iter().map(|source| keys.weight(source.name())).collect(),
        rules: Rules {
            setup: keys.setup(),
            cooldown: keys.cooldown(),
            exclusive: match keys.exclusive {
                ExclusiveKey::Telescope => Exclusive::Telescope,
                ExclusiveKey::All => Exclusive::All,
            },
            max_per_day: keys.max_per_day(),
            max_sessions: keys
                .max_sessions
                .as_ref()
                .map(|it| SessionCount { count: it.count, window: it.window() }),
            day_boundaries: midnights(world.start, world.end),
        },
        demands,
    }
}

/// UTC midnights around and within the mission.
fn midnights(start: Instant, end: Instant) -> Vec<Instant> {
    (utc_day(start)..=utc_day(end) + 1).map(utc_midnight).collect()
}
