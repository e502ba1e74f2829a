//! Why it cannot be told what passes teach.

use crate::opportunities::{OffersError, SightError};
use crate::world::TableFault;
use ephem::apparent::SkyError;
use thiserror::Error;

/// Why it cannot be told what passes teach.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum InformationError {
    /// The tables do not serve their own span.
    #[error(transparent)]
    Table(#[from] TableFault),
    /// The ephemeris does not serve the mission's span.
    #[error(transparent)]
    Sky(#[from] SkyError),
    /// A line of sight that is not there.
    #[error(transparent)]
    Sight(#[from] SightError),
    /// The search for passes.
    #[error(transparent)]
    Search(#[from] OffersError),
    /// Noise or band of none of the receivers is known.
    #[error("{key} of {receiver} is needed: without it nothing is known of its noise")]
    Unknown {
        /// The first receiver asked for.
        receiver: String,
        /// The key.
        key: &'static str,
    },
    /// No target has a known strength in the band of any receiver.
    #[error(
        "{target} has no known strength in the band of {receiver}, and so has no other target in any \
         band: another frequency_ghz is needed, or a [[calibration.source]] with flux_jy"
    )]
    NoSignal {
        /// The first target.
        target: String,
        /// The first receiver.
        receiver: String,
    },
    /// The computation was ended from outside.
    #[error("stopped")]
    Stopped,
}
