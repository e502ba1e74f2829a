//! Where the spacecraft is.
//!
//! A [`Trajectory`] answers with the spacecraft's barycentric state, km and km/s, ICRF axes: at the
//! Sun-Earth L2 point, from an SPK file, or from a CCSDS OEM file.
//!
//! Method: `r_L2 = r_Sun + (1 + g)(r_EMB - r_Sun)`, velocity likewise, with g the root of the
//! collinear quintic for the mass ratio Sun/(Earth + Moon) = 328900.56. Files give the state from
//! their centre, and the kernel adds the centre's.
//!
//! Limits: L2 is the point itself, not an orbit about it, which strays to 0.3 deg as seen from the
//! Sun. EME2000 is taken as ICRF (23 mas at most). `tests/trajectory.rs` compares with SPICE.
//!
//! # Example
//! ```
//! use ephem::kernel::{EARTH, Kernel};
//! use ephem::time::parse_time;
//! use ephem::trajectory::Trajectory;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let oem = "CCSDS_OEM_VERS = 2.0\nMETA_START\nCENTER_NAME = EARTH\nREF_FRAME = ICRF\n\
//!            TIME_SYSTEM = TDB\nSTART_TIME = 2032-04-01T00:00:00\nSTOP_TIME = 2032-04-02T00:00:00\n\
//!            META_STOP\n2032-04-01T00:00:00 1500000 0 0 0 0.5 0\n\
//!            2032-04-02T00:00:00 1500000 43200 0 0 0.5 0\n";
//! let kernel = Kernel::embedded();
//! let noon = parse_time("2032-04-01T12:00:00 TDB")?;
//! let earth = kernel.state(EARTH, noon)?.position_km;
//! let seen = Trajectory::from_oem("halo.oem", oem)?.state(&kernel, noon)?.position_km - earth;
//! assert!((seen.y - 21_600.0).abs() < 1e-6);
//! let l2 = Trajectory::l2().state(&kernel, noon)?.position_km - earth;
//! assert!((1.4e6..1.6e6).contains(&l2.norm()));
//! # Ok(())
//! # }
//! ```

use crate::kernel::{
    EARTH_MOON_BARYCENTER, Kernel, SOLAR_SYSTEM_BARYCENTER, SUN, State, StateError, file_name,
    inside, link_state,
};
use crate::oem::{self, OemSegment};
use crate::spk::{Spk, SpkError};
use crate::time::{from_tdb_seconds, tdb_seconds};
use nalgebra::Vector3;
use onboard_core::time::Instant;
use std::path::Path;
use thiserror::Error;

pub use crate::oem::OemError;

/// Distance of L2 beyond the Earth-Moon barycentre over the latter's from the Sun.
pub const L2_FRACTION: f64 = 0.010_078_240_4;

/// Bodies of DE440, which are not spacecraft.
const PLANETARY: [i32; 15] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 199, 299, 301, 399];
/// Longest chain of segments from the spacecraft to a body of the kernel.
const LONGEST_CHAIN: usize = 8;

/// Why a trajectory file cannot be used.
#[derive(Debug, Error)]
pub enum TrajectoryError {
    /// The file cannot be read.
    #[error("cannot read the trajectory '{path}': {source}")]
    Read {
        /// The path as given.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Neither an SPK nor an OEM.
    #[error(
        "the trajectory '{name}' is neither an SPK (which begins with 'DAF/SPK') nor a CCSDS OEM (in KVN, which begins with 'CCSDS_OEM_VERS', or in XML, whose element 'oem' has that id)"
    )]
    Kind {
        /// File name.
        name: String,
    },
    /// The SPK file is damaged.
    #[error("the trajectory '{name}' {fault}")]
    Spk {
        /// File name.
        name: String,
        /// What is wrong.
        fault: SpkError,
    },
    /// The OEM file is wrong.
    #[error("the trajectory '{name}', {fault}")]
    Oem {
        /// File name.
        name: String,
        /// What is wrong.
        fault: OemError,
    },
    /// The SPK file does not say which body is the spacecraft.
    #[error(
        "the trajectory '{name}' {}: it holds {holds:?}; choose with '{name}:ID'",
        if asked.is_some() { "lacks the spacecraft asked for" } else { "does not hold exactly one spacecraft" }
    )]
    Spacecraft {
        /// File name.
        name: String,
        /// The number asked for.
        asked: Option<i32>,
        /// NAIF numbers in the file.
        holds: Vec<i32>,
    },
    /// The spacecraft's segments cannot be evaluated.
    #[error("the trajectory '{name}': {fault}")]
    State {
        /// File name.
        name: String,
        /// Why.
        fault: StateError,
    },
}

/// The spacecraft's path.
#[derive(Debug, Clone)]
pub struct Trajectory {
    name: String,
    course: Course,
}

#[derive(Debug, Clone)]
enum Course {
    L2,
    Spk { spk: Spk, spacecraft: i32 },
    Oem(Vec<OemSegment>),
}

impl Trajectory {
    /// The Sun-Earth L2 point.
    #[must_use]
    pub fn l2() -> Self {
        Self { name: "l2".to_owned(), course: Course::L2 }
    }

    /// The trajectory in an SPK or OEM file; `path.bsp:-123` chooses a spacecraft by its number.
    ///
    /// # Errors
    /// [`TrajectoryError`].
    pub fn load(path: &str) -> Result<Self, TrajectoryError> {
        let (file, spacecraft) = match path.rsplit_once(':') {
            Some((file, id)) if !Path::new(path).exists() => match id.parse() {
                Ok(id) => (file, Some(id)),
                Err(_) => (path, None),
            },
            _ => (path, None),
        };
        let bytes = std::fs::read(file)
            .map_err(|source| TrajectoryError::Read { path: file.to_owned(), source })?;
        let name = file_name(Path::new(file));
        if bytes.starts_with(b"DAF/") || bytes.starts_with(b"NAIF/DAF") {
            return Self::from_spk(&name, &bytes, spacecraft);
        }
        match std::str::from_utf8(&bytes) {
            Ok(text) if text.contains("CCSDS_OEM_VERS") && spacecraft.is_none() => {
                Self::from_oem(&name, text)
            }
            _ => Err(TrajectoryError::Kind { name }),
        }
    }

    /// The trajectory of a spacecraft in the bytes of an SPK file called `name`.
    ///
    /// Without a number, the one body that DE440 does not hold; of several, the only negative one.
    ///
    /// # Errors
    /// [`TrajectoryError`].
    pub fn from_spk(
        name: &str,
        bytes: &[u8],
        spacecraft: Option<i32>,
    ) -> Result<Self, TrajectoryError> {
        let spk = Spk::parse(bytes)
            .map_err(|fault| TrajectoryError::Spk { name: name.to_owned(), fault })?;
        let holds: Vec<i32> = spk.bodies().collect();
        let own: Vec<i32> = holds.iter().copied().filter(|b| !PLANETARY.contains(b)).collect();
        let negative: Vec<i32> = own.iter().copied().filter(|body| *body < 0).collect();
        let chosen = match (spacecraft, own.as_slice(), negative.as_slice()) {
            (Some(asked), ..) => holds.contains(&asked).then_some(asked),
            (None, [only], _) | (None, _, [only]) => Some(*only),
            _ => None,
        };
        let Some(spacecraft) = chosen else {
            return Err(TrajectoryError::Spacecraft {
                name: name.to_owned(),
                asked: spacecraft,
                holds,
            });
        };
        // Every segment must be of a type that can be evaluated: try each at its start.
        for edge in spk.segment_edges(spacecraft) {
            link_state(&spk, spacecraft, edge)
                .map_err(|fault| TrajectoryError::State { name: name.to_owned(), fault })?;
        }
        Ok(Self { name: name.to_owned(), course: Course::Spk { spk, spacecraft } })
    }

    /// The trajectory in the text of an OEM file called `name`.
    ///
    /// # Errors
    /// [`TrajectoryError::Oem`] with the line, key, value and what would be legal.
    pub fn from_oem(name: &str, text: &str) -> Result<Self, TrajectoryError> {
        let segments = oem::parse(text)
            .map_err(|fault| TrajectoryError::Oem { name: name.to_owned(), fault })?;
        Ok(Self { name: name.to_owned(), course: Course::Oem(segments) })
    }

    /// `l2`, or the file's name without folders.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Barycentric state of the spacecraft.
    ///
    /// # Errors
    /// [`StateError`]: outside the trajectory or the kernel, or a centre the kernel lacks.
    pub fn state(&self, kernel: &Kernel, at: Instant) -> Result<State, StateError> {
        let tdb_s = tdb_seconds(at);
        match &self.course {
            Course::L2 => {
                let sun = kernel.state_at(SUN, tdb_s)?;
                let barycenter = kernel.state_at(EARTH_MOON_BARYCENTER, tdb_s)?;
                let beyond = |sun: Vector3<f64>, earth: Vector3<f64>| {
                    sun + (earth - sun) * (1.0 + L2_FRACTION)
                };
                Ok(State {
                    position_km: beyond(sun.position_km, barycenter.position_km),
                    velocity_km_s: beyond(sun.velocity_km_s, barycenter.velocity_km_s),
                })
            }
            Course::Spk { spk, spacecraft } => spk_state(spk, *spacecraft, kernel, tdb_s),
            Course::Oem(segments) => {
                // Where two segments meet, the later one counts.
                let after = segments.partition_point(|segment| segment.start <= at);
                let segment =
                    after.checked_sub(1).and_then(|i| segments.get(i)).filter(|s| at <= s.stop);
                let Some(segment) = segment else {
                    let (start, end) = self.coverage().unwrap_or((at, at));
                    return Err(StateError::OutOfTrajectory { at, start, end });
                };
                let center = kernel.state_at(segment.center, tdb_s)?;
                let (position_km, velocity_km_s) = segment.state(tdb_s);
                Ok(State {
                    position_km: center.position_km + position_km,
                    velocity_km_s: center.velocity_km_s + velocity_km_s,
                })
            }
        }
    }

    /// First and last instant of the file; `None` for L2, which goes as far as the kernel.
    #[must_use]
    pub fn coverage(&self) -> Option<(Instant, Instant)> {
        match &self.course {
            Course::L2 => None,
            Course::Spk { spk, spacecraft } => {
                spk.span(*spacecraft).map(|(start_s, end_s, _)| inside(start_s, end_s))
            }
            Course::Oem(segments) => Some((segments.first()?.start, segments.last()?.stop)),
        }
    }

    /// Instants inside the coverage where a burn or a segment's boundary breaks the smoothness.
    #[must_use]
    pub fn breaks(&self) -> Vec<Instant> {
        let mut edges: Vec<Instant> = match &self.course {
            Course::L2 => Vec::new(),
            Course::Spk { spk, spacecraft } => {
                spk.segment_edges(*spacecraft).into_iter().map(from_tdb_seconds).collect()
            }
            Course::Oem(segments) => segments.iter().flat_map(|s| [s.start, s.stop]).collect(),
        };
        let (first, last) = (edges.first().copied(), edges.last().copied());
        edges.retain(|edge| Some(*edge) > first && Some(*edge) < last);
        edges.dedup();
        edges
    }

    /// Instants where the interpolation of tabulated states bends or jumps.
    pub(crate) fn joints(&self) -> Vec<Instant> {
        match &self.course {
            Course::L2 => Vec::new(),
            Course::Spk { spk, spacecraft } => {
                spk.joint_times(*spacecraft).into_iter().map(from_tdb_seconds).collect()
            }
            Course::Oem(segments) => segments.iter().flat_map(OemSegment::joints).collect(),
        }
    }
}

/// Chains an SPK's segments until a body that the kernel holds.
fn spk_state(spk: &Spk, spacecraft: i32, kernel: &Kernel, tdb_s: f64) -> Result<State, StateError> {
    let (mut position, mut velocity) = (Vector3::zeros(), Vector3::zeros());
    let mut current = spacecraft;
    for _ in 0..LONGEST_CHAIN {
        let (step, center) = link_state(spk, current, tdb_s)?;
        position += step.0;
        velocity += step.1;
        if center == SOLAR_SYSTEM_BARYCENTER || kernel.holds(center) {
            let center = kernel.state_at(center, tdb_s)?;
            return Ok(State {
                position_km: center.position_km + position,
                velocity_km_s: center.velocity_km_s + velocity,
            });
        }
        current = center;
    }
    Err(StateError::Chain { body: spacecraft })
}
