//! Where does a mission's text come from: presets, files, bases, overrides.
//!
//! Method: a file over its base, that over its own, tables merged key by key; then the overrides in
//! their order. Paths in a base are rewritten relative to the mission file.
//!
//! Limits: a base is a preset or a file; it cannot be overridden.

use crate::fault::{Fault, MissionError, Problem};
use crate::presets;
use crate::reading::document::{self, Place, Source, Table, Value};
use crate::reading::section::Section;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A key set on the command line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Override {
    option: String,
    key: String,
    value: String,
    toml: bool,
}

impl Override {
    /// The `key=value` of a `--set`: the value as in a mission file, strings with or without quotes.
    ///
    /// # Errors
    /// [`MissionError`] where there is no key or no equals sign.
    pub fn set(text: &str) -> Result<Self, MissionError> {
        match text.split_once('=') {
            Some((key, value)) if !key.trim().is_empty() => Ok(Self {
                option: "--set".to_owned(),
                key: key.trim().to_owned(),
                value: value.to_owned(),
                toml: true,
            }),
            _ => {
                let problem = Problem::NotAnOverride { text: text.to_owned() };
                Err(Fault { origin: "--set".to_owned(), line: None, problem }.into())
            }
        }
    }

    /// The value that another option gives to a key, taken literally.
    #[must_use]
    pub fn option(option: &str, key: &str, value: &str) -> Self {
        let (option, key, value) = (option.to_owned(), key.to_owned(), value.to_owned());
        Self { option, key, value, toml: false }
    }

    fn apply(&self, table: &mut Table) -> Result<(), MissionError> {
        let source = Arc::new(Source {
            name: self.option.clone(),
            folder: String::new(),
            rank: usize::MAX,
            typed: true,
        });
        let node = if self.toml {
            document::parse_typed(&self.value, &source)
        } else {
            document::Node {
                value: Value::Word(self.value.clone()),
                place: Place { source, line: None },
            }
        };
        if self.key == "base" {
            return Err(node.place.error(Problem::NotLegal {
                key: "base".to_owned(),
                value: node.value.to_string(),
                need: "--mission, to start from another mission,".to_owned(),
            }));
        }
        document::set(table, &self.key, node)
    }
}

/// Bases within bases that are read; more is a loop.
const MAX_BASES: usize = 16;

/// A preset or a file with overrides: its keys, its place, and the folder that paths count from.
pub(crate) fn load(
    mission: &str,
    overrides: &[Override],
) -> Result<(Table, Place, PathBuf), MissionError> {
    if let Some(preset) = presets::find(mission) {
        let directory = PathBuf::new();
        let (table, place) = read_text(preset, &preset_name(mission), &directory, overrides)?;
        return Ok((table, place, directory));
    }
    let path = Path::new(mission);
    let asked = Place { source: source("--mission", "", MAX_BASES), line: None };
    let text = read_file(path, mission, &asked)?;
    let directory = path.parent().map(Path::to_owned).unwrap_or_default();
    let (table, place) = read_text(&text, mission, &directory, overrides)?;
    Ok((table, place, directory))
}

/// A mission's text with its bases below and overrides on top.
pub(crate) fn read_text(
    text: &str,
    name: &str,
    directory: &Path,
    overrides: &[Override],
) -> Result<(Table, Place), MissionError> {
    let source = source(name, "", MAX_BASES);
    let mut table = with_base(text, &source, directory)?;
    for change in overrides {
        change.apply(&mut table)?;
    }
    Ok((table, Place { source, line: None }))
}

fn source(name: &str, folder: &str, rank: usize) -> Arc<Source> {
    Arc::new(Source { name: name.to_owned(), folder: folder.to_owned(), rank, typed: false })
}

fn preset_name(name: &str) -> String {
    format!("preset {name}")
}

fn read_file(path: &Path, name: &str, asked: &Place) -> Result<String, MissionError> {
    let bytes = std::fs::read(path).map_err(|error| {
        if error.kind() == std::io::ErrorKind::NotFound {
            asked.error(Problem::NoSuchMission {
                name: name.to_owned(),
                presets: presets::NAMES.join(", "),
            })
        } else {
            let reason = error.to_string();
            unreadable(name, reason)
        }
    })?;
    String::from_utf8(bytes).map_err(|_| unreadable(name, "it is not UTF-8 text".to_owned()))
}

fn unreadable(name: &str, reason: String) -> MissionError {
    let problem = Problem::Unreadable { reason };
    Fault { origin: name.to_owned(), line: None, problem }.into()
}

/// A text over its base; the key `base` is gone.
fn with_base(text: &str, source: &Arc<Source>, directory: &Path) -> Result<Table, MissionError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut table = document::parse(text, source)?;
    let Some(node) = table.remove("base") else { return Ok(table) };
    let Some(base) = Section::text_of(&node) else {
        return Err(node.place.error(Problem::NotLegal {
            key: "base".to_owned(),
            value: node.value.to_string(),
            need: "a preset's name or the path of a mission file".to_owned(),
        }));
    };
    let circular = || node.place.error(Problem::CircularBase { base: base.to_owned() });
    let rank = source.rank.checked_sub(1).ok_or_else(circular)?;
    let below = if let Some(preset) = presets::find(base) {
        with_base(preset, &self::source(&preset_name(base), "", rank), directory)?
    } else {
        let relative = if Path::new(base).is_absolute() {
            base.to_owned()
        } else {
            format!("{}{base}", source.folder)
        };
        let text = read_file(&directory.join(&relative), base, &node.place)?;
        let folder = relative.rfind('/').map_or("", |slash| &relative[..=slash]);
        with_base(&text, &self::source(&relative, folder, rank), directory)?
    };
    Ok(document::merge(below, table))
}
