//! Whose line of sight: a telescope's, a detector's, or the mission boresight.

use crate::failure::Failure;
use clap::Args;
use mission::Mission;
use planner::opportunities::{SightLine, select};

/// Lines of sight.
#[derive(Debug, Clone, Args)]
pub struct SightArgs {
    /// Only this telescope
    #[arg(long, value_name = "NAME")]
    pub telescope: Option<String>,
    /// A detector, TELESCOPE/NAME where ambiguous, or all; without it the mission boresight
    #[arg(long, value_name = "NAME|all")]
    pub detector: Option<String>,
}

impl SightArgs {
    /// The lines of sight of a mission that are asked for.
    ///
    /// # Errors
    /// [`Failure::Input`] names the option and what the mission has instead.
    pub fn lines(&self, mission: &Mission) -> Result<Vec<SightLine>, Failure> {
        Ok(select(mission, self.telescope.as_deref(), self.detector.as_deref())?)
    }
}
