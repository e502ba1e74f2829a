//! The search by days: a schedule and a bound under overlap, days and windows of starts.
//!
//! Method: dual prices come from the linear relaxation (`relaxation.rs`). Rows that link days are
//! dualised, each day is searched exactly (`split.rs`, `search.rs`), and the multipliers are optimised by
//! subgradient methods (`lagrangian.rs`, `subgradient.rs`). A beam search joins the days' best sets into
//! schedules (`assemble.rs`), a local search improves them (`improve.rs`), and `days.rs` puts the parts
//! together.
//!
//! Limits: further rules are not known here; leaving them out only raises the bound.

mod relaxation;
mod bound;
mod knapsack;
mod bits;
mod starts;
mod search;
mod split;
mod subgradient;
mod lagrangian;
mod assemble;
mod improve;
mod days;

pub(super) use days::{Days, improved};
pub(super) use relaxation::{Relaxed, solve as relax};
