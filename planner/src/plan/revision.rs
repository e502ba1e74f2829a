//! What is asked of a plan beyond the mission: an earlier plan to stay close to, a part of it frozen,
//! sessions fixed or forbidden.
//!
//! Sessions are named by their ids, `TELESCOPE-TARGET-TURN`; a turn counts from the mission's start,
//! so an earlier plan must be of a mission with the same start. Its other inputs may differ: that is
//! what replanning is for.

use super::error::{Asked, RevisionError};
use crate::schedule::{Previous, Problem};
use onboard_core::time::Instant;
use std::collections::{BTreeMap, BTreeSet};

/// Share of the mean worth of an earlier plan's sessions that a change must bring, unless said.
const CHANGE_SHARE: f64 = 0.1;

/// What is asked beyond the mission; by default nothing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Revision {
    /// An earlier plan.
    pub earlier: Option<EarlierPlan>,
    /// What each session added or dropped must bring to the objective; without it a tenth of the
    /// mean worth of the earlier plan's sessions.
    pub change_price: Option<f64>,
    /// Before this instant the earlier plan stays as it is.
    pub frozen_until: Option<Instant>,
    /// Ids of sessions that must stand.
    pub fixed: Vec<String>,
    /// Ids of sessions that must not.
    pub forbidden: Vec<String>,
}

/// An earlier plan of the same mission.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EarlierPlan {
    /// Its objective.
    pub objective: f64,
    /// The id and the start, setup included, of each of its sessions.
    pub sessions: Vec<(String, Instant)>,
}

impl Revision {
    /// Asks it of a problem whose candidates have these ids.
    pub(crate) fn ask(&self, ids: &[String], problem: &mut Problem) -> Result<(), RevisionError> {
        let places: BTreeMap<&str, usize> =
            ids.iter().enumerate().map(|(place, id)| (id.as_str(), place)).collect();
        let fixed = found(Asked::Fixed, &self.fixed, &places)?;
        let forbidden = found(Asked::Forbidden, &self.forbidden, &places)?;
        if let Some(&both) = fixed.iter().find(|it| forbidden.contains(it)) {
            return Err(RevisionError::FixedAndForbidden { id: ids[both].clone() });
        }
        problem.demands.fixed = fixed;
        problem.demands.forbidden = forbidden;
        let Some(earlier) = &self.earlier else { return Ok(()) };
        let before = &earlier.sessions;
        let standing: Vec<usize> =
            before.iter().filter_map(|(id, _)| places.get(id.as_str()).copied()).collect();
        if standing.is_empty() && !before.is_empty() {
            return Err(RevisionError::NothingInCommon { sessions: before.len() });
        }
        if let Some(until) = self.frozen_until {
            freeze(before, until, &places, problem)?;
        }
        let mean = earlier.objective / f64_from(before.len().max(1));
        let price = self.change_price.unwrap_or_else(|| (CHANGE_SHARE * mean).max(0.0));
        problem.demands.previous = Some(Previous { sessions: standing, price });
        Ok(())
    }
}

/// Fixes what the earlier plan starts before an instant, and forbids all else there.
fn freeze(
    before: &[(String, Instant)],
    until: Instant,
    places: &BTreeMap<&str, usize>,
    problem: &mut Problem,
) -> Result<(), RevisionError> {
    let mut frozen = BTreeSet::new();
    for (id, _) in before.iter().filter(|it| it.1 < until) {
        let Some(&place) = places.get(id.as_str()) else {
            return Err(RevisionError::FrozenNotOffered { id: id.clone() });
        };
        frozen.insert(place);
    }
    for place in 0..problem.candidates.len() {
        if problem.reserved(place).0 < until && !frozen.contains(&place) {
            problem.demands.forbidden.push(place);
        }
    }
    problem.demands.fixed.extend(frozen);
    for list in [&mut problem.demands.fixed, &mut problem.demands.forbidden] {
        list.sort_unstable();
        list.dedup();
    }
    Ok(())
}

/// A count as a number.
fn f64_from(count: usize) -> f64 {
    u32::try_from(count).map_or(f64::MAX, f64::from)
}

/// The candidates of named sessions, ascending.
fn found(
    asked: Asked,
    names: &[String],
    places: &BTreeMap<&str, usize>,
) -> Result<Vec<usize>, RevisionError> {
    let mut all = BTreeSet::new();
    for id in names {
        let Some(&place) = places.get(id.as_str()) else {
            return Err(RevisionError::NoSuchOpportunity { asked, id: id.clone() });
        };
        if !all.insert(place) {
            return Err(RevisionError::NamedTwice { asked, id: id.clone() });
        }
    }
    Ok(all.into_iter().collect())
}
