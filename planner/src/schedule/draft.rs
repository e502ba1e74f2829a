//! A schedule under construction: the sessions that stand, and the capacity that is left.
//!
//! Method: the sessions that stand are kept per lane and by start, and the reserved time per cell,
//! so that one more is checked in logarithmic time, exactly.
//!
//! Limits: it knows overlap, days and windows of starts; further rules are the programme's
//! (`joint/`).

use super::model::{Model, Session};
use super::reason::Because;
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

    /// Whether each session stands.
    pub(super) fn marks(&self) -> &[bool] {
        &self.stands
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

    /// Sessions whose removal lets a session in, if together they are worth less than it.
    ///
    /// All that overlap it; then in each day that is too full, and in each window, the least valuable
    /// until it fits.
    pub(super) fn cheaper_blockers(&self, session: &Session) -> Option<Vec<usize>> {
        let mut out: Vec<usize> = Vec::new();
        let mut budget = session.value;
        let mut eject = |id: usize, out: &mut Vec<usize>| {
            budget -= self.model.sessions[id].value;
            out.push(id);
            budget > 0
        };
        if let Some(lane) = self.lanes.get(session.lane) {
            let earlier = lane.range(..(session.end, 0)).rev();
            for (&(_, id), _) in earlier.take_while(|(_, end)| **end > session.start) {
                if !eject(id, &mut out) {
                    return None;
                }
            }
        }
        if self.model.day_limit.is_some() {
            for (cell, ns) in self.model.shares(session) {
                let share = |id: usize| self.model.share(&self.model.sessions[id], cell);
                let freed: i64 = out.iter().map(|&id| share(id)).sum();
                let mut excess = ns - self.left(cell) - freed;
                if excess <= 0 {
                    continue;
                }
                let (from, until) = (self.model.cells[cell], self.model.cells[cell + 1]);
                let first = from.saturating_sub(self.model.longest);
                let mut inside: Vec<usize> = self
                    .starts
                    .range((first, 0)..(until, 0))
                    .map(|&(_, id)| id)
                    .filter(|id| share(*id) > 0 && !out.contains(id))
                    .collect();
                inside.sort_unstable_by_key(|&id| (self.model.sessions[id].value, id));
                // The least valuable that is enough alone, or from the least valuable up.
                let alone = inside.iter().copied().find(|&id| share(id) >= excess);
                for id in alone.map_or(inside, |id| vec![id]) {
                    if !eject(id, &mut out) {
                        return None;
                    }
                    excess -= share(id);
                    if excess <= 0 {
                        break;
                    }
                }
            }
        }
        if let Some((count, window)) = self.model.count {
            let first = session.start.saturating_sub(window).saturating_add(1);
            let until = session.start.saturating_add(window);
            let range = self.starts.range((first, 0)..(until, 0));
            let mut near: Vec<(i64, usize)> =
                range.copied().filter(|(_, id)| !out.contains(id)).collect();
            let place = near.partition_point(|&(start, _)| start < session.start);
            near.insert(place, (session.start, usize::MAX));
            while let Some(run) =
                near.windows(count + 1).find(|run| run[count].0.saturating_sub(run[0].0) < window)
            {
                let others = run.iter().map(|&(_, id)| id).filter(|&id| id != usize::MAX);
                let least = others.min_by_key(|&id| (self.model.sessions[id].value, id))?;
                if !eject(least, &mut out) {
                    return None;
                }
                near.retain(|&(_, id)| id != least);
            }
        }
        Some(out)
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
