//! An AEM in XML \[CCSDS505\], alone or inside an `ndm`.
//!
//! Method: a tree read by `roxmltree`, which refuses document types and so entities; elements are
//! told by their local names.

use super::meta::{Entry, Meta, VERSIONS};
use super::{History, HistoryError, Row};
use roxmltree::{Document, Node};

pub(super) fn read(text: &str) -> Result<History, HistoryError> {
    let document = Document::parse(text).map_err(|error| HistoryError::Xml(error.to_string()))?;
    let line = |node: Node<'_, '_>| {
        usize::try_from(document.text_pos_at(node.range().start).row).unwrap_or(usize::MAX)
    };
    let named = |name: &'static str| move |node: &Node<'_, '_>| node.tag_name().name() == name;
    let root = document.root();
    let aem = root.descendants().find(named("aem")).ok_or_else(|| {
        let found = document.root_element().tag_name().name().to_owned();
        HistoryError::Line { line: 1, text: found, expected: "an aem".to_owned() }
    })?;
    let version = aem.attribute("version").unwrap_or("");
    if !VERSIONS.contains(&version) {
        return Err(HistoryError::Value {
            line: line(aem),
            key: "version".to_owned(),
            value: version.to_owned(),
            legal: VERSIONS.join(", "),
        });
    }
    let mut history = History { form: "AEM in XML", reference: None, rows: Vec::new() };
    for segment in aem.descendants().filter(named("segment")) {
        let missing = |key| HistoryError::Missing { line: line(segment), key };
        let metadata =
            segment.children().find(named("metadata")).ok_or_else(|| missing("metadata"))?;
        let entries: Vec<Entry> = metadata
            .children()
            .filter(Node::is_element)
            .map(|it| (line(it), it.tag_name().name().to_owned(), content(it)))
            .collect();
        let meta = Meta::new(&entries, line(metadata))?.scalar_last();
        if *history.reference.get_or_insert(meta.reference) != meta.reference {
            return Err(HistoryError::Frames { line: line(segment) });
        }
        let data = segment.children().find(named("data")).ok_or_else(|| missing("data"))?;
        let mut rows: Vec<Row> = Vec::new();
        for state in data.children().filter(named("attitudeState")) {
            let find = |key: &'static str| {
                let found = state.descendants().find(named(key));
                found.map(content).ok_or(HistoryError::Missing { line: line(state), key })
            };
            let epoch = find("EPOCH")?;
            let numbers = [find("Q1")?, find("Q2")?, find("Q3")?, find("QC")?];
            let fields = numbers.each_ref().map(String::as_str);
            rows.push(meta.row(line(state), &epoch, fields, &rows)?);
        }
        history.rows.extend(rows);
    }
    Ok(history)
}

fn content(node: Node<'_, '_>) -> String {
    node.text().unwrap_or("").trim().to_owned()
}
