//! Sets of small numbers as bits, one set a row, for searches that allocate nothing per node.

/// Sets of numbers below a limit, each a row of words.
#[derive(Debug, Default)]
pub(super) struct Bits {
    /// Words of a row.
    width: usize,
    words: Vec<u64>,
}

impl Bits {
    /// No set yet of numbers below `limit`.
    pub(super) fn sets_of(limit: usize) -> Self {
        Self { width: limit.div_ceil(64).max(1), words: Vec::new() }
    }

    /// Adds an empty set; its row.
    pub(super) fn push(&mut self) -> usize {
        let row = self.words.len() / self.width;
        self.words.resize(self.words.len() + self.width, 0);
        row
    }

    pub(super) fn insert(&mut self, row: usize, number: usize) {
        self.words[row * self.width + number / 64] |= 1 << (number % 64);
    }

    pub(super) fn remove(&mut self, row: usize, number: usize) {
        self.words[row * self.width + number / 64] &= !(1 << (number % 64));
    }

    /// Writes what a row has in common with a row of others into the row after it, which it returns.
    pub(super) fn meet(&mut self, row: usize, (others, other): (&Self, usize)) -> usize {
        let from = (row + 1) * self.width;
        if self.words.len() < from + self.width {
            self.words.resize(from + self.width, 0);
        }
        let (before, after) = self.words.split_at_mut(from);
        let mine = &before[row * self.width..];
        let theirs = &others.words[other * others.width..][..others.width];
        for ((into, a), b) in after.iter_mut().zip(mine).zip(theirs) {
            *into = a & b;
        }
        row + 1
    }

    /// The least number of a row that is at least `least`.
    pub(super) fn first_from(&self, row: usize, least: usize) -> Option<usize> {
        let words = &self.words[row * self.width..][..self.width];
        let mut at = least / 64;
        let mut word = words.get(at)? & (u64::MAX << (least % 64));
        while word == 0 {
            at += 1;
            word = *words.get(at)?;
        }
        Some(64 * at + word.trailing_zeros() as usize)
    }

    /// The largest number of a row below `end`.
    pub(super) fn last_before(&self, row: usize, end: usize) -> Option<usize> {
        let words = &self.words[row * self.width..][..self.width];
        let mut at = end / 64;
        let mut word = words.get(at).map_or(0, |it| it & !(u64::MAX << (end % 64)));
        while word == 0 {
            at = at.checked_sub(1)?;
            word = words[at];
        }
        Some(64 * at + 63 - word.leading_zeros() as usize)
    }
}
