//! A plan flown before it is written: its own uplink, through the flight core's sequencer.
//!
//! A session that the spacecraft would skip for a reason that the plan could not know is left out, with
//! that reason, and the plan made again. Any other skip is a fault of ours.
//!
//! # Example
//! A day's plan, which the spacecraft carries out as it is:
//! ```
//! use formats::flown::flown;
//! use mission::{Mission, Override};
//! use planner::plan::{Revision, plan};
//! use planner::{progress::Quietly, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=1")?])?;
//! let world = World::open(mission, None)?;
//! let planned = plan(&world, &Revision::default(), &Quietly)?;
//! let sessions = planned.schedule.chosen.len();
//! let (plan, uplink) = flown(&world, planned, 1, &Quietly)?;
//! assert_eq!(plan.schedule.chosen.len(), sessions);
//! assert!(uplink.starts_with(b"GYRFALCN"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::uplink::{Contents, TooLarge, contents_told, records};
use onboard_core::sequencer::{AbortReason, SkipReason};
use onboard_core::uplink::Tables;
use planner::onboard::{NotFlown, fly};
use planner::plan::{Plan, PlanError};
use planner::progress::Progress;
use planner::schedule::skipped;
use planner::world::World;
use thiserror::Error;

/// Most times that a plan is made again.
const MOST: usize = 8;

/// Why a plan cannot be flown.
#[derive(Debug, Error)]
pub enum FlightError {
    /// The plan could not be made again.
    #[error(transparent)]
    Plan(Box<PlanError>),
    /// The uplink cannot hold it.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// What should never be, in words.
    #[error("{0}")]
    Fault(String),
}

/// A plan that the spacecraft carries out, and its uplink's bytes.
///
/// # Errors
/// [`FlightError`].
pub fn flown(
    world: &World,
    plan: Plan,
    sequence: u32,
    progress: &dyn Progress,
) -> Result<(Plan, Vec<u8>), FlightError> {
    let mut plan = plan;
    for _ in 0..MOST {
        let sessions = records(world, &plan)?;
        let ephemeris = &plan.offered.tables.fitted.bytes;
        let uplink =
            Contents { world, ephemeris, sessions: Some(&sessions), sequence }.to_bytes()?;
        let refused = refused(world, &plan, &uplink)?;
        if refused.is_empty() {
            return Ok((plan, uplink));
        }
        let again = plan.without(&refused, progress);
        plan = again.map_err(|error| FlightError::Plan(Box::new(error)))?;
    }
    Err(FlightError::Fault(format!("after {MOST} plans the spacecraft would still skip a session")))
}

/// The candidates whose sessions the spacecraft would not carry out, with the reason.
fn refused(
    world: &World,
    plan: &Plan,
    uplink: &[u8],
) -> Result<Vec<(usize, SkipReason)>, FlightError> {
    let tables = Tables::load(uplink)
        .map_err(|error| FlightError::Fault(format!("the uplink: {}", contents_told(error))))?;
    let not_flown = fly(&tables)
        .map_err(|error| FlightError::Fault(format!("the simulated flight: {error:?}")))?;
    let mut refused = Vec::new();
    for (index, why) in not_flown {
        let place = usize::try_from(index).unwrap_or(usize::MAX);
        let Some(&candidate) = plan.schedule.chosen.get(place) else {
            return Err(FlightError::Fault(format!("session {index} is not in the plan")));
        };
        match foreseeable(why) {
            Ok(reason) => refused.push((candidate, reason)),
            Err(told) => {
                let id = plan.offered.id(world, candidate);
                let fault = format!("planned but the spacecraft would skip it: {id}: {told}");
                return Err(FlightError::Fault(fault));
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
