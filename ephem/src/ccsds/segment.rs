//! A segment of a message.

use super::block::Block;
use super::record::Record;

/// Metadata and the data that it describes.
#[derive(Debug, Clone)]
pub struct Segment<'d> {
    /// Line on which it begins.
    pub line: usize,
    /// Its metadata.
    pub meta: Block<'d>,
    /// Its data, in the order of the text.
    pub records: Vec<Record<'d>>,
}
