//! How a long computation says how far it has come, and learns that it should end early.
//!
//! One trait for surveys, map-making, plans and whatever else takes seconds. Units are those of the
//! computation: samples of a survey, days of a schedule. Who neither shows nor stops anything passes
//! [`Quietly`].
//!
//! Limits: [`Progress::stopped`] is asked between pieces of work of at most about a tenth of a second.
//!
//! # Example
//! A plan that ends at a deadline with what it has; the bound of a plan that was ended still holds:
//! ```
//! use mission::{Mission, Override};
//! use planner::plan::{Revision, plan};
//! use planner::{progress::Progress, schedule::Stopped, world::World};
//! use std::time::Instant;
//!
//! struct Deadline(Instant);
//!
//! impl Progress for Deadline {
//!     fn stopped(&self) -> bool {
//!         Instant::now() >= self.0
//!     }
//! }
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=7")?])?;
//! let found = plan(&World::open(mission, None)?, &Revision::default(), &Deadline(Instant::now()))?;
//! assert_eq!(found.schedule.stopped, Stopped::Interrupted);
//! assert!(found.schedule.objective <= found.schedule.upper_bound);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

/// Who watches a computation; called from all its threads.
pub trait Progress: Sync {
    /// A step of `units` of work begins; its name fits a line.
    fn begin(&self, _step: &str, _units: u64) {}

    /// So many more units are done.
    fn advance(&self, _units: u64) {}

    /// Whether the computation should end with what it has.
    fn stopped(&self) -> bool {
        false
    }
}

/// Nobody watches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Quietly;

impl Progress for Quietly {}

/// Passes on that the computation should end, and nothing else: for work beside the step that is shown.
pub(crate) struct StopOnly<'a>(pub(crate) &'a dyn Progress);

impl Progress for StopOnly<'_> {
    fn stopped(&self) -> bool {
        self.0.stopped()
    }
}
