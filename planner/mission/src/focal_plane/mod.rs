//! Which detectors does a telescope get from its `detectors` key: a grid, or an instrument model.
//!
//! Frames: as in [`crate::telescope`]; the quaternions of a model take detector components
//! to the telescope's.
//!
//! Method: the entries of a model are narrowed by release, channel, telescope and names, in this
//! order; each must be met by what the ones before have left. The SHA-256 of the file's bytes goes
//! into the resolved mission, and a mission that gives it holds the file to it.
//!
//! Limits: all faults of the keys are told, but of a model's entries the first [`SHOWN`].

use crate::detector::{Kinds, NamedDetector};
use crate::digest::sha256_hex;
use crate::fault::{Fault, Problem, Warning};
use crate::file_path::FilePath;
use crate::names::nearest_first;
use crate::number::Number;
use crate::reading::canon::toml_string;
use crate::reading::document::{Node, Value};
use crate::reading::range::Range;
use crate::reading::section::Section;
use crate::rounding;
use grid::{MAX_DETECTORS, lay_out};
use imo::{Entry, Model};
use onboard_core::field_of_view::FieldOfView;
use onboard_core::frame::{self, Boresight};
use onboard_core::rotation::Rotation;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

mod imo;
mod grid;

const SPACING: Range = Range::positive("an angle", 180.0, "deg");
/// Faulty entries of a model that are told one by one.
const SHOWN: usize = 8;
/// The keys that belong to a file.
const WITH_FILE: [&str; 5] = ["release", "channel", "telescope", "names", "sha256"];

/// Where a telescope's detectors are seen from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mount<'m> {
    /// Folder that paths count from.
    pub(crate) directory: &'m Path,
    /// Telescope frame into mission boresight frame.
    pub(crate) rotation: Rotation<frame::Telescope, Boresight>,
    /// The field that a grid covers.
    pub(crate) field_of_view: Option<&'m FieldOfView>,
    /// What its detectors measure with.
    pub(crate) kinds: Kinds<'m>,
}

/// What a `detectors` key gives.
#[derive(Debug, Default)]
pub(crate) struct FocalPlane {
    pub(crate) detectors: Vec<NamedDetector>,
    pub(crate) grid_deg: Option<Number>,
    pub(crate) warning: Option<Warning>,
}

impl FocalPlane {
    /// Reads `detectors` of a telescope's table; none where the key is absent.
    pub(crate) fn read(section: &mut Section<'_>, mount: &Mount<'_>) -> Option<Self> {
        let field = section.node_of("field_of_view");
        let unbounded = field.is_none_or(|node| Section::text_of(node) == Some("none"));
        let (key, field_key) = (section.key("detectors"), section.key("field_of_view"));
        section.inline("detectors", |section| {
            if section.has("file") {
                if section.has("grid_deg") {
                    exclusive(section, "file", "grid_deg");
                }
                section.knows(&["grid_deg"]);
                return of_file(section, mount, key);
            }
            if section.has("grid_deg") {
                for other in WITH_FILE.into_iter().filter(|other| section.has(other)) {
                    exclusive(section, "grid_deg", other);
                }
                let place = section.place_of("grid_deg");
                let spacing = section.number("grid_deg", &SPACING, None);
                section.knows(&["file"]);
                section.knows(&WITH_FILE);
                if unbounded {
                    let need = "the circle or rectangle that detectors.grid_deg is to cover";
                    let problem = Problem::Missing { key: field_key, need: need.to_owned() };
                    section.fault(&place, problem);
                }
                return of_grid(section, mount, spacing);
            }
            section.knows(&["grid_deg"]);
            section.knows(&WITH_FILE);
            section.find("file");
            section.missing("file", &"a file, or grid_deg,");
            Self::default()
        })
    }
}

fn exclusive(section: &Section<'_>, first: &str, second: &str) {
    let problem = Problem::Exclusive { first: section.key(first), second: section.key(second) };
    section.fault(&section.place_of(second), problem);
}

/// A grid over the field of view, its detectors called g000 and on.
fn of_grid(section: &Section<'_>, mount: &Mount<'_>, spacing: Number) -> FocalPlane {
    let spacing_rad = rounding::radians(spacing.exact());
    let Some(field) = mount.field_of_view.filter(|_| spacing_rad > 0.0) else {
        return FocalPlane::default();
    };
    let laid_out = lay_out(field.shape(), spacing_rad).unwrap_or_else(|count| {
        let problem = Problem::OutOfRange {
            key: section.key("grid_deg"),
            value: spacing.text().to_owned(),
            need: format!("a spacing of at most {MAX_DETECTORS} detectors, not about {}", count.0),
            hint: "",
        };
        section.fault(&section.place_of("grid_deg"), problem);
        Vec::new()
    });
    let digits = laid_out.len().saturating_sub(1).to_string().len().max(3);
    let named =
        |(index, detector): (usize, &Rotation<frame::Detector, frame::Telescope>)| NamedDetector {
            name: format!("g{index:0digits$}"),
            rotation: detector.then(mount.rotation),
            polarisation_angle_deg: Number::zero(),
            polarisation_angle_rad: 0.0,
            channel: None,
            receiver: mount.kinds.telescope.clone(),
        };
    let detectors = laid_out.iter().enumerate().map(named).collect();
    FocalPlane { detectors, grid_deg: Some(spacing), warning: None }
}

/// The detectors of an instrument model.
fn of_file(section: &mut Section<'_>, mount: &Mount<'_>, key: String) -> FocalPlane {
    let file = FilePath::read(section, "file");
    let wanted = Wanted::read(section);
    let pin = section.find_some("sha256");
    let bytes = if file.text().is_empty() { None } else { read_bytes(section, mount, &file) };
    let digest = bytes.as_ref().map(sha256_hex);
    section.record("sha256", digest.as_deref().map_or_else(|| toml_string("none"), toml_string));
    if let (Some(pin), Some(digest)) = (pin, &digest)
        && Section::text_of(pin) != Some(digest)
    {
        let need = format!("{digest}, the SHA-256 of {} as it is now,", file.text());
        section.not_legal("sha256", pin, &need);
    }
    let Some(bytes) = bytes else { return FocalPlane::default() };
    let tell =
        |problem| section.report(Fault { origin: file.text().to_owned(), line: None, problem });
    let model = match Model::parse(&bytes) {
        Ok(model) => model,
        Err(problem) => {
            tell(problem);
            return FocalPlane::default();
        }
    };
    let entries = wanted.narrow(section, &model, file.text());
    let mut detectors = Vec::new();
    let mut faults = Vec::new();
    let mut names = BTreeSet::new();
    for entry in &entries {
        match entry.mounted() {
            Ok(found) if !names.insert(found.name.clone()) => {
                faults.push(Problem::Duplicate { key: entry.key("name"), value: found.name });
            }
            Ok(found) => {
                let angle_rad = found.polarisation_angle_rad;
                let angle_deg = Number::parse(&angle_rad.to_degrees().to_string());
                detectors.push(NamedDetector {
                    name: found.name,
                    rotation: found.rotation.then(mount.rotation),
                    polarisation_angle_deg: angle_deg.unwrap_or_else(|_| Number::zero()),
                    polarisation_angle_rad: angle_rad,
                    channel: entry.channel().map(str::to_owned),
                    receiver: found.receiver.or(mount.kinds.of(entry.channel())),
                });
            }
            Err(problem) => faults.push(problem),
        }
    }
    let more = faults.len().saturating_sub(SHOWN);
    faults.truncate(SHOWN);
    if more > 0 {
        faults.push(Problem::More { count: more });
    }
    let warning = if faults.is_empty() { unsaid(key, &entries, &detectors) } else { None };
    faults.into_iter().for_each(tell);
    FocalPlane { detectors, grid_deg: None, warning }
}

fn read_bytes(section: &Section<'_>, mount: &Mount<'_>, file: &FilePath) -> Option<Vec<u8>> {
    match std::fs::read(mount.directory.join(file.text())) {
        Ok(bytes) => Some(bytes),
        Err(error) => {
            let problem = Problem::UnreadableFile {
                key: section.key("file"),
                value: toml_string(file.text()),
                reason: error.to_string(),
            };
            section.fault(&section.place_of("file"), problem);
            None
        }
    }
}

/// Pairs of entries that differ in `pol` alone.
fn unsaid(key: String, entries: &[&Entry], detectors: &[NamedDetector]) -> Option<Warning> {
    let mut pairs = Vec::new();
    let mut seen: BTreeMap<[u64; 4], (&str, &str)> = BTreeMap::new();
    for (entry, detector) in entries.iter().zip(detectors) {
        let Some(side) = entry.side_without_angle() else { continue };
        let turned = detector.rotation.to_xyzw().map(f64::to_bits);
        let (other, name) = *seen.entry(turned).or_insert((side, &detector.name));
        if other != side {
            pairs.push(format!("{name} and {}", detector.name));
        }
    }
    let first = pairs.first()?.clone();
    Some(Warning::PolarisationUnsaid { key, count: pairs.len(), first })
}

/// Which entries of a model are wanted.
struct Wanted<'a> {
    release: Option<&'a Node>,
    channel: Option<&'a Node>,
    telescope: Option<&'a Node>,
    names: Option<Vec<&'a Node>>,
}

impl<'a> Wanted<'a> {
    fn read(section: &mut Section<'a>) -> Self {
        Self {
            release: text(section, "release"),
            channel: text(section, "channel"),
            telescope: text(section, "telescope"),
            names: names(section),
        }
    }

    /// What is wanted of a model; what is not in it is a fault, and then nothing is.
    fn narrow<'m>(&self, section: &Section<'_>, model: &'m Model, file: &str) -> Vec<&'m Entry> {
        let mut left: Vec<&Entry> = model.entries.iter().collect();
        let mut of = format!("of {file}");
        if let Some(node) = self.release {
            let tag = Section::text_of(node).unwrap_or_default();
            let files = model.releases.get(tag);
            left.retain(|entry| match (files, entry.uuid()) {
                (Some(files), Some(uuid)) => files.contains(uuid),
                _ => false,
            });
            if left.is_empty() {
                let known: Vec<&str> = model.releases.keys().map(String::as_str).collect();
                let what = format!("a release {of} with detectors");
                not_there(section, ("release", node), &what, &known);
                return left;
            }
            of = format!("of {file} in release {tag}");
        }
        for (key, node, property) in [
            ("channel", self.channel, Entry::channel as fn(&Entry) -> Option<&str>),
            ("telescope", self.telescope, Entry::telescope),
        ] {
            if let Some(node) = node {
                left = only(section, (key, node), left, (&of, property));
                if left.is_empty() {
                    return left;
                }
                let text = Section::text_of(node).unwrap_or_default();
                of = format!("{of} in {key} {text}");
            }
        }
        if let Some(nodes) = &self.names {
            let known: BTreeSet<&str> = left.iter().filter_map(|entry| entry.name()).collect();
            let wanted: BTreeSet<&str> =
                nodes.iter().filter_map(|it| Section::text_of(it)).collect();
            for node in nodes {
                if !Section::text_of(node).is_some_and(|name| known.contains(name)) {
                    let known: Vec<&str> = known.iter().copied().collect();
                    not_there(section, ("names", node), &format!("a detector {of}"), &known);
                }
            }
            left.retain(|entry| entry.name().is_some_and(|name| wanted.contains(name)));
        }
        left
    }
}

/// The entries whose property is the node's text; where there are none, what there would be.
fn only<'m>(
    section: &Section<'_>,
    (key, node): (&str, &Node),
    entries: Vec<&'m Entry>,
    (of, property): (&str, fn(&Entry) -> Option<&str>),
) -> Vec<&'m Entry> {
    let wanted = Section::text_of(node);
    let (found, others): (Vec<_>, Vec<_>) =
        entries.into_iter().partition(|entry| property(entry) == wanted);
    if found.is_empty() {
        let known: BTreeSet<&str> = others.iter().filter_map(|entry| property(entry)).collect();
        let known: Vec<&str> = known.into_iter().collect();
        not_there(section, (key, node), &format!("a {key} {of}"), &known);
    }
    found
}

/// Says what there is instead, the nearest first.
fn not_there(section: &Section<'_>, (key, node): (&str, &Node), what: &str, known: &[&str]) {
    let need = if known.is_empty() {
        format!("{what}, which has none,")
    } else {
        let nearest = nearest_first(Section::text_of(node).unwrap_or_default(), known);
        format!("{what} ({nearest})")
    };
    section.not_legal(key, node, &need);
}

/// A word that may be absent or `"none"`.
fn text<'a>(section: &mut Section<'a>, key: &'static str) -> Option<&'a Node> {
    let node = section.find_some(key);
    let text = node.and_then(Section::text_of).filter(|text| !text.is_empty());
    if let (Some(node), None) = (node, text) {
        section.not_legal(key, node, &format!("a {key}'s name or \"none\""));
    }
    section.record(key, toml_string(text.unwrap_or("none")));
    node.filter(|_| text.is_some())
}

/// A list of names that may be absent or `"none"`.
fn names<'a>(section: &mut Section<'a>) -> Option<Vec<&'a Node>> {
    let need = "a list of detectors' names, each once, or \"none\"";
    let Some(node) = section.find_some("names") else {
        section.record("names", toml_string("none"));
        return None;
    };
    let items = match &node.value {
        Value::List(items) if !items.is_empty() => items.iter().collect(),
        Value::Word(_) => vec![node],
        _ => Vec::new(),
    };
    let texts: Vec<&str> = items.iter().filter_map(|item| Section::text_of(item)).collect();
    let distinct: BTreeSet<&str> = texts.iter().copied().collect();
    if texts.is_empty() || texts.len() < items.len() || distinct.len() < texts.len() {
        section.not_legal("names", node, &need);
        return None;
    }
    let quoted: Vec<String> = texts.iter().map(|text| toml_string(text)).collect();
    section.record("names", format!("[{}]", quoted.join(", ")));
    Some(items)
}
