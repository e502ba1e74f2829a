//! What `timeline.json` holds.

use crate::error::WriteError;
use onboard_core::time::Instant;
use planner::provenance::Provenance;
use planner::worth::strength::Strength;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A timeline, as `timeline.json` holds it.
#[derive(Debug, Serialize, Deserialize)]
pub struct Timeline {
    /// Where it comes from.
    #[serde(flatten)]
    pub provenance: Provenance,
    /// Sum of weight times dwell in seconds.
    pub objective: f64,
    /// No schedule has a larger objective.
    pub upper_bound: f64,
    /// (upper bound - objective) / upper bound.
    pub gap: f64,
    /// Why the search ended.
    pub stopped: String,
    /// What changed against an earlier plan, where one was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub against: Option<Against>,
    /// The sessions by start.
    pub sessions: Vec<Session>,
    /// The opportunities not taken.
    pub rejected: Vec<Rejected>,
    /// How far the rules are used.
    pub constraints: Vec<Constraint>,
    /// What giving way in a rule would bring.
    #[serde(default)]
    pub loosening: Vec<Loosened>,
    /// Whether the periods beat on the sky, as `resonance --json` says it; null where not judged.
    pub resonance: Option<Value>,
}

/// A file that holds no timeline.
#[derive(Debug, Error)]
pub enum TimelineError {
    /// It cannot be read.
    #[error("cannot read {}: {error}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        error: std::io::Error,
    },
    /// It is another file.
    #[error("{} is no timeline as plan writes it: {error}", path.display())]
    NotATimeline {
        /// The file.
        path: PathBuf,
        /// What the reader said.
        error: serde_json::Error,
    },
}

impl Timeline {
    /// The timeline of a file, and the file's bytes.
    ///
    /// # Errors
    /// [`TimelineError`] where there is none.
    pub fn read(file: &Path) -> Result<(Self, Vec<u8>), TimelineError> {
        let path = || file.to_owned();
        let bytes = std::fs::read(file)
            .map_err(|error| TimelineError::Unreadable { path: path(), error })?;
        let timeline = serde_json::from_slice(&bytes)
            .map_err(|error| TimelineError::NotATimeline { path: path(), error })?;
        Ok((timeline, bytes))
    }

    /// `timeline.json`.
    ///
    /// # Errors
    /// [`WriteError::Refused`] where it cannot be written.
    pub fn to_json(&self) -> Result<Vec<u8>, WriteError> {
        let mut bytes = Vec::new();
        let indent = serde_json::ser::PrettyFormatter::with_indent(b" ");
        let mut writer = serde_json::Serializer::with_formatter(&mut bytes, indent);
        self.serialize(&mut writer).map_err(WriteError::refused)?;
        bytes.push(b'\n');
        Ok(bytes)
    }
}

/// What changed against an earlier plan, by ids.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Against {
    /// SHA-256 of its `timeline.json`.
    pub sha256: String,
    /// Sessions in both at the same times.
    pub kept: usize,
    /// Sessions that it did not have.
    pub added: Vec<String>,
    /// Sessions that only it had.
    pub dropped: Vec<String>,
    /// Sessions in both at other times.
    pub moved: Vec<String>,
}

/// One session.
#[derive(Debug, Serialize, Deserialize)]
pub struct Session {
    /// Telescope, target and precession turn.
    pub id: String,
    /// Target's name.
    pub target: String,
    /// Telescope's name.
    pub telescope: String,
    /// Start, setup included, TDB.
    pub start_tdb: String,
    /// End, cooldown included, TDB.
    pub end_tdb: String,
    /// Start, UTC.
    pub start_utc: String,
    /// End, UTC.
    pub end_utc: String,
    /// Start, ns of TAI.
    pub start_tai_ns: i64,
    /// End, ns of TAI.
    pub end_tai_ns: i64,
    /// The passes by entry.
    pub transits: Vec<SessionTransit>,
    /// Time with the target in view.
    pub dwell_s: f64,
    /// Number of passes.
    #[serde(default)]
    pub passes: usize,
    /// Least impact parameter of its passes.
    #[serde(default)]
    pub impact_min_deg: f64,
    /// Largest impact parameter.
    #[serde(default)]
    pub impact_max_deg: f64,
    /// How evenly its passes cover the phases of the half-wave plate, 0 to 1; null without a plate.
    #[serde(default)]
    pub hwp_coverage: Option<f64>,
    /// How strong the target is.
    #[serde(flatten)]
    pub signal: Signal,
    /// Why it is there.
    pub reason: String,
}

impl Session {
    /// Start, setup included.
    #[must_use]
    pub const fn start(&self) -> Instant {
        Instant::from_tai_ns(self.start_tai_ns)
    }

    /// End, cooldown included.
    #[must_use]
    pub const fn end(&self) -> Instant {
        Instant::from_tai_ns(self.end_tai_ns)
    }
}

/// One pass of a session.
#[derive(Debug, Serialize, Deserialize)]
pub struct SessionTransit {
    /// Detector's name, or `-` for the field of view.
    pub detector: String,
    /// First instant inside, TDB.
    pub entry_tdb: String,
    /// Last instant inside, TDB.
    pub exit_tdb: String,
    /// First instant inside, ns of TAI.
    pub entry_tai_ns: i64,
    /// Last instant inside, ns of TAI.
    pub exit_tai_ns: i64,
    /// Closest approach, ns of TAI.
    pub closest_tai_ns: i64,
    /// Time inside.
    pub dwell_s: f64,
    /// Separation at closest approach.
    pub min_separation_deg: f64,
    /// Crossing angle at closest approach.
    pub psi_deg: f64,
    /// Scan-beam angle at closest approach.
    #[serde(default)]
    pub scan_beam_angle_deg: f64,
    /// Offset of the target across the scan at closest approach, positive along z x v.
    #[serde(default)]
    pub impact_deg: f64,
    /// Angle of the half-wave plate at closest approach; null without a plate.
    #[serde(default)]
    pub hwp_deg: Option<f64>,
}

/// An opportunity not taken.
#[derive(Debug, Serialize, Deserialize)]
pub struct Rejected {
    /// The id its session would have.
    pub opportunity: String,
    /// The rule that excludes it.
    pub because: String,
}

/// How far a rule is used.
#[derive(Debug, Serialize, Deserialize)]
pub struct Constraint {
    /// The rule and its place.
    pub name: String,
    /// The rule's key in mission files.
    #[serde(default)]
    pub rule: String,
    /// In what use and limit are counted; null for a pure number.
    #[serde(default)]
    pub unit: Option<Unit>,
    /// What the schedule uses.
    pub used: f64,
    /// What the rule allows.
    pub limit: f64,
    /// Objective that a small loosening would bring.
    pub shadow_price: f64,
}

impl Constraint {
    /// Where the rule holds: its name without rule and unit.
    #[must_use]
    pub fn place(&self) -> &str {
        let place = self.name.strip_prefix(&*self.rule).unwrap_or(&self.name).trim_start();
        let unit = match self.unit {
            Some(Unit::Seconds) => " (s)",
            Some(Unit::Days) => " (days)",
            Some(Unit::Sessions) | None => "",
        };
        place.strip_suffix(unit).unwrap_or(place)
    }
}

/// In what the use and the limit of a rule are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// Seconds, of reserved time or of producing data.
    #[serde(rename = "s")]
    Seconds,
    /// Days of 86,400 s.
    #[serde(rename = "days")]
    Days,
    /// Sessions.
    #[serde(rename = "sessions")]
    Sessions,
}

/// What giving way in a rule would bring while sessions may be taken in parts.
#[derive(Debug, Serialize, Deserialize)]
pub struct Loosened {
    /// The rule's key.
    pub rule: String,
    /// The step, as in `10 more minutes per day`.
    pub step: String,
    /// What the objective gains.
    pub objective_percent: f64,
    /// What the time in view of each target gains, where it has any.
    pub dwell_percent: BTreeMap<String, f64>,
}

/// The strength of a session's target at the beam's centre; null for what is not known.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Signal {
    /// Angular diameter of a planet.
    pub angular_diameter_arcsec: Option<f64>,
    /// Temperature of a black body as bright as a planet in the telescope's band.
    pub brightness_temperature_k: Option<f64>,
    /// Part of the beam that a planet fills.
    pub beam_dilution: Option<f64>,
    /// Peak antenna temperature, Rayleigh-Jeans.
    pub antenna_temperature_mk: Option<f64>,
    /// The polarised part of it.
    pub polarised_temperature_mk: Option<f64>,
}

impl From<Strength> for Signal {
    fn from(it: Strength) -> Self {
        let in_mk = |kelvin: f64| 1e3 * kelvin;
        Self {
            angular_diameter_arcsec: it.diameter_rad.map(|rad| 3600.0 * rad.to_degrees()),
            brightness_temperature_k: it.brightness_k,
            beam_dilution: it.dilution,
            antenna_temperature_mk: it.antenna_k.map(in_mk),
            polarised_temperature_mk: it.polarised_k.map(in_mk),
        }
    }
}
