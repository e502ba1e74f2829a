//! What a mission offers to a plan: lines of sight, the passes of its targets through them, and the
//! opportunities that passes make.
//!
//! # Example
//! The transits of Jupiter within half a degree of the mission boresight in LiteBIRD's first 20 days:
//! ```
//! use mission::{Mission, Override};
//! use planner::opportunities::{boresight, search};
//! use planner::world::World;
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=20")?])?;
//! let mut world = World::open(mission, None)?;
//! world.keep_targets(&["jupiter".to_owned()])?;
//! let tables = world.tables(&world.ground_options())?;
//! let lines = [boresight(&world.mission)?];
//! let found = search(&world, tables.parse()?, &lines)?;
//! let half_degree_rad = 0.5_f64.to_radians();
//! assert_eq!(found.len(), 15);
//! assert!(found.iter().all(|it| it.transit.min_separation_rad <= half_degree_rad));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod sight_line;
mod pass;
mod bursts;
mod opportunity;
mod passes;

pub use opportunity::{Opportunities, Opportunity, OpportunityError};
pub use pass::Pass;
pub use passes::{Found, Offers, OffersError, search};
pub use sight_line::{FieldKey, NONE, SightError, SightLine, boresight, of_plan, select};
