//! Where the Sun and the planets are.
//!
//! A [`Kernel`] answers with barycentric states: position in km, velocity in km/s, ICRF axes (those
//! of DE440), at TDB. It is the embedded excerpt of DE440, 2024 to 2046, or any SPK file.
//!
//! Method: segments are chained from the body to the solar system barycentre, each evaluated by
//! ANISE; DE440 is \[Park2021\]. A file is checked before use: structure, counts, every number, that
//! the records of the bodies meet, that each body has a centre that it can have and is about as far
//! away as it should be.
//!
//! Limits: bodies 4 to 8 are system barycentres. Low bits of a coefficient may be wrong unseen: up
//! to 1e-10 of the distance (`tests/bad_kernel.rs`); the SHA-256 tells. Segments of one body are
//! taken to leave no gap when coverage is stated; a gap is found on use.
//!
//! # Example
//! ```
//! use ephem::kernel::{EARTH, Kernel, MOON, SUN};
//! use ephem::time::parse_time;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let kernel = Kernel::embedded();
//! let at = parse_time("2032-04-01T00:00:00 TDB")?;
//! let earth = kernel.state(EARTH, at)?;
//! let from_sun = earth.position_km - kernel.state(SUN, at)?.position_km;
//! // The Earth passes its mean distance of 1 au in the first days of April.
//! assert!((from_sun.norm() / 149_597_870.7 - 1.0).abs() < 1e-3);
//! assert!((earth.velocity_km_s.norm() - 29.8).abs() < 0.2);
//! let (start, end) = kernel.coverage(MOON).ok_or("no Moon")?;
//! assert!(start < at && at < end);
//! # Ok(())
//! # }
//! ```

mod bodies;
mod error;

pub use crate::daf::{DafError, FilePart};
pub use crate::spk::{LegalNumber, SpkError};
pub use bodies::{EARTH, EARTH_MOON_BARYCENTER, MOON, SOLAR_SYSTEM_BARYCENTER, SUN, body_name};
pub use error::{KernelError, StateError};

use crate::interpolation::PosVel;
use crate::spk::{Link, Spk, Unsupported};
use crate::time::{from_tdb_seconds, tdb_seconds};
use bodies::LONGEST_CHAIN;
use nalgebra::Vector3;
use onboard_core::time::{Duration, Instant};
use sha2::{Digest, Sha256};
use std::path::Path;

const EMBEDDED: &[u8] = include_bytes!("../data/de440-2024-2046.bsp");
const EMBEDDED_NAME: &str = "de440-2024-2046.bsp";
const EMBEDDED_SHA256: &str = "e60c55e845569ad8c696009f6b22f8eb08a0c73ddbb31d29d3fd773952e024a3";

/// Bodies whose records must meet for a loaded kernel to be used.
const CHECKED_BODIES: [i32; 11] = [1, 2, 3, 4, 5, 6, 7, 8, SUN, MOON, EARTH];
/// Body, centre, and the range of their distance in km: a few per cent beyond perihelion and
/// aphelion, so that a body under a wrong number or centre shows.
const DISTANCES_KM: [(i32, i32, f64, f64); 12] = [
    (1, SUN, 4.4e7, 7.2e7),
    (2, SUN, 1.05e8, 1.12e8),
    (EARTH_MOON_BARYCENTER, SUN, 1.43e8, 1.57e8),
    (4, SUN, 2.0e8, 2.55e8),
    (5, SUN, 7.2e8, 8.4e8),
    (6, SUN, 1.3e9, 1.56e9),
    (7, SUN, 2.65e9, 3.1e9),
    (8, SUN, 4.35e9, 4.65e9),
    (9, SUN, 4.2e9, 7.6e9),
    (SUN, SOLAR_SYSTEM_BARYCENTER, 0.0, 2.5e6),
    (MOON, EARTH, 3.4e5, 4.2e5),
    (EARTH, EARTH_MOON_BARYCENTER, 4.1e3, 5.1e3),
];
/// Bodies whose segments have a centre that is one of these, in every ephemeris that is in use.
const CENTERS: [(i32, &[i32]); 14] = [
    (1, &[0, SUN]),
    (2, &[0, SUN]),
    (EARTH_MOON_BARYCENTER, &[0, SUN]),
    (4, &[0, SUN]),
    (5, &[0, SUN]),
    (6, &[0, SUN]),
    (7, &[0, SUN]),
    (8, &[0, SUN]),
    (9, &[0, SUN]),
    (SUN, &[0]),
    (199, &[1, 0, SUN]),
    (299, &[2, 0, SUN]),
    (MOON, &[EARTH_MOON_BARYCENTER, EARTH, 0, SUN]),
    (EARTH, &[EARTH_MOON_BARYCENTER, MOON, 0, SUN]),
];
/// Coverage is stated this much narrower, for the rounding of TDB seconds.
const EDGE: Duration = Duration::from_ns(1_000);

/// A position in km and a velocity in km/s, from the solar system barycentre, ICRF axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Position in km.
    pub position_km: Vector3<f64>,
    /// Velocity in km/s.
    pub velocity_km_s: Vector3<f64>,
}

impl From<PosVel> for State {
    fn from((position_km, velocity_km_s): PosVel) -> Self {
        Self { position_km, velocity_km_s }
    }
}

/// A planetary ephemeris.
#[derive(Debug, Clone)]
pub struct Kernel {
    name: String,
    sha256: String,
    spk: Spk,
}

impl Kernel {
    /// The embedded excerpt of DE440, 2024-01-01 to 2046-01-01 TDB.
    ///
    /// # Panics
    /// Never: the bytes are part of the program, and a test parses them.
    #[must_use]
    pub fn embedded() -> Self {
        let spk = Spk::parse(EMBEDDED).expect("the embedded kernel is sound");
        Self { name: EMBEDDED_NAME.to_owned(), sha256: EMBEDDED_SHA256.to_owned(), spk }
    }

    /// The kernel in an SPK file.
    ///
    /// # Errors
    /// [`KernelError`]: unreadable, not an SPK, truncated, damaged, or without the Sun
    /// or the Earth-Moon barycentre.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, KernelError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path)
            .map_err(|source| KernelError::Read { path: path.display().to_string(), source })?;
        Self::from_bytes(&file_name(path), &bytes)
    }

    /// The kernel in the bytes of an SPK file called `name`.
    ///
    /// # Errors
    /// [`KernelError`], as [`Kernel::load`].
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, KernelError> {
        let refuse = |fault| KernelError::Spk { name: name.to_owned(), fault };
        let spk = Spk::parse(bytes).map_err(refuse)?;
        for body in [SUN, EARTH_MOON_BARYCENTER] {
            if spk.span(body).is_none() {
                let holds = spk.bodies().collect();
                return Err(KernelError::MissingBody { name: name.to_owned(), body, holds });
            }
        }
        for (body, legal) in CENTERS {
            if let Some(found) = spk.centers(body).find(|it| !legal.contains(it)) {
                let name = name.to_owned();
                return Err(KernelError::Center { name, body, found, legal });
            }
        }
        spk.check_joints(&CHECKED_BODIES).map_err(refuse)?;
        let kernel = Self { name: name.to_owned(), sha256: sha256_hex(bytes), spk };
        kernel.check_distances()?;
        Ok(kernel)
    }

    /// Checks at three instants that the bodies are about where they belong.
    fn check_distances(&self) -> Result<(), KernelError> {
        let state = |body: i32, at: Instant| {
            self.state(body, at)
                .map_err(|fault| KernelError::State { name: self.name.clone(), fault })
        };
        for (body, center, nearest_km, farthest_km) in DISTANCES_KM {
            if !(self.holds(body) && self.holds(center)) {
                continue;
            }
            let name = || self.name.clone();
            let known = |body| {
                let chain = KernelError::State { name: name(), fault: StateError::Chain { body } };
                self.coverage(body).ok_or(chain)
            };
            // Each body is asked only where both are known.
            let (start, end) = known(body)?;
            let barycenter = center == SOLAR_SYSTEM_BARYCENTER;
            let (from, until) = if barycenter { (start, end) } else { known(center)? };
            let (start, end) = (start.max(from), end.min(until));
            if start > end {
                continue;
            }
            let middle = start.plus(Duration::from_ns(end.since(start).ns() / 2));
            for at in [start, middle, end] {
                let offset = state(body, at)?.position_km - state(center, at)?.position_km;
                let found_km = offset.norm();
                if !(nearest_km..=farthest_km).contains(&found_km) {
                    let name = name();
                    return Err(KernelError::Implausible {
                        name,
                        body,
                        center,
                        at,
                        found_km,
                        nearest_km,
                        farthest_km,
                    });
                }
            }
        }
        Ok(())
    }

    /// File name, without folders.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// SHA-256 of the file in lower-case hexadecimal.
    #[must_use]
    pub fn sha256(&self) -> &str {
        &self.sha256
    }

    /// Whether the kernel has segments for a body.
    #[must_use]
    pub fn holds(&self, body: i32) -> bool {
        body == SOLAR_SYSTEM_BARYCENTER || self.spk.span(body).is_some()
    }

    /// First and last instant at which a body's barycentric state is known, a microsecond inside.
    #[must_use]
    pub fn coverage(&self, body: i32) -> Option<(Instant, Instant)> {
        let (mut start_s, mut end_s, mut center) = self.spk.span(body)?;
        for _ in 0..LONGEST_CHAIN {
            if center == SOLAR_SYSTEM_BARYCENTER {
                return Some(inside(start_s, end_s));
            }
            let (start, end, next) = self.spk.span(center)?;
            (start_s, end_s, center) = (start_s.max(start), end_s.min(end), next);
        }
        None
    }

    /// Barycentric state of a body.
    ///
    /// # Errors
    /// [`StateError`]: no such body, or not at that time.
    pub fn state(&self, body: i32, at: Instant) -> Result<State, StateError> {
        self.state_at(body, tdb_seconds(at))
    }

    /// Barycentric state of a body at TDB seconds since 2000-01-01T12:00:00 TDB.
    ///
    /// # Errors
    /// [`StateError`]: no such body, or not at that time.
    pub fn state_at(&self, body: i32, tdb_s: f64) -> Result<State, StateError> {
        let mut state: PosVel = (Vector3::zeros(), Vector3::zeros());
        let mut current = body;
        for _ in 0..LONGEST_CHAIN {
            if current == SOLAR_SYSTEM_BARYCENTER {
                return Ok(state.into());
            }
            let (step, center) = link_state(&self.spk, current, tdb_s)?;
            state = (state.0 + step.0, state.1 + step.1);
            current = center;
        }
        Err(StateError::Chain { body })
    }
}

/// A segment's state and centre, or why there is none.
pub(crate) fn link_state(spk: &Spk, body: i32, tdb_s: f64) -> Result<(PosVel, i32), StateError> {
    match spk.link(body, tdb_s) {
        Link::State { state, center } => Ok((state, center)),
        Link::NoBody => Err(StateError::NoBody { body }),
        Link::Unsupported(Unsupported::Type(data_type)) => {
            Err(StateError::DataType { body, data_type })
        }
        Link::Unsupported(Unsupported::Frame(frame)) => Err(StateError::Frame { body, frame }),
        Link::OutOfSpan => {
            let (start_s, end_s, _) = spk.span(body).unwrap_or_default();
            let (start, end) = (from_tdb_seconds(start_s), from_tdb_seconds(end_s));
            Err(StateError::OutOfSpan { body, at: from_tdb_seconds(tdb_s), start, end })
        }
    }
}

/// Instants just inside a span of TDB seconds.
pub(crate) fn inside(start_s: f64, end_s: f64) -> (Instant, Instant) {
    (
        from_tdb_seconds(start_s).plus(EDGE),
        from_tdb_seconds(end_s).plus(Duration::from_ns(-EDGE.ns())),
    )
}

/// The last part of a path, as text.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into())
}

fn sha256_hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    Sha256::digest(bytes).iter().fold(String::with_capacity(64), |mut text, byte| {
        // Writing to a String cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::format_tdb;

    #[test]
    fn the_embedded_kernel_is_the_one_described() {
        assert_eq!(sha256_hex(EMBEDDED), EMBEDDED_SHA256);
        let checked = Kernel::from_bytes(EMBEDDED_NAME, EMBEDDED).unwrap();
        assert_eq!(checked.sha256(), Kernel::embedded().sha256());
        assert!(CHECKED_BODIES.iter().all(|body| checked.holds(*body)));
    }

    #[test]
    fn coverage_is_what_can_be_asked() {
        let kernel = Kernel::embedded();
        for body in CHECKED_BODIES {
            let (start, end) = kernel.coverage(body).unwrap();
            assert!(format_tdb(start).starts_with("2024-01-01T00:00:00.0"));
            assert!(format_tdb(end).starts_with("2045-12-31T23:59:59.9"));
            assert!(kernel.state(body, start).is_ok() && kernel.state(body, end).is_ok());
            let before = start.plus(Duration::from_seconds(-1.0));
            assert!(matches!(kernel.state(body, before), Err(StateError::OutOfSpan { .. })));
        }
        assert_eq!(kernel.state_at(9, 9e8), Err(StateError::NoBody { body: 9 }));
        assert_eq!(kernel.coverage(9), None);
    }
}
