//! Why it cannot be told what sessions are worth.

use crate::world::TableFault;
use ephem::apparent::SkyError;
use mission::schedule::Purpose;
use std::fmt;
use thiserror::Error;

/// Why it cannot be told what sessions are worth.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum WorthError {
    /// The tables do not serve their own span.
    #[error(transparent)]
    Table(#[from] TableFault),
    /// The ephemeris does not serve the mission's span.
    #[error(transparent)]
    Sky(#[from] SkyError),
    /// A weight by purpose whose source has no known strength.
    #[error(
        "calibration.schedule.weights.{target}.{}: {}",
        purpose.key(), Missing { target, telescope, purpose: *purpose, unknown: *missing }
    )]
    Strength {
        /// The target that has the weight.
        target: String,
        /// The telescope that sees it.
        telescope: String,
        /// The purpose.
        purpose: Purpose,
        /// What is not known.
        missing: Unknown,
    },
}

/// What is not known of a strength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unknown {
    /// The telescope's frequency.
    NoFrequency,
    /// The reference source's strength at the telescope's frequency.
    Reference {
        /// That frequency.
        at_ghz: f64,
    },
    /// The target's strength at the telescope's frequency.
    Source {
        /// That frequency.
        at_ghz: f64,
    },
}

/// What is missing, in words.
struct Missing<'m> {
    target: &'m str,
    telescope: &'m str,
    purpose: Purpose,
    unknown: Unknown,
}

impl fmt::Display for Missing<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { target, telescope: name, purpose, unknown } = self;
        let polarised = *purpose == Purpose::PolarisationAngle;
        match unknown {
            Unknown::NoFrequency => write!(f, "frequency_ghz of telescope {name} is needed"),
            Unknown::Reference { at_ghz } => write!(
                f,
                "the reference, {}, has no known strength at {at_ghz} GHz, the frequency of \
                 telescope {name}: another frequency_ghz is needed",
                if polarised { "Tau A" } else { "Jupiter" }
            ),
            Unknown::Source { at_ghz } => write!(
                f,
                "{} of {target} is not known at {at_ghz} GHz, the frequency of telescope {name}: a \
                 plain weight is needed, or a [[calibration.source]] with flux_jy{}",
                if polarised { "a polarised signal" } else { "the signal" },
                if polarised { " and polarised_fraction" } else { "" }
            ),
        }
    }
}
