//! From a mission among the planets to its plan.

use super::error::PlanError;
use super::problem::problem;
use super::revision::Revision;
use super::session::{Session, session_id};
use crate::opportunities::{Offers, Opportunity};
use crate::progress::Progress;
use crate::schedule::{Loosening, Problem, Schedule, loosen, schedule_until};
use crate::world::{Tables, World};
use crate::worth::{Scene, WorthError};
use ephem::fit::FitOptions;
use mission::occasions::{Blackout, blackouts};
use onboard_core::sequencer::SkipReason;
use rayon::prelude::*;

/// What a mission offers to a schedule, and the rules that bind it.
#[derive(Debug)]
pub struct Offered {
    /// The tables that go on board.
    pub tables: Tables,
    /// Lines of sight, passes, opportunities; candidate and opportunity have the same index.
    pub offers: Offers,
    /// The blackouts, as in the problem's demands.
    pub blackouts: Vec<Blackout>,
    /// The scheduling problem.
    pub problem: Problem,
}

/// A plan.
#[derive(Debug)]
pub struct Plan {
    /// What it was chosen from.
    pub offered: Offered,
    /// The sessions that stand, the bound, and why the others do not stand.
    pub schedule: Schedule,
    /// What giving way in a rule would bring.
    pub loosened: Vec<Loosening>,
}

impl Offered {
    /// What the mission offers, asked for nothing beyond its own rules.
    ///
    /// # Errors
    /// [`PlanError`] where kernel, sources or the files of the schedule cannot be used.
    pub fn find(world: &World) -> Result<Self, PlanError> {
        let tables = world.tables(&FitOptions::UPLINK)?;
        let offers = Offers::find(world, &tables)?;
        let blackouts = blackouts(&world.mission, (world.start, world.end))
            .map_err(super::error::DemandError::from)?;
        let demands = Scene::new(world, &tables, &offers)?.demands(&blackouts)?;
        let problem = problem(world, &offers.opportunities, demands);
        Ok(Self { tables, offers, blackouts, problem })
    }

    /// The best schedule of it.
    fn scheduled(self, progress: &dyn Progress) -> Result<Plan, PlanError> {
        let problem = &self.problem;
        let (schedule, loosened) =
            rayon::join(|| schedule_until(problem, progress), || loosen(problem, progress));
        Ok(Plan { schedule: schedule?, loosened: loosened?, offered: self })
    }

    /// The id that an opportunity's session has.
    #[must_use]
    pub fn id(&self, world: &World, candidate: usize) -> String {
        session_id(world, self.opportunity(candidate))
    }

    /// The opportunity of a candidate.
    #[must_use]
    pub fn opportunity(&self, candidate: usize) -> &Opportunity {
        &self.offers.opportunities.list()[candidate]
    }

    /// The session that each of these candidates would be, in their order.
    ///
    /// # Errors
    /// [`WorthError`] where tables or ephemeris do not serve the mission's own span.
    pub fn sessions(
        &self,
        world: &World,
        candidates: &[usize],
    ) -> Result<Vec<Session>, WorthError> {
        let scene = Scene::new(world, &self.tables, &self.offers)?;
        let session = |&candidate: &usize| {
            let reserved = self.problem.reserved(candidate);
            scene.session(self.opportunity(candidate), reserved, self.problem.value(candidate))
        };
        candidates.par_iter().map(session).collect()
    }
}

impl Plan {
    /// The plan made again without some of its sessions, each with the reason why the spacecraft would
    /// skip it.
    ///
    /// # Errors
    /// As [`plan`].
    pub fn without(
        self,
        sessions: &[(usize, SkipReason)],
        progress: &dyn Progress,
    ) -> Result<Self, PlanError> {
        let mut offered = self.offered;
        let demands = &mut offered.problem.demands;
        for &(candidate, reason) in sessions {
            if let Err(place) = demands.avoided.binary_search(&candidate) {
                demands.avoided.insert(place, candidate);
                demands.skipped.insert(candidate, reason);
            }
        }
        offered.scheduled(progress)
    }

    /// Its sessions by start.
    ///
    /// # Errors
    /// As [`Offered::sessions`].
    pub fn sessions(&self, world: &World) -> Result<Vec<Session>, WorthError> {
        self.offered.sessions(world, &self.schedule.chosen)
    }
}

/// The plan of a mission; where `progress` stops it, the best so far with a bound that still holds.
///
/// # Errors
/// [`PlanError`]: input that cannot be used, rules that contradict each other, or an earlier plan that
/// is not this mission's.
pub fn plan(
    world: &World,
    revision: &Revision,
    progress: &dyn Progress,
) -> Result<Plan, PlanError> {
    let mut offered = Offered::find(world)?;
    let list = offered.offers.opportunities.list();
    let ids: Vec<String> = list.iter().map(|it| session_id(world, it)).collect();
    revision.ask(&ids, &mut offered.problem)?;
    offered.scheduled(progress)
}
