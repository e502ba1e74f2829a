//! When does the mission start, and how long does it last.
//!
//! A [`TimeText`] is a time that has been checked, with its scale, as `ephem::time` reads it.
//!
//! Limits: years 1900 to 2200.

use crate::number::Number;
use crate::reading::canon::toml_string;
use crate::reading::document::Value;
use crate::reading::range::Range;
use crate::reading::section::Section;
use crate::rounding;
use ephem::time::{TimeError, parse_time};
use onboard_core::time::Duration;
use std::fmt;

/// A time with its scale, that exists.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TimeText {
    text: String,
    /// 1900 to 2200.
    pub year: u16,
}

/// What a time must look like.
const TIME_NEED: &str = "a time from 1900 to 2200 as YYYY-MM-DDThh:mm:ss[.fffffffff] followed by TDB, TT, TAI, UTC or Z";

impl fmt::Display for TimeText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl TimeText {
    /// Reads `2032-04-01T00:00:00 TDB`, `2032-04-01T00:00:00.5Z`, `2032-092T00:00:00Z` and the like.
    ///
    /// # Errors
    /// What is wrong with it; nothing more than that where its year is not 1900 to 2200.
    pub fn parse(text: &str) -> Result<Self, Option<TimeError>> {
        let text = text.trim();
        parse_time(text).map_err(Some)?;
        let year = text.get(..4).and_then(|year| year.parse().ok());
        let year = year.filter(|year| (1900..=2200).contains(year)).ok_or(None)?;
        Ok(Self { text: text.to_owned(), year })
    }

    /// The text as written.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// The time that a mission covers.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    /// When the scan clock starts.
    pub start: TimeText,
    /// How long it runs.
    pub duration_days: Number,
    /// The same, rounded to nanoseconds.
    pub duration: Duration,
}

const DURATION: Range = Range::positive("a duration", 36525.0, "days");

impl Span {
    pub(crate) fn read(section: &mut Section<'_>) -> Option<Self> {
        let start = match section.find("start") {
            None => {
                section.missing("start", &TIME_NEED);
                None
            }
            Some(node) => {
                let text = match &node.value {
                    Value::Moment(text) => Some(text.as_str()),
                    _ => Section::text_of(node),
                };
                match text.map(TimeText::parse) {
                    Some(Ok(start)) => Some(start),
                    Some(Err(Some(error))) => {
                        section.not_legal("start", node, &format!("{error}; {TIME_NEED}"));
                        None
                    }
                    None | Some(Err(None)) => {
                        section.not_legal("start", node, &TIME_NEED);
                        None
                    }
                }
            }
        };
        section.record("start", toml_string(start.as_ref().map_or("", TimeText::text)));
        let duration_days = section.number("duration_days", &DURATION, None);
        let duration = rounding::duration(&duration_days.times(86400, 1))?;
        Some(Self { start: start?, duration_days, duration })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_with_their_scale() {
        for text in [
            "2032-04-01T00:00:00Z",
            "2032-04-01T00:00:00 UTC",
            "2016-12-31T23:59:60.25Z",
            "2032-02-29T00:00:00 TAI",
            "2000-02-29T00:00:00.123456789 TT",
            "2032-04-01T00:00:00.1234567890 TDB",
            "2032-092T01:02:03.5 TDB",
            "2032-04-01t00:00:00 tdb",
        ] {
            assert_eq!(TimeText::parse(text).unwrap().text(), text);
        }
        assert_eq!(TimeText::parse("2032-04-01T01:02:03.5 TDB").unwrap().year, 2032);
    }

    #[test]
    fn other_times_are_refused() {
        let said = |text| TimeText::parse(text).unwrap_err().map(|it| it.to_string());
        assert_eq!(said("1899-12-31T00:00:00 TDB"), None);
        for (bad, sentence) in [
            ("", "names no time scale"),
            ("2032-04-01T00:00:00", "names no time scale"),
            ("2032-4-1T00:00:00 TDB", "not of the form"),
            ("2032-04-01T24:00:00 TDB", "hour 24"),
            ("2032-04-01T00:60:00 TDB", "minute 60"),
            ("2032-04-01T23:59:60 TDB", "no leap second"),
            ("2031-12-31T23:59:60Z", "no leap second"),
            ("2033-02-29T00:00:00 TDB", "day 29: legal is 1 to 28"),
            ("2032-13-01T00:00:00 TDB", "month 13"),
            ("2032-04-01T00:00:00 GPS", "GPS"),
            ("2032-04-01T00:00:00+09:00", "scale"),
            ("2032-04-01T00:00 TDB", "no seconds"),
            ("+032-04-01T00:00:00 TDB", "not of the form"),
        ] {
            assert!(said(bad).unwrap().contains(sentence), "{bad}: {:?}", said(bad));
        }
    }
}
