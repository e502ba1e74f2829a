//! The paths of the files that a mission names.
//!
//! A path counts from the folder of the mission file; one in a base of another folder is rewritten
//! so that it does.

use crate::reading::canon::toml_string;
use crate::reading::document::{Node, Value};
use crate::reading::section::Section;
use std::path::{Path, PathBuf};

/// A file that a mission names; [`Mission::path`](crate::Mission::path) says where it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FilePath {
    text: String,
}

impl FilePath {
    /// The path as written, relative to the mission file.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Where it is, for a mission in this folder.
    #[must_use]
    pub fn within(&self, folder: &Path) -> PathBuf {
        folder.join(&self.text)
    }

    /// The path in a node, which may stand in a base of another folder.
    pub(crate) fn of(node: &Node) -> Option<Self> {
        let (Value::Text(text) | Value::Word(text)) = &node.value else { return None };
        if text.is_empty() || text == "none" || text.contains('\0') {
            return None;
        }
        let relative = !Path::new(text).is_absolute();
        let folder = if relative { node.place.source.folder.as_str() } else { "" };
        Some(Self { text: format!("{folder}{text}") })
    }

    /// A path that must be there.
    pub(crate) fn read(section: &mut Section<'_>, key: &'static str) -> Self {
        let need = "the path of a file";
        let node = section.find(key);
        let file = node.and_then(Self::of);
        match (node, &file) {
            (None, _) => section.missing(key, &need),
            (Some(node), None) => section.not_legal(key, node, &need),
            _ => {}
        }
        let file = file.unwrap_or(Self { text: String::new() });
        section.record(key, toml_string(&file.text));
        file
    }

    /// A path that may be absent or `"none"`.
    pub(crate) fn read_optional(section: &mut Section<'_>, key: &'static str) -> Option<Self> {
        let node = section.find_some(key);
        let file = node.and_then(Self::of);
        if let (Some(node), None) = (node, &file) {
            section.not_legal(key, node, &"the path of a file or \"none\"");
        }
        section.record(key, toml_string(file.as_ref().map_or("none", |file| &file.text)));
        file
    }
}
