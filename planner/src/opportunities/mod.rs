//! What a mission offers to a plan: lines of sight, the passes of its targets through them, and the
//! opportunities that passes make.

mod sight_line;
mod opportunity;
mod passes;

pub use opportunity::{Opportunities, Opportunity, OpportunityError, Pass};
pub use passes::{Found, Offers, OffersError, search};
pub use sight_line::{NONE, SightError, SightLine, View, boresight, of_plan, select};
