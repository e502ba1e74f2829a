//! Why a programme cannot be searched.

use thiserror::Error;

/// Why a programme cannot be worked on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum ProgramError {
    /// Lists of different lengths.
    #[error("there are {values} values but {choices} choices")]
    Lengths {
        /// Number of values.
        values: usize,
        /// Number of choices.
        choices: usize,
    },
    /// A row or cell names a choice that does not exist, or twice.
    #[error("row or cell {index} names choice {choice}, which does not exist or came before")]
    Term {
        /// Index among the rows, then the cells.
        index: usize,
        /// The choice.
        choice: usize,
    },
    /// A number is out of range.
    #[error("{what} {index} holds {number}, beyond what sums allow")]
    Number {
        /// Which list.
        what: &'static str,
        /// Index in it.
        index: usize,
        /// The number.
        number: i64,
    },
    /// The choices that must be taken break a row of coefficients at or above zero.
    #[error("the choices that must be taken use {used} of row {row}, more than {limit}")]
    Always {
        /// The row.
        row: usize,
        /// What they use.
        used: i128,
        /// The row's limit.
        limit: i64,
    },
}
