//! What the page is made from: a plan, and all that it was planned from.

use formats::forecast::Taught;
use formats::timeline::{Difference, Timeline};
use onboard_core::ephemeris::EphemerisTable;
use planner::opportunities::Offers;
use planner::world::World;

/// What a report is made from.
#[derive(Debug, Clone, Copy)]
pub struct Source<'r> {
    /// The mission among the planets.
    pub world: &'r World,
    /// The fitted directions of its targets.
    pub table: EphemerisTable<'r>,
    /// What it offers: lines of sight, passes, opportunities.
    pub offers: &'r Offers,
    /// The plan.
    pub timeline: &'r Timeline,
    /// What its sessions teach.
    pub taught: &'r Taught<'r>,
    /// A rule that the plan breaks, in words, by the check in exact arithmetic.
    pub violation: Option<&'r str>,
    /// What changed against an earlier plan, where there is one.
    pub difference: Option<&'r Difference>,
}
