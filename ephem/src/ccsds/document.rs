//! A text in either notation.

use super::error::CcsdsError;
use super::kind::MessageKind;
use super::kvn::Kvn;
use super::segment::Segment;
use super::xml::Xml;

/// How a message is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Notation {
    /// Keyword = value.
    Kvn,
    /// XML.
    Xml,
}

/// A text whose notation is known.
#[derive(Debug)]
pub struct Document<'t>(Text<'t>);

#[derive(Debug)]
enum Text<'t> {
    Kvn(&'t str),
    Xml(roxmltree::Document<'t>),
}

impl<'t> Document<'t> {
    /// Tells the notation by the first character, and parses XML. A byte order mark is passed.
    ///
    /// # Errors
    /// [`CcsdsError::Xml`].
    pub fn parse(text: &'t str) -> Result<Self, CcsdsError> {
        let text = text.trim_start_matches('\u{feff}');
        if !text.trim_start().starts_with('<') {
            return Ok(Self(Text::Kvn(text)));
        }
        roxmltree::Document::parse(text)
            .map(|document| Self(Text::Xml(document)))
            .map_err(|error| CcsdsError::Xml(error.to_string()))
    }

    /// Its notation.
    #[must_use]
    pub const fn notation(&self) -> Notation {
        match self.0 {
            Text::Kvn(_) => Notation::Kvn,
            Text::Xml(_) => Notation::Xml,
        }
    }

    /// The segments of the message of that kind, in the order of the text.
    ///
    /// # Errors
    /// [`CcsdsError`]: another kind or version, or a header that is wrong.
    pub fn segments<'d>(&'d self, kind: &'static MessageKind) -> Result<Segments<'d>, CcsdsError> {
        let rest = match &self.0 {
            Text::Kvn(text) => Rest::Kvn(Kvn::new(text, kind)?),
            Text::Xml(document) => Rest::Xml(Xml::new(document, kind)?),
        };
        Ok(Segments { rest })
    }
}

/// The segments of a message, one after the other; they end with the first error.
#[derive(Debug, Clone)]
pub struct Segments<'d> {
    rest: Rest<'d>,
}

#[derive(Debug, Clone)]
enum Rest<'d> {
    Kvn(Kvn<'d>),
    Xml(Xml<'d>),
    Nothing,
}

impl<'d> Iterator for Segments<'d> {
    type Item = Result<Segment<'d>, CcsdsError>;

    fn next(&mut self) -> Option<Self::Item> {
        let segment = match &mut self.rest {
            Rest::Kvn(kvn) => kvn.segment(),
            Rest::Xml(xml) => xml.segment(),
            Rest::Nothing => return None,
        };
        if segment.is_err() {
            self.rest = Rest::Nothing;
        }
        segment.transpose()
    }
}
