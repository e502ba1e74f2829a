//! The problem as the search sees it: sessions that could stand, in integers.
//!
//! Times are i64 ns of TAI. Values are i64 units, one unit being the largest value (or a sixteenth of a larger
//! charge) over 2^40; a
//! value is rounded up, so that a bound on sums of units is a bound on sums of values. At most 2^21
//! candidates of at most 2^40 units keep every sum inside an i64.
//!
//! **Lanes** hold the sessions of which no two may overlap: one per telescope, or one for all. **Cells**
//! are the stretches of time that are searched exactly: the days of the day rule where there is one,
//! else equal parts of the mission.
//!
//! Limits: candidates without value, outside the mission, or too long for a day never enter; the reason
//! is noted for each.

use super::problem::Problem;
use super::reason::Because;
use super::rule::{Exclusive, Rules};
use crate::program::number::{f64_from_i128, i64_from_f64};
use onboard_core::time::Duration;

/// Units of the largest value.
const LARGEST_VALUE: f64 = 1_099_511_627_776.0;
/// Largest charge at one place over the largest value: the programme's values go to 2^45.
const CHARGE_PER_VALUE: f64 = 16.0;
/// Shortest cell where no rule sets days, in ns: a day.
const CELL_NS: i64 = 86_400_000_000_000;

/// A candidate that could stand.
#[derive(Debug, Clone, Copy)]
pub(super) struct Session {
    /// Index in the problem.
    pub(super) candidate: usize,
    /// Reserved from, ns.
    pub(super) start: i64,
    /// Reserved until, ns; after `start`.
    pub(super) end: i64,
    /// Sessions on one lane must not overlap.
    pub(super) lane: usize,
    /// Value in units, at least 1.
    pub(super) value: i64,
}

impl Session {
    /// Reserved time in ns, positive.
    pub(super) const fn length(&self) -> i64 {
        self.end.saturating_sub(self.start)
    }

    const fn overlaps(&self, other: &Self) -> bool {
        self.start < other.end && other.start < self.end
    }
}

/// All sessions that could stand, and the rules.
#[derive(Debug)]
pub(super) struct Model {
    /// By start, then end, lane and candidate.
    pub(super) sessions: Vec<Session>,
    /// Number of lanes; 0 where sessions may overlap.
    pub(super) lanes: usize,
    /// Ascending boundaries of the cells; cell k is `[cells[k], cells[k + 1])`.
    pub(super) cells: Vec<i64>,
    /// Most reserved ns in each cell, where cells are days with a limit; positive.
    pub(super) day_limit: Option<i64>,
    /// Most starts per sliding window, and the window's length in ns.
    pub(super) count: Option<(usize, i64)>,
    /// Telescope of each lane; `None` where one lane holds all.
    pub(super) lane_names: Vec<Option<usize>>,
    /// Longest reserved time of a session in ns.
    pub(super) longest: i64,
    /// Length of the mission in ns.
    pub(super) span_ns: i64,
    /// Value of the most valuable session, or more.
    largest: f64,
}

impl Model {
    /// The model, and for each candidate the reason why it can never stand, if there is one.
    pub(super) fn new(problem: &Problem) -> (Self, Vec<Option<Because>>) {
        let rules = &problem.rules;
        let total = problem.candidates.len();
        let reasons: Vec<_> = (0..total).map(|index| screen(problem, index)).collect();
        let stand = || (0..total).filter(|&index| reasons[index].is_none());
        // No charge is more than the integers of the programme hold.
        let charge = problem.demands.largest_charge() / CHARGE_PER_VALUE;
        let largest = stand().map(|index| problem.value(index)).fold(charge, f64::max);
        let telescopes = problem.candidates.iter().map(|it| it.telescope).collect();
        let (lane_names, lane_of) = lanes(rules.exclusive, telescopes);
        let mut sessions: Vec<_> = stand()
            .map(|candidate| {
                let (start, end) = problem.reserved(candidate);
                // The quotient and the product are off by less than a thousandth of a unit.
                let units = (problem.value(candidate) / largest * LARGEST_VALUE + 1e-3).ceil();
                Session {
                    candidate,
                    start: start.tai_ns(),
                    end: end.tai_ns(),
                    lane: lane_of(candidate),
                    value: i64_from_f64(units).max(1),
                }
            })
            .collect();
        sessions.sort_unstable_by_key(|it| (it.start, it.end, it.lane, it.candidate));
        let longest = sessions.iter().map(Session::length).max().unwrap_or(0);
        let model = Self {
            cells: cells(problem, longest),
            sessions,
            lanes: lane_names.len(),
            lane_names,
            longest,
            span_ns: problem.span.1.since(problem.span.0).ns(),
            day_limit: rules.max_per_day.map(Duration::ns),
            count: rules
                .max_sessions
                .map(|it| (usize::try_from(it.count).unwrap_or(usize::MAX), it.window.ns())),
            largest,
        };
        (model, reasons)
    }

    /// The same with other values, per session; those not above zero left out.
    pub(super) fn with_values(&self, values: &[i64]) -> Self {
        let worth = self.sessions.iter().zip(values).filter(|it| *it.1 > 0);
        Self {
            sessions: worth.map(|(it, &value)| Session { value, ..*it }).collect(),
            cells: self.cells.clone(),
            lane_names: self.lane_names.clone(),
            ..*self
        }
    }

    /// Candidates of sessions, in their order.
    pub(super) fn candidates(&self, ids: &[usize]) -> Vec<usize> {
        ids.iter().map(|&id| self.sessions[id].candidate).collect()
    }

    /// Whether two sessions must not stand together because they overlap.
    pub(super) const fn clash(&self, a: &Session, b: &Session) -> bool {
        self.lanes > 0 && a.lane == b.lane && a.overlaps(b)
    }

    /// Number of cells.
    pub(super) fn cell_count(&self) -> usize {
        self.cells.len().saturating_sub(1)
    }

    /// The cell that holds an instant of the mission.
    pub(super) fn cell_at(&self, at: i64) -> usize {
        self.cells.partition_point(|&boundary| boundary <= at).saturating_sub(1)
    }

    /// Each cell that a session touches, with the time in it in ns.
    pub(super) fn shares(&self, session: &Session) -> impl Iterator<Item = (usize, i64)> + '_ {
        let (start, end) = (session.start, session.end);
        (self.cell_at(start)..self.cell_count())
            .take_while(move |&cell| self.cells[cell] < end)
            .map(move |cell| {
                let (from, until) = (self.cells[cell], self.cells[cell + 1]);
                (cell, until.min(end).saturating_sub(from.max(start)))
            })
    }

    /// Time of a session in one cell, ns.
    pub(super) fn share(&self, session: &Session, cell: usize) -> i64 {
        let (from, until) = (self.cells[cell], self.cells[cell + 1]);
        until.min(session.end).saturating_sub(from.max(session.start)).max(0)
    }

    /// Identifiers of the sessions that start in `[from, until)`.
    pub(super) fn starting(&self, from: i64, until: i64) -> std::ops::Range<usize> {
        let first = self.sessions.partition_point(|it| it.start < from);
        first..self.sessions.partition_point(|it| it.start < until).max(first)
    }

    /// A bound in units as a bound on values, rounded up.
    pub(super) fn value_from_units(&self, units: i128) -> f64 {
        // Three roundings to nearest, each off by at most half of f64::EPSILON.
        f64_from_i128(units) / LARGEST_VALUE * self.largest * (1.0 + 2.0 * f64::EPSILON)
    }

    /// Units of the largest value, and that value.
    pub(super) const fn unit(&self) -> (f64, f64) {
        (LARGEST_VALUE, self.largest)
    }

    /// A price in units as a value.
    pub(super) fn price_from_units(&self, units: f64) -> f64 {
        units / LARGEST_VALUE * self.largest
    }
}

/// Why a candidate can stand in no schedule.
fn screen(problem: &Problem, index: usize) -> Option<Because> {
    let (start, end) = problem.reserved(index);
    if problem.value(index) <= 0.0 {
        return Some(Because::NoValue);
    }
    if start < problem.span.0 {
        return Some(Because::BeforeMission);
    }
    if end > problem.span.1 {
        return Some(Because::AfterMission);
    }
    let demands = &problem.demands;
    if demands.forbidden.contains(&index) {
        return Some(Because::Forbidden);
    }
    if demands.avoided.binary_search(&index).is_ok() {
        let skipped = demands.skipped.get(&index);
        return Some(skipped.map_or(Because::Avoided, |reason| Because::Skipped(*reason)));
    }
    if let Some(index) = demands.blackouts.iter().position(|it| it.0 < end && start < it.1) {
        return Some(Because::Blackout { index });
    }
    if problem.rules.max_sessions.is_some_and(|it| it.count == 0) {
        return Some(Because::SessionCount { from: start, count: 0 });
    }
    let limit = problem.rules.max_per_day?.ns();
    let days = &problem.rules.day_boundaries;
    let first = days.partition_point(|day| *day <= start).saturating_sub(1);
    (first..days.len().saturating_sub(1)).take_while(|&day| days[day] < end).find_map(|day| {
        let needs = end.min(days[day + 1]).since(start.max(days[day]));
        (needs.ns() > limit).then_some(Because::TooLongForDay { day, needs })
    })
}

/// The telescope of each lane, and the lane of each candidate.
fn lanes(
    exclusive: Exclusive,
    telescopes: Vec<usize>,
) -> (Vec<Option<usize>>, impl Fn(usize) -> usize) {
    let mut names: Vec<Option<usize>> = match exclusive {
        Exclusive::None => Vec::new(),
        Exclusive::Telescope => telescopes.iter().copied().map(Some).collect(),
        Exclusive::All => vec![None],
    };
    names.sort_unstable();
    names.dedup();
    let sorted = names.clone();
    let lane = move |candidate: usize| {
        let name = Some(telescopes[candidate]);
        if exclusive == Exclusive::Telescope { sorted.partition_point(|it| *it < name) } else { 0 }
    };
    (names, lane)
}

/// Boundaries of the cells.
fn cells(problem: &Problem, longest: i64) -> Vec<i64> {
    let Rules { max_per_day, day_boundaries, .. } = &problem.rules;
    if max_per_day.is_some() {
        return day_boundaries.iter().map(|boundary| boundary.tai_ns()).collect();
    }
    let length = longest.saturating_mul(2).max(CELL_NS);
    let (start, end) = (problem.span.0.tai_ns(), problem.span.1.tai_ns());
    let mut boundaries = vec![start];
    let mut at = start;
    while at < end {
        at = at.saturating_add(length);
        boundaries.push(at);
    }
    boundaries
}
