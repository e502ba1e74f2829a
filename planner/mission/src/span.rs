//! When does the mission start, and how long does it last.
//!
//! A [`TimeText`] is a time whose syntax and calendar have been checked, with its scale; it becomes
//! an instant where leap seconds and TDB are known.
//!
//! Limits: years 1900 to 2200; whether a UTC day has a leap second is not checked here.

use crate::number::Number;
use crate::reading::canon::toml_string;
use crate::reading::document::Value;
use crate::reading::range::Range;
use crate::reading::section::Section;
use crate::rounding;
use onboard_core::time::Duration;
use std::fmt;

/// A time scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeScale {
    /// Barycentric dynamical time.
    Tdb,
    /// Terrestrial time.
    Tt,
    /// International atomic time.
    Tai,
    /// Coordinated universal time.
    Utc,
}

/// A calendar time with its scale.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TimeText {
    text: String,
    /// The scale; `Z` is UTC.
    pub scale: TimeScale,
    /// 1900 to 2200.
    pub year: u16,
    /// 1 to 12.
    pub month: u8,
    /// 1 to the month's length.
    pub day: u8,
    /// 0 to 23.
    pub hour: u8,
    /// 0 to 59.
    pub minute: u8,
    /// 0 to 59, or 60 at the end of a UTC day.
    pub second: u8,
    /// 0 to 999,999,999.
    pub nanosecond: u32,
}

/// What a time must look like.
const TIME_NEED: &str = "a time from 1900 to 2200 as YYYY-MM-DDThh:mm:ss[.fffffffff] followed by TDB, TT, TAI, UTC or Z";

impl fmt::Display for TimeText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl TimeText {
    /// Reads `2032-04-01T00:00:00 TDB`, `2032-04-01T00:00:00.5Z` and the like; `None` where it is
    /// no time from 1900 to 2200 in this form.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        let (clock, scale) = if let Some(clock) = text.strip_suffix('Z') {
            (clock, TimeScale::Utc)
        } else {
            let (clock, scale) = text.split_once(' ')?;
            let scale = match scale.trim() {
                "TDB" => TimeScale::Tdb,
                "TT" => TimeScale::Tt,
                "TAI" => TimeScale::Tai,
                "UTC" => TimeScale::Utc,
                _ => return None,
            };
            (clock, scale)
        };
        let (date, time) = clock.split_once('T')?;
        let (time, fraction) = time.split_once('.').map_or((time, None), |(t, f)| (t, Some(f)));
        let [year, month, day] = fields(date, '-', [4, 2, 2])?;
        let [hour, minute, second] = fields(time, ':', [2, 2, 2])?;
        let nanosecond = fraction.map_or(Some(0), nanoseconds)?;
        let leap_second = second == 60 && minute == 59 && hour == 23 && scale == TimeScale::Utc;
        let legal = (1900..=2200).contains(&year)
            && (1..=12).contains(&month)
            && (1..=days_in(year, month)).contains(&day)
            && hour < 24
            && minute < 60
            && (second < 60 || leap_second);
        if !legal {
            return None;
        }
        Some(Self {
            text: text.to_owned(),
            scale,
            year,
            month: u8::try_from(month).ok()?,
            day: u8::try_from(day).ok()?,
            hour: u8::try_from(hour).ok()?,
            minute: u8::try_from(minute).ok()?,
            second: u8::try_from(second).ok()?,
            nanosecond,
        })
    }

    /// The text as written.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// Three fields of so many digits.
fn fields(text: &str, separator: char, widths: [usize; 3]) -> Option<[u16; 3]> {
    let mut parts = text.split(separator);
    let mut read = [0; 3];
    for (value, width) in read.iter_mut().zip(widths) {
        let part = parts.next()?;
        if part.len() != width || !part.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        *value = part.parse().ok()?;
    }
    parts.next().is_none().then_some(read)
}

fn nanoseconds(fraction: &str) -> Option<u32> {
    let legal =
        (1..=9).contains(&fraction.len()) && fraction.bytes().all(|byte| byte.is_ascii_digit());
    if legal { format!("{fraction:0<9}").parse().ok() } else { None }
}

fn days_in(year: u16, month: u16) -> u16 {
    let leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    match month {
        2 if leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
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
                let start = text.and_then(TimeText::parse);
                if start.is_none() {
                    section.not_legal("start", node, &TIME_NEED);
                }
                start
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
        let time = TimeText::parse("2032-04-01T01:02:03.5 TDB").unwrap();
        assert_eq!((time.year, time.month, time.day), (2032, 4, 1));
        assert_eq!((time.hour, time.minute, time.second), (1, 2, 3));
        assert_eq!((time.nanosecond, time.scale), (500_000_000, TimeScale::Tdb));
        for (text, scale) in [
            ("2032-04-01T00:00:00Z", TimeScale::Utc),
            ("2032-04-01T00:00:00 UTC", TimeScale::Utc),
            ("2016-12-31T23:59:60.25Z", TimeScale::Utc),
            ("2032-02-29T00:00:00 TAI", TimeScale::Tai),
            ("2000-02-29T00:00:00.123456789 TT", TimeScale::Tt),
        ] {
            assert_eq!(TimeText::parse(text).unwrap().scale, scale, "{text}");
        }
    }

    #[test]
    fn other_times_are_refused() {
        for bad in [
            "",
            "2032-04-01T00:00:00",
            "2032-04-01 TDB",
            "2032-4-1T00:00:00 TDB",
            "2032-04-01T24:00:00 TDB",
            "2032-04-01T00:60:00 TDB",
            "2032-04-01T23:59:60 TDB",
            "2033-02-29T00:00:00 TDB",
            "2100-02-29T00:00:00 TDB",
            "2032-13-01T00:00:00 TDB",
            "2032-00-01T00:00:00 TDB",
            "1899-12-31T00:00:00 TDB",
            "2032-04-01T00:00:00. TDB",
            "2032-04-01T00:00:00.1234567890 TDB",
            "2032-04-01T00:00:00 GPS",
            "2032-04-01T00:00:00+09:00",
            "2032-04-01T00:00 TDB",
            "2032-04-01-02T00:00:00 TDB",
            "+032-04-01T00:00:00 TDB",
        ] {
            assert_eq!(TimeText::parse(bad), None, "{bad}");
        }
    }
}
