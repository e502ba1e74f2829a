//! A CCSDS Attitude Ephemeris Message, in KVN or XML.

use super::error::HistoryError;
use super::meta::Meta;
use super::row::Row;
use ephem::ccsds::{Axes, Document, MessageKind, Notation};

/// What a message holds.
pub(super) struct Aem {
    /// Its notation, in words.
    pub(super) form: &'static str,
    /// The inertial axes of all its segments.
    pub(super) axes: Option<Axes>,
    pub(super) rows: Vec<Row>,
}

pub(super) fn read(text: &str) -> Result<Aem, HistoryError> {
    let document = Document::parse(text)?;
    let form = match document.notation() {
        Notation::Kvn => "AEM in KVN",
        Notation::Xml => "AEM in XML",
    };
    let mut aem = Aem { form, axes: None, rows: Vec::new() };
    for segment in document.segments(&MessageKind::AEM)? {
        let segment = segment?;
        let meta = Meta::read(&segment.meta)?;
        if *aem.axes.get_or_insert(meta.axes) != meta.axes {
            return Err(HistoryError::Frames { line: segment.line });
        }
        // Only rows of the same segment must rise.
        let mut before: Option<Row> = None;
        aem.rows.reserve(segment.records.len());
        for record in &segment.records {
            let row = meta.row(record, before.as_ref())?;
            before = Some(row);
            aem.rows.push(row);
        }
    }
    Ok(aem)
}
