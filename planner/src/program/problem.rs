//! An integer programme over yes-or-no choices: values, rows, and concave parts of the objective.
//!
//! Every number is an integer in the caller's units; a choice is named by its position.
//!
//! Limits: [`LARGEST_VALUE`] and [`LARGEST_COEFFICIENT`] keep every sum inside an i128.

use super::gain::Gain;

/// Largest value of a choice or gain, in units.
pub const LARGEST_VALUE: i64 = 1 << 45;
/// Largest coefficient or limit.
pub const LARGEST_COEFFICIENT: i64 = 1 << 53;

/// `sum a_i x_i <= limit`.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Row {
    /// Choices and their coefficients, each choice at most once.
    pub terms: Vec<(usize, i64)>,
    /// The limit.
    pub limit: i64,
}

/// A concave part of the objective.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// Choices and what they add to the cell's sum, not negative.
    pub terms: Vec<(usize, i64)>,
    /// What the sum is worth.
    pub gain: Gain,
    /// The sum before any choice.
    pub base: i64,
}

impl Cell {
    /// The largest sum: every choice taken.
    pub(super) fn most(&self) -> i64 {
        self.base + self.terms.iter().map(|it| it.1).sum::<i64>()
    }
}

/// What is open about a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choice {
    /// It may be taken.
    Free,
    /// It must be taken.
    Always,
    /// It must not be taken.
    Never,
}

/// An integer programme over yes-or-no choices.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Program {
    /// Value of each choice in units.
    pub values: Vec<i64>,
    /// What is open about each.
    pub choices: Vec<Choice>,
    /// The rows.
    pub rows: Vec<Row>,
    /// The concave parts of the objective.
    pub cells: Vec<Cell>,
}

impl Program {
    /// The largest sum of a cell over sets that hold no forbidden choice.
    pub(super) fn most_open(&self, cell: &Cell) -> i64 {
        let open = cell.terms.iter().filter(|it| self.choices[it.0] != Choice::Never);
        cell.base + open.map(|term| term.1).sum::<i64>()
    }
}
