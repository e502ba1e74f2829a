//! Rows too many to list, separated where a set or a relaxation violates them.

use super::problem::Row;

/// A family of rows of one kind.
pub trait Family: Sync {
    /// Rows of the family that a set violates; none exactly where the set meets them all.
    fn broken(&self, taken: &[bool]) -> Vec<Row>;

    /// Rows of the family that a fractional solution violates, for a sharper relaxation; may be none.
    fn separate(&self, shares: &[f64]) -> Vec<Row> {
        let _ = shares;
        Vec::new()
    }
}
