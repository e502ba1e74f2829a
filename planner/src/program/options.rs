//! How much work a search may do, and what it may start from.

use super::family::Family;
use crate::progress::{Progress, Quietly};
use std::fmt;

/// How much work to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most nodes of the final branch and bound.
    pub nodes: usize,
    /// Most numbers that it touches, which bounds large nodes more than small ones.
    pub work: usize,
    /// Most rounds of cuts over the whole programme.
    pub cut_rounds: usize,
    /// Most passes of exchanges.
    pub passes: usize,
    /// Most nodes of one exchange.
    pub exchange_nodes: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { nodes: 400_000, work: 70_000_000_000, cut_rounds: 8, passes: 3, exchange_nodes: 200 }
    }
}

/// What the search may use beside the programme.
#[derive(Clone, Copy)]
pub struct Aids<'a> {
    /// Rows separated as they are violated.
    pub families: &'a [&'a dyn Family],
    /// A set to start from; left aside where it breaks a row.
    pub start: &'a [usize],
    /// A bound known from elsewhere: no set is worth more, in units.
    pub bound: Option<i128>,
    /// Who watches the search, and may end it early.
    pub progress: &'a dyn Progress,
}

impl Default for Aids<'_> {
    fn default() -> Self {
        Self { families: &[], start: &[], bound: None, progress: &Quietly }
    }
}

impl fmt::Debug for Aids<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Aids").field("families", &self.families.len()).finish_non_exhaustive()
    }
}
