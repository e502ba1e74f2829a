//! Why a message is refused, in sentences; lines count from 1.

use super::kind::Fence;
use crate::time::TimeError;
use core::fmt;
use thiserror::Error;

/// Why a message is refused.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CcsdsError {
    /// A value is not one of those known.
    #[error("line {line}: {key} is '{value}'; legal is {legal}")]
    Value {
        /// Line number.
        line: usize,
        /// Keyword.
        key: String,
        /// Its value.
        value: String,
        /// What it may be.
        legal: Legal,
    },
    /// A keyword is not known where it stands.
    #[error("line {line}: unknown key '{key}'; legal are {}", legal.join(", "))]
    Key {
        /// Line number.
        line: usize,
        /// Keyword.
        key: String,
        /// Legal keywords.
        legal: Vec<&'static str>,
    },
    /// A block lacks a keyword.
    #[error("line {line}: {holder} has no {key}")]
    Missing {
        /// Line number.
        line: usize,
        /// What lacks it.
        holder: Holder,
        /// Keyword.
        key: &'static str,
    },
    /// A line is not what its place asks for.
    #[error("line {line}: '{text}' is not {expected}")]
    Line {
        /// Line number.
        line: usize,
        /// The line.
        text: String,
        /// What it should be.
        expected: Expected,
    },
    /// A time cannot be read.
    #[error("line {line}: {key}: {fault}")]
    Time {
        /// Line number.
        line: usize,
        /// Keyword, or `epoch` in a record.
        key: String,
        /// Why.
        fault: TimeError,
    },
    /// Not XML.
    #[error("not readable as XML: {0}")]
    Xml(String),
    /// The text ends too early.
    #[error("the file ends {0}")]
    Ended(Unfinished),
}

/// What a value may be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Legal {
    /// One of these.
    OneOf(Vec<&'static str>),
    /// A whole number.
    Whole {
        /// Smallest.
        first: usize,
        /// Largest.
        last: usize,
    },
    /// A finite number.
    Finite,
    /// A single one, and this line gives it already.
    Once(usize),
}

impl fmt::Display for Legal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OneOf(values) => f.write_str(&values.join(", ")),
            Self::Whole { first, last } => write!(f, "a whole number from {first} to {last}"),
            Self::Finite => f.write_str("a finite number"),
            Self::Once(line) => write!(f, "one value, and line {line} gives it already"),
        }
    }
}

/// What lacks a keyword.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holder {
    /// The block of KVN that this keyword ends.
    EndedBy(&'static str),
    /// The element of XML that begins at the line.
    Element(&'static str),
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::EndedBy(keyword) => write!(f, "{keyword}, but the block"),
            Self::Element(name) => write!(f, "the {name} that begins here"),
        }
    }
}

/// What a line should be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expected {
    /// `KEY = value`.
    KeyValue,
    /// The keyword with which a message of that name begins.
    Opening {
        /// Keyword.
        keyword: &'static str,
        /// The message's name.
        name: &'static str,
    },
    /// A keyword that stands alone.
    Keyword(&'static str),
    /// An element of that name.
    Element(&'static str),
    /// An epoch and that many numbers.
    Numbers(usize),
    /// Described in words.
    Such(&'static str),
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::KeyValue => f.write_str("of the form KEY = value"),
            Self::Opening { keyword, name } => {
                write!(f, "{keyword} = 2.0, with which an {name} begins")
            }
            Self::Keyword(words) | Self::Such(words) => f.write_str(words),
            Self::Element(name) => write!(f, "an {name}"),
            Self::Numbers(count) => write!(f, "an epoch and {count} numbers"),
        }
    }
}

/// Where a text ends too early.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unfinished {
    /// Before anything.
    Empty,
    /// Before any metadata.
    Header,
    /// Before the block that must follow.
    Before(Fence),
    /// Inside a block.
    Inside(Fence),
}

impl fmt::Display for Unfinished {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("before its first line"),
            Self::Header => f.write_str("before any META_START"),
            Self::Before(Fence { start, .. }) => write!(f, "before {start}"),
            Self::Inside(Fence { name, stop, .. }) => {
                write!(f, "inside a {name} block, without {stop}")
            }
        }
    }
}
