//! The mission of the command line, and the sky that it flies in.

use super::told::warn;
use crate::cli::{self, SharedArgs};
use crate::failure::Failure;
use mission::Mission;
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
    let world = World::open(mission(shared)?, shared.ephemeris.as_deref())?;
    warn(shared, world.far_trajectory().as_slice());
    Ok(world)
}

/// The Sun's fitted directions, for those that sample or search them.
pub(super) fn sun_table(tables: &Tables) -> Result<SunTable, Failure> {
    SunTable::new(tables.fitted.bytes.as_slice())
        .map_err(|error| Failure::internal(format!("the fitted table: {error:?}")))
}
