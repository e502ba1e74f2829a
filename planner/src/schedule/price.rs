//! Dual prices of the rules, in integer units of value.
//!
//! Each price is the multiplier of one inequality that every schedule meets:
//!
//! | price | inequality |
//! |---|---|
//! | of an instant t on a lane | at most one session of the lane reserves t |
//! | of a cell's nanosecond | reserved time in the cell is at most the day's limit |
//! | of a window from t | at most `count` sessions start in `[t, t + window)` |
//!
//! so any prices at or above zero bound every schedule from above (`daily/bound.rs`), however found.
//!
//! Method: prices of instants and windows as running sums over sorted instants, so that what a
//! session pays is a difference of two sums; a cell's price per nanosecond carries 48 fractional
//! bits, rounded down where a session pays and up where the rule's capacity is valued.
//!
//! Limits: a price is cut at 2^42 units, four times the most valuable session.

use super::model::{Model, Session};
use crate::program::number::{i64_from_f64, i64_from_i128, i128_from_f64};

/// Fractional bits of a cell's price per nanosecond.
const FRACTION_BITS: u32 = 48;
/// Largest price of one inequality's whole capacity, in units.
const LARGEST_PRICE: f64 = 4_398_046_511_104.0;

/// Prices at instants, summed from the left.
#[derive(Debug, Clone, Default)]
pub(super) struct Ladder {
    /// Ascending.
    at: Vec<i64>,
    /// `below[k]` is the sum of the first k prices.
    below: Vec<i64>,
}

impl Ladder {
    /// Prices at ascending instants; those that are not positive are left out.
    pub(super) fn new(points: impl Iterator<Item = (i64, f64)>) -> Self {
        let mut ladder = Self { at: Vec::new(), below: vec![0] };
        let mut sum = 0_i64;
        for (at, price) in points {
            let price = i64_from_f64(price.min(LARGEST_PRICE));
            if price > 0 {
                sum = sum.saturating_add(price);
                ladder.at.push(at);
                ladder.below.push(sum);
            }
        }
        ladder
    }

    /// Sum of the prices at instants in `[from, until)`.
    pub(super) fn sum(&self, from: i64, until: i64) -> i64 {
        if until <= from {
            return 0;
        }
        let first = self.at.partition_point(|&at| at < from);
        let last = first + self.at[first..].partition_point(|&at| at < until);
        self.below.get(last).copied().unwrap_or(0) - self.below.get(first).copied().unwrap_or(0)
    }

    /// Sum of all prices.
    pub(super) fn total(&self) -> i64 {
        self.below.last().copied().unwrap_or(0)
    }

    /// The instants and their prices.
    pub(super) fn points(&self) -> impl Iterator<Item = (i64, i64)> + '_ {
        self.between(i64::MIN, i64::MAX)
    }

    /// The instants in `[from, until)` and their prices.
    pub(super) fn between(&self, from: i64, until: i64) -> impl Iterator<Item = (i64, i64)> + '_ {
        let first = self.at.partition_point(|&at| at < from);
        let points = self.at[first..].iter().zip(self.below[first..].windows(2));
        points.take_while(move |(at, _)| **at < until).map(|(&at, pair)| (at, pair[1] - pair[0]))
    }
}

/// Prices of all rules.
#[derive(Debug, Clone, Default)]
pub(super) struct Prices {
    /// Per lane, of instants.
    pub(super) lanes: Vec<Ladder>,
    /// Per cell, of a nanosecond, times 2^48; empty without a day limit.
    cells: Vec<i128>,
    /// Of windows by their first instant.
    pub(super) windows: Ladder,
}

impl Prices {
    /// No rule has a price.
    pub(super) fn none(model: &Model) -> Self {
        Self {
            lanes: vec![Ladder::new(std::iter::empty()); model.lanes],
            cells: model.day_limit.map(|_| vec![0; model.cell_count()]).unwrap_or_default(),
            windows: Ladder::new(std::iter::empty()),
        }
    }

    /// Sets the price in units of a cell's whole limit.
    pub(super) fn set_cell(&mut self, cell: usize, price: f64, limit: i64) {
        let scaled = i128_from_f64(price.clamp(0.0, LARGEST_PRICE)) << FRACTION_BITS;
        self.cells[cell] = scaled / i128::from(limit.max(1));
    }

    /// What `ns` of a cell cost a session, rounded down.
    pub(super) fn cell_cost(&self, cell: usize, ns: i64) -> i64 {
        let Some(&price) = self.cells.get(cell) else { return 0 };
        i64_from_i128((price * i128::from(ns)) >> FRACTION_BITS)
    }

    /// What `ns` of a cell are worth as capacity, rounded up.
    pub(super) fn cell_worth(&self, cell: usize, ns: i64) -> i64 {
        let Some(&price) = self.cells.get(cell) else { return 0 };
        i64_from_i128(-((-price * i128::from(ns)) >> FRACTION_BITS))
    }

    /// What a session pays for its instants and nanoseconds in one of its cells.
    pub(super) fn in_cell(&self, model: &Model, session: &Session, cell: usize, ns: i64) -> i64 {
        let (from, until) = (model.cells[cell], model.cells[cell + 1]);
        let instants = self
            .lanes
            .get(session.lane)
            .map_or(0, |lane| lane.sum(session.start.max(from), session.end.min(until)));
        instants + self.cell_cost(cell, ns)
    }

    /// What a session pays for the windows that hold its start.
    pub(super) fn for_start(&self, model: &Model, start: i64) -> i64 {
        // start in [t, t + window)  <=>  t in (start - window, start]
        model.count.map_or(0, |(_, window)| {
            let first = start.saturating_sub(window).saturating_add(1);
            self.windows.sum(first, start.saturating_add(1))
        })
    }

    /// What a session pays for everything.
    pub(super) fn of(&self, model: &Model, session: &Session) -> i64 {
        let instants =
            self.lanes.get(session.lane).map_or(0, |lane| lane.sum(session.start, session.end));
        let cells: i64 = if self.cells.is_empty() {
            0
        } else {
            model.shares(session).map(|(cell, ns)| self.cell_cost(cell, ns)).sum()
        };
        instants + cells + self.for_start(model, session.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ladder_sums_half_open_stretches() {
        let ladder = Ladder::new([(3, 5.0), (7, 0.0), (8, 2.5), (9, 1.0)].into_iter());
        assert_eq!(ladder.total(), 8);
        assert_eq!(ladder.sum(3, 9), 7);
        assert_eq!(ladder.sum(4, 9), 2);
        assert_eq!(ladder.sum(3, 3), 0);
        assert_eq!(ladder.sum(9, 3), 0);
        assert_eq!(ladder.sum(-100, 100), 8);
        assert_eq!(ladder.points().collect::<Vec<_>>(), [(3, 5), (8, 2), (9, 1)]);
        assert_eq!(Ladder::default().sum(0, 10), 0);
    }

    #[test]
    fn a_cell_costs_less_than_it_is_worth() {
        let mut prices = Prices { cells: vec![0], ..Prices::default() };
        for limit in [1, 3, 1_000_000_007, 86_400_000_000_000] {
            for price in [1.0, 12_345.0, 1e12, f64::MAX] {
                prices.set_cell(0, price, limit);
                let parts = [limit / 3, limit / 5, limit - limit / 3 - limit / 5];
                let paid: i64 = parts.iter().map(|&ns| prices.cell_cost(0, ns)).sum();
                assert!(paid <= prices.cell_worth(0, limit), "{price} for {limit} ns");
                assert!(prices.cell_worth(0, limit) <= i64_from_f64(price.min(LARGEST_PRICE)) + 1);
            }
        }
        prices.set_cell(0, f64::NAN, 1);
        assert_eq!(prices.cell_worth(0, 1), 0);
    }
}
