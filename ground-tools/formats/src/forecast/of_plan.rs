//! What a plan's sessions teach, and what is to be seen first of it.
//!
//! Of every channel the detector nearest the middle of the channel's is judged, or the telescope's axis.

use super::requirement::{Required, required};
use crate::timeline::{Idle, Timeline, idle};
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::time::Instant;
use planner::information::{InformationError, Session, Teaching, looks, one_of_each};
use planner::opportunities::Opportunities;
use planner::progress::Quietly;
use planner::world::World;

/// What a plan teaches.
#[derive(Debug)]
pub struct Taught<'m> {
    /// The forecast of its sessions; an error where nothing is known of noise or strength.
    pub teaching: Result<Teaching, InformationError>,
    /// The mission's requirements; none where nothing is known.
    pub required: Vec<Required<'m>>,
    /// The longest time without a session, by telescope.
    pub idle: Vec<Idle>,
    /// Requirements of the mission.
    asked: usize,
}

/// A plan's sessions, of the targets and telescopes of a mission.
#[must_use]
pub fn sessions(world: &World, timeline: &Timeline) -> Vec<Session> {
    let target = |name: &str| world.targets.iter().position(|it| it.name() == name);
    let telescope = |name: &str| world.mission.telescopes.iter().position(|it| it.name == name);
    let session = |it: &crate::timeline::Session| {
        Some(Session {
            target: target(&it.target)?,
            telescope: telescope(&it.telescope)?,
            from: Instant::from_tai_ns(it.start_tai_ns),
            until: Instant::from_tai_ns(it.end_tai_ns),
        })
    };
    timeline.sessions.iter().filter_map(session).collect()
}

impl<'m> Taught<'m> {
    /// What a plan's sessions teach.
    #[must_use]
    pub fn of(
        world: &'m World,
        table: EphemerisTable<'_>,
        timeline: &Timeline,
        opportunities: &Opportunities,
    ) -> Self {
        let found = looks(&world.mission, None, None).map_err(InformationError::from);
        let teaching = found.and_then(|all| {
            let asked = (None, Some(sessions(world, timeline)));
            Teaching::of(world, table, one_of_each(all), asked, &Quietly)
        });
        let required = teaching.as_ref().map_or_else(|_| Vec::new(), |it| required(world, it));
        let idle = idle(world, timeline, opportunities);
        let asked = world.mission.calibration.requirements.len();
        Self { teaching, required, idle, asked }
    }

    /// What is wrong with the plan: telescopes without a session, requirements that are missed.
    #[must_use]
    pub fn alerts(&self) -> Vec<String> {
        let bare = self.idle.iter().filter(|it| it.sessions == 0);
        let mut alerts: Vec<String> =
            bare.map(|it| format!("{}: {}", it.telescope, it.sentence())).collect();
        if let Err(error) = &self.teaching
            && self.asked > 0
        {
            alerts.push(format!("the requirements cannot be judged: {error}"));
        }
        let missed = self.required.iter().filter(|it| it.is_missed());
        alerts.extend(missed.map(|it| format!("{}: {}", it.name(), it.sentence())));
        alerts
    }
}
