//! Is a programme well posed: lists of one length, choices that exist, numbers whose sums fit.

use super::error::ProgramError;
use super::gain::Gain;
use super::problem::{LARGEST_COEFFICIENT, LARGEST_VALUE, Program};

impl Program {
    /// Whether sums over the programme stay within range and every term names a choice.
    pub(super) fn validate(&self) -> Result<(), ProgramError> {
        let count = self.values.len();
        if self.choices.len() != count {
            return Err(ProgramError::Lengths { values: count, choices: self.choices.len() });
        }
        let within = |what, index, number: i64, most: i64| {
            if (-most..=most).contains(&number) {
                Ok(())
            } else {
                Err(ProgramError::Number { what, index, number })
            }
        };
        for (index, &value) in self.values.iter().enumerate() {
            within("value", index, value, LARGEST_VALUE)?;
        }
        let mut seen = vec![usize::MAX; count];
        let rows = self.rows.iter().map(|row| &row.terms);
        let cells = self.cells.iter().map(|cell| &cell.terms);
        for (index, terms) in rows.chain(cells).enumerate() {
            for &(choice, coefficient) in terms {
                if seen.get(choice).is_none_or(|&last| last == index) {
                    return Err(ProgramError::Term { index, choice });
                }
                seen[choice] = index;
                within("row or cell", index, coefficient, LARGEST_COEFFICIENT)?;
            }
        }
        for (index, row) in self.rows.iter().enumerate() {
            within("limit", index, row.limit, LARGEST_COEFFICIENT)?;
        }
        self.validate_cells()
    }

    fn validate_cells(&self) -> Result<(), ProgramError> {
        for (index, cell) in self.cells.iter().enumerate() {
            let (first, second, least) = match cell.gain {
                Gain::Shortfall { wanted, price } => (price, wanted, 0),
                Gain::Log { scale, offset } => (scale, offset, 1),
            };
            let sum: i64 = cell.terms.iter().fold(0, |sum, term| sum.saturating_add(term.1));
            let legal = (0..=LARGEST_VALUE).contains(&first)
                && (least..=LARGEST_COEFFICIENT).contains(&second)
                && cell.terms.iter().all(|term| term.1 >= 0)
                && (0..=LARGEST_COEFFICIENT).contains(&cell.base)
                && cell.base.saturating_add(sum) <= LARGEST_COEFFICIENT
                && cell.gain.at(cell.base.saturating_add(sum)) < LARGEST_VALUE << 8;
            if !legal {
                return Err(ProgramError::Number { what: "cell", index, number: first });
            }
        }
        Ok(())
    }
}
