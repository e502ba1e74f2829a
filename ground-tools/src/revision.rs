//! What a person asks of a plan beyond the mission file: an earlier plan to stay close to, a part of
//! it frozen, sessions fixed or forbidden.
//!
//! Sessions are named by their ids, `TELESCOPE-TARGET-TURN`; a turn counts from the mission's start,
//! so an earlier plan must be of a mission with the same name and start. Its other inputs may differ:
//! that is what replanning is for.

use crate::failure::Failure;
use crate::report::{Difference, Entry, Moved};
use crate::resolve::sha256_hex;
use crate::timeline::{Session, Timeline};
use crate::world::World;
use ephem::time::format_tdb;
use onboard_core::time::Instant;
use planner::schedule::{Previous, Problem};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Share of the mean worth of an earlier plan's sessions that a change must bring, unless said.
const CHANGE_SHARE: f64 = 0.1;

/// An earlier plan.
#[derive(Debug)]
pub struct Earlier {
    /// Its `timeline.json`.
    pub file: PathBuf,
    /// SHA-256 of that file.
    pub sha256: String,
    /// What it holds.
    pub timeline: Timeline,
}

impl Timeline {
    /// The timeline of a file.
    ///
    /// # Errors
    /// [`Failure::Input`] where there is none.
    pub fn read(file: &Path) -> Result<(Self, Vec<u8>), Failure> {
        let bytes = std::fs::read(file).map_err(|error| Failure::file("read", file, &error))?;
        let timeline = serde_json::from_slice(&bytes).map_err(|error| {
            let file = file.display();
            Failure::Input(format!("{file} is no timeline as plan writes it: {error}"))
        })?;
        Ok((timeline, bytes))
    }
}

impl Earlier {
    /// The plan of a folder, or of a `timeline.json`.
    ///
    /// # Errors
    /// [`Failure::Input`] where it is not one, names a session twice, or is another mission's.
    pub fn read(path: &Path, world: &World) -> Result<Self, Failure> {
        let file = if path.is_dir() { path.join("timeline.json") } else { path.to_owned() };
        let (timeline, bytes) = Timeline::read(&file)?;
        let place = file.display();
        let (mission, before) = (&world.mission.name, &timeline.provenance);
        if before.mission != *mission {
            return Err(Failure::Input(format!(
                "{place} is a plan of {}, but this mission is {mission}: an earlier plan of the \
                 same mission is needed",
                before.mission
            )));
        }
        if before.start_tai_ns != world.start.tai_ns() {
            return Err(Failure::Input(format!(
                "{place} is a plan of {mission} from {}, but this mission starts at {}: precession \
                 turns, and so the ids of sessions, count from the start, which must be the same",
                before.start_tdb,
                format_tdb(world.start)
            )));
        }
        let mut ids = BTreeSet::new();
        if let Some(twice) = timeline.sessions.iter().find(|it| !ids.insert(&it.id)) {
            return Err(Failure::Input(format!("{place} holds the session {} twice", twice.id)));
        }
        Ok(Self { file, sha256: sha256_hex(&bytes), timeline })
    }

    /// What a timeline changes.
    #[must_use]
    pub fn difference(&self, now: &Timeline) -> Difference {
        let before: BTreeMap<&str, &Session> =
            self.timeline.sessions.iter().map(|it| (it.id.as_str(), it)).collect();
        let mut kept = BTreeSet::new();
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        let mut difference = Difference {
            against: format!("{name}, SHA-256 {}", self.sha256),
            objective: now.objective - self.timeline.objective,
            ..Difference::default()
        };
        for session in &now.sessions {
            let Some(was) = before.get(session.id.as_str()) else {
                difference.added.push(entry(session));
                continue;
            };
            kept.insert(session.id.as_str());
            let times = |it: &Session| (it.start_tai_ns, it.end_tai_ns);
            if times(was) == times(session) {
                difference.kept += 1;
            } else {
                difference.moved.push(Moved { before: entry(was), now: entry(session) });
            }
        }
        let gone = self.timeline.sessions.iter().filter(|it| !kept.contains(it.id.as_str()));
        difference.dropped = gone.map(entry).collect();
        difference
    }
}

fn entry(it: &Session) -> Entry {
    Entry {
        id: it.id.clone(),
        telescope: it.telescope.clone(),
        target: it.target.clone(),
        start_utc: it.start_utc.clone(),
        end_utc: it.end_utc.clone(),
        dwell_s: it.dwell_s,
    }
}

/// What a person asks.
#[derive(Debug, Clone, Copy)]
pub struct Revision<'r> {
    /// An earlier plan.
    pub earlier: Option<&'r Earlier>,
    /// What each session added or dropped must bring to the objective.
    pub change_price: Option<f64>,
    /// Before this instant the earlier plan stays as it is.
    pub frozen_until: Option<Instant>,
    /// Sessions that must stand.
    pub fixed: &'r [String],
    /// Sessions that must not.
    pub forbidden: &'r [String],
}

impl Revision<'_> {
    /// Asks it of a problem whose candidates have these ids.
    ///
    /// # Errors
    /// [`Failure::Input`] names the session that does not exist, or is asked for in two ways.
    pub fn ask(&self, ids: &[String], problem: &mut Problem) -> Result<(), Failure> {
        let places: BTreeMap<&str, usize> =
            ids.iter().enumerate().map(|(place, id)| (id.as_str(), place)).collect();
        let fixed = found("--fix", self.fixed, &places)?;
        let forbidden = found("--forbid", self.forbidden, &places)?;
        if let Some(&both) = fixed.iter().find(|it| forbidden.contains(it)) {
            let id = &ids[both];
            return Err(Failure::Input(format!("the session {id} is both fixed and forbidden")));
        }
        problem.demands.fixed = fixed;
        problem.demands.forbidden = forbidden;
        let Some(earlier) = self.earlier else { return Ok(()) };
        let before = &earlier.timeline.sessions;
        let standing: Vec<usize> =
            before.iter().filter_map(|it| places.get(it.id.as_str()).copied()).collect();
        if standing.is_empty() && !before.is_empty() {
            return Err(Failure::Input(format!(
                "none of the {} sessions of {} is an opportunity of this mission: an earlier plan \
                 of the same mission is needed",
                before.len(),
                earlier.file.display()
            )));
        }
        if let Some(until) = self.frozen_until {
            self.freeze(until, &places, problem)?;
        }
        let mean = earlier.timeline.objective / f64_from(before.len().max(1));
        let price = self.change_price.unwrap_or_else(|| (CHANGE_SHARE * mean).max(0.0));
        problem.demands.previous = Some(Previous { sessions: standing, price });
        Ok(())
    }

    /// Fixes what the earlier plan starts before an instant, and forbids all else there.
    fn freeze(
        &self,
        until: Instant,
        places: &BTreeMap<&str, usize>,
        problem: &mut Problem,
    ) -> Result<(), Failure> {
        let sessions = self.earlier.map_or(&[][..], |it| &it.timeline.sessions);
        let mut frozen = BTreeSet::new();
        for session in sessions.iter().filter(|it| it.start_tai_ns < until.tai_ns()) {
            let Some(&place) = places.get(session.id.as_str()) else {
                return Err(Failure::Input(format!(
                    "the session {} of the earlier plan is frozen, but this mission offers no such \
                     opportunity",
                    session.id
                )));
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
}

/// A count as a number.
fn f64_from(count: usize) -> f64 {
    u32::try_from(count).map_or(f64::MAX, f64::from)
}

/// The candidates of named sessions, ascending.
fn found(
    option: &str,
    names: &[String],
    places: &BTreeMap<&str, usize>,
) -> Result<Vec<usize>, Failure> {
    let mut all = BTreeSet::new();
    for name in names {
        let Some(&place) = places.get(name.as_str()) else {
            return Err(Failure::Input(format!(
                "{option} {name}: the mission offers no such opportunity; ids are \
                 TELESCOPE-TARGET-TURN with six digits of the turn, as timeline.json has them"
            )));
        };
        if !all.insert(place) {
            return Err(Failure::Input(format!("{option} names {name} twice")));
        }
    }
    Ok(all.into_iter().collect())
}
