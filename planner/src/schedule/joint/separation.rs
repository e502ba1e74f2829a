//! When is a row of a family violated enough to be made, and how many are made at once.

/// Most rows that a family gives at once.
pub(super) const AT_ONCE: usize = 50;
/// Shares below this are none.
pub(super) const SHARE: f64 = 1e-6;
/// Shares must violate a row by this part of its limit.
pub(super) const BROKEN: f64 = 1e-4;
