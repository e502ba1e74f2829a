//! What can be a target.
//!
//! A [`Source`] has a name, a body number for onboard tables, and a place: a body of the kernel, a
//! fixed direction, or a table of the user's own.
//!
//! Numbers: NAIF's for planets, Moon and Earth; [`SUN_AS_TARGET`] for the Sun, because the tables
//! keep the Sun's own number for the geometric Sun-to-spacecraft vector; from
//! `FIRST_USER_BODY` the built-in calibrators, and from [`FIRST_OWN_SOURCE`] the mission's sources.
//!
//! | calibrator | ICRS, J2000 | source |
//! |---|---|---|
//! | `tau_a` | 05 34 31.94 +22 00 52.2 | NED, Crab nebula: at the pulsar |
//! | `cas_a` | 23 23 24.0 +58 48 54 | SIMBAD, Cassiopeia A: centre of the shell |
//! | `cen_a` | 13 25 27.6152 -43 01 08.805 | Ma et al. 1998 (ICRF): the radio core of NGC 5128 |
//!
//! Limits: `mercury` to `neptune` are the system barycentres 1, 2 and 4 to 8. Tau A, Cas A and Cen A
//! are extended by arcminutes (Cen A's lobes by degrees); fixed directions have no proper motion.
//!
//! # Example
//! ```
//! use ephem::source::{FIRST_OWN_SOURCE, Source, SourceError, names};
//!
//! assert!(names().any(|name| name == "tau_a"));
//! let jupiter = Source::by_name("jupiter")?;
//! assert_eq!(jupiter.body(), 5);
//! let own = Source::at_icrs("orion_a", 0, 83.82, -5.39)?;
//! assert_eq!((own.name(), own.body()), ("orion_a", FIRST_OWN_SOURCE));
//! let refusal = Source::at_ecliptic("pole", 1, 0.0, 91.0).map(|_| ()).unwrap_err();
//! assert_eq!(
//!     refusal.to_string(),
//!     "source 'pole': ecliptic_latitude_deg is 91 deg; legal is -90 to 90"
//! );
//! # Ok::<(), SourceError>(())
//! ```

use crate::ecliptic::direction_from_icrf;
use crate::kernel::{EARTH, MOON, SUN};
use onboard_core::direction::Direction;
use onboard_core::ephemeris::FIRST_USER_BODY;
use onboard_core::frame::{Ecliptic, Icrf};
use thiserror::Error;

pub use crate::direction_table::{DirectionTable, TableError};

/// Body number of the Sun seen as a target.
pub const SUN_AS_TARGET: i32 = FIRST_USER_BODY - 1;
/// Body number of the mission's first own source.
pub const FIRST_OWN_SOURCE: i32 = FIRST_USER_BODY + 100;

const BODIES: [(&str, i32); 10] = [
    ("mercury", 1),
    ("venus", 2),
    ("mars", 4),
    ("jupiter", 5),
    ("saturn", 6),
    ("uranus", 7),
    ("neptune", 8),
    ("moon", MOON),
    ("earth", EARTH),
    ("sun", SUN),
];

/// Name, right ascension in hours, minutes, seconds, declination in degrees, minutes, seconds (all
/// of the declination's sign).
type Entry = (&'static str, [f64; 3], [f64; 3]);
const CALIBRATORS: [Entry; 3] = [
    ("tau_a", [5.0, 34.0, 31.94], [22.0, 0.0, 52.2]),
    ("cas_a", [23.0, 23.0, 24.0], [58.0, 48.0, 54.0]),
    ("cen_a", [13.0, 25.0, 27.6152], [-43.0, -1.0, -8.805]),
];

/// Why a source is refused.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SourceError {
    /// No built-in source of that name.
    #[error("unknown target '{0}'; legal are {names}", names = names().collect::<Vec<_>>().join(", "))]
    UnknownName(String),
    /// A coordinate lies outside its range.
    #[error("source '{name}': {what} is {value} deg; legal is {legal}")]
    Coordinate {
        /// The source.
        name: String,
        /// Which coordinate.
        what: &'static str,
        /// Its value in degrees.
        value: f64,
        /// What it may be.
        legal: &'static str,
    },
    /// Too many sources for the numbers.
    #[error("source '{name}' is number {index}; legal is below 1000000")]
    Index {
        /// The source.
        name: String,
        /// Its index.
        index: usize,
    },
    /// Its direction table is wrong.
    #[error("source '{name}': {fault}")]
    Table {
        /// The source.
        name: String,
        /// What is wrong.
        fault: TableError,
    },
}

/// Where a source is.
#[derive(Debug, Clone)]
pub enum Place {
    /// A body of the kernel, by NAIF number.
    SolarSystem(i32),
    /// A catalogue direction at rest with the solar system barycentre.
    Fixed(Direction<Ecliptic>),
    /// Directions as the observer sees them, tabulated against the scan clock.
    Table(DirectionTable),
}

/// A target.
#[derive(Debug, Clone)]
pub struct Source {
    name: String,
    body: i32,
    place: Place,
}

/// Names of the built-in sources.
pub fn names() -> impl Iterator<Item = &'static str> {
    let bodies = BODIES.iter().map(|(name, _)| *name);
    bodies.chain(CALIBRATORS.iter().map(|(name, ..)| *name))
}

/// A source's name as pictures and texts have it: built-in ones with capitals, `Tau A`; others as they
/// are.
#[must_use]
pub fn title(name: &str) -> String {
    if !names().any(|known| known == name) {
        return name.to_owned();
    }
    let capital = |word: &str| {
        let mut letters = word.chars();
        let first = letters.next().map(|it| it.to_ascii_uppercase());
        first.into_iter().chain(letters).collect::<String>()
    };
    name.split('_').map(capital).collect::<Vec<_>>().join(" ")
}

impl Source {
    /// A built-in source: a planet, `moon`, `earth`, `sun`, `tau_a`, `cas_a`, `cen_a`.
    ///
    /// # Errors
    /// [`SourceError::UnknownName`], which lists the legal names.
    pub fn by_name(name: &str) -> Result<Self, SourceError> {
        if let Some((name, naif)) = BODIES.iter().find(|(known, _)| *known == name) {
            let body = if *naif == SUN { SUN_AS_TARGET } else { *naif };
            return Ok(Self { name: (*name).to_owned(), body, place: Place::SolarSystem(*naif) });
        }
        let known = (FIRST_USER_BODY..).zip(CALIBRATORS).find(|(_, (known, ..))| *known == name);
        let Some((body, (name, [h, m, s], [degrees, minutes, seconds]))) = known else {
            return Err(SourceError::UnknownName(name.to_owned()));
        };
        let hours = h + m / 60.0 + s / 3600.0;
        let declination = degrees + minutes / 60.0 + seconds / 3600.0;
        let direction = from_icrs((15.0 * hours).to_radians(), declination.to_radians());
        Ok(Self { name: name.to_owned(), body, place: Place::Fixed(direction) })
    }

    /// The mission's own source number `index`, at ecliptic coordinates (J2000) in degrees.
    ///
    /// # Errors
    /// [`SourceError::Coordinate`] or [`SourceError::Index`].
    pub fn at_ecliptic(
        name: &str,
        index: usize,
        longitude_deg: f64,
        latitude_deg: f64,
    ) -> Result<Self, SourceError> {
        check(name, "ecliptic_longitude_deg", longitude_deg, 360.0)?;
        check(name, "ecliptic_latitude_deg", latitude_deg, 90.0)?;
        let direction = Direction::from_longitude_latitude(
            longitude_deg.to_radians(),
            latitude_deg.to_radians(),
        );
        Self::own(name, index, Place::Fixed(direction))
    }

    /// The mission's own source number `index`, at ICRS coordinates in degrees.
    ///
    /// # Errors
    /// [`SourceError::Coordinate`] or [`SourceError::Index`].
    pub fn at_icrs(
        name: &str,
        index: usize,
        right_ascension_deg: f64,
        declination_deg: f64,
    ) -> Result<Self, SourceError> {
        check(name, "right_ascension_deg", right_ascension_deg, 360.0)?;
        check(name, "declination_deg", declination_deg, 90.0)?;
        let direction = from_icrs(right_ascension_deg.to_radians(), declination_deg.to_radians());
        Self::own(name, index, Place::Fixed(direction))
    }

    /// The mission's own source number `index`, from the text of a CSV file of directions.
    ///
    /// # Errors
    /// [`SourceError::Table`] or [`SourceError::Index`].
    pub fn from_csv(name: &str, index: usize, text: &str) -> Result<Self, SourceError> {
        let table = DirectionTable::from_csv(text)
            .map_err(|fault| SourceError::Table { name: name.to_owned(), fault })?;
        Self::own(name, index, Place::Table(table))
    }

    fn own(name: &str, index: usize, place: Place) -> Result<Self, SourceError> {
        let body = i32::try_from(index)
            .ok()
            .filter(|index| *index < 1_000_000)
            .map(|index| FIRST_OWN_SOURCE + index)
            .ok_or_else(|| SourceError::Index { name: name.to_owned(), index })?;
        Ok(Self { name: name.to_owned(), body, place })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its number in onboard tables.
    #[must_use]
    pub const fn body(&self) -> i32 {
        self.body
    }

    /// Where it is.
    #[must_use]
    pub const fn place(&self) -> &Place {
        &self.place
    }
}

fn check(name: &str, what: &'static str, value: f64, limit: f64) -> Result<(), SourceError> {
    if value.abs() <= limit {
        return Ok(());
    }
    let legal = if limit > 90.0 { "-360 to 360" } else { "-90 to 90" };
    Err(SourceError::Coordinate { name: name.to_owned(), what, value, legal })
}

fn from_icrs(right_ascension_rad: f64, declination_rad: f64) -> Direction<Ecliptic> {
    let direction =
        Direction::<Icrf>::from_longitude_latitude(right_ascension_rad, declination_rad);
    // A unit vector has a direction, so the fallback is never taken.
    direction_from_icrf(direction.xyz().into()).unwrap_or(Direction::Z)
}
