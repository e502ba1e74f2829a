//! The mission of the command line, and the sky that it flies in.

use super::told::warn;
use crate::cli::{self, SharedArgs};
use crate::failure::Failure;
use mission::Mission;
use onboard_core::time::Duration;
use planner::survey::SunTable;
use planner::world::{Tables, World};

/// The mission of the command line, its warnings told.
pub(super) fn mission(shared: &SharedArgs) -> Result<Mission, Failure> {
    let mission = cli::mission(shared)?;
    warn(shared, &mission.warnings);
    Ok(mission)
}

/// The mission of the command line among the planets.
pub(super) fn world(shared: &SharedArgs) -> Result<World, Failure> {
    let mut world = World::open(mission(shared)?, shared.ephemeris.as_deref())?;
    if let Some(window) = cli::window(shared, world.mission_span())? {
        warn(shared, &window.said);
        world.keep_window(window.from, window.until)?;
    }
    if shared.start.is_some() {
        let clock = "--start moves the mission, and with it the clock of its rotations: to look at a \
                     part of a mission, use --from and --until";
        warn(shared, &[clock]);
    }
    warn(shared, world.far_trajectory().as_slice());
    Ok(world)
}

/// What is looked at, in time elapsed on the scan clock.
pub(super) fn window(world: &World) -> (Duration, Duration) {
    (world.start.since(world.zero()), world.end.since(world.zero()))
}

/// The Sun's fitted directions, for those that sample or search them.
pub(super) fn sun_table(tables: &Tables) -> Result<SunTable, Failure> {
    SunTable::new(tables.fitted.bytes.as_slice())
        .map_err(|error| Failure::internal(format!("the fitted table: {error:?}")))
}
