//! One keyword of a FITS header and its value: 80 characters, as text and as numbers.
//!
//! Method: fixed format where the standard asks for it, free format on reading; a text longer than a
//! card goes on in `CONTINUE` cards [FITS4, section 4.2.1.2].
//!
//! Limits: printable ASCII; any other character is written as `?`. Complex numbers are not read.

/// Characters of a card.
pub(super) const CARD: usize = 80;
/// Characters between the quotes of a text that fills its card.
const QUOTED: usize = CARD - 12;

/// What a keyword says.
#[derive(Debug, Clone, PartialEq)]
pub enum CardValue {
    /// Text.
    Text(String),
    /// A whole number.
    Integer(i64),
    /// A number.
    Real(f64),
    /// Yes or no.
    Logical(bool),
}

/// A keyword, its value and a remark.
#[derive(Debug, Clone, PartialEq)]
pub struct Card {
    /// Up to eight of A to Z, 0 to 9, `-` and `_`.
    pub keyword: String,
    /// The value.
    pub value: CardValue,
    /// The remark, left out where it does not fit.
    pub comment: String,
}

impl Card {
    /// A text.
    #[must_use]
    pub fn text(keyword: &str, value: &str, comment: &str) -> Self {
        Self::new(keyword, CardValue::Text(value.to_owned()), comment)
    }

    /// A whole number.
    #[must_use]
    pub fn integer(keyword: &str, value: i64, comment: &str) -> Self {
        Self::new(keyword, CardValue::Integer(value), comment)
    }

    /// A number.
    #[must_use]
    pub fn real(keyword: &str, value: f64, comment: &str) -> Self {
        Self::new(keyword, CardValue::Real(value), comment)
    }

    /// Yes or no.
    #[must_use]
    pub fn logical(keyword: &str, value: bool, comment: &str) -> Self {
        Self::new(keyword, CardValue::Logical(value), comment)
    }

    fn new(keyword: &str, value: CardValue, comment: &str) -> Self {
        Self { keyword: keyword.to_owned(), value, comment: comment.to_owned() }
    }

    /// Whether a header may hold it: a legal keyword and, where it is a number, a finite one.
    #[must_use]
    pub fn is_legal(&self) -> bool {
        let legal = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || "-_".contains(c);
        let finite = !matches!(self.value, CardValue::Real(value) if !value.is_finite());
        (1..=8).contains(&self.keyword.len()) && self.keyword.chars().all(legal) && finite
    }

    /// Appends the card, and those that continue it, to a header.
    pub(super) fn put(&self, header: &mut Vec<u8>) {
        let value = match &self.value {
            CardValue::Text(text) => {
                let mut pieces = pieces(text);
                let last = pieces.pop().unwrap_or_default();
                for (number, piece) in pieces.iter().enumerate() {
                    put_line(header, &format!("{}'{piece}&'", self.start(number)));
                }
                if !pieces.is_empty() {
                    return put_line(header, &format!("CONTINUE  '{last}'"));
                }
                format!("{:<20}", format!("'{last:<8}'"))
            }
            CardValue::Integer(value) => format!("{value:>20}"),
            CardValue::Real(value) => format!("{:>20}", real(*value)),
            CardValue::Logical(value) => format!("{:>20}", if *value { "T" } else { "F" }),
        };
        let bare = format!("{}{value}", self.start(0));
        let full = format!("{bare} / {}", printable(&self.comment));
        let fits = !self.comment.is_empty() && full.len() <= CARD;
        put_line(header, if fits { &full } else { bare.trim_end() });
    }

    fn start(&self, line: usize) -> String {
        if line == 0 { format!("{:<8}= ", self.keyword) } else { "CONTINUE  ".to_owned() }
    }
}

/// The shortest text that reads back as the same number, with a decimal point.
fn real(value: f64) -> String {
    let text = format!("{value:E}");
    let (mantissa, exponent) = text.split_once('E').unwrap_or((&text, "0"));
    let point = if mantissa.contains('.') { "" } else { ".0" };
    if exponent == "0" {
        format!("{mantissa}{point}")
    } else {
        format!("{mantissa}{point}E{exponent}")
    }
}

fn printable(text: &str) -> String {
    text.chars().map(|c| if matches!(c, ' '..='~') { c } else { '?' }).collect()
}

/// A text with its quotes doubled, in pieces that leave room for the sign of a continuation.
fn pieces(text: &str) -> Vec<String> {
    let escaped = printable(text).replace('\'', "''");
    if escaped.len() <= QUOTED {
        return vec![escaped];
    }
    let mut pieces = vec![String::new()];
    for c in printable(text).chars() {
        let unit = if c == '\'' { "''".to_owned() } else { c.to_string() };
        match pieces.last_mut() {
            Some(last) if last.len() + unit.len() < QUOTED => last.push_str(&unit),
            _ => pieces.push(unit),
        }
    }
    pieces
}

fn put_line(header: &mut Vec<u8>, line: &str) {
    header.extend(line.bytes().chain(std::iter::repeat(b' ')).take(CARD));
}

/// Keywords and values of a header as read.
#[derive(Debug, Default)]
pub(super) struct Keywords(Vec<(String, CardValue)>);

impl Keywords {
    /// Takes a card; false at `END`.
    pub(super) fn take(&mut self, card: &[u8]) -> bool {
        let text: String = card.iter().map(|&byte| char::from(byte)).collect();
        let (keyword, rest) = text.split_at_checked(8).unwrap_or((&text, ""));
        match (keyword.trim_end(), rest.strip_prefix("= ")) {
            ("END", _) => return false,
            ("CONTINUE", _) => self.go_on(rest.trim_start()),
            (keyword, Some(value)) => {
                if let Some(value) = parse(value.trim_start()) {
                    self.0.push((keyword.to_owned(), value));
                }
            }
            _ => {}
        }
        true
    }

    fn go_on(&mut self, rest: &str) {
        if let (Some(CardValue::Text(more)), Some((_, CardValue::Text(text)))) =
            (parse(rest), self.0.last_mut())
            && text.ends_with('&')
        {
            text.pop();
            text.push_str(&more);
        }
    }

    fn get(&self, keyword: &str) -> Option<&CardValue> {
        self.0.iter().find(|(name, _)| name == keyword).map(|(_, value)| value)
    }

    pub(super) fn text(&self, keyword: &str) -> Option<&str> {
        match self.get(keyword) {
            Some(CardValue::Text(text)) => Some(text),
            _ => None,
        }
    }

    pub(super) fn integer(&self, keyword: &str) -> Option<i64> {
        match self.get(keyword) {
            Some(&CardValue::Integer(value)) => Some(value),
            _ => None,
        }
    }

    pub(super) fn real(&self, keyword: &str) -> Option<f64> {
        match self.get(keyword) {
            Some(&CardValue::Real(value)) => Some(value),
            #[expect(clippy::cast_precision_loss, reason = "a scale or offset given as an integer")]
            Some(&CardValue::Integer(value)) => Some(value as f64),
            _ => None,
        }
    }

    /// A keyword's value as a person would write it; `nothing` where there is none.
    pub(super) fn shown(&self, keyword: &str) -> String {
        match self.get(keyword) {
            None => "nothing".to_owned(),
            Some(CardValue::Text(text)) => format!("'{text}'"),
            Some(CardValue::Integer(value)) => value.to_string(),
            Some(CardValue::Real(value)) => value.to_string(),
            Some(CardValue::Logical(value)) => if *value { "T" } else { "F" }.to_owned(),
        }
    }
}

/// The value at the start of `text`, a remark after it left aside.
fn parse(text: &str) -> Option<CardValue> {
    if let Some(quoted) = text.strip_prefix('\'') {
        let mut value = String::new();
        let mut rest = quoted.chars().peekable();
        while let Some(c) = rest.next() {
            if c == '\'' && rest.next_if_eq(&'\'').is_none() {
                break;
            }
            value.push(c);
        }
        value.truncate(value.trim_end().len());
        return Some(CardValue::Text(value));
    }
    let token = text.split('/').next()?.trim();
    match token {
        "T" => Some(CardValue::Logical(true)),
        "F" => Some(CardValue::Logical(false)),
        _ => token
            .parse()
            .map(CardValue::Integer)
            .ok()
            .or_else(|| token.replace(['D', 'd'], "E").parse().ok().map(CardValue::Real)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cards(card: &Card) -> (Vec<u8>, Keywords) {
        let mut bytes = Vec::new();
        card.put(&mut bytes);
        let mut read = Keywords::default();
        for line in bytes.chunks(CARD) {
            assert!(read.take(line));
        }
        (bytes, read)
    }

    #[test]
    fn numbers_stand_in_columns_11_to_30() {
        let (bytes, _) = cards(&Card::integer("NAXIS1", 8, "bytes"));
        assert_eq!(
            std::str::from_utf8(&bytes).unwrap().trim_end(),
            "NAXIS1  =                    8 / bytes"
        );
        assert_eq!(real(19.0), "1.9E1");
        assert_eq!(real(-1.6375e30), "-1.6375E30");
        assert_eq!(real(1.0), "1.0");
    }

    #[test]
    fn illegal_keywords_and_numbers_are_told() {
        assert!(Card::integer("A-1_B", 1, "").is_legal());
        for keyword in ["", "lower", "TOOLONGKEY", "A B"] {
            assert!(!Card::integer(keyword, 1, "").is_legal(), "{keyword}");
        }
        assert!(!Card::real("X", f64::NAN, "").is_legal());
    }

    proptest! {
        #[test]
        fn a_text_of_any_length_comes_back(text in "[ -~]{0,300}") {
            let (bytes, read) = cards(&Card::text("MISSION", &text, "a remark"));
            prop_assert_eq!(bytes.len() % CARD, 0);
            prop_assert_eq!(read.text("MISSION"), Some(text.trim_end()));
        }

        #[test]
        fn a_number_comes_back(value in -1e300..1e300f64) {
            let (_, read) = cards(&Card::real("RATE", value, ""));
            prop_assert_eq!(read.real("RATE").map(f64::to_bits), Some(value.to_bits()));
        }

        #[test]
        fn any_bytes_are_taken(bytes in prop::collection::vec(any::<u8>(), 0..100)) {
            let _ = Keywords::default().take(&bytes);
        }
    }
}
