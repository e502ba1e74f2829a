//! The calibration timeline: sessions, what was left out and why, how far the rules are used.
//!
//! Built from a plan; written as JSON and as rows. Ids name telescope, target and place on the scan clock, so
//! they survive replanning.
//!
//! # Example
//! The plan of a day as JSON, and what it changes against itself:
//! ```
//! use formats::timeline::{Difference, Timeline, timeline};
//! use mission::{Mission, Override};
//! use planner::plan::{Revision, plan};
//! use planner::{progress::Quietly, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=1")?])?;
//! let world = World::open(mission, None)?;
//! let now = timeline(&world, &plan(&world, &Revision::default(), &Quietly)?, None)?;
//! let json = now.to_json()?;
//! let earlier: Timeline = serde_json::from_slice(&json)?;
//! assert_eq!(earlier.sessions[0].id, "MFT-jupiter-000003");
//! let difference = Difference::of(&earlier, &now, "timeline.json".to_owned());
//! assert_eq!((difference.kept, difference.added.len()), (now.sessions.len(), 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod types;
mod of_plan;
mod words;
mod table;
mod difference;
mod idle;

pub use difference::{Difference, Entry, Moved};
pub use idle::{Idle, idle};
pub use of_plan::timeline;
pub use types::{
    Against, Constraint, Loosened, Rejected, Session, SessionTransit, Signal, Timeline,
    TimelineError, Unit,
};
pub use words::date;
