//! The mission among the planets: scan clock, strategy, sky and targets, and the tables fitted to
//! them.
//!
//! Frames and signs: `docs/conventions.md`. Where the Sun model is circular and no longitude is
//! given, the real anti-Sun longitude at the start is taken.
//!
//! Limits: the kernel must cover the mission, and the light time before it.
//!
//! # Example
//! How far does Jupiter stand from the Sun when LiteBIRD starts?
//! ```
//! use mission::Mission;
//! use planner::world::World;
//!
//! let world = World::open(Mission::load("litebird", &[])?, None)?;
//! let jupiter = world.targets.iter().find(|it| it.name() == "jupiter").ok_or("no Jupiter")?;
//! let [direction, anti_sun] =
//!     [world.sky.direction(jupiter, world.start)?, world.sky.sun_to_spacecraft(world.start)?];
//! let elongation_rad = std::f64::consts::PI - direction.separation_rad(anti_sun);
//! assert!((elongation_rad.to_degrees() - 73.0).abs() < 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use ephem::apparent::{Corrections, Sky, SkyError};
use ephem::fit::{FitError, FitOptions, FittedTable, fit};
use ephem::kernel::{EARTH_MOON_BARYCENTER, Kernel, KernelError};
use ephem::source::{Place, Source, SourceError};
use ephem::time::{TimeError, format_tdb, parse_time};
use ephem::trajectory::{Trajectory, TrajectoryError};
use mission::calibration::{CalibrationSource, SourceDirection};
use mission::digest::sha256_hex;
use mission::orbit::{Observer, Trajectory as TrajectoryKey};
use mission::sessions::Sessions;
use mission::{FilePath, Mission, in_any_case, meant, rounding};
use onboard_core::ephemeris::{BodyTable, EphemerisError, EphemerisTable, SUN};
use onboard_core::phase::{Phase, Rotor};
use onboard_core::scan::{ScanError, ScanStrategy};
use onboard_core::sun::SunModel;
use onboard_core::time::{Duration, Instant};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Beyond this distance from the Earth a trajectory is warned of.
const FAR_AU: f64 = 0.1;
const KM_PER_AU: f64 = 149_597_870.7;

/// A mission with its sky.
#[derive(Debug)]
pub struct World {
    /// The files that the mission names and that can be read, with their digests.
    pub files: Vec<FileDigest>,
    /// The mission as read.
    pub mission: Mission,
    /// First instant of what is looked at: the mission's start, or a window's.
    pub start: Instant,
    /// Last instant of it.
    pub end: Instant,
    /// Its scanning strategy.
    pub scan: ScanStrategy,
    /// Ephemeris, trajectory, observer and corrections.
    pub sky: Sky,
    /// Its targets, in the mission's order.
    pub targets: Vec<Source>,
    /// What fields of view must keep away from, and by how many radians.
    pub avoided: Vec<(Source, f64)>,
    /// The circular Sun's anti-Sun longitude, where the mission asks for that model.
    pub circular_sun: Option<Rotor>,
}

/// A file behind an output.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileDigest {
    /// Its path as the mission has it.
    pub path: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
}

/// Why a mission cannot be put among the planets.
#[derive(Debug, Error)]
pub enum WorldError {
    /// Its start is no time.
    #[error(transparent)]
    Start(#[from] TimeError),
    /// The flight core refuses its scan, which was checked.
    #[error("{0:?}")]
    Scan(ScanError),
    /// The planetary kernel.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// The spacecraft's trajectory.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// A target, or a source of the mission's own.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// A file that cannot be read.
    #[error("cannot read {}: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// Kernel or trajectory do not cover what is asked.
    #[error(transparent)]
    Sky(#[from] SkyError),
    /// The onboard table cannot be fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// A window that is not the mission's.
    #[error("from {} to {} TDB: a window within the mission is needed, {} to {} TDB", format_tdb(*from), format_tdb(*until), format_tdb(mission.0), format_tdb(mission.1))]
    Window {
        /// Its first instant.
        from: Instant,
        /// Its last.
        until: Instant,
        /// The mission's.
        mission: (Instant, Instant),
    },
    /// A target that the mission does not have.
    #[error("{name} is none of the mission's targets: one of {} is needed{}", known.join(", "), meant(name, known).map_or(String::new(), |it| format!(" (did you mean {it}?)")))]
    NoSuchTarget {
        /// The target.
        name: String,
        /// Those that it has.
        known: Vec<String>,
    },
}

impl From<ScanError> for WorldError {
    fn from(error: ScanError) -> Self {
        Self::Scan(error)
    }
}

/// A fitted table does not serve what it was fitted for; the flight core's error in words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("{}", told(*_0))]
pub struct TableFault(pub EphemerisError);

impl From<EphemerisError> for TableFault {
    fn from(error: EphemerisError) -> Self {
        Self(error)
    }
}

/// An error of the core's table, in words.
fn told(error: EphemerisError) -> String {
    match error {
        EphemerisError::WrongLength => "the table's length contradicts its counts".to_owned(),
        EphemerisError::BadSpan(index) => format!("span {index} of the table is illegal"),
        EphemerisError::BadBody(index) => {
            format!("body record {index} of the table is not that of its spans")
        }
        EphemerisError::BadCoefficient(index) => {
            format!("coefficient {index} of the table is not finite")
        }
        EphemerisError::NoSuchBody(number) => format!("body {number} is not in the table"),
        EphemerisError::OutOfSpan(at) => format!("{} TDB lies outside the table", format_tdb(at)),
        other => other.to_string(),
    }
}

/// A fitted table, ready for the search.
#[derive(Debug)]
pub struct Tables {
    /// How it was fitted, and its bytes.
    pub fitted: FittedTable,
}

impl World {
    /// Reads the kernel, the trajectory and the sources that a mission names.
    ///
    /// # Errors
    /// [`WorldError`] names the file, the source or the time that cannot be used.
    pub fn open(mission: Mission, ephemeris: Option<&Path>) -> Result<Self, WorldError> {
        let start = parse_time(mission.span.start.text())?;
        let end = start.plus(mission.span.duration);
        let scan = mission.scan_strategy(start)?;
        let kernel = match ephemeris {
            None => Kernel::embedded(),
            Some(path) => Kernel::load(path)?,
        };
        let trajectory = match &mission.orbit.trajectory {
            TrajectoryKey::L2 => Trajectory::l2(),
            TrajectoryKey::File(file) => Trajectory::load(&mission.path(file).to_string_lossy())?,
        };
        let sky = Sky {
            kernel,
            trajectory,
            observer: match mission.orbit.observer {
                Observer::Spacecraft => ephem::apparent::Observer::Spacecraft,
                Observer::Earth => ephem::apparent::Observer::Earth,
                Observer::Sun => ephem::apparent::Observer::Sun,
            },
            corrections: if mission.orbit.aberration {
                Corrections::Apparent
            } else {
                Corrections::Geometric
            },
            mission_start: start,
        };
        let targets = mission
            .calibration
            .targets
            .iter()
            .map(|name| source(&mission, name))
            .collect::<Result<Vec<_>, _>>()?;
        let avoided = mission
            .calibration
            .schedule
            .avoidance
            .iter()
            .map(|it| Ok((source(&mission, &it.body)?, rounding::radians(it.angle_deg.exact()))))
            .collect::<Result<Vec<_>, WorldError>>()?;
        let circular_sun = circular_sun(&mission, &sky, start)?;
        let files = digests(&mission);
        Ok(Self { files, mission, start, end, scan, sky, targets, avoided, circular_sun })
    }

    /// Zero of the scan clock: the mission's start.
    #[must_use]
    pub const fn zero(&self) -> Instant {
        self.scan.parameters().start
    }

    /// First and last instant of the mission.
    #[must_use]
    pub const fn mission_span(&self) -> (Instant, Instant) {
        (self.zero(), self.zero().plus(self.mission.span.duration))
    }

    /// Looks at a window of the mission alone; its clock goes on as before.
    ///
    /// # Errors
    /// [`WorldError::Window`] for one that is empty or reaches beyond the mission.
    pub fn keep_window(&mut self, from: Instant, until: Instant) -> Result<(), WorldError> {
        let mission = self.mission_span();
        if from < mission.0 || until > mission.1 || from >= until {
            return Err(WorldError::Window { from, until, mission });
        }
        (self.start, self.end) = (from, until);
        Ok(())
    }

    /// What must be known to tell the sessions of the window as the whole mission has them: the window, and
    /// what one session may reach beyond it.
    #[must_use]
    pub fn reach(&self) -> (Instant, Instant) {
        let beyond_ns = match self.mission.sessions() {
            Sessions::ByTurn => self.mission.scan.precession_period().ns(),
            Sessions::ByPause { gap, longest, .. } => longest.ns().saturating_add(gap.ns()),
        };
        let (first, last) = self.mission_span();
        let before = Duration::from_ns(beyond_ns.saturating_neg());
        let after = Duration::from_ns(beyond_ns);
        (self.start.plus(before).max(first), self.end.plus(after).min(last))
    }

    /// Keeps only the targets named, in the mission's order; none named keeps all.
    ///
    /// # Errors
    /// [`WorldError`] names the target that the mission does not have.
    pub fn keep_targets(&mut self, names: &[String]) -> Result<(), WorldError> {
        if let Some(name) = names.iter().find(|name| !self.is_target(name)) {
            return Err(WorldError::NoSuchTarget {
                name: name.clone(),
                known: self.targets.iter().map(|it| it.name().to_owned()).collect(),
            });
        }
        if !names.is_empty() {
            let known: Vec<String> = self.targets.iter().map(|it| it.name().to_owned()).collect();
            let kept: Vec<&str> =
                names.iter().filter_map(|name| in_any_case(name, &known)).collect();
            self.targets.retain(|source| kept.contains(&source.name()));
        }
        Ok(())
    }

    fn is_target(&self, name: &str) -> bool {
        let known: Vec<&str> = self.targets.iter().map(Source::name).collect();
        in_any_case(name, &known).is_some()
    }

    /// All whose directions go on board: the targets, and what is avoided without being one.
    #[must_use]
    pub fn sources(&self) -> Vec<Source> {
        let mut sources = self.targets.clone();
        for (source, _) in &self.avoided {
            if sources.iter().all(|it| it.body() != source.body()) {
                sources.push(source.clone());
            }
        }
        sources
    }

    /// What should be known of the trajectory: it goes far from the Earth, as one in the wrong unit does.
    #[must_use]
    pub fn far_trajectory(&self) -> Option<String> {
        let TrajectoryKey::File(_) = &self.mission.orbit.trajectory else { return None };
        let kernel = &self.sky.kernel;
        let distance_au = |at: Instant| {
            let there = self.sky.trajectory.state(kernel, at).ok()?.position_km;
            let earth = kernel.state(EARTH_MOON_BARYCENTER, at).ok()?.position_km;
            Some(((there - earth).norm() / KM_PER_AU, at))
        };
        let middle = self.start.plus(Duration::from_ns(self.end.since(self.start).ns() / 2));
        let far = [self.start, middle, self.end].into_iter().filter_map(distance_au);
        let (au, at) = far.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|it| it.0 > FAR_AU)?;
        Some(format!(
            "the trajectory {} is {au:.3} au from the Earth at {} TDB (L2 is 0.01 au away): are its \
             positions in km?",
            self.sky.trajectory.name(),
            format_tdb(at)
        ))
    }

    /// Fits the table of the Sun, the targets and the bodies to avoid over the mission, or as far as a
    /// window reaches.
    ///
    /// # Errors
    /// [`WorldError`] where kernel, trajectory or sources do not cover the mission.
    pub fn tables(&self, options: &FitOptions) -> Result<Tables, WorldError> {
        let fitted = fit(&self.sky, &self.sources(), self.reach(), options)?;
        Ok(Tables { fitted })
    }

    /// Fit options for the ground: a user's table of directions is followed as exactly as it can be.
    #[must_use]
    pub fn ground_options(&self) -> FitOptions {
        let tabulated = self.targets.iter().any(|source| matches!(source.place(), Place::Table(_)));
        if tabulated {
            FitOptions { tolerance_rad: 1e-12, ..FitOptions::GROUND }
        } else {
            FitOptions::GROUND
        }
    }

    /// The Sun model, on this table.
    ///
    /// # Errors
    /// [`TableFault`] where the table has no Sun.
    pub fn sun<'t>(&self, table: EphemerisTable<'t>) -> Result<SunModel<'t>, TableFault> {
        match self.circular_sun {
            Some(longitude) => Ok(SunModel::Circular(longitude)),
            None => body(table, SUN).map(SunModel::Table),
        }
    }
}

impl Tables {
    /// The table as the flight core reads it.
    ///
    /// # Errors
    /// [`TableFault`] where the fit wrote what the core refuses.
    pub fn parse(&self) -> Result<EphemerisTable<'_>, TableFault> {
        Ok(EphemerisTable::parse(&self.fitted.bytes)?)
    }
}

/// One body of a table that was fitted for it.
///
/// # Errors
/// [`TableFault`] where it is not there.
pub fn body(table: EphemerisTable<'_>, number: i32) -> Result<BodyTable<'_>, TableFault> {
    Ok(table.body(number)?)
}

fn source(mission: &Mission, name: &str) -> Result<Source, WorldError> {
    let own = mission.calibration.sources.iter().enumerate().find(|(_, own)| own.name == name);
    match own {
        None => Source::by_name(name).map_err(WorldError::from),
        Some((index, own)) => own_source(mission, index, own),
    }
}

fn own_source(
    mission: &Mission,
    index: usize,
    own: &CalibrationSource,
) -> Result<Source, WorldError> {
    let source = match &own.direction {
        SourceDirection::Ecliptic { longitude_deg, latitude_deg } => {
            Source::at_ecliptic(&own.name, index, longitude_deg.to_f64(), latitude_deg.to_f64())
        }
        SourceDirection::Equatorial { right_ascension_deg, declination_deg } => Source::at_icrs(
            &own.name,
            index,
            right_ascension_deg.to_f64(),
            declination_deg.to_f64(),
        ),
        SourceDirection::Table(file) => {
            Source::from_csv(&own.name, index, &read_text(mission, file)?)
        }
    };
    source.map_err(WorldError::from)
}

/// The digests of the files that a mission names: trajectory, directions, contacts, blackouts. One that
/// cannot be read is left out here: who needs it says so.
fn digests(mission: &Mission) -> Vec<FileDigest> {
    let schedule = &mission.calibration.schedule;
    let trajectory = match &mission.orbit.trajectory {
        TrajectoryKey::L2 => None,
        TrajectoryKey::File(file) => Some(file),
    };
    let directions = mission.calibration.sources.iter().filter_map(|it| match &it.direction {
        SourceDirection::Table(file) => Some(file),
        SourceDirection::Ecliptic { .. } | SourceDirection::Equatorial { .. } => None,
    });
    let contacts = schedule.data.as_ref().map(|it| &it.contacts);
    let files = trajectory.into_iter().chain(directions).chain(contacts).chain(&schedule.blackouts);
    let digest = |file: &FilePath| {
        let bytes = std::fs::read(mission.path(file)).ok()?;
        Some(FileDigest { path: file.text().to_owned(), sha256: sha256_hex(bytes) })
    };
    files.filter_map(digest).collect()
}

fn read_text(mission: &Mission, file: &FilePath) -> Result<String, WorldError> {
    let path = mission.path(file);
    std::fs::read_to_string(&path)
        .map_err(|error| WorldError::Unreadable { path, reason: error.to_string() })
}

fn circular_sun(mission: &Mission, sky: &Sky, start: Instant) -> Result<Option<Rotor>, WorldError> {
    let needs_real = mission.orbit.start_longitude_deg.is_none()
        && mission.orbit.circular_sun(Phase::ZERO).is_some();
    let real = if needs_real {
        let anti_sun = sky.sun_to_spacecraft(start)?;
        Phase::from_radians(anti_sun.longitude_rad())
    } else {
        Phase::ZERO
    };
    Ok(mission.orbit.circular_sun(real))
}
