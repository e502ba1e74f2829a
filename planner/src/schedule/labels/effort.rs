//! How many labels may live, from the work that is left.
//!
//! Work is counted in comparisons of two labels. An item at which `w` labels live costs at most some w^2
//! of them; most items have far fewer labels than the few hard ones, so an item may use [`SHARE`] times
//! its even share of what is left.

/// Of its even share, what an item may use.
const SHARE: u64 = 8;
/// Labels that may always live, and the most that ever may.
const LEAST: u64 = 200;
const MOST: u64 = 40_000;

/// Comparisons that are left.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effort(u64);

impl Effort {
    /// So many comparisons.
    pub(super) const fn new(comparisons: u64) -> Self {
        Self(comparisons)
    }

    /// Takes some away.
    pub(super) fn spend(&mut self, comparisons: usize) {
        self.0 = self.0.saturating_sub(u64::try_from(comparisons).unwrap_or(u64::MAX));
    }

    /// Labels that may live with so many items to come.
    pub(super) fn width(self, items: usize) -> usize {
        let items = u64::try_from(items.max(1)).unwrap_or(u64::MAX);
        let width = (self.0 / items).saturating_mul(SHARE).isqrt().clamp(LEAST, MOST);
        usize::try_from(width).unwrap_or(usize::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_shared_by_the_items_to_come() {
        let mut effort = Effort::new(1_000 * 1_000_000);
        assert_eq!(effort.width(1_000), 2_828);
        assert_eq!(effort.width(1), 40_000);
        effort.spend(999_000_000);
        assert_eq!(effort.width(1_000), 200);
        effort.spend(usize::MAX);
        assert_eq!(effort.width(0), 200);
    }
}
