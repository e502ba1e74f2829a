//! What is looked at for calibration: targets, sources of the user's own, the radius of a transit.
//!
//! Frames: a source has ecliptic longitude and latitude (J2000), right ascension and declination
//! (ICRS), or a table of ecliptic unit vectors against elapsed seconds.
//!
//! Limits: a table of directions is named here and read where ephemerides are.
//!
//! # Example
//! A source of the mission's own among its targets:
//! ```
//! use mission::{Mission, calibration::SourceDirection};
//!
//! let text = r#"
//! base = "litebird"
//! [calibration]
//! targets = ["jupiter", "beacon"]
//! [[calibration.source]]
//! name = "beacon"
//! ecliptic_longitude_deg = 84.1
//! ecliptic_latitude_deg = -1.3
//! "#;
//! let mission = Mission::from_toml(text, "mine.toml", std::path::Path::new(""), &[])?;
//! let beacon = &mission.calibration.sources[0];
//! assert!(matches!(&beacon.direction, SourceDirection::Ecliptic { latitude_deg, .. }
//!     if latitude_deg.text() == "-1.3"));
//! # Ok::<(), mission::fault::MissionError>(())
//! ```

use crate::fault::{Problem, Warning};
use crate::file_path::FilePath;
use crate::names::{in_any_case, nearest_first};
use crate::number::Number;
use crate::reading::canon::toml_string;
use crate::reading::document::{Node, Value};
use crate::reading::range::Range;
use crate::reading::section::{Section, duplicates, one_of_meant};
use crate::requirement::Requirement;
use crate::rounding;
use crate::schedule::{Schedule, Weight};
use crate::sessions::Asked;
use crate::telescope::Telescope;
use num_traits::{One, Zero};

/// Targets that need no source: planets (from Mars on, the Earth aside, system barycentres), the
/// Moon and fixed calibrators.
pub const KNOWN_TARGETS: [&str; 11] = [
    "mercury", "venus", "mars", "jupiter", "saturn", "uranus", "neptune", "moon", "tau_a", "cas_a",
    "cen_a",
];
const DEFAULT_TARGETS: [&str; 5] = ["mars", "jupiter", "saturn", "uranus", "neptune"];

/// Targets, sources and the schedule.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Calibration {
    /// In the user's order, each once.
    pub targets: Vec<String>,
    /// Radius of a transit about a line of sight.
    pub radius_deg: Number,
    /// Which passes belong together, where that is asked for.
    pub(crate) session: Option<Asked>,
    /// Directions of the user's own.
    pub sources: Vec<CalibrationSource>,
    /// What calibration must teach.
    pub requirements: Vec<Requirement>,
    /// What binds the timeline.
    pub schedule: Schedule,
}

impl Calibration {
    /// The transit radius in radians.
    #[must_use]
    pub fn radius_rad(&self) -> f64 {
        rounding::radians(self.radius_deg.exact())
    }

    /// Weights that were given, other than 0 and 1, to what is no target.
    pub(crate) fn idle_weights(&self) -> Vec<Warning> {
        let says_nothing = |it: &Weight| match it {
            Weight::Plain(weight) => weight.exact().is_one() || weight.exact().is_zero(),
            Weight::ByPurpose(_) => false,
        };
        let idle = |it: &&(String, Weight)| !self.targets.contains(&it.0) && !says_nothing(&it.1);
        let warning = |it: &(String, Weight)| Warning::WeightOfNoTarget {
            target: it.0.clone(),
            targets: self.targets.join(", "),
        };
        self.schedule.weights.iter().filter(idle).map(warning).collect()
    }
}

/// A direction of the user's own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CalibrationSource {
    /// Unique, and none of [`KNOWN_TARGETS`].
    pub name: String,
    /// Where it is.
    pub direction: SourceDirection,
    /// Its flux in every telescope's band.
    pub flux_jy: Option<Number>,
    /// The linearly polarised part of it.
    pub polarised_fraction: Option<Number>,
}

/// Where a source is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SourceDirection {
    /// Fixed, ecliptic of J2000.
    Ecliptic {
        /// Ecliptic longitude.
        longitude_deg: Number,
        /// Ecliptic latitude.
        latitude_deg: Number,
    },
    /// Fixed, ICRS.
    Equatorial {
        /// Right ascension in degrees.
        right_ascension_deg: Number,
        /// Declination.
        declination_deg: Number,
    },
    /// Moving: a CSV of `elapsed_s, x, y, z`.
    Table(FilePath),
}

const FLUX: Range = Range::positive("a flux", 1e12, "Jy");
const FRACTION: Range = Range::closed("a fraction", 0.0, 1.0, "");
const RADIUS: Range = Range::positive("an angle", 180.0, "deg");
const LONGITUDE: Range = Range::closed("an angle", -360.0, 360.0, "deg");
const LATITUDE: Range = Range::closed("an angle", -90.0, 90.0, "deg");

impl Calibration {
    pub(crate) fn read(section: &mut Section<'_>, telescopes: &[Telescope]) -> Self {
        let target_nodes = target_nodes(section);
        let radius_deg = section.number("radius_deg", &RADIUS, Some("0.5"));
        let session = section.inline("session", Asked::read);
        let sources = section.tables("source", CalibrationSource::read);
        duplicates(section, "source", sources.iter().map(|source| source.name.as_str()));
        let legal: Vec<&str> =
            KNOWN_TARGETS.into_iter().chain(sources.iter().map(|s| s.name.as_str())).collect();
        let targets = match target_nodes {
            None => DEFAULT_TARGETS.map(str::to_owned).to_vec(),
            Some(nodes) => targets(section, &nodes, &legal),
        };
        let items: Vec<String> = targets.iter().map(|target| toml_string(target)).collect();
        section.record("targets", format!("[{}]", items.join(", ")));
        let requirements = section.tables("requirement", |s| requirement(s, telescopes));
        let requirements = requirements.into_iter().flatten().collect();
        let count = telescopes.len();
        let schedule = section.table("schedule", |s| Schedule::read(s, count, &targets, &legal));
        Self { targets, radius_deg, session, sources, requirements, schedule }
    }
}

/// A requirement on what the mission carries.
fn requirement(section: &mut Section<'_>, telescopes: &[Telescope]) -> Option<Requirement> {
    let requirement = Requirement::read(section)?;
    if let Some(node) = section.node_of("telescope")
        && !requirement.has_subject(telescopes)
    {
        let known: Vec<&str> = telescopes
            .iter()
            .flat_map(|it| {
                let channels = it.channels.iter().map(|channel| channel.name.as_str());
                std::iter::once(it.name.as_str()).chain(channels)
            })
            .collect();
        let said = requirement.telescope.as_str();
        let need = format!(
            "\"all\", a telescope, a channel or a detector of the mission ({})",
            nearest_first(said, &known)
        );
        section.not_legal("telescope", node, &need);
    }
    Some(requirement)
}

/// The targets as given: a list, or words that an option separates by commas.
fn target_nodes(section: &mut Section<'_>) -> Option<Vec<Node>> {
    let node = section.find("targets")?;
    match &node.value {
        Value::List(items) => Some(items.clone()),
        Value::Word(words) => {
            let words = words.strip_prefix('[').and_then(|w| w.strip_suffix(']')).unwrap_or(words);
            let word = |word: &str| Node {
                value: Value::Word(word.trim().to_owned()),
                place: node.place.clone(),
            };
            Some(words.split(',').map(word).collect())
        }
        _ => {
            section.not_legal(
                "targets",
                node,
                &"a list of targets such as [\"mars\", \"jupiter\"]",
            );
            Some(Vec::new())
        }
    }
}

fn targets(section: &Section<'_>, nodes: &[Node], legal: &[&str]) -> Vec<String> {
    let mut targets: Vec<String> = Vec::new();
    for node in nodes {
        let text = Section::text_of(node).unwrap_or_default();
        let found = in_any_case(text, legal);
        let text = found.unwrap_or(text);
        if found.is_none() {
            section.not_legal("targets", node, &one_of_meant(text, legal));
        } else if targets.iter().any(|target| target == text) {
            let problem =
                Problem::Duplicate { key: section.key("targets"), value: text.to_owned() };
            section.fault(&node.place, problem);
        } else {
            targets.push(text.to_owned());
        }
    }
    targets
}

impl CalibrationSource {
    fn read(section: &mut Section<'_>) -> Self {
        let name = section.name("name", None);
        if KNOWN_TARGETS.contains(&name.as_str()) {
            let problem = Problem::Duplicate { key: section.key("name"), value: name.clone() };
            section.fault(&section.place_of("name"), problem);
        }
        let pairs = [
            ["ecliptic_longitude_deg", "ecliptic_latitude_deg"],
            ["right_ascension_deg", "declination_deg"],
            ["directions", "directions"],
        ];
        let given: Vec<&str> = pairs
            .iter()
            .filter_map(|pair| pair.iter().copied().find(|key| section.has(key)))
            .collect();
        if let [first, second, ..] = given.as_slice() {
            let problem =
                Problem::Exclusive { first: section.key(first), second: section.key(second) };
            section.fault(&section.place_of(second), problem);
        }
        let direction = if section.has("directions") {
            SourceDirection::Table(FilePath::read(section, "directions"))
        } else if given.first() == Some(&"right_ascension_deg")
            || given.first() == Some(&"declination_deg")
        {
            SourceDirection::Equatorial {
                right_ascension_deg: section.number("right_ascension_deg", &LONGITUDE, None),
                declination_deg: section.number("declination_deg", &LATITUDE, None),
            }
        } else {
            SourceDirection::Ecliptic {
                longitude_deg: section.number("ecliptic_longitude_deg", &LONGITUDE, None),
                latitude_deg: section.number("ecliptic_latitude_deg", &LATITUDE, None),
            }
        };
        section.knows(&[
            "ecliptic_longitude_deg",
            "ecliptic_latitude_deg",
            "right_ascension_deg",
            "declination_deg",
            "directions",
        ]);
        let flux_jy = section.optional_number("flux_jy", &FLUX);
        let polarised_fraction = section.optional_number("polarised_fraction", &FRACTION);
        if polarised_fraction.is_some() && flux_jy.is_none() {
            section.missing("flux_jy", &FLUX);
        }
        Self { name, direction, flux_jy, polarised_fraction }
    }
}
