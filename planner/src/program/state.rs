//! A set of choices, evaluated exactly: its worth, what it uses of every row, the sum of every cell.
//!
//! Method: used capacities, sums and worth are kept up to date as choices are taken and given back, in
//! integers, so that one more choice is judged by the rows and cells that hold it alone.

use super::error::ProgramError;
use super::family::Family;
use super::problem::{Choice, Program};

/// Where each choice appears.
#[derive(Debug)]
pub(super) struct Index {
    /// Per choice, rows and coefficients.
    pub(super) rows: Vec<Vec<(usize, i64)>>,
    /// Per choice, cells and what it adds.
    pub(super) cells: Vec<Vec<(usize, i64)>>,
    /// Per row, whether all coefficients are at or above zero.
    packing: Vec<bool>,
}

impl Index {
    pub(super) fn new(program: &Program) -> Self {
        let count = program.values.len();
        let (mut rows, mut cells) = (vec![Vec::new(); count], vec![Vec::new(); count]);
        for (index, row) in program.rows.iter().enumerate() {
            for &(choice, coefficient) in &row.terms {
                rows[choice].push((index, coefficient));
            }
        }
        for (index, cell) in program.cells.iter().enumerate() {
            for &(choice, adds) in &cell.terms {
                cells[choice].push((index, adds));
            }
        }
        let packing = program.rows.iter().map(|row| row.terms.iter().all(|it| it.1 >= 0));
        Self { rows, cells, packing: packing.collect() }
    }

    /// Whether a row has no coefficient below zero.
    pub(super) fn is_packing(&self, row: usize) -> bool {
        self.packing[row]
    }
}

/// A set, evaluated.
#[derive(Debug, Clone)]
pub(super) struct State<'p> {
    program: &'p Program,
    index: &'p Index,
    taken: Vec<bool>,
    used: Vec<i128>,
    sums: Vec<i64>,
    value: i128,
}

impl<'p> State<'p> {
    /// Nothing is taken.
    pub(super) fn new(program: &'p Program, index: &'p Index) -> Self {
        Self {
            program,
            index,
            taken: vec![false; program.values.len()],
            used: vec![0; program.rows.len()],
            sums: program.cells.iter().map(|cell| cell.base).collect(),
            value: 0,
        }
    }

    /// A set as marks.
    pub(super) fn of(program: &'p Program, index: &'p Index, marks: &[bool]) -> Self {
        let mut state = Self::new(program, index);
        for (choice, _) in marks.iter().enumerate().filter(|(_, mark)| **mark) {
            state.set(choice, true);
        }
        state
    }

    /// Takes a choice, or removes it.
    pub(super) fn set(&mut self, choice: usize, taken: bool) {
        if self.taken[choice] == taken {
            return;
        }
        self.value += if taken { self.gain(choice) } else { 0 };
        self.taken[choice] = taken;
        let sign = if taken { 1 } else { -1 };
        for &(row, coefficient) in &self.index.rows[choice] {
            self.used[row] += i128::from(sign * coefficient);
        }
        for &(cell, adds) in &self.index.cells[choice] {
            self.sums[cell] += sign * adds;
        }
        self.value -= if taken { 0 } else { self.gain(choice) };
    }

    /// What taking a choice adds, where it is not taken.
    pub(super) fn gain(&self, choice: usize) -> i128 {
        let mut gain = i128::from(self.program.values[choice]);
        for &(cell, adds) in &self.index.cells[choice] {
            let (sum, worth) = (self.sums[cell], self.program.cells[cell].gain);
            gain += i128::from(worth.at(sum + adds) - worth.at(sum));
        }
        gain
    }

    /// Whether taking a choice breaks no row that holds it.
    pub(super) fn fits(&self, choice: usize) -> bool {
        self.program.choices[choice] != Choice::Never
            && self.index.rows[choice].iter().all(|&(row, coefficient)| {
                self.used[row] + i128::from(coefficient) <= i128::from(self.program.rows[row].limit)
            })
    }

    /// As [`Self::fits`], rows with coefficients below zero left aside.
    pub(super) fn fits_packing(&self, choice: usize) -> bool {
        self.program.choices[choice] != Choice::Never
            && self.index.rows[choice].iter().all(|&(row, coefficient)| {
                !self.index.is_packing(row)
                    || self.used[row] + i128::from(coefficient)
                        <= i128::from(self.program.rows[row].limit)
            })
    }

    /// The rows that the set breaks.
    pub(super) fn broken_rows(&self) -> impl Iterator<Item = usize> + '_ {
        let rows = self.used.iter().zip(&self.program.rows).enumerate();
        rows.filter(|(_, (used, row))| **used > i128::from(row.limit)).map(|(index, _)| index)
    }

    /// Whether every choice that must be taken is, and none that must not be.
    pub(super) fn meets_choices(&self) -> bool {
        self.taken.iter().zip(&self.program.choices).all(|(&taken, choice)| match choice {
            Choice::Free => true,
            Choice::Always => taken,
            Choice::Never => !taken,
        })
    }

    /// What the set uses of a row.
    pub(super) fn used(&self, row: usize) -> i128 {
        self.used[row]
    }

    /// The sum of a cell.
    pub(super) fn sum(&self, cell: usize) -> i64 {
        self.sums[cell]
    }

    /// Whether a choice is taken.
    pub(super) fn holds(&self, choice: usize) -> bool {
        self.taken[choice]
    }

    /// The set as marks.
    pub(super) fn marks(self) -> Vec<bool> {
        self.taken
    }

    /// Its value in units.
    pub(super) const fn value(&self) -> i128 {
        self.value
    }
}

impl Program {
    /// Value of a set in units where it meets every row and family, in exact arithmetic.
    ///
    /// # Errors
    /// [`ProgramError`] where the programme is not one.
    pub fn evaluate(
        &self,
        taken: &[usize],
        families: &[&dyn Family],
    ) -> Result<Option<i128>, ProgramError> {
        self.validate()?;
        let index = Index::new(self);
        let mut state = State::new(self, &index);
        let mut marks = vec![false; self.values.len()];
        for &choice in taken {
            if marks.get(choice).is_none_or(|&mark| mark) {
                return Ok(None);
            }
            marks[choice] = true;
            state.set(choice, true);
        }
        let met = state.meets_choices()
            && state.broken_rows().next().is_none()
            && families.iter().all(|family| family.broken(&marks).is_empty());
        Ok(met.then(|| state.value()))
    }
}
