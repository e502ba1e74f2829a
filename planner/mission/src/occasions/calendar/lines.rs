//! The lines of an iCalendar file as they are meant: unfolded, with keywords in capitals.
//!
//! Folds are undone on bytes, since a fold may fall within a character [RFC 5545, section 3.1]. Lines
//! end in CRLF, LF or CR, mixed as they come. Only the properties that are read are kept.
//!
//! Limits: nesting to 16 deep; a line that has not the form NAME:VALUE is refused, but one that
//! begins with `X-` is left out and its number told.

use super::error::{CalendarError, DEEPEST};

/// What is read of components.
const READ: [&str; 18] = [
    "BEGIN",
    "DTEND",
    "DTSTART",
    "DURATION",
    "END",
    "EXDATE",
    "EXRULE",
    "FREEBUSY",
    "RDATE",
    "RECURRENCE-ID",
    "RRULE",
    "STATUS",
    "SUMMARY",
    "TRANSP",
    "TZID",
    "TZOFFSETFROM",
    "TZOFFSETTO",
    "UID",
];
/// What is read too, but is no property of RFC 5545.
const ZONE: &str = "X-WR-TIMEZONE";

/// A file's lines.
#[derive(Debug)]
pub(super) struct Lines {
    /// One for each calendar: one property each, lines end in CRLF, keywords are in capitals.
    pub(super) texts: Vec<String>,
    /// Numbers of malformed lines that are left out.
    pub(super) malformed: Vec<u64>,
}

impl Lines {
    /// The lines of a file.
    pub(super) fn of(bytes: &[u8]) -> Result<Self, CalendarError> {
        let mut lines = Self { texts: Vec::new(), malformed: Vec::new() };
        let mut open: Vec<String> = Vec::new();
        let (mut begun, mut ended) = (0, 0);
        let mut first = true;
        for (number, bytes) in unfolded(bytes) {
            let line = String::from_utf8_lossy(&bytes);
            let line = line.trim_start_matches('\u{feff}').trim_end();
            if line.is_empty() {
                continue;
            }
            let property = property(line);
            let begins = property.as_ref().is_some_and(|it| it.0 == "BEGIN" && is_calendar(it.2));
            if std::mem::take(&mut first) && !begins {
                return Err(CalendarError::NotACalendar);
            }
            let Some((name, parameters, value)) = property else {
                if line.get(..2).is_some_and(|it| it.eq_ignore_ascii_case("x-")) {
                    lines.malformed.push(number);
                    continue;
                }
                return Err(CalendarError::Line { number, text: line.to_owned() });
            };
            if !(READ.contains(&name.as_str()) || name == ZONE) {
                continue;
            }
            let mut value = value.to_owned();
            match name.as_str() {
                "BEGIN" => {
                    // The reader of components takes one calendar at a time.
                    if open.is_empty() {
                        lines.texts.push(String::new());
                    }
                    begun += 1;
                    value = value.trim().to_ascii_uppercase();
                    open.push(value.clone());
                    if open.len() > DEEPEST {
                        return Err(CalendarError::Nested { number });
                    }
                }
                "END" => {
                    ended += 1;
                    value = value.trim().to_ascii_uppercase();
                    if open.pop().as_ref() != Some(&value) {
                        return Err(CalendarError::End { number, name: value });
                    }
                }
                _ => {}
            }
            for part in [&name, parameters, ":", &value, "\r\n"] {
                if let Some(text) = lines.texts.last_mut() {
                    text.push_str(part);
                }
            }
        }
        match (first, open.is_empty()) {
            (true, _) => Err(CalendarError::NotACalendar),
            (_, false) => Err(CalendarError::CutShort { begun, ended }),
            _ => Ok(lines),
        }
    }
}

fn is_calendar(value: &str) -> bool {
    value.trim().eq_ignore_ascii_case("VCALENDAR")
}

/// Each line with the number of its first part, from 1.
fn unfolded(bytes: &[u8]) -> Vec<(u64, Vec<u8>)> {
    let mut lines: Vec<(u64, Vec<u8>)> = Vec::new();
    let mut number = 0;
    let mut rest = bytes;
    while !rest.is_empty() {
        number += 1;
        let end = rest.iter().position(|it| matches!(it, b'\r' | b'\n')).unwrap_or(rest.len());
        let (line, after) = rest.split_at(end);
        rest = after.strip_prefix(b"\r\n").or(after.get(1..)).unwrap_or_default();
        match (line, lines.last_mut()) {
            ([b' ' | b'\t', more @ ..], Some((_, last))) => last.extend(more),
            _ => lines.push((number, line.to_vec())),
        }
    }
    lines
}

/// Name in capitals, parameters with their semicolons, and value; `None` where it is malformed.
fn property(line: &str) -> Option<(String, &str, &str)> {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '-';
    let name = line.find(|c| !is_name(c)).filter(|&end| end > 0)?;
    let mut quoted = false;
    let colon = line.get(name..)?.find(|c| {
        quoted ^= c == '"';
        c == ':' && !quoted
    })?;
    let parameters = line.get(name..name + colon)?;
    let legal = parameters.is_empty() || (parameters.starts_with(';') && parameters.contains('='));
    let value = line.get(name + colon + 1..)?;
    legal.then(|| (line[..name].to_ascii_uppercase(), parameters, value))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(of: &[u8]) -> String {
        Lines::of(of).unwrap().texts.concat()
    }

    #[test]
    fn line_ends_may_be_mixed_and_a_fold_may_split_a_character() {
        let whole = "BEGIN:VCALENDAR\r\nSUMMARY:Manœuvre\r\nUID:1\r\nEND:VCALENDAR\r\n";
        let split = b"begin:vcalendar\nSummary:Man\xc5\r\n \x93uv\r\n\tre\ruid:1\nX-A:b\r\n\r\nEnd:VCalendar";
        assert_eq!(text(split), whole);
        assert_eq!(text(format!("\u{feff}{whole}").as_bytes()), whole);
    }

    #[test]
    fn malformed_lines_are_named() {
        let file = |line: &str| format!("BEGIN:VCALENDAR\r\n{line}\r\nEND:VCALENDAR\r\n");
        let left_out = Lines::of(file("X-NO VALUE").as_bytes()).unwrap();
        assert_eq!(left_out.malformed, [2]);
        for (line, sentence) in [
            ("DTSTART", "line 2: 'DTSTART'"),
            ("RRULE FREQ=DAILY", "line 2: 'RRULE FREQ=DAILY'"),
            ("DTSTART;TZID=\"A:20320401", "line 2"),
            ("DTSTART;TZID:20320401", "line 2"),
            (":x", "line 2"),
            ("BEGIN:VEVENT\nEND:VTODO", "line 3: END:VTODO"),
        ] {
            let said = Lines::of(file(line).as_bytes()).unwrap_err().to_string();
            assert!(said.contains(sentence), "{said}");
        }
        let deep = "BEGIN:VCALENDAR\n".repeat(60_000);
        assert_eq!(Lines::of(deep.as_bytes()).unwrap_err(), CalendarError::Nested { number: 17 });
    }
}
