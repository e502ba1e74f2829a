//! XML, alone or inside an `ndm`.

use super::block::{Block, Entry};
use super::error::{CcsdsError, Expected, Holder, Legal};
use super::kind::MessageKind;
use super::record::Record;
use super::segment::Segment;
use roxmltree::{Document, Node};
use std::vec::IntoIter;

const SEGMENT: &str = "segment";
const METADATA: &str = "metadata";

/// A message of which the header is passed.
#[derive(Debug, Clone)]
pub(super) struct Xml<'d> {
    kind: &'static MessageKind,
    /// Offsets of the line ends.
    line_ends: Vec<usize>,
    segments: IntoIter<Node<'d, 'd>>,
}

impl<'d> Xml<'d> {
    /// Finds the message and its version.
    pub(super) fn new(
        document: &'d Document<'d>,
        kind: &'static MessageKind,
    ) -> Result<Self, CcsdsError> {
        let message = document.root().descendants().find(named(kind.element)).ok_or_else(|| {
            let text = document.root_element().tag_name().name().to_owned();
            CcsdsError::Line { line: 1, text, expected: Expected::Element(kind.element) }
        })?;
        let line_ends = document.input_text().match_indices('\n').map(|(at, _)| at).collect();
        let segments: Vec<Node<'d, 'd>> = message.descendants().filter(named(SEGMENT)).collect();
        let xml = Self { kind, line_ends, segments: segments.into_iter() };
        let value = message.attribute("version").unwrap_or("");
        if !kind.versions.contains(&value) {
            let version = Entry { line: xml.line(message), key: "version", value };
            return Err(version.illegal(Legal::OneOf(kind.versions.to_vec())));
        }
        Ok(xml)
    }

    fn line(&self, node: Node<'_, '_>) -> usize {
        let start = node.range().start;
        1 + self.line_ends.partition_point(|end| *end < start)
    }

    /// The next segment; `None` at the end.
    pub(super) fn segment(&mut self) -> Result<Option<Segment<'d>>, CcsdsError> {
        let Some(segment) = self.segments.next() else { return Ok(None) };
        let line = self.line(segment);
        let missing = |key| CcsdsError::Missing { line, holder: Holder::Element(SEGMENT), key };
        let metadata = segment.children().find(named(METADATA)).ok_or_else(|| missing(METADATA))?;
        let mut meta = Block::new(self.kind, self.line(metadata), Holder::Element(METADATA));
        for node in metadata.children().filter(Node::is_element) {
            let value = node.text().unwrap_or("").trim();
            meta.push(Entry { line: self.line(node), key: node.tag_name().name(), value })?;
        }
        let data = segment.children().find(named("data")).ok_or_else(|| missing("data"))?;
        let name = self.kind.record;
        let records = data
            .children()
            .filter(named(name))
            .map(|node| Record::from_element(self.line(node), name, node))
            .collect();
        Ok(Some(Segment { line, meta, records }))
    }
}

fn named(name: &'static str) -> impl Fn(&Node<'_, '_>) -> bool {
    move |node| node.tag_name().name() == name
}
