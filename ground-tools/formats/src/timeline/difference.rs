//! What changed against an earlier plan.
//!
//! A session with the same id in both plans is kept, or moved where its times differ.

use super::types::{Against, Session, Timeline};
use onboard_core::time::Instant;
use std::collections::{BTreeMap, BTreeSet};

/// What an earlier plan and this one do not share.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Difference {
    /// What the earlier plan is called: its file, and its digest where there is one.
    pub against: String,
    /// Sessions in both at the same times.
    pub kept: usize,
    /// Sessions that the earlier plan did not have, by start.
    pub added: Vec<Entry>,
    /// Sessions that only the earlier plan had, by start.
    pub dropped: Vec<Entry>,
    /// Sessions in both at other times, by their new start.
    pub moved: Vec<Moved>,
    /// This plan's objective less the earlier one's.
    pub objective: f64,
}

impl Difference {
    /// What a timeline changes against an earlier one, which is called `against`.
    #[must_use]
    pub fn of(earlier: &Timeline, now: &Timeline, against: String) -> Self {
        let before: BTreeMap<&str, &Session> =
            earlier.sessions.iter().map(|it| (it.id.as_str(), it)).collect();
        let mut kept = BTreeSet::new();
        let objective = now.objective - earlier.objective;
        let mut difference = Self { against, objective, ..Self::default() };
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
        let gone = earlier.sessions.iter().filter(|it| !kept.contains(it.id.as_str()));
        difference.dropped = gone.map(entry).collect();
        difference
    }

    /// As the timeline holds it; `sha256` is of the earlier plan.
    #[must_use]
    pub fn by_ids(&self, sha256: &str) -> Against {
        let ids = |list: &[Entry]| list.iter().map(|it| it.id.clone()).collect();
        Against {
            sha256: sha256.to_owned(),
            kept: self.kept,
            added: ids(&self.added),
            dropped: ids(&self.dropped),
            moved: self.moved.iter().map(|it| it.now.id.clone()).collect(),
        }
    }
}

/// A session as the timeline tells it.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Telescope, target and precession turn.
    pub id: String,
    /// Telescope's name.
    pub telescope: String,
    /// Target's name.
    pub target: String,
    /// Start, setup included.
    pub start: Instant,
    /// End, cooldown included.
    pub end: Instant,
    /// Time with the target in view.
    pub dwell_s: f64,
}

/// A session at other times than before.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// As it was.
    pub before: Entry,
    /// As it is.
    pub now: Entry,
}

fn entry(it: &Session) -> Entry {
    Entry {
        id: it.id.clone(),
        telescope: it.telescope.clone(),
        target: it.target.clone(),
        start: it.start(),
        end: it.end(),
        dwell_s: it.dwell_s,
    }
}
