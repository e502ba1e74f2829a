//! Conic programmes, solved by Clarabel. No other module sees the solver.
//!
//! Minimise `costs . x` where `limits - A x` lies in the cones, one after the other over the rows.
//!
//! Limits: the solution is approximate, and may be one that the solver calls almost solved; what is
//! proved rests on arithmetic elsewhere, never on it.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus,
    SupportedConeT, ZeroConeT,
};

/// What the next rows' slack lies in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cone {
    /// So many rows are equalities.
    Zero(usize),
    /// So many rows are limits.
    Nonnegative(usize),
    /// Three rows (x, y, z) with `y exp(x / y) <= z`.
    Exponential,
}

/// A programme to minimise.
#[derive(Debug)]
pub(crate) struct Conic {
    /// Per column, rows ascending and coefficients.
    pub(crate) columns: Vec<Vec<(usize, f64)>>,
    /// Cost of each column.
    pub(crate) costs: Vec<f64>,
    /// Right-hand side of each row.
    pub(crate) limits: Vec<f64>,
    /// The cones, over all rows.
    pub(crate) cones: Vec<Cone>,
    /// Relative and absolute tolerance.
    pub(crate) tolerance: f64,
    /// Most iterations.
    pub(crate) iterations: u32,
}

/// A solution up to the tolerance.
#[derive(Debug)]
pub(crate) struct Solution {
    /// Value of each column.
    pub(crate) primal: Vec<f64>,
    /// Dual of each row.
    pub(crate) dual: Vec<f64>,
}

impl Conic {
    /// The solution; `None` where the solver fails.
    pub(crate) fn solve(&self) -> Option<Solution> {
        if self.columns.is_empty() {
            // Clarabel cannot do without columns.
            let met = self.limits.iter().all(|limit| *limit >= 0.0);
            return met.then(|| Solution { primal: vec![], dual: vec![0.0; self.limits.len()] });
        }
        let (mut starts, mut rows, mut coefficients) = (vec![0], Vec::new(), Vec::new());
        for entries in &self.columns {
            rows.extend(entries.iter().map(|entry| entry.0));
            coefficients.extend(entries.iter().map(|entry| entry.1));
            starts.push(rows.len());
        }
        let (height, width) = (self.limits.len(), self.columns.len());
        let matrix = CscMatrix::new(height, width, starts, rows, coefficients);
        let cone = |cone: &Cone| match *cone {
            Cone::Zero(count) => ZeroConeT(count),
            Cone::Nonnegative(count) => NonnegativeConeT(count),
            Cone::Exponential => SupportedConeT::ExponentialConeT(),
        };
        let cones: Vec<SupportedConeT<f64>> = self.cones.iter().map(cone).collect();
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .tol_gap_rel(self.tolerance)
            .tol_gap_abs(self.tolerance)
            .tol_feas(self.tolerance)
            .max_iter(self.iterations)
            .build()
            .ok()?;
        let squares = CscMatrix::zeros((width, width));
        let mut solver =
            DefaultSolver::new(&squares, &self.costs, &matrix, &self.limits, &cones, settings)
                .ok()?;
        solver.solve();
        let solution = solver.solution;
        let usable = matches!(solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
        usable.then_some(Solution { primal: solution.x, dual: solution.z })
    }
}
