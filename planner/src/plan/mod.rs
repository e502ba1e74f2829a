//! The calibration plan of a mission, in one call: which opportunities to take, with a bound on what any
//! schedule could achieve, and what each rule costs.
//!
//! Method: onboard tables are fitted to the mission, so that a plan is made of what the spacecraft will
//! see; every pass of every target through every telescope is found and grouped; the rules of
//! `calibration.schedule` are stated; the scheduler chooses ([`crate::schedule`]).
//!
//! Limits: those of the scheduler.
//!
//! # Example
//! The plan of LiteBIRD's first week:
//! ```
//! use mission::{Mission, Override};
//! use planner::plan::{Revision, plan};
//! use planner::{progress::Quietly, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=7")?])?;
//! let world = World::open(mission, None)?;
//! let plan = plan(&world, &Revision::default(), &Quietly)?;
//! let sessions = plan.sessions(&world)?;
//! assert_eq!((sessions.len(), sessions[0].id.as_str()), (28, "MFT-jupiter-000000"));
//! let in_view_s: f64 = sessions.iter().map(|it| it.dwell.seconds()).sum();
//! assert!((in_view_s - plan.schedule.objective).abs() < 1e-6);
//! assert!(plan.schedule.objective <= plan.schedule.upper_bound);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod demands;
mod error;
mod problem;
mod revision;
mod run;
mod session;

pub use error::{Asked, DemandError, PlanError, RevisionError};
pub use revision::{EarlierPlan, Revision};
pub use run::{Offered, Plan, plan};
pub use session::{Session, SessionPass, session_id};
