//! Which opportunities to take, and how much better could any other choice be.
//!
//! A candidate is taken or not. A taken one is a **session**: it reserves the half-open interval
//! from its first entry less the setup to its last exit plus the cooldown. The objective is the sum
//! of weight times dwell in seconds, or what the [`Demands`] value instead; [`Rules`] and [`Demands`]
//! say which sessions may stand together.
//!
//! Method: candidates that no schedule can hold are screened out (`model.rs`). Labels, an exact dynamic
//! programme over time (`labels/`, `lagrangian.rs`), give a schedule and a bound; the integer programme of
//! all rules (`joint/`, [`program`](crate::program)) goes on from them where they are not close
//! (`solve.rs`). Where the rules contradict each other, a minimal infeasible subset of them is reported
//! (`infeasible.rs`). The result passes [`check()`], which shares no code with the rest; each candidate left
//! out gets the rule that excludes it (`explain.rs`), each rule its use and its shadow price (`usage.rs`).
//! All arithmetic on time is in integer nanoseconds, on value in integers.
//!
//! Limits: effort is bounded by counts of work, never by a clock, so equal input gives equal
//! output. The schedule need not be the best one; the bound holds for any prices, whatever the
//! solver did. Gaps reached are stated and held by `tests/schedule.rs`.
//!
//! # Example
//! Two sessions that overlap on one telescope, and one later:
//! ```
//! use onboard_core::time::{Duration, Instant};
//! use planner::schedule::{Because, Candidate, Demands, Exclusive, Problem, Rules, check, schedule};
//!
//! let at = |minute: i64| Instant::from_tai_ns(minute * 60_000_000_000);
//! let session = |from, until| {
//!     let (first_entry, last_exit) = (at(from), at(until));
//!     let dwell = last_exit.since(first_entry);
//!     Candidate { target: 0, telescope: 0, first_entry, last_exit, dwell }
//! };
//! let (setup, cooldown) = (Duration::from_seconds(600.0), Duration::ZERO);
//! let (exclusive, max_per_day, max_sessions) = (Exclusive::Telescope, None, None);
//! let rules =
//!     Rules { setup, cooldown, exclusive, max_per_day, max_sessions, day_boundaries: vec![] };
//! let candidates = vec![session(20, 50), session(45, 90), session(100, 130)];
//! let (span, weights, demands) = ((at(0), at(1_440)), vec![1.0], Demands::default());
//! let problem = Problem { span, candidates, weights, rules, demands };
//! let found = schedule(&problem)?;
//! assert_eq!((&found.chosen, check(&problem, &found.chosen)), (&vec![1, 2], Ok(())));
//! assert_eq!(found.rejected[0].because, Because::Conflict { with: 1 });
//! # Ok::<(), planner::schedule::ScheduleError>(())
//! ```

mod rule;
mod demands;
mod problem;
mod reason;
mod violation;
mod conflict;
mod error;
mod validate;
mod check;
mod model;
mod instants;
mod price;
mod draft;
mod daily;
mod joint;
mod labels;
mod lagrangian;
mod infeasible;
mod explain;
mod usage;
mod worth;
mod solution;
mod solve;
mod loosen;

pub use check::check;
pub use conflict::Conflict;
pub use demands::{Contact, Data, Demands, Diversity, Log, LongestGap, Previous, Thermal};
pub use error::ScheduleError;
pub use loosen::{Give, Loosening, loosen};
pub use problem::{Candidate, MAX_CANDIDATES, Problem};
pub use reason::{Because, Rejection, skipped};
pub use rule::{ConstraintUse, Exclusive, Rule, RuleName, Rules, SessionCount, Unit};
pub use solution::{Schedule, Stopped};
pub use solve::{schedule, schedule_until};
pub use violation::Violation;
