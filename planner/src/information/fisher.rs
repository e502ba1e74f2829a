//! Information as a matrix that adds up.
//!
//! `F_ij = sum over passes of (1 / sigma^2) int (ds/dp_i)(ds/dp_j) dt`, symmetric, in the units of
//! [`super::Parameter`]. Independent data add, so matrices of passes, sessions, targets and
//! detectors of one kind do.
//!
//! Limits: white noise, and a signal that is linear in its parameters over their errors.

use super::parameter::{COUNT, Parameter};

/// Entries on and above the diagonal, row by row.
const ENTRIES: usize = COUNT * (COUNT + 1) / 2;

/// The information on all parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fisher {
    upper: [f64; ENTRIES],
}

impl Default for Fisher {
    fn default() -> Self {
        Self { upper: [0.0; ENTRIES] }
    }
}

impl Fisher {
    /// The matrix whose entry in row `i` and column `j`, j from i on, is `of(i, j)`.
    pub(crate) fn from_fn(mut of: impl FnMut(usize, usize) -> f64) -> Self {
        let mut it = Self::default();
        let mut next = it.upper.iter_mut();
        for row in 0..COUNT {
            for column in row..COUNT {
                if let Some(entry) = next.next() {
                    *entry = of(row, column);
                }
            }
        }
        it
    }

    /// Takes in what other data teach.
    pub fn add(&mut self, other: &Self) {
        for (own, theirs) in self.upper.iter_mut().zip(&other.upper) {
            *own += theirs;
        }
    }

    /// The entry of two parameters.
    #[must_use]
    pub fn entry(&self, one: Parameter, other: Parameter) -> f64 {
        self.at(one.index(), other.index())
    }

    /// The entry of a row and a column below [`COUNT`].
    pub(crate) fn at(&self, row: usize, column: usize) -> f64 {
        let (low, high) = (row.min(column), row.max(column));
        // Rows above hold COUNT, COUNT - 1, ... entries.
        self.upper[low * COUNT - low * (low + 1) / 2 + high]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_where_they_were_put_and_add_up() {
        let value = |row: usize, column: usize| f64::from(u8::try_from(10 * row + column).unwrap());
        let mut it = Fisher::from_fn(value);
        it.add(&Fisher::from_fn(value));
        for row in 0..COUNT {
            for column in row..COUNT {
                assert!((it.at(row, column) - 2.0 * value(row, column)).abs() < 1e-12);
                assert!((it.at(column, row) - it.at(row, column)).abs() < 1e-12);
            }
        }
        assert!((it.entry(Parameter::TimeConstant, Parameter::OffsetY) - 52.0).abs() < 1e-12);
    }
}
