//! Where is the spacecraft, and whence and how are directions seen.
//!
//! Signs: the circular Sun's longitude is that of the anti-Sun direction, ecliptic of J2000, and
//! grows by 360 deg in 365.25 d.
//!
//! Limits: a trajectory is named here and read where ephemerides are.
//!
//! # Example
//! Directions seen from the Earth's centre, and a Sun that turns uniformly from longitude 90 deg:
//! ```
//! use mission::orbit::Observer;
//! use mission::{Mission, Override};
//! use onboard_core::phase::Phase;
//!
//! let keys = ["orbit.observer=earth", "orbit.sun=circular", "orbit.start_longitude_deg=90"];
//! let set = keys.map(Override::set).into_iter().collect::<Result<Vec<_>, _>>()?;
//! let orbit = Mission::load("litebird", &set)?.orbit;
//! assert_eq!(orbit.observer, Observer::Earth);
//! let sun = orbit.circular_sun(Phase::ZERO).ok_or("the ephemeris's Sun")?;
//! assert_eq!(sun.start, Phase::from_bits(1 << 62));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::file_path::FilePath;
use crate::number::Number;
use crate::reading::canon::toml_string;
use crate::reading::section::Section;
use crate::rounding;
use crate::scan::{PHASE, phase_of_degrees};
use num_rational::BigRational;
use onboard_core::phase::{Phase, Rotor, TurnRate};

/// Where the Sun is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sun {
    /// Kernel and trajectory.
    Ephemeris,
    /// A uniform motion in longitude.
    Circular,
}

/// The spacecraft's trajectory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Trajectory {
    /// The Sun-Earth L2 point.
    L2,
    /// An SPK or a CCSDS OEM.
    File(FilePath),
}

/// Whence targets are seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Observer {
    /// The trajectory.
    Spacecraft,
    /// The Earth's centre.
    Earth,
    /// The Sun's centre.
    Sun,
}

/// The orbit and how it is used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Orbit {
    /// The Sun model.
    pub sun: Sun,
    /// Anti-Sun longitude of the circular model at the start; `None` is the real one.
    pub start_longitude_deg: Option<Number>,
    /// The spacecraft's trajectory.
    pub trajectory: Trajectory,
    /// Whence targets are seen.
    pub observer: Observer,
    /// Whether light time and stellar aberration are applied.
    pub aberration: bool,
}

/// Seconds in which the circular Sun turns once: 365.25 d.
pub const CIRCULAR_YEAR_S: i64 = 31_557_600;

impl Orbit {
    pub(crate) fn read(section: &mut Section<'_>) -> Self {
        let suns = [("ephemeris", Sun::Ephemeris), ("circular", Sun::Circular)];
        let observers = [
            ("spacecraft", Observer::Spacecraft),
            ("earth", Observer::Earth),
            ("sun", Observer::Sun),
        ];
        Self {
            sun: section.choice("sun", &suns).unwrap_or(Sun::Ephemeris),
            start_longitude_deg: section.optional_number("start_longitude_deg", &PHASE),
            trajectory: trajectory(section),
            observer: section.choice("observer", &observers).unwrap_or(Observer::Spacecraft),
            aberration: section.truth("aberration", true),
        }
    }

    /// The circular model's anti-Sun longitude, or `None` where the Sun is the ephemeris's.
    ///
    /// `real_longitude` is the anti-Sun longitude at the start, for a mission that gives none.
    #[must_use]
    pub fn circular_sun(&self, real_longitude: Phase) -> Option<Rotor> {
        let year = BigRational::from_integer(CIRCULAR_YEAR_S.into());
        let rate = rounding::turn_rate_of_period(&year, 1).unwrap_or(TurnRate::from_bits(0));
        let start = self.start_longitude_deg.as_ref().map_or(real_longitude, phase_of_degrees);
        (self.sun == Sun::Circular).then_some(Rotor { rate, start })
    }
}

fn trajectory(section: &mut Section<'_>) -> Trajectory {
    let node = section.find("trajectory");
    let file = node.filter(|node| Section::text_of(node) != Some("l2")).map(|node| {
        let file = FilePath::of(node);
        if file.is_none() {
            section.not_legal("trajectory", node, &"\"l2\" or the path of an SPK or OEM file");
        }
        file
    });
    let trajectory = file.flatten().map_or(Trajectory::L2, Trajectory::File);
    let text = match &trajectory {
        Trajectory::L2 => "l2",
        Trajectory::File(file) => file.text(),
    };
    section.record("trajectory", toml_string(text));
    trajectory
}
