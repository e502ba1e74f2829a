//! How a table of a mission file becomes typed values.
//!
//! A [`Section`] hands out its keys one by one: each read names the key, its legal range and its
//! default, and so is the schema. What nobody asked for is an unknown key. Every value read is also
//! written into the canonical text ([`crate::reading::canon`]).
//!
//! Method: faults are collected, not thrown: a faulty key yields a stand-in and the mission is
//! discarded at the end, so that one run names every fault.
//!
//! Limits: a table that is absent offers no keys of its own to the search for the nearest one.

use crate::fault::{Fault, Problem};
use crate::names::meant;
use crate::number::Number;
use crate::reading::canon::{Canon, toml_string};
use crate::reading::document::{Node, Place, Table, Value, name_of};
use crate::reading::findings::Findings;
use crate::reading::range::Range;
use num_rational::BigRational;
use num_traits::Signed;
use std::cell::RefCell;
use std::fmt;

static NOTHING: Table = Table::new();

/// One table on its way to typed values.
pub(crate) struct Section<'a> {
    path: String,
    table: &'a Table,
    place: Place,
    findings: &'a RefCell<Findings>,
    known: Vec<&'static str>,
    canon: Canon,
}

impl<'a> Section<'a> {
    pub(crate) fn new(table: &'a Table, place: Place, findings: &'a RefCell<Findings>) -> Self {
        Self::child(String::new(), table, place, findings)
    }

    fn child(
        path: String,
        table: &'a Table,
        place: Place,
        findings: &'a RefCell<Findings>,
    ) -> Self {
        Self { path, table, place, findings, known: Vec::new(), canon: Canon::default() }
    }

    /// The dotted path of one of this table's keys.
    pub(crate) fn key(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// The value of a key, which is known from now on.
    pub(crate) fn find(&mut self, key: &'static str) -> Option<&'a Node> {
        self.known.push(key);
        self.findings.borrow_mut().known.push(self.key(key));
        self.table.get(key)
    }

    /// Whether a key is there, known or not.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    /// A key's value, known or not.
    pub(crate) fn node_of(&self, key: &str) -> Option<&'a Node> {
        self.table.get(key)
    }

    /// Keys that are legal here though they are not read.
    pub(crate) fn knows(&mut self, keys: &[&'static str]) {
        for key in keys {
            self.find(key);
        }
    }

    /// The place of a key's value, or of the table where there is none.
    pub(crate) fn place_of(&self, key: &str) -> Place {
        self.table.get(key).map_or_else(|| self.place.clone(), |node| node.place.clone())
    }

    pub(crate) fn fault(&self, place: &Place, problem: Problem) {
        self.findings.borrow_mut().faults.push(place.fault(problem));
    }

    /// A fault of a file that this table names.
    pub(crate) fn report(&self, fault: Fault) {
        self.findings.borrow_mut().faults.push(fault);
    }

    pub(crate) fn record(&mut self, key: &str, value: String) {
        self.canon.line(key, value);
    }

    pub(crate) fn missing(&self, key: &str, need: &impl fmt::Display) {
        let problem = Problem::Missing { key: self.key(key), need: need.to_string() };
        self.fault(&self.place, problem);
    }

    pub(crate) fn not_legal(&self, key: &str, node: &Node, need: &impl fmt::Display) {
        let (key, value, need) = (self.key(key), node.value.to_string(), need.to_string());
        self.fault(&node.place, Problem::NotLegal { key, value, need });
    }

    /// A number of a node, checked.
    pub(crate) fn number_of(&self, key: &str, node: &Node, range: &Range) -> Option<Number> {
        let (Value::Number(text) | Value::Text(text) | Value::Word(text)) = &node.value else {
            self.not_legal(key, node, range);
            return None;
        };
        let number = match Number::parse(text) {
            Ok(number) => number,
            Err(_) if matches!(node.value, Value::Number(_)) => {
                self.out_of_range(key, node, range, "");
                return None;
            }
            Err(_) => {
                self.not_legal(key, node, range);
                return None;
            }
        };
        if range.holds(number.exact()) {
            return Some(number);
        }
        let hint = if number.exact().is_negative() { range.if_negative } else { "" };
        self.out_of_range(key, node, range, hint);
        None
    }

    fn out_of_range(&self, key: &str, node: &Node, range: &Range, hint: &'static str) {
        let (key, value, need) = (self.key(key), node.value.to_string(), range.to_string());
        self.fault(&node.place, Problem::OutOfRange { key, value, need, hint });
    }

    /// A number; without a default it must be there.
    pub(crate) fn number(
        &mut self,
        key: &'static str,
        range: &Range,
        default: Option<&str>,
    ) -> Number {
        let read = match (self.find(key), default) {
            (Some(node), _) => self.number_of(key, node, range),
            (None, Some(default)) => Number::parse(default).ok(),
            (None, None) => {
                self.missing(key, range);
                None
            }
        };
        let number = read.unwrap_or_else(Number::zero);
        self.record(key, number.toml());
        number
    }

    /// A number that may be absent or `"none"`.
    pub(crate) fn optional_number(&mut self, key: &'static str, range: &Range) -> Option<Number> {
        let number = self.find_some(key).and_then(|node| self.number_of(key, node, range));
        self.record(key, number.as_ref().map_or_else(none, Number::toml));
        number
    }

    /// A whole number; it must be there.
    pub(crate) fn count(&mut self, key: &'static str, range: &Range) -> u32 {
        let number = self.number(key, range, None);
        let whole = number.exact().is_integer().then(|| u32::try_from(number.exact().numer()).ok());
        if let Some(count) = whole.flatten() {
            return count;
        }
        if let Some(node) = self.table.get(key) {
            self.not_legal(key, node, range);
        }
        0
    }

    /// 1 or -1; 1 where it is absent.
    pub(crate) fn sign(&mut self, key: &'static str) -> i8 {
        let need = "1 or -1";
        let sign = match self.find(key) {
            None => 1,
            Some(node) => {
                let range = Range::closed("a sign", -1.0, 1.0, "");
                let number = match &node.value {
                    Value::Number(text) | Value::Word(text) => Number::parse(text).ok(),
                    _ => None,
                };
                let legal = number.filter(|number| {
                    range.holds(number.exact())
                        && number.exact().abs() == BigRational::from_integer(1.into())
                });
                if legal.is_none() {
                    self.not_legal(key, node, &need);
                }
                if legal.is_some_and(|number| number.exact().is_negative()) { -1 } else { 1 }
            }
        };
        self.record(key, sign.to_string());
        sign
    }

    pub(crate) fn truth(&mut self, key: &'static str, default: bool) -> bool {
        let truth = match self.find(key) {
            None => default,
            Some(Node { value: Value::Truth(truth), .. }) => *truth,
            Some(node) => {
                let typed = Self::text_of(node).and_then(|text| text.parse().ok());
                if typed.is_none() || !node.place.source.typed {
                    self.not_legal(key, node, &"true or false");
                }
                typed.unwrap_or(default)
            }
        };
        self.record(key, truth.to_string());
        truth
    }

    /// The text of a node: a string, or anything without structure that was typed as an option.
    pub(crate) fn text_of(node: &Node) -> Option<&str> {
        match &node.value {
            Value::Text(text) | Value::Word(text) => Some(text),
            Value::Number(text) | Value::Moment(text) if node.place.source.typed => Some(text),
            _ => None,
        }
    }

    /// A name; without a default it must be there.
    pub(crate) fn name(&mut self, key: &'static str, default: Option<&str>) -> String {
        let name = match (self.find(key), default) {
            (Some(node), _) => {
                let name = Self::text_of(node).filter(|name| is_name(name));
                if name.is_none() {
                    self.not_legal(key, node, &NAME);
                }
                name.unwrap_or("")
            }
            (None, Some(default)) => default,
            (None, None) => {
                self.missing(key, &NAME);
                ""
            }
        };
        self.record(key, toml_string(name));
        name.to_owned()
    }

    /// One of a few words, the first where it is absent.
    pub(crate) fn choice<T: Copy>(
        &mut self,
        key: &'static str,
        choices: &[(&str, T)],
    ) -> Option<T> {
        let found = match self.find(key) {
            None => choices.first(),
            Some(node) => {
                let text = Self::text_of(node);
                let found = choices.iter().find(|(word, _)| Some(*word) == text);
                if found.is_none() {
                    let words: Vec<String> =
                        choices.iter().map(|(word, _)| format!("\"{word}\"")).collect();
                    self.not_legal(key, node, &words.join(" or "));
                }
                found
            }
        };
        self.record(key, found.map_or_else(none, |(word, _)| toml_string(word)));
        found.map(|(_, value)| *value)
    }

    /// A key's value unless it is `"none"`.
    pub(crate) fn find_some(&mut self, key: &'static str) -> Option<&'a Node> {
        self.find(key).filter(|node| Self::text_of(node) != Some("none"))
    }

    /// N numbers.
    pub(crate) fn numbers<const N: usize>(
        &mut self,
        key: &'static str,
        range: &Range,
        default: [&str; N],
    ) -> Option<[Number; N]> {
        let default = default.map(|text| Number::parse(text).unwrap_or_else(|_| Number::zero()));
        let read = match self.find(key) {
            None => Some(default),
            Some(node) => match &node.value {
                Value::List(items) if items.len() == N => {
                    let read: Vec<Number> =
                        items.iter().filter_map(|item| self.number_of(key, item, range)).collect();
                    read.try_into().ok()
                }
                _ => {
                    self.not_legal(key, node, &format!("a list of {N} numbers"));
                    None
                }
            },
        };
        if let Some(numbers) = &read {
            let items: Vec<String> = numbers.iter().map(Number::toml).collect();
            self.record(key, format!("[{}]", items.join(", ")));
        }
        read
    }

    /// A table of its own, read even where it is absent.
    pub(crate) fn table<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&mut Section<'a>) -> T,
    ) -> T {
        let node = self.find(key);
        let (table, place) = match node {
            Some(Node { value: Value::Table(table), place }) => (table, place.clone()),
            Some(node) => {
                self.not_legal(key, node, &"a table");
                (&NOTHING, node.place.clone())
            }
            None => (&NOTHING, Place { line: None, ..self.place.clone() }),
        };
        let mut section = Section::child(self.key(key), table, place, self.findings);
        let value = read(&mut section);
        self.canon.table(key, section.finish());
        value
    }

    /// A list of tables, each with its position; an element's path carries its name.
    pub(crate) fn tables<T>(
        &mut self,
        key: &'static str,
        read: impl FnMut(&mut Section<'a>) -> T,
    ) -> Vec<T> {
        let Some(node) = self.find(key) else {
            self.canon.list(key, Vec::new());
            return Vec::new();
        };
        let (values, canons) = self.elements(key, node, read);
        self.canon.list(key, canons);
        values
    }

    /// A list of inline tables.
    pub(crate) fn inline_tables<T>(
        &mut self,
        key: &'static str,
        read: impl FnMut(&mut Section<'a>) -> T,
    ) -> Vec<T> {
        let Some(node) = self.find_some(key) else {
            self.record(key, "[]".to_owned());
            return Vec::new();
        };
        let (values, canons) = self.elements(key, node, read);
        let items: Vec<String> = canons.iter().map(Canon::inline).collect();
        self.record(key, format!("[{}]", items.join(", ")));
        values
    }

    fn elements<T>(
        &self,
        key: &'static str,
        node: &'a Node,
        mut read: impl FnMut(&mut Section<'a>) -> T,
    ) -> (Vec<T>, Vec<Canon>) {
        let Value::List(items) = &node.value else {
            self.not_legal(key, node, &"a list of tables");
            return (Vec::new(), Vec::new());
        };
        let mut values = Vec::new();
        let mut canons = Vec::new();
        for (index, item) in items.iter().enumerate() {
            let label = name_of(item).map_or_else(|| index.to_string(), str::to_owned);
            let path = format!("{}.{label}", self.key(key));
            let Value::Table(table) = &item.value else {
                self.not_legal(key, item, &"a table");
                continue;
            };
            let mut section = Section::child(path, table, item.place.clone(), self.findings);
            values.push(read(&mut section));
            canons.push(section.finish());
        }
        (values, canons)
    }

    /// An inline table that may be absent or `"none"`.
    pub(crate) fn inline<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&mut Section<'a>) -> T,
    ) -> Option<T> {
        let Some(node) = self.find_some(key) else {
            self.record(key, none());
            return None;
        };
        let Value::Table(table) = &node.value else {
            self.not_legal(key, node, &"a table or \"none\"");
            return None;
        };
        let mut section = Section::child(self.key(key), table, node.place.clone(), self.findings);
        let value = read(&mut section);
        let canon = section.finish().inline();
        self.record(key, canon);
        Some(value)
    }

    /// The canonical text; what nobody asked for is unknown.
    pub(crate) fn finish(self) -> Canon {
        for (key, node) in self.table {
            if !self.known.contains(&key.as_str()) {
                let unknown = (node.place.clone(), self.key(key));
                self.findings.borrow_mut().unknown.push(unknown);
            }
        }
        self.canon
    }
}

fn none() -> String {
    "\"none\"".to_owned()
}

/// What a name must be.
pub(crate) const NAME: &str = "a name of 1 to 64 printable characters that does not begin with # = + or @, neither \"-\", \"all\" nor \"none\", without , / and quotes";

/// Whether a character is not seen, but turns the direction of writing or ends lines.
const fn turns(c: char) -> bool {
    matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}')
}

/// Whether a text can name something in every output.
pub(crate) fn is_name(text: &str) -> bool {
    (1..=64).contains(&text.chars().count())
        && text.trim() == text
        && !text.chars().any(|c| c.is_control() || turns(c) || matches!(c, ',' | '/' | '"' | '\''))
        // A comment of a CSV, or a formula of a spreadsheet.
        && !text.starts_with(['#', '=', '+', '@'])
        && !matches!(text, "-" | "all" | "none")
}

/// The sentence part for a name from a list.
pub(crate) fn one_of(legal: &[&str]) -> String {
    format!("one of {}", legal.join(", "))
}

/// The same, with the name that may have been meant.
pub(crate) fn one_of_meant(name: &str, legal: &[&str]) -> String {
    let meant = meant(name, legal).map_or(String::new(), |it| format!(" (did you mean {it}?)"));
    format!("{}{meant}", one_of(legal))
}

/// Faults for names that occur twice in a list of tables.
pub(crate) fn duplicates<'n>(
    section: &Section<'_>,
    key: &str,
    names: impl Iterator<Item = &'n str>,
) {
    let mut seen: Vec<&str> = Vec::new();
    for (index, name) in names.enumerate() {
        if !name.is_empty() && seen.contains(&name) {
            let place = match section.node_of(key).map(|node| &node.value) {
                Some(Value::List(items)) => items.get(index).map(|item| item.place.clone()),
                _ => None,
            };
            let problem = Problem::Duplicate {
                key: format!("{}.{index}.name", section.key(key)),
                value: name.to_owned(),
            };
            section.fault(&place.unwrap_or_else(|| section.place_of(key)), problem);
        }
        seen.push(name);
    }
}
