//! Why there is no plan.

use crate::onboard::{BeyondRecord, JudgeError};
use crate::opportunities::OffersError;
use crate::schedule::ScheduleError;
use crate::world::{TableFault, WorldError};
use crate::worth::WorthError;
use mission::occasions::OccasionError;
use thiserror::Error;

/// Why the rules of a mission's schedule cannot be stated.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DemandError {
    /// A file of contacts or blackouts.
    #[error(transparent)]
    Occasion(#[from] OccasionError),
    /// Sessions whose worth cannot be told.
    #[error(transparent)]
    Worth(#[from] WorthError),
    /// A mission that cannot go on board, so that nothing says what the spacecraft would begin.
    #[error(transparent)]
    Judge(#[from] JudgeError),
    /// A session that cannot go on board.
    #[error(transparent)]
    Record(#[from] BeyondRecord),
    /// The tables do not serve their own span.
    #[error(transparent)]
    Table(#[from] TableFault),
}

/// Why there is no plan.
#[derive(Debug, Error)]
pub enum PlanError {
    /// Kernel, trajectory or sources do not cover the mission.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The tables do not serve their own span.
    #[error(transparent)]
    Table(#[from] TableFault),
    /// Passes cannot be found.
    #[error(transparent)]
    Offers(#[from] OffersError),
    /// The rules cannot be stated.
    #[error(transparent)]
    Demand(#[from] DemandError),
    /// What is asked beyond the mission does not fit it.
    #[error(transparent)]
    Revision(#[from] RevisionError),
    /// No schedule, or none that is proved sound.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
}

/// Whether a session was asked to stand or not to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// It must stand.
    Fixed,
    /// It must not.
    Forbidden,
}

/// Why what is asked beyond the mission does not fit it.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RevisionError {
    /// A session that the mission does not offer.
    #[error(
        "{id}: the mission offers no such opportunity; ids are TELESCOPE-TARGET-TURN with six digits \
         of the turn"
    )]
    NoSuchOpportunity {
        /// What was asked of it.
        asked: Asked,
        /// Its id.
        id: String,
    },
    /// A session named twice.
    #[error("the session {id} is named twice")]
    NamedTwice {
        /// What was asked of it.
        asked: Asked,
        /// Its id.
        id: String,
    },
    /// A session asked for in two ways.
    #[error("the session {id} is both fixed and forbidden")]
    FixedAndForbidden {
        /// Its id.
        id: String,
    },
    /// An earlier plan without a session that this mission offers.
    #[error(
        "none of the {sessions} sessions of the earlier plan is an opportunity of this mission: an \
         earlier plan of the same mission is needed"
    )]
    NothingInCommon {
        /// How many sessions it has.
        sessions: usize,
    },
    /// A frozen session that this mission does not offer.
    #[error(
        "the session {id} of the earlier plan is frozen, but this mission offers no such opportunity"
    )]
    FrozenNotOffered {
        /// Its id.
        id: String,
    },
}
