//! Why there is no plan, in words.

use crate::failure::Failure;
use formats::timeline::date;
use planner::plan::PlanError;
use planner::schedule::{Conflict, RuleName, ScheduleError};
use planner::world::World;

/// Why there is no plan; rules that contradict each other fail in words.
pub(super) fn plan_failure(world: &World, error: PlanError) -> Failure {
    match error {
        PlanError::Schedule(ScheduleError::Infeasible(conflict)) => {
            Failure::Check(contradiction(world, &conflict))
        }
        PlanError::Schedule(
            error @ (ScheduleError::Unsound(_) | ScheduleError::BoundBelow { .. }),
        ) => Failure::internal(error),
        PlanError::Schedule(error @ ScheduleError::NotFound) => Failure::Check(error.to_string()),
        error => error.into(),
    }
}

/// A contradiction among the rules, and the least change that would end it.
fn contradiction(world: &World, conflict: &Conflict) -> String {
    let named = |rule: &RuleName| match rule {
        RuleName::Fixed | RuleName::Forbidden => format!("the {rule}"),
        _ => format!("calibration.schedule.{rule}"),
    };
    let rules: Vec<String> = conflict.rules.iter().map(named).collect();
    let place = conflict.season.map_or_else(String::new, |(target, telescope, from)| {
        format!(
            " of {} on {} in the season from {} UTC",
            world.targets[target].name(),
            world.mission.telescopes[telescope].name,
            date(from)
        )
    });
    format!(
        "no schedule meets {} together: of the {} sessions asked for{place}, at most {} can be had; \
         asking for {} fewer, or leaving out any one of these rules, ends the contradiction",
        rules.join(", "),
        conflict.wanted,
        conflict.possible,
        conflict.wanted.saturating_sub(conflict.possible)
    )
}
