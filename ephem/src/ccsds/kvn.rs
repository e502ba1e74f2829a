//! Keyword = value notation.

use super::block::{Block, Entry};
use super::error::{CcsdsError, Expected, Holder, Legal, Unfinished};
use super::kind::{Fence, HEADER_KEYS, META, MessageKind};
use super::record::Record;
use super::segment::Segment;
use core::iter::{Enumerate, Peekable};
use core::str;

/// The lines of a text that are neither blank nor comments, with their numbers.
#[derive(Debug, Clone)]
struct Lines<'d>(Enumerate<str::Lines<'d>>);

impl<'d> Iterator for Lines<'d> {
    type Item = (usize, &'d str);

    fn next(&mut self) -> Option<Self::Item> {
        let is_comment = |line: &str| {
            line.strip_prefix("COMMENT").is_some_and(|r| r.is_empty() || r.starts_with([' ', '\t']))
        };
        self.0
            .by_ref()
            .map(|(index, line)| (index + 1, line.trim()))
            .find(|(_, line)| !line.is_empty() && !is_comment(line))
    }
}

/// A message of which the header is read.
#[derive(Debug, Clone)]
pub(super) struct Kvn<'d> {
    kind: &'static MessageKind,
    lines: Peekable<Lines<'d>>,
}

impl<'d> Kvn<'d> {
    /// Reads the header.
    pub(super) fn new(text: &'d str, kind: &'static MessageKind) -> Result<Self, CcsdsError> {
        let mut lines = Lines(text.lines().enumerate()).peekable();
        let (line, first) = *lines.peek().ok_or(CcsdsError::Ended(Unfinished::Empty))?;
        let opening = entry(line, first)?;
        if opening.key != kind.opening {
            let expected = Expected::Opening { keyword: kind.opening, name: kind.name };
            return Err(CcsdsError::Line { line, text: first.to_owned(), expected });
        }
        if !kind.versions.contains(&opening.value) {
            return Err(opening.illegal(Legal::OneOf(kind.versions.to_vec())));
        }
        while let Some((line, text)) = lines.next_if(|(_, text)| *text != META.start) {
            let key = entry(line, text)?.key;
            if key != kind.opening && !HEADER_KEYS.contains(&key) {
                let legal = [&[kind.opening], &HEADER_KEYS[..]].concat();
                return Err(CcsdsError::Key { line, key: key.to_owned(), legal });
            }
        }
        if lines.peek().is_none() {
            return Err(CcsdsError::Ended(Unfinished::Header));
        }
        Ok(Self { kind, lines })
    }

    /// The next segment; `None` at the end.
    pub(super) fn segment(&mut self) -> Result<Option<Segment<'d>>, CcsdsError> {
        let Some(&(line, _)) = self.lines.peek() else { return Ok(None) };
        let meta = self.meta()?;
        let records = match self.kind.data {
            Some(fence) => self.fenced(fence)?,
            None => self.bare()?,
        };
        Ok(Some(Segment { line, meta, records }))
    }

    fn meta(&mut self) -> Result<Block<'d>, CcsdsError> {
        self.expect(META)?;
        let mut block = Block::new(self.kind, 0, Holder::EndedBy(META.stop));
        for (line, text) in self.lines.by_ref() {
            if text == META.stop {
                block.end_at(line);
                return Ok(block);
            }
            block.push(entry(line, text)?)?;
        }
        Err(CcsdsError::Ended(Unfinished::Inside(META)))
    }

    /// Passes the line that begins a block.
    fn expect(&mut self, fence: Fence) -> Result<(), CcsdsError> {
        match self.lines.next() {
            Some((_, text)) if text == fence.start => Ok(()),
            Some((line, text)) => {
                let expected = Expected::Keyword(fence.start);
                Err(CcsdsError::Line { line, text: text.to_owned(), expected })
            }
            None => Err(CcsdsError::Ended(Unfinished::Before(fence))),
        }
    }

    /// The records of a block.
    fn fenced(&mut self, fence: Fence) -> Result<Vec<Record<'d>>, CcsdsError> {
        self.expect(fence)?;
        let mut records = Vec::new();
        for (line, text) in self.lines.by_ref() {
            if text == fence.stop {
                return Ok(records);
            }
            records.push(Record::from_line(line, text));
        }
        Err(CcsdsError::Ended(Unfinished::Inside(fence)))
    }

    /// The records up to the next metadata.
    fn bare(&mut self) -> Result<Vec<Record<'d>>, CcsdsError> {
        let mut records = Vec::new();
        while let Some((line, text)) = self.lines.next_if(|(_, text)| *text != META.start) {
            match self.kind.passed_over.filter(|fence| text == fence.start) {
                Some(fence) if self.lines.any(|(_, text)| text == fence.stop) => {}
                Some(fence) => return Err(CcsdsError::Ended(Unfinished::Inside(fence))),
                None => records.push(Record::from_line(line, text)),
            }
        }
        Ok(records)
    }
}

/// Splits `KEY = value`.
fn entry(line: usize, text: &str) -> Result<Entry<'_>, CcsdsError> {
    let expected = Expected::KeyValue;
    let (key, value) = text.split_once('=').ok_or_else(|| CcsdsError::Line {
        line,
        text: text.to_owned(),
        expected,
    })?;
    Ok(Entry { line, key: key.trim(), value: value.trim() })
}
