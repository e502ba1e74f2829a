//! A block of metadata: keywords with their values.

use super::epoch::epoch;
use super::error::{CcsdsError, Holder, Legal};
use super::kind::MessageKind;
use crate::time::Scale;
use onboard_core::time::Instant;

/// A keyword, its value, and the line on which they stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry<'d> {
    /// Line number.
    pub line: usize,
    /// Keyword.
    pub key: &'d str,
    /// Its value, as written.
    pub value: &'d str,
}

impl Entry<'_> {
    /// The refusal of its value.
    #[must_use]
    pub fn illegal(&self, legal: Legal) -> CcsdsError {
        let (line, key, value) = (self.line, self.key.to_owned(), self.value.to_owned());
        CcsdsError::Value { line, key, value, legal }
    }

    /// The one of `legal` that the value is, in letters of any case.
    ///
    /// # Errors
    /// [`CcsdsError::Value`], which lists them.
    pub fn one_of(&self, legal: &[&'static str]) -> Result<&'static str, CcsdsError> {
        let found = legal.iter().copied().find(|known| known.eq_ignore_ascii_case(self.value));
        found.ok_or_else(|| self.illegal(Legal::OneOf(legal.to_vec())))
    }
}

/// The metadata of a segment.
#[derive(Debug, Clone)]
pub struct Block<'d> {
    kind: &'static MessageKind,
    entries: Vec<Entry<'d>>,
    line: usize,
    holder: Holder,
}

impl<'d> Block<'d> {
    /// Without entries; `line` and `holder` tell where one is missing.
    pub(super) const fn new(kind: &'static MessageKind, line: usize, holder: Holder) -> Self {
        Self { kind, entries: Vec::new(), line, holder }
    }

    /// Sets the line that tells where an entry is missing.
    pub(super) const fn end_at(&mut self, line: usize) {
        self.line = line;
    }

    /// Adds an entry that is known and, comments aside, not there yet.
    pub(super) fn push(&mut self, entry: Entry<'d>) -> Result<(), CcsdsError> {
        if !self.kind.keys.contains(&entry.key) {
            return Err(CcsdsError::Key {
                line: entry.line,
                key: entry.key.to_owned(),
                legal: self.kind.keys.to_vec(),
            });
        }
        if let Some(before) = self.find(entry.key).filter(|_| entry.key != "COMMENT") {
            return Err(entry.illegal(Legal::Once(before.line)));
        }
        self.entries.push(entry);
        Ok(())
    }

    /// The entry of a keyword.
    #[must_use]
    pub fn find(&self, key: &str) -> Option<Entry<'d>> {
        self.entries.iter().find(|entry| entry.key == key).copied()
    }

    /// The entry of a keyword that must be there.
    ///
    /// # Errors
    /// [`CcsdsError::Missing`].
    pub fn need(&self, key: &'static str) -> Result<Entry<'d>, CcsdsError> {
        self.find(key).ok_or_else(|| self.missing(key))
    }

    /// The refusal for want of a keyword.
    #[must_use]
    pub const fn missing(&self, key: &'static str) -> CcsdsError {
        CcsdsError::Missing { line: self.line, holder: self.holder, key }
    }

    /// The scale of its epochs, `TIME_SYSTEM`.
    ///
    /// # Errors
    /// [`CcsdsError`]: missing, or not one that is read.
    pub fn time_system(&self) -> Result<Scale, CcsdsError> {
        let entry = self.need("TIME_SYSTEM")?;
        let legal = self.kind.time_systems;
        Scale::from_name(entry.one_of(legal)?)
            .ok_or_else(|| entry.illegal(Legal::OneOf(legal.to_vec())))
    }

    /// The epoch that a keyword gives, if it is there.
    ///
    /// # Errors
    /// [`CcsdsError::Time`].
    pub fn time(&self, key: &str, scale: Scale) -> Result<Option<Instant>, CcsdsError> {
        self.find(key).map(|entry| epoch(entry.line, key, entry.value, scale)).transpose()
    }
}
