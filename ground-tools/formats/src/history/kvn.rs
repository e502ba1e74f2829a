//! An AEM in keyword = value notation \[CCSDS504, version 1 and 2\].

use super::meta::{Entry, Meta, VERSIONS};
use super::{History, HistoryError, Row};

const HEADER_KEYS: [&str; 6] =
    ["CCSDS_AEM_VERS", "CLASSIFICATION", "COMMENT", "CREATION_DATE", "MESSAGE_ID", "ORIGINATOR"];

type Lines<'t> = std::iter::Peekable<std::vec::IntoIter<(usize, &'t str)>>;

pub(super) fn read(text: &str) -> Result<History, HistoryError> {
    let is_comment = |line: &str| {
        line.strip_prefix("COMMENT").is_some_and(|r| r.is_empty() || r.starts_with([' ', '\t']))
    };
    let lines: Vec<(usize, &str)> = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !is_comment(line))
        .collect();
    let mut lines = lines.into_iter().peekable();
    header(&mut lines)?;
    let mut history = History { form: "AEM in KVN", reference: None, rows: Vec::new() };
    while let Some((line, text)) = lines.next() {
        if text != "META_START" {
            return Err(unexpected(line, text, "META_START"));
        }
        let meta = block(&mut lines)?;
        if *history.reference.get_or_insert(meta.reference) != meta.reference {
            return Err(HistoryError::Frames { line });
        }
        history.rows.extend(data(&mut lines, &meta)?);
    }
    Ok(history)
}

fn unexpected(line: usize, text: &str, expected: impl Into<String>) -> HistoryError {
    HistoryError::Line { line, text: text.to_owned(), expected: expected.into() }
}

fn key_value(line: usize, text: &str) -> Result<Entry, HistoryError> {
    let (key, value) =
        text.split_once('=').ok_or_else(|| unexpected(line, text, "of the form KEY = value"))?;
    Ok((line, key.trim().to_owned(), value.trim().to_owned()))
}

fn header(lines: &mut Lines<'_>) -> Result<(), HistoryError> {
    let mut first = true;
    while let Some((line, text)) = lines.next_if(|(_, text)| *text != "META_START") {
        let (line, key, value) = key_value(line, text)?;
        if first && key != "CCSDS_AEM_VERS" {
            return Err(unexpected(line, text, "CCSDS_AEM_VERS = 2.0, with which an AEM begins"));
        }
        if first && !VERSIONS.contains(&value.as_str()) {
            return Err(HistoryError::Value { line, key, value, legal: VERSIONS.join(", ") });
        }
        if !HEADER_KEYS.contains(&key.as_str()) {
            return Err(HistoryError::Key { line, key, legal: HEADER_KEYS.join(", ") });
        }
        first = false;
    }
    if lines.peek().is_some() { Ok(()) } else { Err(HistoryError::Ended("before any META_START")) }
}

fn block(lines: &mut Lines<'_>) -> Result<Meta, HistoryError> {
    let mut entries: Vec<Entry> = Vec::new();
    for (line, text) in lines {
        if text == "META_STOP" {
            return Meta::new(&entries, line);
        }
        entries.push(key_value(line, text)?);
    }
    Err(HistoryError::Ended("inside a META block, without META_STOP"))
}

fn data(lines: &mut Lines<'_>, meta: &Meta) -> Result<Vec<Row>, HistoryError> {
    match lines.next() {
        Some((_, "DATA_START")) => {}
        Some((line, text)) => return Err(unexpected(line, text, "DATA_START")),
        None => return Err(HistoryError::Ended("before DATA_START")),
    }
    let mut rows: Vec<Row> = Vec::new();
    for (line, text) in lines {
        if text == "DATA_STOP" {
            return Ok(rows);
        }
        let fields: Vec<&str> = text.split_whitespace().collect();
        match fields[..] {
            [epoch, a, b, c, d, ..] if fields.len() == meta.numbers + 1 => {
                rows.push(meta.row(line, epoch, [a, b, c, d], &rows)?);
            }
            _ => {
                let expected = format!("an epoch and {} numbers", meta.numbers);
                return Err(unexpected(line, text, expected));
            }
        }
    }
    Err(HistoryError::Ended("inside a data block, without DATA_STOP"))
}
