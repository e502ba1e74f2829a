//! What a person reads on standard error: whole, but never longer than a person reads.
//!
//! Values of files and options stand in messages as they are; here control characters and those that
//! turn the direction of writing are escaped, long words and lines cut.
//!
//! Limits: line ends stay, since messages have several lines.

use std::borrow::Cow;

/// Most characters of a word.
const WORD: usize = 200;
/// Most characters of a line.
const LINE: usize = 2000;

/// A message for a terminal.
#[must_use]
pub fn for_terminal(message: &str) -> String {
    let lines: Vec<String> =
        message.lines().map(|line| cut(&words(line), LINE).into_owned()).collect();
    lines.join("\n")
}

fn words(line: &str) -> String {
    let mut told = String::new();
    for word in line.split(' ') {
        if !told.is_empty() {
            told.push(' ');
        }
        for c in cut(word, WORD).chars() {
            let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
            if c.is_control() || turns {
                told.extend(c.escape_default());
            } else {
                told.push(c);
            }
        }
    }
    told
}

/// The first characters of a text, and how many there are.
fn cut(text: &str, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        None => text.into(),
        Some((end, _)) => {
            let all = text.chars().count();
            format!("{}... ({all} characters)", text.get(..end).unwrap_or_default()).into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped_and_lengths_bounded() {
        assert_eq!(for_terminal("a \u{1b}[31mb\u{202e}c"), "a \\u{1b}[31mb\\u{202e}c");
        assert_eq!(for_terminal("one\ntwo  three"), "one\ntwo  three");
        let long = format!("key = {} is not legal", "x".repeat(1_000_000));
        let told = for_terminal(&long);
        assert!(told.contains("xxx... (1000000 characters) is not legal") && told.len() < 300);
        assert!(for_terminal(&"many words ".repeat(100_000)).len() < 2100);
    }
}
