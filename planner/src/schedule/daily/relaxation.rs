//! Dual prices from the linear relaxation, solved by `crate::conic`.
//!
//! Method: maximise `w . x` over `0 <= x <= 1` under one row per maximal clique of overlapping
//! reserved intervals on a lane, one per day with a limit, and one per sliding window (`instants.rs`).
//! Long windows are differences of a cumulative number of starts, so that their rows stay short. Rows
//! are scaled to a right-hand side of about one and values to at most one. With a day limit, where few
//! sessions can stand, columns are generated: the densest and most valuable of each cell at first, then
//! those of positive reduced value at the prices found, until what is left out can raise the bound by
//! [`LEFT_OUT`] of it at most. The prices hold for all sessions, since each belongs to an instant, a cell
//! or a window and not to a matrix.
//!
//! Limits: prices are approximate and need not be optimal; nothing relies on them but the quality
//! of bound and schedule. Where the solver fails, the prices of the round before stay, or none.

use super::bound::priced;
use crate::conic::{Cone, Conic, Solution};
use crate::program::number::{f64_from_i64, f64_from_i128, i64_from_usize};
use crate::schedule::instants::{MOST_APART, WINDOWS, cliques, window_starts};
use crate::schedule::model::Model;
use crate::schedule::price::{Ladder, Prices};
use std::cmp::Reverse;

/// One unit of the relaxation's objective, in units of value.
const UNIT: f64 = 1_099_511_627_776.0;
/// Most rounds of adding sessions.
const ROUNDS: usize = 6;
/// Sessions left out may raise the bound by this share.
const LEFT_OUT: f64 = 1e-2;
/// The densest sessions of each cell that the first round sees, and the most valuable.
const FIRST: (usize, usize) = (12, 4);
/// Tolerance with a day limit, where a sharper bound follows, and without.
const TOLERANCE: (f64, f64) = (1e-4, 1e-7);
/// Most iterations of the solver.
const ITERATIONS: u32 = 100;

/// Dual prices, and the share of each session in the relaxed schedule.
#[derive(Debug)]
pub(crate) struct Relaxed {
    pub(crate) prices: Prices,
    /// In [0, 1] up to the solver's tolerance, per session.
    pub(crate) shares: Vec<f64>,
    /// The solver reached its tolerances.
    pub(crate) solved: bool,
}

impl Relaxed {
    /// Mean value in units of the sessions in the relaxed schedule.
    pub(super) fn typical_value(&self, model: &Model) -> f64 {
        let (mut values, mut shares) = (0.0, 0.0);
        for (session, share) in model.sessions.iter().zip(&self.shares) {
            let share = share.clamp(0.0, 1.0);
            values += share * f64_from_i64(session.value);
            shares += share;
        }
        if shares > 1e-3 { values / shares } else { UNIT }
    }
}

/// Prices and shares from the linear relaxation.
pub(crate) fn solve(model: &Model) -> Relaxed {
    let total = model.sessions.len();
    let mut relaxed =
        Relaxed { prices: Prices::none(model), shares: vec![0.0; total], solved: total == 0 };
    if total == 0 {
        return relaxed;
    }
    let mut inside = first_sessions(model);
    for _ in 0..ROUNDS {
        let ids: Vec<usize> = (0..total).filter(|&id| inside[id]).collect();
        let Some((prices, shares)) = solve_over(model, &ids) else { break };
        relaxed.prices = prices;
        relaxed.solved = true;
        relaxed.shares.fill(0.0);
        for (&id, share) in ids.iter().zip(shares) {
            relaxed.shares[id] = share;
        }
        let mut missing = 0_i128;
        for (id, session) in model.sessions.iter().enumerate() {
            let surplus = session.value - relaxed.prices.of(model, session);
            if !inside[id] && surplus > 0 {
                missing += i128::from(surplus);
                inside[id] = true;
            }
        }
        let bound = priced(model, &relaxed.prices);
        if f64_from_i128(missing) <= LEFT_OUT * f64_from_i128(bound) {
            break;
        }
    }
    relaxed
}

/// The sessions that the first round sees.
fn first_sessions(model: &Model) -> Vec<bool> {
    let total = model.sessions.len();
    if model.day_limit.is_none() {
        return vec![true; total];
    }
    let mut inside = vec![false; total];
    for cell in 0..model.cell_count() {
        let mut ids: Vec<usize> =
            model.starting(model.cells[cell], model.cells[cell + 1]).collect();
        let density = |id: usize| {
            let session = &model.sessions[id];
            f64_from_i64(session.value) / f64_from_i64(session.length())
        };
        ids.sort_by(|&a, &b| density(b).total_cmp(&density(a)));
        for &id in ids.iter().take(FIRST.0) {
            inside[id] = true;
        }
        ids.sort_by_key(|&id| Reverse(model.sessions[id].value));
        for &id in ids.iter().take(FIRST.1) {
            inside[id] = true;
        }
    }
    inside
}

/// The rows of a relaxation, and the place of the price that each row's dual goes to.
///
/// First the equalities that define the cumulative number of starts, then the limits.
struct Rows {
    /// First instants of the windows, ascending.
    windows: Vec<i64>,
    /// Where starts are counted up: all first and last instants of windows, ascending; empty where
    /// windows are so short that each session can stand in the rows of all of its own.
    marks: Vec<i64>,
    /// Instants of the clique rows per lane, ascending, and the number of their first row.
    instants: Vec<(Vec<i64>, usize)>,
    /// Number of the row of each cell.
    cells: Vec<Option<usize>>,
    /// Number of the first window's row.
    first_window: usize,
    /// Number of rows.
    count: usize,
}

impl Rows {
    fn new(model: &Model, ids: &[usize]) -> Self {
        let windows = window_starts(model, ids);
        let length = model.count.map_or(0, |(_, window)| window);
        let mut marks: Vec<i64> = Vec::new();
        if length / WINDOWS > MOST_APART {
            let ends = windows.iter().map(|at| at.saturating_add(length));
            marks.extend(windows.iter().copied().chain(ends));
        }
        marks.sort_unstable();
        marks.dedup();
        let mut count = marks.len().saturating_sub(1);
        let instants = (0..model.lanes)
            .map(|lane| {
                let on_lane = ids.iter().copied().filter(|&id| model.sessions[id].lane == lane);
                let points = cliques(model, on_lane);
                let first = count;
                count += points.len();
                (points, first)
            })
            .collect();
        let mut cells = vec![None; model.cell_count()];
        if model.day_limit.is_some() {
            for &id in ids {
                for (cell, _) in model.shares(&model.sessions[id]) {
                    cells[cell].get_or_insert(0);
                }
            }
            for row in cells.iter_mut().flatten() {
                *row = count;
                count += 1;
            }
        }
        let first_window = count;
        count += windows.len();
        Self { windows, marks, instants, cells, first_window, count }
    }

    /// Rows and coefficients of a session, rows ascending.
    fn of(&self, model: &Model, id: usize) -> Vec<(usize, f64)> {
        let session = &model.sessions[id];
        let mut entries = Vec::new();
        let mark = self.marks.partition_point(|&at| at <= session.start);
        if mark > 0 && mark < self.marks.len() {
            entries.push((mark - 1, -1.0));
        }
        if let Some((points, first)) = self.instants.get(session.lane) {
            let from = points.partition_point(|&at| at < session.start);
            let until = points.partition_point(|&at| at < session.end);
            entries.extend((from..until).map(|place| (first + place, 1.0)));
        }
        if let Some(limit) = model.day_limit {
            entries.extend(model.shares(session).filter_map(|(cell, ns)| {
                self.cells[cell].map(|row| (row, f64_from_i64(ns) / f64_from_i64(limit)))
            }));
        }
        if let (Some((count, window)), true) = (model.count, self.marks.is_empty()) {
            let oldest = session.start.saturating_sub(window);
            let from = self.windows.partition_point(|&at| at <= oldest);
            let until = self.windows.partition_point(|&at| at <= session.start);
            let share = 1.0 / f64_from_i64(i64_from_usize(count));
            entries.extend((from..until).map(|place| (self.first_window + place, share)));
        }
        entries
    }

    /// Rows and coefficients of the cumulative number y of starts at each mark but the first, where it
    /// is zero: `y[k + 1] - y[k] - starts between = 0`, `(y[end] - y[start]) / count <= 1`.
    fn of_marks(&self, model: &Model) -> Vec<Vec<(usize, f64)>> {
        let mut entries = vec![Vec::new(); self.marks.len()];
        for row in 1..self.marks.len() {
            entries[row - 1].push((row - 1, -1.0));
            entries[row].push((row - 1, 1.0));
        }
        // The row that ends at a mark comes before the row that starts at it.
        for column in &mut entries {
            column.sort_unstable_by_key(|entry| entry.0);
        }
        if let (Some((count, window)), false) = (model.count, self.marks.is_empty()) {
            let share = 1.0 / f64_from_i64(i64_from_usize(count));
            for (place, &at) in self.windows.iter().enumerate() {
                let row = self.first_window + place;
                let end = at.saturating_add(window);
                entries[self.marks.partition_point(|&mark| mark < at)].push((row, -share));
                entries[self.marks.partition_point(|&mark| mark < end)].push((row, share));
            }
        }
        entries.into_iter().skip(1).collect()
    }

    fn prices(&self, model: &Model, dual: &[f64]) -> Prices {
        let ladder = |points: &[i64], first: usize, unit: f64| {
            Ladder::new(points.iter().zip(&dual[first..]).map(|(&at, z)| (at, z * unit)))
        };
        let mut prices = Prices::none(model);
        for (prices, (points, first)) in prices.lanes.iter_mut().zip(&self.instants) {
            *prices = ladder(points, *first, UNIT);
        }
        for (cell, row) in self.cells.iter().enumerate() {
            if let (Some(row), Some(limit)) = (row, model.day_limit) {
                prices.set_cell(cell, dual[*row] * UNIT, limit);
            }
        }
        if let Some((count, _)) = model.count {
            let unit = UNIT / f64_from_i64(i64_from_usize(count));
            prices.windows = ladder(&self.windows, self.first_window, unit);
        }
        prices
    }
}

/// Prices and shares with only the sessions `ids`, by start; `None` where the solver fails.
fn solve_over(model: &Model, ids: &[usize]) -> Option<(Prices, Vec<f64>)> {
    let rows = Rows::new(model, ids);
    let sessions = ids.len();
    // x <= 1 follows from the cliques where there are lanes.
    let capped = model.lanes == 0;
    let mut columns: Vec<Vec<(usize, f64)>> = Vec::with_capacity(sessions);
    for (column, &id) in ids.iter().enumerate() {
        let mut entries = rows.of(model, id);
        entries.push((rows.count + column, -1.0));
        if capped {
            entries.push((rows.count + sessions + column, 1.0));
        }
        columns.push(entries);
    }
    columns.extend(rows.of_marks(model));
    let (height, width) =
        (rows.count + if capped { 2 * sessions } else { sessions }, columns.len());
    let equalities = rows.marks.len().saturating_sub(1);
    let mut limits = vec![1.0; height];
    limits[..equalities].fill(0.0);
    limits[rows.count..rows.count + sessions].fill(0.0);
    let mut costs: Vec<f64> =
        ids.iter().map(|&id| -f64_from_i64(model.sessions[id].value) / UNIT).collect();
    costs.resize(width, 0.0);
    let tolerance = if model.day_limit.is_some() { TOLERANCE.0 } else { TOLERANCE.1 };
    let cones = vec![Cone::Zero(equalities), Cone::Nonnegative(height - equalities)];
    let conic = Conic { columns, costs, limits, cones, tolerance, iterations: ITERATIONS };
    let Solution { primal, dual } = conic.solve()?;
    let shares = primal.into_iter().take(sessions).collect();
    Some((rows.prices(model, &dual), shares))
}
