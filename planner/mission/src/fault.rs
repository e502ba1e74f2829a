//! What is wrong with a mission, where, and what would be legal.
//!
//! A [`MissionError`] lists every [`Fault`] found, a sentence each: the place (a file and its line,
//! a preset, or an option of the command line), the key, the value and the legal range.
//!
//! Limits: a text that is not TOML stops at its first fault.
//!
//! # Example
//! Two faults at once, each where it stands:
//! ```
//! use mission::{Mission, Override};
//!
//! let set = [Override::set("scan.alpha_deg=200")?, Override::set("scan.bata_deg=50")?];
//! let told = Mission::load("litebird", &set).err().ok_or("no fault")?.to_string();
//! let lines: Vec<&str> = told.lines().collect();
//! assert_eq!(lines.len(), 2);
//! assert!(told.contains("scan.alpha_deg = 200 is out of range"));
//! assert!(told.contains("unknown key scan.bata_deg; did you mean scan.beta_deg?"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::quantity::QuantityError;
use std::fmt;
use thiserror::Error;

/// Most faults that a sentence tells; the others are counted.
const MOST_TOLD: usize = 10;

/// Everything that is wrong with a mission; at least one fault.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub struct MissionError {
    faults: Vec<Fault>,
}

impl MissionError {
    pub(crate) const fn new(faults: Vec<Fault>) -> Self {
        Self { faults }
    }

    /// The faults, in the order of their lines.
    #[must_use]
    pub fn faults(&self) -> &[Fault] {
        &self.faults
    }
}

impl From<Fault> for MissionError {
    fn from(fault: Fault) -> Self {
        Self::new(vec![fault])
    }
}

impl fmt::Display for MissionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, fault) in self.faults.iter().take(MOST_TOLD).enumerate() {
            let separator = if index == 0 { "" } else { "\n" };
            write!(f, "{separator}{fault}")?;
        }
        match self.faults.len().saturating_sub(MOST_TOLD) {
            0 => Ok(()),
            more => write!(f, "\nand {more} faults more"),
        }
    }
}

/// One thing that is wrong, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// A file's name, `preset NAME`, or an option such as `--set`.
    pub origin: String,
    /// Line of the file, from 1.
    pub line: Option<usize>,
    /// What is wrong.
    pub problem: Problem,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.origin)?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        write!(f, ": {}", self.problem)
    }
}

/// What can be wrong with a mission. Keys are dotted paths, values as written.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Problem {
    /// A file that cannot be read.
    #[error("cannot read it: {reason}")]
    Unreadable {
        /// What the system said.
        reason: String,
    },
    /// A file named by a key that cannot be read.
    #[error("{key} = {value} cannot be read: {reason}")]
    UnreadableFile {
        /// The key.
        key: String,
        /// The path as written.
        value: String,
        /// What the system said.
        reason: String,
    },
    /// Text that is not JSON.
    #[error("not JSON: {message}")]
    NotJson {
        /// What the JSON reader said.
        message: String,
    },
    /// Faults of one file beyond those that are listed.
    #[error("{count} more entries are faulty")]
    More {
        /// How many.
        count: usize,
    },
    /// Neither a preset nor a file.
    #[error("{name} is neither a preset ({presets}) nor a file")]
    NoSuchMission {
        /// The name as given.
        name: String,
        /// The presets' names.
        presets: String,
    },
    /// A file that is its own base, over any number of steps.
    #[error("base = {base} leads back to a file already read")]
    CircularBase {
        /// The base as written.
        base: String,
    },
    /// Text that is not TOML.
    #[error("not TOML: {message}")]
    Syntax {
        /// What the TOML reader said.
        message: String,
    },
    /// An override without a key and a value.
    #[error("{text} is not an override: key=value is needed, such as scan.alpha_deg=47.5")]
    NotAnOverride {
        /// The text as typed.
        text: String,
    },
    /// An option's quantity that is no number or has the wrong unit.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
    /// An override of a list's element that does not exist.
    #[error("{key} does not exist: {legal} is needed")]
    NoSuchElement {
        /// The key as typed, up to the element.
        key: String,
        /// The elements that exist.
        legal: String,
    },
    /// A key that no mission has.
    #[error("unknown key {key}; did you mean {nearest}?")]
    UnknownKey {
        /// The key.
        key: String,
        /// The nearest legal key.
        nearest: String,
    },
    /// A key without which there is no mission.
    #[error("{key} is missing: {need} is needed")]
    Missing {
        /// The key.
        key: String,
        /// What it needs.
        need: String,
    },
    /// A number outside its range.
    #[error("{key} = {value} is out of range: {need} is needed{hint}")]
    OutOfRange {
        /// The key, or an expression of keys.
        key: String,
        /// The value as written.
        value: String,
        /// The legal range.
        need: String,
        /// What the user may have meant, after a semicolon; or empty.
        hint: &'static str,
    },
    /// A value of the wrong kind, or none of the choices.
    #[error("{key} = {value} is not legal: {need} is needed")]
    NotLegal {
        /// The key.
        key: String,
        /// The value as written.
        value: String,
        /// What is legal.
        need: String,
    },
    /// A name given twice.
    #[error("{key} = {value} is there twice: a name of its own is needed")]
    Duplicate {
        /// The key of the second.
        key: String,
        /// The name.
        value: String,
    },
    /// Two keys of which one excludes the other.
    #[error("{first} and {second} exclude each other: one of them is needed")]
    Exclusive {
        /// One key.
        first: String,
        /// The other.
        second: String,
    },
}

/// What is legal, but should be known.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Warning {
    /// The boresight never comes near the ecliptic poles.
    #[error(
        "no full sky: scan.alpha_deg + scan.beta_deg - 90 = {excess} does not exceed scan.full_sky_margin_deg = {margin}"
    )]
    PolesUnseen {
        /// alpha + beta - 90 in degrees.
        excess: String,
        /// The margin it should exceed.
        margin: String,
    },
    /// The boresight's circle about the spin axis stays on one side of the terminator.
    #[error(
        "no full sky: scan.alpha_deg and scan.beta_deg differ by {difference}, more than 90 deg"
    )]
    PolesPassedBy {
        /// The absolute difference of alpha and beta in degrees.
        difference: String,
    },
    /// The boresight comes near the Sun.
    #[error(
        "the boresight comes within {closest} deg of the Sun (180 - scan.alpha_deg - scan.beta_deg); \
         less than {limit} deg is warned of"
    )]
    NearSun {
        /// The least angle between boresight and Sun in degrees.
        closest: String,
        /// The angle below which that is said.
        limit: u32,
    },
    /// Pairs of detectors that should differ in polarisation angle and do not.
    #[error(
        "{key}: {count} pairs of detectors, the first {first}, differ in pol but neither in quat nor \
         in pol_angle_rad: both of a pair get the same polarisation angle"
    )]
    PolarisationUnsaid {
        /// The key of the detectors' source.
        key: String,
        /// How many pairs.
        count: usize,
        /// Names of the first.
        first: String,
    },
    /// A weight that nothing is seen with.
    #[error(
        "calibration.schedule.weights.{target} weighs nothing: {target} is not among \
         calibration.targets, which are {targets}"
    )]
    WeightOfNoTarget {
        /// The name that has the weight.
        target: String,
        /// The mission's targets.
        targets: String,
    },
}
