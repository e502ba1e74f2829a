//! A plan flown before it is written: its own uplink, through the flight core's sequencer.
//!
//! A session that the spacecraft would skip for a reason that the plan could not know is left out, with
//! that reason, and the plan made again. Any other skip is a fault of ours.

use super::contradiction::plan_failure;
use crate::failure::Failure;
use crate::output::interrupt::SearchLimit;
use formats::uplink::{Contents, contents_told, records};
use onboard_core::sequencer::{AbortReason, SkipReason};
use onboard_core::uplink::Tables;
use planner::onboard::{NotFlown, fly};
use planner::plan::Plan;
use planner::schedule::skipped;
use planner::world::World;

/// Most times that a plan is made again.
const MOST: usize = 8;

/// A plan that the spacecraft carries out, and its uplink's bytes.
pub(super) fn flown(
    world: &World,
    plan: Plan,
    sequence: u32,
    search_limit: &SearchLimit,
) -> Result<(Plan, Vec<u8>), Failure> {
    let mut plan = plan;
    for _ in 0..MOST {
        let uplink = uplink(world, &plan, sequence)?;
        let refused = refused(world, &plan, &uplink)?;
        if refused.is_empty() {
            return Ok((plan, uplink));
        }
        plan = plan.without(&refused, search_limit).map_err(|error| plan_failure(world, error))?;
    }
    Err(Failure::internal(format!("after {MOST} plans the spacecraft would still skip a session")))
}

fn uplink(world: &World, plan: &Plan, sequence: u32) -> Result<Vec<u8>, Failure> {
    let records = records(world, plan)?;
    let ephemeris = &plan.offered.tables.fitted.bytes;
    Ok(Contents { world, ephemeris, sessions: Some(&records), sequence }.to_bytes()?)
}

/// The candidates whose sessions the spacecraft would not carry out, with the reason.
fn refused(world: &World, plan: &Plan, uplink: &[u8]) -> Result<Vec<(usize, SkipReason)>, Failure> {
    let tables = Tables::load(uplink)
        .map_err(|error| Failure::internal(format!("the uplink: {}", contents_told(error))))?;
    let not_flown = fly(&tables)
        .map_err(|error| Failure::internal(format!("the simulated flight: {error:?}")))?;
    let mut refused = Vec::new();
    for (index, why) in not_flown {
        let place = usize::try_from(index).unwrap_or(usize::MAX);
        let Some(&candidate) = plan.schedule.chosen.get(place) else {
            return Err(Failure::internal(format!("session {index} is not in the plan")));
        };
        match foreseeable(why) {
            Ok(reason) => refused.push((candidate, reason)),
            Err(told) => {
                let id = plan.offered.id(world, candidate);
                return Err(Failure::internal(format!(
                    "planned but the spacecraft would skip it: {id}: {told}"
                )));
            }
        }
    }
    Ok(refused)
}

/// A reason that the plan could not know; else in words what should never be.
///
/// Passes on a field's edge come and go with the steps of the search, and passes of the next turn may
/// begin before the last of this one ends; a limit may be met within the search's own tolerance; a
/// check may not be finished in the time before the start.
fn foreseeable(why: NotFlown) -> Result<SkipReason, String> {
    match why {
        NotFlown::Skipped(
            reason @ (SkipReason::NotChecked
            | SkipReason::Entry(_)
            | SkipReason::Exit(_)
            | SkipReason::Passes(_)
            | SkipReason::Avoidance(_)),
        ) => Ok(reason),
        NotFlown::Aborted(AbortReason::Avoidance(body)) => Ok(SkipReason::Avoidance(body)),
        NotFlown::Skipped(reason) => Err(skipped(reason)),
        NotFlown::Aborted(reason) => Err(format!("it would give it up: {reason:?}")),
    }
}
