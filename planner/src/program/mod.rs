//! The best set of yes-or-no choices under integer rows, and a bound that no set exceeds.
//!
//! Maximise `sum v_i x_i + sum_c G_c(sum w_ci x_i)` over `x` in {0, 1} under rows `sum a_i x_i <= b`,
//! all numbers integers, every `G_c` concave ([`Gain`]: a priced shortfall, or a logarithm). Rows too
//! many to list come from a [`Family`], which separates those that a set or a relaxation violates.
//!
//! Method: Clarabel solves the linear relaxation on scaled data (`relaxation.rs`). From its dual
//! multipliers follows a bound in exact integer arithmetic on the data as given (`bound.rs`), whatever
//! the solver did. Rounding and repair give the first incumbent (`round.rs`); where families have rows,
//! a greedy fill by reduced profit and a large-neighbourhood search with threshold acceptance improve
//! it (`large_neighbourhood.rs`). Reduced costs fix the choices that have one value in every better set.
//! What is left is searched by branch and bound (`branch.rs`) over a dual simplex method
//! (`simplex.rs`), with cover cuts (`cover.rs`), each node pruned by the same exact bound; where too much
//! is left, neighbourhoods are searched in turn (`exchange.rs`). The set returned was evaluated row by
//! row in integers (`state.rs`).
//!
//! Limits: effort is counted in nodes, cuts and passes, so equal input gives equal output; a
//! [`Progress`](crate::progress::Progress) that asks to stop ends the search early, with the best set so
//! far and a bound that holds. Sums stay within i128 for values up to 2^45, coefficients and limits up
//! to 2^53.
//!
//! # Example
//! Three choices, of which two exclude each other, and a budget:
//! ```
//! use planner::program::{Aids, Choice, Ended, Limits, Program, Row, solve};
//!
//! let program = Program {
//!     values: vec![60, 100, 120],
//!     choices: vec![Choice::Free; 3],
//!     rows: vec![
//!         Row { terms: vec![(0, 10), (1, 20), (2, 30)], limit: 50 },
//!         Row { terms: vec![(1, 1), (2, 1)], limit: 1 },
//!     ],
//!     cells: Vec::new(),
//! };
//! let found = solve(&program, &Limits::default(), &Aids::default())?;
//! assert_eq!(found.taken, Some(vec![0, 2]));
//! assert_eq!((found.value, found.bound, found.ended), (180, 180, Ended::Proven));
//! # Ok::<(), planner::program::ProgramError>(())
//! ```

pub(crate) mod number;
mod gain;
mod problem;
mod family;
mod error;
mod validate;
mod options;
mod outcome;
mod state;
mod bound;
mod relaxation;
mod separation;
mod charge;
mod round;
mod large_neighbourhood;
mod cover;
mod simplex;
mod node_relaxation;
mod pseudo_cost;
mod waiting;
mod branch;
mod incumbent;
mod exchange;
mod solve;

pub use error::ProgramError;
pub use family::Family;
pub use gain::Gain;
pub use options::{Aids, Limits};
pub use outcome::{Ended, Outcome};
pub use problem::{Cell, Choice, LARGEST_COEFFICIENT, LARGEST_VALUE, Program, Row};
pub use solve::solve;

pub(crate) use charge::{Charged, Dualised, charged, worth_of};
pub(crate) use relaxation::Relaxed;
pub(crate) use separation::{grow, relax, relaxed_shares};
pub(crate) use solve::solve_from;
