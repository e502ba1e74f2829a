//! What a person asks of the schedule, checked: a sentence for each option that is not legal.

use crate::cli::RevisionArgs;
use crate::cli::quantities::instant;
use crate::failure::Failure;
use crate::verb::earlier::Earlier;
use formats::timeline::{Difference, Timeline};
use mission::{quantity, rounding};
use onboard_core::time::{Duration, Instant};
use planner::plan::{EarlierPlan, Revision};
use planner::world::World;

/// What the options ask of the schedule.
pub(super) struct Wishes<'w> {
    arguments: &'w RevisionArgs,
    /// In seconds.
    pub(super) time_limit: Option<f64>,
    frozen_until: Option<Instant>,
    earlier: Option<Earlier>,
}

impl<'w> Wishes<'w> {
    pub(super) fn read(arguments: &'w RevisionArgs, world: &World) -> Result<Self, Failure> {
        if let Some(price) = arguments.change_price.filter(|it| !(0.0..=1e12).contains(it)) {
            return Err(Failure::Input(format!(
                "--change-price {price}: a number from 0 to 1e12 is needed"
            )));
        }
        let earlier = arguments.against.as_ref().map(|path| Earlier::read(path, world));
        Ok(Self {
            arguments,
            time_limit: arguments.time_limit.as_deref().map(time_limit).transpose()?,
            frozen_until: arguments
                .freeze_until
                .as_deref()
                .map(|it| instant("--freeze-until", it))
                .transpose()?,
            earlier: earlier.transpose()?,
        })
    }

    pub(super) fn revision(&self) -> Revision {
        let earlier = self.earlier.as_ref().map(|it| EarlierPlan {
            objective: it.timeline.objective,
            sessions: it
                .timeline
                .sessions
                .iter()
                .map(|it| (it.id.clone(), Instant::from_tai_ns(it.start_tai_ns)))
                .collect(),
        });
        Revision {
            earlier,
            change_price: self.arguments.change_price,
            frozen_until: self.frozen_until,
            fixed: self.arguments.fix.clone(),
            forbidden: self.arguments.forbid.clone(),
        }
    }

    /// What a timeline changes, which it is told.
    pub(super) fn difference(&self, timeline: &mut Timeline) -> Option<Difference> {
        let earlier = self.earlier.as_ref()?;
        let difference = earlier.difference(timeline);
        timeline.against = Some(difference.by_ids(&earlier.sha256));
        Some(difference)
    }
}

/// The seconds of `--time-limit`.
fn time_limit(text: &str) -> Result<f64, Failure> {
    let option = |error: String| Failure::Input(format!("--time-limit: {error}"));
    let exact = quantity::seconds(text).map_err(|error| option(error.to_string()))?;
    let seconds = rounding::duration(&exact).map(Duration::seconds);
    seconds
        .filter(|it| (0.0..=1e9).contains(it))
        .ok_or_else(|| option(format!("{text} is not a duration from 0 s to 1e9 s")))
}
