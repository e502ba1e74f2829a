//! Why writing stopped.

use crate::attitude::SpiceError;
use planner::world::TableFault;
use std::error::Error;
use std::fmt::Display;

/// Why writing stopped.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The place could not take it.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// The Sun's table ends before the attitudes do.
    #[error(transparent)]
    Table(#[from] TableFault),
    /// A C-kernel cannot hold the attitudes.
    #[error(transparent)]
    Spice(#[from] SpiceError),
    /// A row could not be made; the error is that of whoever makes it.
    #[error(transparent)]
    Row(Box<dyn Error + Send + Sync>),
    /// The format's writer refuses what no input should cause.
    #[error("{0}")]
    Refused(String),
}

impl WriteError {
    /// The writer's own words.
    pub fn refused(error: impl Display) -> Self {
        Self::Refused(error.to_string())
    }

    /// A row that could not be made.
    pub fn row(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Row(error.into())
    }
}
