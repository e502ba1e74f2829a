//! The calibration plan of a mission, in one call: which opportunities to take, with a bound on what any
//! schedule could achieve, and what each rule costs.
//!
//! Method: onboard tables are fitted to the mission, so that a plan is made of what the spacecraft will
//! see; every pass of every target through every telescope is found and grouped; the rules of
//! `calibration.schedule` are stated; the scheduler chooses ([`crate::schedule`]).
//!
//! Limits: those of the scheduler.

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
