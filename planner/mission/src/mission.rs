//! What is the mission: every key of its file, checked and typed.
//!
//! A mission is read from a preset or a TOML file, over a base where it names one, with overrides of
//! the command line on top; see [`Mission::load`]. Angles are kept as written and in radians, rates
//! and phases exactly.
//!
//! Method: one reader per section, in the order of the sections; the readers are the schema.
//!
//! Limits: of the files that a mission names only instrument models are opened, not trajectory,
//! directions, contacts and blackouts.

use crate::calibration::Calibration;
use crate::digest::sha256_hex;
use crate::fault::{MissionError, Warning};
use crate::file::{self, Override};
use crate::file_path::FilePath;
use crate::orbit::Orbit;
use crate::reading::document::{Place, Table};
use crate::reading::findings::Findings;
use crate::reading::section::{Section, duplicates};
use crate::scan::{Scan, Tolerance};
use crate::sessions::Sessions;
use crate::span::Span;
use crate::telescope::Telescope;
use onboard_core::scan::{ScanError, ScanParameters, ScanStrategy};
use onboard_core::time::Instant;
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// A mission without a fault.
#[derive(Debug, Clone)]
pub struct Mission {
    /// Its name.
    pub name: String,
    /// When it starts and how long it lasts.
    pub span: Span,
    /// How it scans.
    pub scan: Scan,
    /// How well the periods are held.
    pub tolerance: Tolerance,
    /// Where it is and whence directions are seen.
    pub orbit: Orbit,
    /// What it carries, in the user's order.
    pub telescopes: Vec<Telescope>,
    /// What it looks at for calibration.
    pub calibration: Calibration,
    /// Who writes the products, and about what.
    pub product: Product,
    /// What is legal but should be known.
    pub warnings: Vec<Warning>,
    directory: PathBuf,
    resolved: String,
}

/// Fields that CCSDS messages ask for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Product {
    /// Who writes the message.
    pub originator: String,
    /// The spacecraft's name; the mission's where none is given.
    pub object_name: String,
    /// The spacecraft's international designator.
    pub object_id: String,
}

impl Product {
    fn read(section: &mut Section<'_>, mission: &str) -> Self {
        Self {
            originator: section.name("originator", Some("GYRFALCON")),
            object_name: section.name("object_name", Some(mission)),
            object_id: section.name("object_id", Some("UNKNOWN")),
        }
    }
}

impl Mission {
    /// Reads a preset by name, or else a mission file, with `overrides` on top in their order.
    ///
    /// # Errors
    /// [`MissionError`] lists every fault.
    pub fn load(mission: &str, overrides: &[Override]) -> Result<Self, MissionError> {
        let (table, place, directory) = file::load(mission, overrides)?;
        Self::read(&table, place, directory)
    }

    /// Reads a mission from the text of a file called `name` in `directory`.
    ///
    /// # Errors
    /// [`MissionError`] lists every fault.
    pub fn from_toml(
        text: &str,
        name: &str,
        directory: &Path,
        overrides: &[Override],
    ) -> Result<Self, MissionError> {
        let (table, place) = file::read_text(text, name, directory, overrides)?;
        Self::read(&table, place, directory.to_owned())
    }

    fn read(table: &Table, place: Place, directory: PathBuf) -> Result<Self, MissionError> {
        let findings = RefCell::new(Findings::default());
        let mut top = Section::new(table, place, &findings);
        top.knows(&["base"]);
        let name = top.name("name", None);
        let times = top.table("span", Span::read);
        let scan = top.table("scan", Scan::read);
        let tolerance = top.table("tolerance", Tolerance::read);
        let orbit = top.table("orbit", Orbit::read);
        let telescopes = top.tables("telescope", |s| Telescope::read(s, &directory));
        duplicates(&top, "telescope", telescopes.iter().map(|t| t.name.as_str()));
        let calibration = top.table("calibration", |s| Calibration::read(s, &telescopes));
        let product = top.table("product", |s| Product::read(s, &name));
        let resolved = top.finish().text();
        let faults = findings.into_inner().into_faults();
        let Some(times) = times.filter(|_| faults.is_empty()) else {
            return Err(MissionError::new(faults));
        };
        let mut warnings = scan.warnings();
        warnings.extend(scan.near_sun());
        warnings.extend(telescopes.iter().filter_map(|telescope| telescope.warning.clone()));
        warnings.extend(calibration.idle_weights());
        Ok(Self {
            name,
            span: times,
            scan,
            tolerance,
            orbit,
            telescopes,
            calibration,
            product,
            warnings,
            directory,
            resolved,
        })
    }

    /// The scanning strategy whose scan clock starts at `start`.
    ///
    /// # Errors
    /// [`ScanError`] where the flight core refuses what was checked here; none is known.
    pub fn scan_strategy(&self, start: Instant) -> Result<ScanStrategy, ScanError> {
        ScanStrategy::new(ScanParameters {
            start,
            alpha_rad: self.scan.alpha_rad,
            beta_rad: self.scan.beta_rad,
            precession: self.scan.precession,
            spin: self.scan.spin,
        })
    }

    /// Where a file that the mission names is: relative paths count from the mission file's folder.
    #[must_use]
    pub fn path(&self, file: &FilePath) -> PathBuf {
        file.within(&self.directory)
    }

    /// Which passes of a target over a telescope belong to one session.
    #[must_use]
    pub fn sessions(&self) -> Sessions {
        Sessions::of(self.calibration.session.as_ref(), &self.scan)
    }

    /// The mission with every key explicit, as TOML that reads back as the same mission.
    #[must_use]
    pub fn resolved_toml(&self) -> &str {
        &self.resolved
    }

    /// SHA-256 of [`Self::resolved_toml`] in hexadecimal digits.
    #[must_use]
    pub fn digest(&self) -> String {
        sha256_hex(&self.resolved)
    }
}
