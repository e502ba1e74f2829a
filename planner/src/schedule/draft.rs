//! A schedule in the making: what stands, and what the rules leave.
//!
//! Method: the sessions that stand are kept per lane and by start, and the reserved time per cell,
//! so that one more is checked in logarithmic time, exactly.

use super::explain::Because;
use super::model::{Model, Session};
use onboard_core::time::Instant;
use std::collections::{BTreeMap, BTreeSet};

/// A set of sessions that meets every rule.
#[derive(Debug, Clone)]
pub(super) struct Draft<'a> {
    model: &'a Model,
    stands: Vec<bool>,
    /// Per lane, by (start, id): the end.
    lanes: Vec<BTreeMap<(i64, usize), i64>>,
    /// By (start, id), all that stand.
    starts: BTreeSet<(i64, usize)>,
    /// Reserved ns in each cell; empty without a day limit.
    used: Vec<i64>,
    value: i64,
}

impl<'a> Draft<'a> {
    /// Nothing stands.
    pub(super) fn new(model: &'a Model) -> Self {
        Self {
            model,
            stands: vec![false; model.sessions.len()],
            lanes: vec![BTreeMap::new(); model.lanes],
            starts: BTreeSet::new(),
            used: model.day_limit.map(|_| vec![0; model.cell_count()]).unwrap_or_default(),
            value: 0,
        }
    }

    /// The sessions that stand, by start.
    pub(super) fn chosen(&self) -> impl Iterator<Item = usize> + '_ {
        self.starts.iter().map(|&(_, id)| id)
    }

    /// Whether a session stands.
    pub(super) fn stands(&self, id: usize) -> bool {
        self.stands[id]
    }

    /// Sum of the values in units.
    pub(super) const fn value(&self) -> i64 {
        self.value
    }

    /// Time of a cell that the rules leave, ns.
    pub(super) fn left(&self, cell: usize) -> i64 {
        self.model.day_limit.map_or(i64::MAX, |limit| limit - self.used[cell])
    }

    /// Reserved ns in a cell with a limit.
    pub(super) fn used(&self, cell: usize) -> i64 {
        self.used[cell]
    }

    /// Starts in `[from, until)` that stand, ascending.
    pub(super) fn starts(&self, from: i64, until: i64) -> impl Iterator<Item = i64> + '_ {
        let range = (from, 0)..(until.max(from), 0);
        self.starts.range(range).map(|&(start, _)| start)
    }

    /// Whether a session may be added.
    pub(super) fn fits(&self, session: &Session) -> bool {
        self.clash(session).is_none()
            && self.full_cell(session).is_none()
            && self.full_window(session).is_none()
    }

    /// The rule that keeps a session out, if there is one.
    pub(super) fn refusal(&self, session: &Session) -> Option<Because> {
        if let Some(id) = self.clash(session) {
            return Some(Because::Conflict { with: self.model.sessions[id].candidate });
        }
        if let Some((day, needs, left)) = self.full_cell(session) {
            return Some(Because::day_full(day, needs, left));
        }
        let (count, _) = self.model.count?;
        let from = self.full_window(session)?;
        Some(Because::SessionCount { from: Instant::from_tai_ns(from), count })
    }

    /// A session that stands and overlaps.
    fn clash(&self, session: &Session) -> Option<usize> {
        let lane = self.lanes.get(session.lane)?;
        // Those that stand do not overlap, so the last that starts before the end decides.
        let (&(_, id), &end) = lane.range(..(session.end, 0)).next_back()?;
        (end > session.start).then_some(id)
    }

    /// A cell with too little time left, what the session needs there, and what is left.
    fn full_cell(&self, session: &Session) -> Option<(usize, i64, i64)> {
        self.model.day_limit?;
        self.model
            .shares(session)
            .map(|(cell, ns)| (cell, ns, self.left(cell)))
            .find(|&(_, ns, left)| ns > left)
    }

    /// Start of a window that one more start would overfill.
    fn full_window(&self, session: &Session) -> Option<i64> {
        let (count, window) = self.model.count?;
        let start = session.start;
        let first = start.saturating_sub(window).saturating_add(1);
        let mut near: Vec<i64> = self.starts(first, start.saturating_add(window)).collect();
        let place = near.partition_point(|&other| other < start);
        near.insert(place, start);
        let from =
            near.windows(count + 1).find(|run| run[count].saturating_sub(run[0]) < window)?;
        Some(from[0])
    }

    /// Adds a session that fits.
    pub(super) fn add(&mut self, id: usize) {
        let session = self.model.sessions[id];
        self.stands[id] = true;
        self.value += session.value;
        self.starts.insert((session.start, id));
        if let Some(lane) = self.lanes.get_mut(session.lane) {
            lane.insert((session.start, id), session.end);
        }
        if !self.used.is_empty() {
            for (cell, ns) in self.model.shares(&session) {
                self.used[cell] += ns;
            }
        }
    }

    /// Takes a session out.
    pub(super) fn remove(&mut self, id: usize) {
        let session = self.model.sessions[id];
        self.stands[id] = false;
        self.value -= session.value;
        self.starts.remove(&(session.start, id));
        if let Some(lane) = self.lanes.get_mut(session.lane) {
            lane.remove(&(session.start, id));
        }
        if !self.used.is_empty() {
            for (cell, ns) in self.model.shares(&session) {
                self.used[cell] -= ns;
            }
        }
    }
}
