//! How a command ends when it does not end well.
//!
//! Exit codes: 1 a check failed, 2 bad input, 3 an internal error. The message is a sentence: what,
//! where, which value, what would be legal. The libraries below return enums with values; here they
//! become sentences with the names of options, and get their exit codes.

use formats::WriteError;
use formats::attitude::SpiceError;
use formats::fits::FitsFileError;
use formats::timeline::TimelineError;
use formats::uplink::TooLarge;
use formats::vectors::VectorsError;
use mission::fault::MissionError;
use mission::occasions::OccasionError;
use mission::{meant, nearest_first};
use pictures::PictureError;
use planner::onboard::JudgeError;
use planner::opportunities::{OffersError, SightError};
use planner::plan::{Asked, DemandError, PlanError, RevisionError};
use planner::resonance::check::CheckError;
use planner::world::{TableFault, WorldError};
use planner::worth::WorthError;
use std::fmt::Display;
use std::path::Path;
use thiserror::Error;

/// Why a command did not end with exit code 0.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Failure {
    /// A check failed: exit code 1.
    #[error("{0}")]
    Check(String),
    /// The input cannot be used: exit code 2.
    #[error("{0}")]
    Input(String),
    /// The program is wrong: exit code 3.
    #[error("internal error: {0}")]
    Internal(String),
}

impl Failure {
    /// Bad input, in the words of the error that found it.
    pub fn input(error: impl Display) -> Self {
        Self::Input(error.to_string())
    }

    /// Something that checked input cannot cause.
    pub fn internal(error: impl Display) -> Self {
        Self::Internal(error.to_string())
    }

    /// A file or folder that cannot be read or written.
    #[must_use]
    pub fn file(what: &str, path: &Path, error: &std::io::Error) -> Self {
        Self::Input(format!("cannot {what} {}: {error}", path.display()))
    }

    /// The exit code.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Check(_) => 1,
            Self::Input(_) => 2,
            Self::Internal(_) => 3,
        }
    }
}

/// Errors whose own words are what a person needs to know of bad input.
macro_rules! input {
    ($($error:ty),* $(,)?) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::input(error)
            }
        })*
    };
}

input!(MissionError, OccasionError, FitsFileError, TimelineError, TooLarge);

impl From<PictureError> for Failure {
    fn from(error: PictureError) -> Self {
        match error {
            PictureError::Render(_) => Self::internal(error),
            _ => Self::input(error),
        }
    }
}

/// Errors that checked input cannot cause.
macro_rules! internal {
    ($($error:ty),* $(,)?) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::internal(error)
            }
        })*
    };
}

internal!(TableFault, OffersError);

impl From<WorldError> for Failure {
    fn from(error: WorldError) -> Self {
        match error {
            WorldError::Scan(_) => Self::internal(error),
            WorldError::NoSuchTarget { .. } => Self::Input(format!(
                "--target {error} (or add it with --set calibration.targets=...)"
            )),
            error => Self::input(error),
        }
    }
}

impl From<SightError> for Failure {
    fn from(error: SightError) -> Self {
        match error {
            SightError::NoSuchTelescope { name, known } => no_such("--telescope", &name, &known),
            SightError::NoSuchDetector { name, known } => no_such("--detector", &name, &known),
            SightError::AmbiguousDetector { .. } => Self::Input(format!("--{error}")),
            SightError::NoDetectors => Self::Input(format!(
                "--detector all: {error}; add [[telescope.detector]] tables, or name a telescope with \
                 --telescope to see through its field of view"
            )),
            error @ (SightError::Rotation(_) | SightError::Field(_)) => Self::internal(error),
        }
    }
}

/// Says what there is instead, the nearest first.
fn no_such(option: &str, name: &str, known: &[String]) -> Failure {
    if known.is_empty() {
        return Failure::Input(format!("{option} {name}: the mission lists none"));
    }
    let meant = meant(name, known).map_or(String::new(), |it| format!("; did you mean {it}?"));
    let known = nearest_first(name, known);
    Failure::Input(format!("{option} {name} is not in the mission: it has {known}{meant}"))
}

impl From<WorthError> for Failure {
    fn from(error: WorthError) -> Self {
        match error {
            WorthError::Strength { .. } => Self::input(error),
            WorthError::Table(_) | WorthError::Sky(_) => Self::internal(error),
        }
    }
}

impl From<DemandError> for Failure {
    fn from(error: DemandError) -> Self {
        match error {
            DemandError::Occasion(error) => error.into(),
            DemandError::Worth(error) => error.into(),
            DemandError::Judge(error @ JudgeError::Mission(_)) => Self::internal(error),
            DemandError::Judge(error @ JudgeError::TooMany(_)) => Self::input(error),
            DemandError::Record(error) => Self::input(error),
            DemandError::Table(error) => error.into(),
        }
    }
}

impl From<RevisionError> for Failure {
    fn from(error: RevisionError) -> Self {
        let option = |asked| match asked {
            Asked::Fixed => "--fix",
            Asked::Forbidden => "--forbid",
        };
        Self::Input(match &error {
            RevisionError::NoSuchOpportunity { asked, .. } => {
                format!("{} {error}, as timeline.json has them", option(*asked))
            }
            RevisionError::NamedTwice { asked, id } => {
                format!("{} names {id} twice", option(*asked))
            }
            _ => error.to_string(),
        })
    }
}

/// A plan that fails for want of input; contradictions among rules are for `plan` to tell.
impl From<PlanError> for Failure {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::World(error) => error.into(),
            PlanError::Table(error) => error.into(),
            PlanError::Offers(error) => error.into(),
            PlanError::Demand(error) => error.into(),
            PlanError::Revision(error) => error.into(),
            PlanError::Schedule(error) => Self::input(error),
        }
    }
}

impl From<CheckError> for Failure {
    fn from(error: CheckError) -> Self {
        match error {
            CheckError::Sky(_) | CheckError::Certificate(_) => Self::input(error),
            CheckError::Nside(_) | CheckError::Window(_) => Self::internal(error),
        }
    }
}

impl From<VectorsError> for Failure {
    fn from(error: VectorsError) -> Self {
        match error {
            VectorsError::NoSuchBody { .. } => {
                Self::Input(format!("{error}, or other names with --target"))
            }
            VectorsError::Table(error) => Self::input(error),
            VectorsError::Offers(error) => error.into(),
        }
    }
}

impl From<SpiceError> for Failure {
    fn from(error: SpiceError) -> Self {
        Self::Input(match error {
            SpiceError::Empty => format!("{error}: leave out ck, or give --aem-span all"),
            SpiceError::TooLarge(_) => {
                format!("{error}: a larger --aem-error-arcsec or a shorter span is needed")
            }
            SpiceError::OutsideClock(_) => error.to_string(),
        })
    }
}

/// What was to be written could not be made; a place that cannot take it is named by whoever writes.
impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Io(error) => Self::input(error),
            WriteError::Table(error) => error.into(),
            WriteError::Spice(error) => error.into(),
            WriteError::Row(error) => match error.downcast::<Self>() {
                Ok(failure) => *failure,
                Err(other) => Self::internal(other),
            },
            WriteError::Refused(reason) => Self::Internal(reason),
        }
    }
}
