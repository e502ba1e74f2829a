//! What is the mission once everything is filled in, as text.
//!
//! [`Section`](crate::reading::section::Section) writes each key it reads into a [`Canon`], defaults too; the
//! whole is TOML that reads back as the same mission, and its SHA-256 names the mission.
//!
//! Method: keys stand in the order in which they are read, numbers in the user's own decimals; a
//! key that may be absent and is says `"none"`.
//!
//! Limits: files that a mission names enter by name, not by content, but instrument models with
//! their SHA-256.

use std::fmt::Write;

/// The keys of one table, in order, as TOML.
#[derive(Debug, Default)]
pub(crate) struct Canon {
    lines: Vec<(String, String)>,
    parts: Vec<(String, Part)>,
}

#[derive(Debug)]
enum Part {
    Table(Canon),
    List(Vec<Canon>),
}

impl Canon {
    pub(crate) fn line(&mut self, key: &str, value: String) {
        self.lines.push((key.to_owned(), value));
    }

    pub(crate) fn table(&mut self, key: &str, table: Self) {
        self.parts.push((key.to_owned(), Part::Table(table)));
    }

    /// A list of tables; an empty one is a line.
    pub(crate) fn list(&mut self, key: &str, tables: Vec<Self>) {
        if tables.is_empty() {
            self.line(key, "[]".to_owned());
        } else {
            self.parts.push((key.to_owned(), Part::List(tables)));
        }
    }

    /// The lines as an inline table.
    pub(crate) fn inline(&self) -> String {
        if self.lines.is_empty() {
            return "{}".to_owned();
        }
        let items: Vec<String> =
            self.lines.iter().map(|(key, value)| format!("{} = {value}", toml_key(key))).collect();
        format!("{{ {} }}", items.join(", "))
    }

    /// The whole as a TOML text.
    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        self.write("", &mut text);
        text
    }

    fn write(&self, path: &str, text: &mut String) {
        for (key, value) in &self.lines {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{} = {value}", toml_key(key));
        }
        for (key, part) in &self.parts {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            match part {
                Part::Table(table) => {
                    let _ = writeln!(text, "\n[{path}]");
                    table.write(&path, text);
                }
                Part::List(tables) => {
                    for table in tables {
                        let _ = writeln!(text, "\n[[{path}]]");
                        table.write(&path, text);
                    }
                }
            }
        }
    }
}

/// A key, bare where TOML allows.
fn toml_key(key: &str) -> String {
    let bare = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'-';
    if !key.is_empty() && key.bytes().all(bare) { key.to_owned() } else { toml_string(key) }
}

/// A basic string in quotes.
pub(crate) fn toml_string(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stand_before_tables() {
        let mut inner = Canon::default();
        inner.line("x y", "1".to_owned());
        let inline = inner.inline();
        let mut outer = Canon::default();
        outer.table("t", inner);
        outer.line("a", toml_string("b\"\\\n"));
        outer.list("empty", Vec::new());
        outer.list("l", vec![Canon::default(), Canon::default()]);
        assert_eq!(inline, "{ \"x y\" = 1 }");
        assert_eq!(
            outer.text(),
            "a = \"b\\\"\\\\\\u000A\"\nempty = []\n\n[t]\n\"x y\" = 1\n\n[[l]]\n\n[[l]]\n"
        );
    }
}
