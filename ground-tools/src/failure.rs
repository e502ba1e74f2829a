//! How a command ends when it does not end well.
//!
//! Exit codes: 1 a check failed, 2 bad input, 3 an internal error. The message is a sentence: what,
//! where, which value, what would be legal.

use crate::fault::MissionError;
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

impl From<MissionError> for Failure {
    fn from(error: MissionError) -> Self {
        Self::input(error)
    }
}
