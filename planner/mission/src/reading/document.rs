//! What does a mission file say, before anything is checked.
//!
//! A [`Table`] is TOML with every number as its text and every value with its [`Place`]. Tables of
//! a base and of the file over it merge key by key; anything else, lists of tables too, replaces.
//! An override of the command line sets one key by its dotted path, list elements by name or index.
//!
//! Method: the `toml` crate's borrowed document, which keeps the digits of numbers and the spans.
//!
//! Limits: a key given by dotted segments in a file has the line of its last segment.

use crate::fault::{Fault, MissionError, Problem};
use num_bigint::BigInt;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A text that values come from.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Source {
    /// A file's name, `preset NAME`, or an option of the command line.
    pub(crate) name: String,
    /// Folder of the file relative to the mission file's, with a trailing slash; or empty.
    pub(crate) folder: String,
    /// What is written over what: the larger over the smaller.
    pub(crate) rank: usize,
    /// Whether a person typed it as an option.
    pub(crate) typed: bool,
}

/// Where a value was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) source: Arc<Source>,
    pub(crate) line: Option<usize>,
}

impl Place {
    pub(crate) fn fault(&self, problem: Problem) -> Fault {
        Fault { origin: self.source.name.clone(), line: self.line, problem }
    }

    pub(crate) fn error(&self, problem: Problem) -> MissionError {
        self.fault(problem).into()
    }
}

/// A value and its place.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub(crate) value: Value,
    pub(crate) place: Place,
}

#[derive(Debug, Clone)]
pub(crate) enum Value {
    /// A number's text; `nan` and `inf` too.
    Number(String),
    /// A string in quotes.
    Text(String),
    /// What was typed as an option's value and is no TOML: a string without quotes.
    Word(String),
    /// A date or time without quotes.
    Moment(String),
    Truth(bool),
    List(Vec<Node>),
    Table(Table),
}

/// Keys in alphabetical order.
pub(crate) type Table = BTreeMap<String, Node>;

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(text) | Self::Word(text) | Self::Moment(text) => f.write_str(text),
            Self::Text(text) => write!(f, "{text:?}"),
            Self::Truth(value) => write!(f, "{value}"),
            Self::List(nodes) => {
                let items: Vec<String> = nodes.iter().map(|node| node.value.to_string()).collect();
                write!(f, "[{}]", items.join(", "))
            }
            Self::Table(table) => {
                let items: Vec<String> =
                    table.iter().map(|(key, node)| format!("{key} = {}", node.value)).collect();
                write!(f, "{{ {} }}", items.join(", "))
            }
        }
    }
}

/// Reads a TOML text.
pub(crate) fn parse(text: &str, source: &Arc<Source>) -> Result<Table, MissionError> {
    let lines = Lines::new(text);
    match DeTable::parse(text) {
        Ok(table) => Ok(read_table(table.get_ref(), source, Some(&lines))),
        Err(error) => {
            let line = error.span().map(|span| lines.of(span.start));
            let message = error.message().replace('\n', " ");
            Err(Place { source: Arc::clone(source), line }.error(Problem::Syntax { message }))
        }
    }
}

/// Reads an option's value: TOML where it is, else a word.
pub(crate) fn parse_typed(text: &str, source: &Arc<Source>) -> Node {
    let value = match DeValue::parse(text.trim()) {
        Ok(value) => read_value(value.get_ref(), source, None),
        Err(_) => Value::Word(text.trim().to_owned()),
    };
    Node { value, place: Place { source: Arc::clone(source), line: None } }
}

/// The starts of a text's lines.
struct Lines(Vec<usize>);

impl Lines {
    fn new(text: &str) -> Self {
        Self(text.match_indices('\n').map(|(at, _)| at).collect())
    }

    /// The line, from 1, of a byte.
    fn of(&self, byte: usize) -> usize {
        self.0.partition_point(|&newline| newline < byte) + 1
    }
}

fn read_table(table: &DeTable<'_>, source: &Arc<Source>, lines: Option<&Lines>) -> Table {
    let entry = |(key, value): (&Spanned<std::borrow::Cow<'_, str>>, &Spanned<DeValue<'_>>)| {
        let line = lines.map(|lines| lines.of(key.span().start));
        let place = Place { source: Arc::clone(source), line };
        let value = read_value(value.get_ref(), source, lines);
        (key.get_ref().to_string(), Node { value, place })
    };
    table.iter().map(entry).collect()
}

fn read_value(value: &DeValue<'_>, source: &Arc<Source>, lines: Option<&Lines>) -> Value {
    match value {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(integer) => {
            let digits = integer.as_str();
            let decimal = if integer.radix() == 10 {
                digits.to_owned()
            } else {
                BigInt::parse_bytes(digits.as_bytes(), integer.radix())
                    .map_or_else(|| digits.to_owned(), |value| value.to_string())
            };
            Value::Number(decimal)
        }
        DeValue::Float(float) => Value::Number(float.as_str().to_owned()),
        DeValue::Boolean(truth) => Value::Truth(*truth),
        DeValue::Datetime(moment) => Value::Moment(moment.to_string()),
        DeValue::Array(items) => {
            let item = |item: &Spanned<DeValue<'_>>| Node {
                value: read_value(item.get_ref(), source, lines),
                place: Place {
                    source: Arc::clone(source),
                    line: lines.map(|lines| lines.of(item.span().start)),
                },
            };
            Value::List(items.iter().map(item).collect())
        }
        DeValue::Table(table) => Value::Table(read_table(table, source, lines)),
    }
}

/// `over` on top of `base`.
pub(crate) fn merge(base: Table, over: Table) -> Table {
    let mut merged = base;
    for (key, node) in over {
        let node = match (merged.remove(&key), node) {
            (
                Some(Node { value: Value::Table(below), .. }),
                Node { value: Value::Table(above), place },
            ) => Node { value: Value::Table(merge(below, above)), place },
            (_, node) => node,
        };
        merged.insert(key, node);
    }
    merged
}

/// Sets the key at a dotted path; tables on the way that do not exist are made.
pub(crate) fn set(table: &mut Table, path: &str, node: Node) -> Result<(), MissionError> {
    let segments = segments(path);
    let bad = |node: &Node| {
        node.place.error(Problem::NotAnOverride { text: format!("{path}={}", node.value) })
    };
    let Some((end, way)) = segments.split_last() else { return Err(bad(&node)) };
    if segments.iter().any(String::is_empty) {
        return Err(bad(&node));
    }
    let mut at = Cursor::Table(table);
    for (depth, segment) in way.iter().enumerate() {
        let made = Node { value: Value::Table(Table::new()), place: node.place.clone() };
        let next = match at {
            Cursor::Table(table) => table.entry(segment.clone()).or_insert(made),
            Cursor::List(list) => {
                let legal = elements(list);
                let shown = segments.iter().take(depth + 1).cloned().collect::<Vec<_>>().join(".");
                let missing = Problem::NoSuchElement { key: shown, legal };
                element(list, segment).ok_or_else(|| node.place.error(missing))?
            }
        };
        at = match &mut next.value {
            Value::Table(table) => Cursor::Table(table),
            Value::List(list) => Cursor::List(list),
            _ => return Err(bad(&node)),
        };
    }
    match at {
        Cursor::Table(table) => {
            table.insert(end.clone(), node);
        }
        Cursor::List(list) => {
            let missing = Problem::NoSuchElement { key: path.to_owned(), legal: elements(list) };
            let place = node.place.clone();
            *element(list, end).ok_or_else(|| place.error(missing))? = node;
        }
    }
    Ok(())
}

enum Cursor<'a> {
    Table(&'a mut Table),
    List(&'a mut Vec<Node>),
}

/// A dotted path's segments; quotes protect a dot.
fn segments(path: &str) -> Vec<String> {
    let mut segments = vec![String::new()];
    let mut quote = None;
    for c in path.trim().chars() {
        match quote {
            Some(open) if c == open => quote = None,
            None if c == '"' || c == '\'' => quote = Some(c),
            None if c == '.' => segments.push(String::new()),
            _ => {
                if let Some(segment) = segments.last_mut() {
                    segment.push(c);
                }
            }
        }
    }
    segments
}

/// The name that a table carries.
pub(crate) fn name_of(node: &Node) -> Option<&str> {
    let Value::Table(table) = &node.value else { return None };
    match table.get("name").map(|name| &name.value) {
        Some(Value::Text(name) | Value::Word(name)) => Some(name),
        _ => None,
    }
}

/// The element with this name, or else at this index.
fn element<'a>(list: &'a mut [Node], segment: &str) -> Option<&'a mut Node> {
    let named = list.iter().position(|node| name_of(node) == Some(segment));
    let index = named.or_else(|| segment.parse().ok())?;
    list.get_mut(index)
}

fn elements(list: &[Node]) -> String {
    let shown: Vec<String> = list
        .iter()
        .enumerate()
        .map(|(index, node)| name_of(node).map_or_else(|| index.to_string(), str::to_owned))
        .collect();
    if shown.is_empty() {
        "a list with elements in the mission file".to_owned()
    } else {
        format!("one of {}", shown.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source() -> Arc<Source> {
        Arc::new(Source { name: "test".to_owned(), folder: String::new(), rank: 0, typed: false })
    }

    fn table(text: &str) -> Table {
        parse(text, &source()).unwrap()
    }

    fn shown(table: &Table) -> String {
        Value::Table(table.clone()).to_string()
    }

    #[test]
    fn numbers_keep_their_digits_and_values_their_lines() {
        let read = table("a = 192.3480\n[b]\nc = 1_000\nd = 0x10\ne = nan\n");
        assert_eq!(shown(&read), "{ a = 192.3480, b = { c = 1000, d = 16, e = nan } }");
        let Value::Table(inner) = &read["b"].value else { panic!() };
        assert_eq!((read["b"].place.line, inner["d"].place.line), (Some(2), Some(4)));
    }

    #[test]
    fn a_fault_of_syntax_has_its_line() {
        let fault = parse("a = 1\nb = = 2\n", &source()).unwrap_err();
        assert_eq!(fault.faults()[0].line, Some(2), "{fault}");
        let fault = parse("a = 1\na = 2\n", &source()).unwrap_err();
        assert_eq!(fault.to_string(), "test, line 2: not TOML: duplicate key");
    }

    #[test]
    fn tables_merge_and_lists_replace() {
        let base = table("a = 1\n[t]\nx = 1\ny = 2\n[[l]]\nname = 'p'\n[[l]]\nname = 'q'\n");
        let over = table("[t]\ny = 3\n[[l]]\nname = 'r'\n");
        assert_eq!(
            shown(&merge(base, over)),
            "{ a = 1, l = [{ name = \"r\" }], t = { x = 1, y = 3 } }"
        );
    }

    #[test]
    fn an_override_finds_elements_by_name_or_index() {
        let mut read = table("[[l]]\nname = 'p'\n[[l]]\nname = 'q.1'\n");
        for (path, text) in [("l.p.x", "1"), ("l.1.x", "two"), ("l.\"q.1\".y", "[3]"), ("n.z", "")]
        {
            set(&mut read, path, parse_typed(text, &source())).unwrap();
        }
        assert_eq!(
            shown(&read),
            "{ l = [{ name = \"p\", x = 1 }, { name = \"q.1\", x = two, y = [3] }], n = { z =  } }"
        );
        let sentence = |path: &str| {
            set(&mut read.clone(), path, parse_typed("1", &source())).unwrap_err().to_string()
        };
        assert_eq!(sentence("l.s.x"), "test: l.s does not exist: one of p, q.1 is needed");
        assert_eq!(sentence("l.2"), "test: l.2 does not exist: one of p, q.1 is needed");
        assert!(sentence("l.p.name.x").contains("l.p.name.x=1 is not an override"));
        assert!(sentence("l..x").contains("l..x=1 is not an override"));
    }
}
