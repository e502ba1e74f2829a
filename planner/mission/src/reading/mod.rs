//! How the text of a mission becomes typed values: a table of nodes with their places, one reader of
//! sections that checks every key, what it found, and the canonical text.

pub(crate) mod range;
pub(crate) mod document;
pub(crate) mod canon;
pub(crate) mod findings;
pub(crate) mod section;
