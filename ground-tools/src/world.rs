//! The mission among the planets: scan clock, strategy, sky and targets, and the tables fitted to
//! them.
//!
//! Frames and signs: `docs/conventions.md`. Where the Sun model is circular and no longitude is
//! given, the real anti-Sun longitude at the start is taken.
//!
//! Limits: the kernel must cover the mission, and the light time before it.

use crate::failure::Failure;
use crate::mission::calibration::{CalibrationSource, SourceDirection};
use crate::mission::orbit::{Observer, Trajectory as TrajectoryKey};
use crate::mission::{FilePath, Mission};
use crate::provenance::FileDigest;
use crate::resolve::sha256_hex;
use crate::rounding;
use ephem::apparent::{Corrections, Sky};
use ephem::fit::{FitOptions, FittedTable, fit};
use ephem::kernel::Kernel;
use ephem::source::{Place, Source};
use ephem::time::parse_time;
use ephem::trajectory::Trajectory;
use onboard_core::ephemeris::{BodyTable, EphemerisTable, SUN};
use onboard_core::phase::{Phase, Rotor};
use onboard_core::scan::ScanStrategy;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use std::path::Path;

/// A mission with its sky.
#[derive(Debug)]
pub struct World {
    /// The files that the mission names and that can be read, with their digests.
    pub files: Vec<FileDigest>,
    /// The mission as read.
    pub mission: Mission,
    /// First instant of the mission.
    pub start: Instant,
    /// Last instant of the mission.
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
    /// [`Failure::Input`] names the file, the source or the time that cannot be used.
    pub fn open(mission: Mission, ephemeris: Option<&Path>) -> Result<Self, Failure> {
        let start = parse_time(mission.span.start.text()).map_err(Failure::input)?;
        let end = start.plus(mission.span.duration);
        let scan = mission.scan_strategy(start).map_err(|e| Failure::internal(format!("{e:?}")))?;
        let kernel = match ephemeris {
            None => Kernel::embedded(),
            Some(path) => Kernel::load(path).map_err(Failure::input)?,
        };
        let trajectory = match &mission.orbit.trajectory {
            TrajectoryKey::L2 => Trajectory::l2(),
            TrajectoryKey::File(file) => {
                Trajectory::load(&mission.path(file).to_string_lossy()).map_err(Failure::input)?
            }
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
            .collect::<Result<Vec<_>, Failure>>()?;
        let circular_sun = circular_sun(&mission, &sky, start)?;
        let files = digests(&mission);
        Ok(Self { files, mission, start, end, scan, sky, targets, avoided, circular_sun })
    }

    /// Keeps only the targets named, in the mission's order; none named keeps all.
    ///
    /// # Errors
    /// [`Failure::Input`] names the target that the mission does not have.
    pub fn keep_targets(&mut self, names: &[String]) -> Result<(), Failure> {
        let known = || self.targets.iter().map(Source::name).collect::<Vec<_>>().join(", ");
        if let Some(name) = names.iter().find(|name| self.target(name).is_none()) {
            return Err(Failure::Input(format!(
                "--target {name} is none of the mission's targets: one of {} is needed (or add it \
                 with --set calibration.targets=...)",
                known()
            )));
        }
        if !names.is_empty() {
            self.targets.retain(|source| names.iter().any(|name| name == source.name()));
        }
        Ok(())
    }

    fn target(&self, name: &str) -> Option<&Source> {
        self.targets.iter().find(|source| source.name() == name)
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

    /// Fits the table of the Sun, the targets and the bodies to avoid over the mission.
    ///
    /// # Errors
    /// [`Failure::Input`] where kernel, trajectory or sources do not cover the mission.
    pub fn tables(&self, options: &FitOptions) -> Result<Tables, Failure> {
        let span = (self.start, self.end);
        let fitted = fit(&self.sky, &self.sources(), span, options).map_err(Failure::input)?;
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
    /// [`Failure::Internal`] where the table has no Sun.
    pub fn sun<'t>(&self, table: EphemerisTable<'t>) -> Result<SunModel<'t>, Failure> {
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
    /// [`Failure::Internal`] where the fit wrote what the core refuses.
    pub fn parse(&self) -> Result<EphemerisTable<'_>, Failure> {
        EphemerisTable::parse(&self.fitted.bytes)
            .map_err(|error| Failure::internal(format!("the fitted table is refused: {error:?}")))
    }
}

/// One body of a table that was fitted for it.
///
/// # Errors
/// [`Failure::Internal`] where it is not there.
pub fn body(table: EphemerisTable<'_>, number: i32) -> Result<BodyTable<'_>, Failure> {
    table.body(number).map_err(|error| Failure::internal(format!("the fitted table: {error:?}")))
}

fn source(mission: &Mission, name: &str) -> Result<Source, Failure> {
    let own = mission.calibration.sources.iter().enumerate().find(|(_, own)| own.name == name);
    match own {
        None => Source::by_name(name).map_err(Failure::input),
        Some((index, own)) => own_source(mission, index, own),
    }
}

fn own_source(mission: &Mission, index: usize, own: &CalibrationSource) -> Result<Source, Failure> {
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
    source.map_err(Failure::input)
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

fn read_text(mission: &Mission, file: &FilePath) -> Result<String, Failure> {
    let path = mission.path(file);
    std::fs::read_to_string(&path).map_err(|error| Failure::file("read", &path, &error))
}

fn circular_sun(mission: &Mission, sky: &Sky, start: Instant) -> Result<Option<Rotor>, Failure> {
    let needs_real = mission.orbit.start_longitude_deg.is_none()
        && mission.orbit.circular_sun(Phase::ZERO).is_some();
    let real = if needs_real {
        let anti_sun = sky.sun_to_spacecraft(start).map_err(Failure::input)?;
        Phase::from_radians(anti_sun.longitude_rad())
    } else {
        Phase::ZERO
    };
    Ok(mission.orbit.circular_sun(real))
}
