//! An opportunity as the session that goes on board.

use crate::opportunities::{Offers, Opportunity};
use crate::world::World;
use onboard_core::time::Duration;
use onboard_core::uplink::SessionRecord;
use thiserror::Error;

/// A session's number that its record cannot hold: its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("the uplink table cannot hold the {0} of a session")]
pub struct BeyondRecord(pub &'static str);

/// The session of an opportunity over the time that it reserves, setup and cooldown included.
///
/// # Errors
/// [`BeyondRecord`] names the number that the record cannot hold.
pub fn record(
    world: &World,
    offers: &Offers,
    opportunity: &Opportunity,
) -> Result<SessionRecord, BeyondRecord> {
    let keys = &world.mission.calibration.schedule;
    let setup = Duration::from_ns(keys.setup().ns().saturating_neg());
    let passes = offers.opportunities.passes(opportunity).len();
    Ok(SessionRecord {
        start: opportunity.first_entry.plus(setup),
        end: opportunity.last_exit.plus(keys.cooldown()),
        first_entry: opportunity.first_entry,
        last_exit: opportunity.last_exit,
        body: world.targets[opportunity.target].body(),
        turn: u32::try_from(opportunity.number).map_err(|_| BeyondRecord("number"))?,
        telescope: u16::try_from(opportunity.telescope).map_err(|_| BeyondRecord("telescope"))?,
        passes: u16::try_from(passes).unwrap_or(u16::MAX),
    })
}
