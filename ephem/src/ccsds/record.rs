//! A record of the data: a line of KVN, or an element of XML.

use super::error::{CcsdsError, Expected, Holder, Legal};
use roxmltree::Node;

/// One of a record's fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Its keyword, the name of its element in XML.
    pub key: &'static str,
    /// The unit that XML may name; `None` where there is none.
    pub unit: Option<&'static str>,
}

impl Column {
    /// A field without a unit.
    #[must_use]
    pub const fn of(key: &'static str) -> Self {
        Self { key, unit: None }
    }

    /// A field in a unit.
    #[must_use]
    pub const fn in_unit(key: &'static str, unit: &'static str) -> Self {
        Self { key, unit: Some(unit) }
    }
}

/// A record: an epoch and numbers.
#[derive(Debug, Clone, Copy)]
pub struct Record<'d> {
    /// Line number.
    pub line: usize,
    content: Content<'d>,
}

#[derive(Debug, Clone, Copy)]
enum Content<'d> {
    Line(&'d str),
    Element { name: &'static str, node: Node<'d, 'd> },
}

impl<'d> Record<'d> {
    pub(super) const fn from_line(line: usize, text: &'d str) -> Self {
        Self { line, content: Content::Line(text) }
    }

    pub(super) const fn from_element(line: usize, name: &'static str, node: Node<'d, 'd>) -> Self {
        Self { line, content: Content::Element { name, node } }
    }

    /// Its fields, the `columns` first and in their order.
    ///
    /// In KVN as many of the numbers in `more` as stand there follow; `None` if no count fits. XML
    /// gives the columns alone, by their names.
    ///
    /// # Errors
    /// [`CcsdsError`]: XML lacks a column, or gives it in another unit.
    pub fn fields(
        &self,
        columns: &[Column],
        more: &[usize],
    ) -> Result<Option<Vec<&'d str>>, CcsdsError> {
        match self.content {
            Content::Line(text) => {
                let fields: Vec<&str> = text.split_whitespace().collect();
                let fits = more.iter().any(|more| fields.len() == columns.len() + more);
                Ok(fits.then_some(fields))
            }
            Content::Element { name, node } => columns
                .iter()
                .map(|it| self.child(name, node, it))
                .collect::<Result<_, _>>()
                .map(Some),
        }
    }

    fn child(
        &self,
        name: &'static str,
        node: Node<'d, 'd>,
        column: &Column,
    ) -> Result<&'d str, CcsdsError> {
        let key = column.key;
        let holder = Holder::Element(name);
        let found = node
            .descendants()
            .find(|it| it.tag_name().name() == key)
            .ok_or(CcsdsError::Missing { line: self.line, holder, key })?;
        if let (Some(unit), Some(named)) = (column.unit, found.attribute("units"))
            && !named.eq_ignore_ascii_case(unit)
        {
            return Err(CcsdsError::Value {
                line: self.line,
                key: format!("the unit of {key}"),
                value: named.to_owned(),
                legal: Legal::OneOf(vec![unit]),
            });
        }
        Ok(found.text().unwrap_or("").trim())
    }

    /// Its refusal.
    #[must_use]
    pub fn refused(&self, expected: Expected) -> CcsdsError {
        let text = match self.content {
            Content::Line(text) => text.to_owned(),
            Content::Element { node, .. } => {
                let texts = node.descendants().filter(Node::is_text).filter_map(|it| it.text());
                texts.flat_map(str::split_whitespace).collect::<Vec<_>>().join(" ")
            }
        };
        CcsdsError::Line { line: self.line, text, expected }
    }
}
