//! Where the words go: to a file on the target, to a comparison on the host.

use core::fmt::{self, Write};

/// Takes words in order; block, item and field say where a word belongs.
pub trait Sink {
    /// The words that follow belong to this block.
    fn block(&mut self, index: u32);

    /// The words that follow belong to this item of the block: an instant, or an index.
    fn item(&mut self, item: i64);

    /// One word.
    fn word(&mut self, field: &'static str, bits: u64);

    /// The bits of a number.
    fn number(&mut self, field: &'static str, value: f64) {
        self.word(field, value.to_bits());
    }

    /// The bits of some numbers.
    fn numbers<const N: usize>(&mut self, fields: [&'static str; N], values: [f64; N]) {
        for (field, value) in fields.into_iter().zip(values) {
            self.number(field, value);
        }
    }

    /// The bits of an integer, sign-extended.
    fn integer(&mut self, field: &'static str, value: i64) {
        self.word(field, u64::from_le_bytes(value.to_le_bytes()));
    }

    /// The text of a value, eight letters a word, zeros behind the last.
    fn text(&mut self, field: &'static str, value: &impl fmt::Debug)
    where
        Self: Sized,
    {
        let mut letters = Letters { sink: self, field, word: [0; 8], filled: 0 };
        // Writing letters cannot fail.
        let _ = write!(letters, "{value:?}");
        let last = u64::from_le_bytes(letters.word);
        self.word(field, last);
    }
}

struct Letters<'s, S: Sink> {
    sink: &'s mut S,
    field: &'static str,
    word: [u8; 8],
    filled: usize,
}

impl<S: Sink> Write for Letters<'_, S> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for letter in text.bytes() {
            if self.filled == 8 {
                self.sink.word(self.field, u64::from_le_bytes(self.word));
                (self.word, self.filled) = ([0; 8], 0);
            }
            if let Some(place) = self.word.get_mut(self.filled) {
                *place = letter;
            }
            self.filled += 1;
        }
        Ok(())
    }
}
