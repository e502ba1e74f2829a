//! How tens of thousands of opportunities and their sentences fit into a page.
//!
//! Numbers are variable-length: seven bits a byte, the lowest first, the top bit set where more follow;
//! signed ones alternate 0, -1, 1, -2. A sentence is a **template**, text with holes, and what fills the
//! holes: ids of sessions, dates, instants, runs of digits. Numbers in holes are differences from what
//! filled the same hole before, so that days that go by cost one byte.
//!
//! Limits: numbers below 2^53, which the page's script holds exactly; longer runs of digits are split.

use std::collections::BTreeMap;
use std::ops::Range;

/// Digits in one hole, below 2^53.
const MOST_DIGITS: usize = 15;
/// Digits of a turn in an id.
const TURN_DIGITS: usize = 6;

/// A hole of a template, or the text between two.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Part {
    /// Words as they stand.
    Text(String),
    /// An id: class and turn.
    Id,
    /// A date as a day since 1970.
    Date,
    /// A date and time as seconds since 1970.
    Time,
    /// Digits, padded with zeros to this width; 0 where they do not begin with one.
    Digits(usize),
}

/// Appends a number.
pub(super) fn push(bytes: &mut Vec<u8>, mut number: u64) {
    while number >= 128 {
        bytes.push(low_bits(number) | 128);
        number >>= 7;
    }
    bytes.push(low_bits(number));
}

const fn low_bits(number: u64) -> u8 {
    (number & 127) as u8
}

/// Appends a signed number.
#[expect(clippy::cast_sign_loss, reason = "the sign goes to the lowest bit")]
pub(super) fn push_signed(bytes: &mut Vec<u8>, number: i64) {
    push(bytes, ((number << 1) ^ (number >> 63)) as u64);
}

/// Writes sentences as templates and numbers.
#[derive(Debug)]
pub(super) struct Sentences {
    /// What ids of each class begin with: `TELESCOPE-target-`.
    prefixes: Vec<String>,
    templates: BTreeMap<Vec<Part>, usize>,
    /// The templates in the order of their numbers, and the last numbers in their holes.
    written: Vec<(Vec<Part>, Vec<i64>)>,
}

impl Sentences {
    pub(super) const fn new(prefixes: Vec<String>) -> Self {
        Self { prefixes, templates: BTreeMap::new(), written: Vec::new() }
    }

    /// Appends a sentence; gives the number of its template.
    pub(super) fn push(&mut self, bytes: &mut Vec<u8>, sentence: &str) -> usize {
        let (parts, numbers) = self.take_apart(sentence);
        let next = self.written.len();
        let template = *self.templates.entry(parts.clone()).or_insert(next);
        if template == next {
            self.written.push((parts, vec![0; numbers.len()]));
        }
        push(bytes, u64::try_from(template).unwrap_or(0));
        for (number, last) in numbers.into_iter().zip(&mut self.written[template].1) {
            push_signed(bytes, number - *last);
            *last = number;
        }
        template
    }

    /// The templates by number.
    pub(super) fn templates(&self) -> impl Iterator<Item = &[Part]> {
        self.written.iter().map(|(parts, _)| parts.as_slice())
    }

    fn take_apart(&self, sentence: &str) -> (Vec<Part>, Vec<i64>) {
        let (mut parts, mut numbers, mut text) = (Vec::new(), Vec::new(), String::new());
        let mut rest = sentence;
        let mut word_begins = true;
        while let Some(first) = rest.chars().next() {
            let found = if word_begins { self.id(rest) } else { None }
                .or_else(|| calendar(rest))
                .or_else(|| digits(rest));
            let length = if let Some((part, values, length)) = found {
                if !text.is_empty() {
                    parts.push(Part::Text(std::mem::take(&mut text)));
                }
                parts.push(part);
                numbers.extend(values);
                length
            } else {
                text.push(first);
                first.len_utf8()
            };
            word_begins = first == ' ';
            rest = &rest[length..];
        }
        if !text.is_empty() {
            parts.push(Part::Text(text));
        }
        (parts, numbers)
    }

    fn id(&self, text: &str) -> Option<(Part, Vec<i64>, usize)> {
        let (class, prefix) = self
            .prefixes
            .iter()
            .enumerate()
            .find(|(_, prefix)| text.starts_with(prefix.as_str()))?;
        let turn = run(&text[prefix.len()..]);
        if turn.len() < TURN_DIGITS || (turn.len() > TURN_DIGITS && turn.starts_with('0')) {
            return None;
        }
        let numbers = vec![i64::try_from(class).ok()?, turn.parse().ok()?];
        Some((Part::Id, numbers, prefix.len() + turn.len()))
    }
}

/// The digits that a text begins with, as many as one hole takes.
fn run(text: &str) -> &str {
    let length = text.bytes().take(MOST_DIGITS).take_while(u8::is_ascii_digit).count();
    &text[..length]
}

fn digits(text: &str) -> Option<(Part, Vec<i64>, usize)> {
    let run = run(text);
    let number = run.parse().ok()?;
    let width = if run.len() > 1 && run.starts_with('0') { run.len() } else { 0 };
    Some((Part::Digits(width), vec![number], run.len()))
}

/// A date, or a date and a time to the second.
fn calendar(text: &str) -> Option<(Part, Vec<i64>, usize)> {
    let number =
        |range: Range<usize>| text.get(range).filter(|it| run(it).len() == it.len())?.parse().ok();
    let is = |at: usize, letter: u8| text.as_bytes().get(at) == Some(&letter);
    if !(is(4, b'-') && is(7, b'-')) {
        return None;
    }
    let (year, month, day): (i64, i64, i64) = (number(0..4)?, number(5..7)?, number(8..10)?);
    if year < 1970 || !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    let date = civil_day(year, month, day);
    let (next_year, next_month) = if month == 12 { (year + 1, 1) } else { (year, month + 1) };
    if date >= civil_day(next_year, next_month, 1) {
        return None;
    }
    let clock =
        || -> Option<[i64; 3]> { Some([number(11..13)?, number(14..16)?, number(17..19)?]) };
    if is(10, b'T')
        && is(13, b':')
        && is(16, b':')
        && let Some([hour, minute, second]) = clock()
        && hour < 24
        && minute < 60
        && second < 60
    {
        return Some((Part::Time, vec![date * 86_400 + hour * 3600 + minute * 60 + second], 19));
    }
    Some((Part::Date, vec![date], 10))
}

/// Days since 1970-01-01 of the Gregorian calendar, for years from 1970.
pub(super) const fn civil_day(year: i64, month: i64, day: i64) -> i64 {
    // Years begin in March, so that the leap day is their last.
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let leap_days = year / 4 - year / 100 + year / 400;
    365 * year + leap_days + (153 * month + 2) / 5 + day - 1 - 719_468
}

/// A template for a person: an ellipsis for each hole, one for holes that only signs part.
pub(super) fn label(parts: &[Part]) -> String {
    let mut text = String::new();
    for part in parts {
        match part {
            Part::Text(words)
                if text.ends_with('\u{2026}') && matches!(&**words, "." | ":" | "-" | "Z") => {}
            Part::Text(words) if text.ends_with('\u{2026}') => {
                text.push_str(words.strip_prefix('Z').unwrap_or(words));
            }
            Part::Text(words) => text.push_str(words),
            _ if text.ends_with('\u{2026}') => {}
            _ => text.push('\u{2026}'),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;

    /// A plain reader of what was written.
    struct Reader<'b> {
        bytes: &'b [u8],
        at: usize,
        last: BTreeMap<usize, Vec<i64>>,
    }

    impl Reader<'_> {
        fn number(&mut self) -> u64 {
            let (mut number, mut shift) = (0, 0);
            loop {
                let byte = self.bytes[self.at];
                self.at += 1;
                number |= u64::from(byte & 127) << shift;
                shift += 7;
                if byte < 128 {
                    return number;
                }
            }
        }

        fn signed(&mut self) -> i64 {
            let number = self.number();
            (number >> 1).cast_signed() ^ -((number & 1).cast_signed())
        }

        fn sentence(&mut self, sentences: &Sentences) -> String {
            let template = usize::try_from(self.number()).unwrap();
            let parts: Vec<Part> = sentences.templates().nth(template).unwrap().to_vec();
            let mut text = String::new();
            let mut hole = 0;
            let mut next = |reader: &mut Self| {
                let change = reader.signed();
                let last = reader.last.entry(template).or_default();
                last.resize(last.len().max(hole + 1), 0);
                last[hole] += change;
                hole += 1;
                last[hole - 1]
            };
            for part in parts {
                match part {
                    Part::Text(words) => text += &words,
                    Part::Id => {
                        let class = usize::try_from(next(self)).unwrap();
                        let turn = next(self);
                        write!(text, "{}{turn:06}", sentences.prefixes[class]).unwrap();
                    }
                    Part::Date => text += &date(next(self)),
                    Part::Time => {
                        let at = next(self);
                        let s = at % 86_400;
                        text += &date(at / 86_400);
                        let [hour, minute, second] = [s / 3600, s / 60 % 60, s % 60];
                        write!(text, "T{hour:02}:{minute:02}:{second:02}").unwrap();
                    }
                    Part::Digits(width) => write!(text, "{:0width$}", next(self)).unwrap(),
                }
            }
            text
        }
    }

    /// A date by counting days, not by the formula under test.
    fn date(mut day: i64) -> String {
        let leap = |year: i64| year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
        let mut year = 1970;
        while day >= 365 + i64::from(leap(year)) {
            day -= 365 + i64::from(leap(year));
            year += 1;
        }
        let mut month = 1;
        for length in [31, 28 + i64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
            if day < length {
                break;
            }
            day -= length;
            month += 1;
        }
        format!("{year}-{month:02}-{:02}", day + 1)
    }

    #[test]
    fn sentences_come_back_word_for_word() {
        let texts = [
            "it needs 33.9 min of 2032-02-29 UTC, which has 0.05 min left",
            "it needs 7.0 min of 2100-03-01 UTC, which has 12.0 min left",
            "it overlaps the session MFT-jupiter-000012",
            "it overlaps the session A b-tau_a-1234567, and MFT-jupiter-0000012",
            "the window from 2032-04-01T02:08:51.007582103Z already holds 4 sessions",
            "adds 26447.992159342994 to 00: 2032-13-01, 2032-04-31T24:00:00, 123456789012345678901",
            "no digits, but \u{2026} and <b>\"&'",
            "",
        ];
        let mut sentences = Sentences::new(vec!["MFT-jupiter-".into(), "A b-tau_a-".into()]);
        let mut bytes = Vec::new();
        for text in texts.iter().chain(&texts) {
            sentences.push(&mut bytes, text);
        }
        let mut reader = Reader { bytes: &bytes, at: 0, last: BTreeMap::new() };
        for text in texts.iter().chain(&texts) {
            assert_eq!(reader.sentence(&sentences), *text);
        }
        assert_eq!(reader.at, bytes.len());
        let labels: Vec<String> = sentences.templates().map(label).collect();
        assert_eq!(labels[0], "it needs \u{2026} min of \u{2026} UTC, which has \u{2026} min left");
        assert!(
            labels.contains(&"the window from \u{2026} already holds \u{2026} sessions".to_owned())
        );
    }

    #[test]
    fn numbers_of_every_size_come_back() {
        let mut bytes = Vec::new();
        let numbers = [0, 1, -1, 63, -64, 64, 127, 128, 1 << 40, -(1 << 52)];
        for number in numbers {
            push_signed(&mut bytes, number);
        }
        assert_eq!(bytes.iter().take_while(|byte| **byte < 128).count(), 5);
        let mut reader = Reader { bytes: &bytes, at: 0, last: BTreeMap::new() };
        assert_eq!(numbers.map(|_| reader.signed()), numbers);
    }
}
