//! Prices from the linear relaxation, solved by Clarabel. No other module sees the solver.
//!
//! Method: maximise `w . x` over `0 <= x <= 1` under one row per maximal clique of overlapping
//! reserved intervals on a lane, one per day with a limit, and one per sliding window, windows an
//! eighth of their length apart. Rows are scaled to a right-hand side of about one and values to at
//! most one. All rules reach only days, so the mission is solved in parts of [`PART_CELLS`] cells,
//! each with [`MARGIN_CELLS`] more on either side; a part gives the prices and shares of its own
//! cells. Prices hold for all sessions wherever they come from, since each belongs to an instant, a
//! cell or a window and not to a matrix.
//!
//! Limits: prices are approximate and need not be optimal; nothing relies on them but the quality
//! of bound and schedule. A part whose solver fails has no prices.

use super::model::Model;
use super::number::{f64_from_i64, i64_from_usize};
use super::price::{Ladder, Prices};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus,
};
use rayon::prelude::*;

/// One unit of the relaxation's objective, in units of value.
const UNIT: f64 = 1_099_511_627_776.0;
/// Cells that one part prices.
const PART_CELLS: usize = 24;
/// Cells on either side that it sees besides.
const MARGIN_CELLS: usize = 3;

/// Prices, and the share of each session in the relaxed schedule.
#[derive(Debug)]
pub(super) struct Relaxed {
    pub(super) prices: Prices,
    /// In [0, 1] up to the solver's tolerance, per session.
    pub(super) shares: Vec<f64>,
    /// The solver reached its tolerances.
    pub(super) solved: bool,
}

/// Prices and shares from the linear relaxation.
pub(super) fn solve(model: &Model) -> Relaxed {
    let cells = model.cell_count();
    let parts: Vec<(usize, Option<Part>)> = (0..cells)
        .into_par_iter()
        .step_by(PART_CELLS)
        .map(|first| (first, solve_part(model, first, (first + PART_CELLS).min(cells))))
        .collect();
    let mut relaxed = Relaxed {
        prices: Prices::none(model),
        shares: vec![0.0; model.sessions.len()],
        solved: parts.iter().all(|(_, part)| part.is_some()),
    };
    let mut points = vec![Vec::new(); model.lanes];
    let mut windows = Vec::new();
    for part in parts.into_iter().filter_map(|(_, part)| part) {
        for (points, more) in points.iter_mut().zip(part.instants) {
            points.extend(more);
        }
        windows.extend(part.windows);
        if let Some(limit) = model.day_limit {
            for (cell, price) in part.cells {
                relaxed.prices.set_cell(cell, price, limit);
            }
        }
        for (id, share) in part.shares {
            relaxed.shares[id] = share;
        }
    }
    relaxed.prices.lanes =
        points.into_iter().map(|points| Ladder::new(points.into_iter())).collect();
    relaxed.prices.windows = Ladder::new(windows.into_iter());
    relaxed
}

/// What one part of the mission tells: prices in units, by instant or cell, and shares by session.
struct Part {
    instants: Vec<Vec<(i64, f64)>>,
    cells: Vec<(usize, f64)>,
    windows: Vec<(i64, f64)>,
    shares: Vec<(usize, f64)>,
}

/// Solves the cells `first..last` with their margins; `None` where the solver fails.
fn solve_part(model: &Model, first: usize, last: usize) -> Option<Part> {
    let wide_first = first.saturating_sub(MARGIN_CELLS);
    let wide_last = (last + MARGIN_CELLS).min(model.cell_count());
    let ids: Vec<usize> = model.starting(model.cells[wide_first], model.cells[wide_last]).collect();
    let (rows, dual, shares) = if ids.is_empty() {
        (Rows::new(model, &ids), Vec::new(), Vec::new())
    } else {
        solve_over(model, &ids)?
    };
    let (from, until) = (model.cells[first], model.cells[last]);
    let own = |at: &i64| (from..until).contains(at);
    let priced = |points: &[i64], row: usize, unit: f64| -> Vec<(i64, f64)> {
        let prices = points.iter().zip(&dual[row..]);
        prices.filter(|(at, _)| own(at)).map(|(&at, z)| (at, z * unit)).collect()
    };
    let count = model.count.map_or(1, |(count, _)| count);
    Some(Part {
        instants: rows.instants.iter().map(|(points, row)| priced(points, *row, UNIT)).collect(),
        cells: (first..last)
            .filter_map(|cell| rows.cells[cell].map(|row| (cell, dual[row] * UNIT)))
            .collect(),
        windows: priced(
            &rows.windows.0,
            rows.windows.1,
            UNIT / f64_from_i64(i64_from_usize(count)),
        ),
        shares: ids
            .into_iter()
            .zip(shares)
            .filter(|(id, _)| own(&model.sessions[*id].start))
            .collect(),
    })
}

/// The rows of a relaxation, each with the prices' place that its dual goes to.
struct Rows {
    /// Instants of the clique rows per lane, ascending, and the number of their first row.
    instants: Vec<(Vec<i64>, usize)>,
    /// Number of the row of each cell.
    cells: Vec<Option<usize>>,
    /// First instants of the windows, ascending, and the number of their first row.
    windows: (Vec<i64>, usize),
    /// Number of rows.
    count: usize,
}

impl Rows {
    fn new(model: &Model, ids: &[usize]) -> Self {
        let mut count = 0;
        let instants = (0..model.lanes)
            .map(|lane| {
                let points = cliques(
                    model,
                    ids.iter().copied().filter(|&id| model.sessions[id].lane == lane),
                );
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
        let windows = (window_starts(model, ids), count);
        count += windows.0.len();
        Self { instants, cells, windows, count }
    }

    /// Rows and coefficients of a session, rows ascending.
    fn of(&self, model: &Model, id: usize) -> Vec<(usize, f64)> {
        let session = &model.sessions[id];
        let mut entries = Vec::new();
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
        if let Some((count, window)) = model.count {
            let (points, first) = &self.windows;
            let oldest = session.start.saturating_sub(window);
            let from = points.partition_point(|&at| at <= oldest);
            let until = points.partition_point(|&at| at <= session.start);
            let share = 1.0 / f64_from_i64(i64_from_usize(count));
            entries.extend((from..until).map(|place| (first + place, share)));
        }
        entries
    }
}

/// One instant in each maximal set of sessions that overlap; sessions come by start.
fn cliques(model: &Model, ids: impl Iterator<Item = usize>) -> Vec<i64> {
    let mut points = Vec::new();
    let mut open: Option<(i64, i64)> = None;
    for id in ids {
        let session = &model.sessions[id];
        // `open` is the last start and the first end since the last instant was set down.
        open = match open {
            Some((last, first_end)) if session.start >= first_end => {
                points.push(last);
                Some((session.start, session.end))
            }
            Some((_, first_end)) => Some((session.start, first_end.min(session.end))),
            None => Some((session.start, session.end)),
        };
    }
    points.extend(open.map(|(last, _)| last));
    points
}

/// First instants of the windows that get a row.
fn window_starts(model: &Model, ids: &[usize]) -> Vec<i64> {
    let Some((count, window)) = model.count else { return Vec::new() };
    let mut points: Vec<i64> = Vec::new();
    for (place, &id) in ids.iter().enumerate() {
        let start = model.sessions[id].start;
        let apart = points.last().is_none_or(|&last| start.saturating_sub(last) >= window / 8);
        let crowded = ids
            .get(place.saturating_add(count))
            .is_some_and(|&other| model.sessions[other].start < start.saturating_add(window));
        if apart && crowded {
            points.push(start);
        }
    }
    points
}

/// Rows, their duals and the shares of the sessions `ids`, by start; `None` where the solver fails.
fn solve_over(model: &Model, ids: &[usize]) -> Option<(Rows, Vec<f64>, Vec<f64>)> {
    let rows = Rows::new(model, ids);
    let n = ids.len();
    // x <= 1 follows from the cliques where there are lanes.
    let capped = model.lanes == 0;
    let mut starts = vec![0];
    let (mut row_of, mut coefficients) = (Vec::new(), Vec::new());
    for (column, &id) in ids.iter().enumerate() {
        for (row, coefficient) in rows.of(model, id) {
            row_of.push(row);
            coefficients.push(coefficient);
        }
        row_of.push(rows.count + column);
        coefficients.push(-1.0);
        if capped {
            row_of.push(rows.count + n + column);
            coefficients.push(1.0);
        }
        starts.push(row_of.len());
    }
    let height = rows.count + if capped { 2 * n } else { n };
    let mut limits = vec![1.0; height];
    limits[rows.count..rows.count + n].fill(0.0);
    let matrix = CscMatrix::new(height, n, starts, row_of, coefficients);
    let costs: Vec<f64> =
        ids.iter().map(|&id| -f64_from_i64(model.sessions[id].value) / UNIT).collect();
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_rel(1e-6)
        .tol_gap_abs(1e-6)
        .tol_feas(1e-7)
        .max_iter(60)
        .build()
        .ok()?;
    let cones = [NonnegativeConeT(height)];
    let squares = CscMatrix::zeros((n, n));
    let mut solver =
        DefaultSolver::new(&squares, &costs, &matrix, &limits, &cones, settings).ok()?;
    solver.solve();
    let usable =
        matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    usable.then(|| (rows, solver.solution.z.clone(), solver.solution.x.clone()))
}
