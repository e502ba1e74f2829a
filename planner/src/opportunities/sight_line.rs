//! Which lines of sight are asked for: the mission boresight, telescopes, detectors.
//!
//! Without a name it is the mission boresight, evaluated once. A telescope without listed detectors
//! is seen through its field of view, or where it has none through the circle of
//! `calibration.radius_deg`; one with detectors through each of them.

use mission::telescope::{NamedDetector, Telescope};
use mission::{Mission, in_any_case, nearest_first};
use onboard_core::field_of_view::{FieldOfView, FieldOfViewError, FieldShape};
use onboard_core::frame::{Boresight, Detector};
use onboard_core::phase::Rotor;
use onboard_core::rotation::{Rotation, RotationError};
use thiserror::Error;

/// Stands where there is no telescope or no detector.
pub const NONE: &str = "-";

/// Where a field of view is and its size, as bits.
pub type FieldKey = ([u64; 4], [u64; 2]);

/// Why there is no such line of sight.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SightError {
    /// No telescope of that name.
    #[error("telescope {name} is not in the mission: it has {}", nearest_first(name, known))]
    NoSuchTelescope {
        /// The name.
        name: String,
        /// Those that there are.
        known: Vec<String>,
    },
    /// No detector of that name.
    #[error("detector {name} is not in the mission: it has {}", nearest_first(name, known))]
    NoSuchDetector {
        /// The name.
        name: String,
        /// Those that there are, with their telescopes.
        known: Vec<String>,
    },
    /// A name that several telescopes give to a detector.
    #[error("detector {name} is ambiguous: one of {} is needed", matching.join(", "))]
    AmbiguousDetector {
        /// The name.
        name: String,
        /// Those that it may mean.
        matching: Vec<String>,
    },
    /// All detectors of a mission that lists none.
    #[error("the mission lists no detectors")]
    NoDetectors,
    /// The flight core refuses a rotation that was checked.
    #[error("{0:?}")]
    Rotation(RotationError),
    /// The flight core refuses a field of view that was checked.
    #[error("{0:?}")]
    Field(FieldOfViewError),
}

/// One line of sight and what counts as inside.
#[derive(Debug, Clone)]
pub struct SightLine {
    /// Index of the telescope, where there is one.
    pub telescope: Option<usize>,
    /// Telescope's name, or [`NONE`].
    pub telescope_name: String,
    /// Detector's name, or [`NONE`].
    pub detector_name: String,
    /// Its frame in the boresight frame.
    pub rotation: Rotation<Detector, Boresight>,
    /// What counts as inside.
    pub field: FieldOfView,
    /// The half-wave plate before it.
    pub hwp: Option<Rotor>,
    /// Polarisation angle from its x axis in radians; 0 but for a detector.
    pub polarisation_rad: f64,
}

impl SightLine {
    /// `TELESCOPE/DETECTOR`.
    #[must_use]
    pub fn key(&self) -> String {
        format!("{}/{}", self.telescope_name, self.detector_name)
    }

    /// Equal, to the bit, for lines of sight that have the same directions inside at all times.
    #[must_use]
    pub fn field_key(&self) -> FieldKey {
        let (place, shape) = match self.field.shape() {
            FieldShape::Circle(radius) => {
                let [x, y, z] = self.field.centre().xyz();
                ([x, y, z, 0.0], [radius, 0.0])
            }
            FieldShape::Rectangle { width_rad, height_rad } => {
                (self.rotation.to_xyzw(), [width_rad, height_rad])
            }
        };
        (place.map(f64::to_bits), shape.map(f64::to_bits))
    }
}

/// A telescope's frame read as a detector's: z its line of sight, x its x.
fn as_detector<F>(
    frame: Rotation<F, Boresight>,
) -> Result<Rotation<Detector, Boresight>, SightError> {
    Rotation::from_xyzw(frame.to_xyzw()).map_err(SightError::Rotation)
}

fn circle<F>(mission: &Mission, frame: Rotation<F, Boresight>) -> Result<FieldOfView, SightError> {
    FieldOfView::circle(frame, mission.calibration.radius_rad()).map_err(SightError::Field)
}

/// The mission boresight, with the half-wave plate that all telescopes share, if they do.
///
/// # Errors
/// [`SightError::Rotation`] or [`SightError::Field`] where checked values are refused.
pub fn boresight(mission: &Mission) -> Result<SightLine, SightError> {
    let mut plates = mission.telescopes.iter().map(|telescope| telescope.hwp);
    let first = plates.next().flatten();
    let rotation = Rotation::IDENTITY;
    Ok(SightLine {
        telescope: None,
        telescope_name: NONE.to_owned(),
        detector_name: NONE.to_owned(),
        rotation,
        field: circle(mission, rotation)?,
        hwp: if plates.all(|plate| plate == first) { first } else { None },
        polarisation_rad: 0.0,
    })
}

/// A telescope's own line of sight.
fn telescope(mission: &Mission, index: usize, it: &Telescope) -> Result<SightLine, SightError> {
    let rotation = as_detector(it.rotation)?;
    let field = match it.field_of_view {
        Some(field) => field,
        None => circle(mission, rotation)?,
    };
    Ok(SightLine {
        telescope: Some(index),
        telescope_name: it.name.clone(),
        detector_name: NONE.to_owned(),
        rotation,
        field,
        hwp: it.hwp,
        polarisation_rad: 0.0,
    })
}

fn detector(
    mission: &Mission,
    (index, it): (usize, &Telescope),
    named: &NamedDetector,
) -> Result<SightLine, SightError> {
    Ok(SightLine {
        telescope: Some(index),
        telescope_name: it.name.clone(),
        detector_name: named.name.clone(),
        rotation: named.rotation,
        field: circle(mission, named.rotation)?,
        hwp: it.hwp,
        polarisation_rad: named.polarisation_angle_rad,
    })
}

/// All lines of sight of a telescope: its detectors, or itself where none are listed.
fn of_telescope(
    mission: &Mission,
    index: usize,
    it: &Telescope,
) -> Result<Vec<SightLine>, SightError> {
    if it.detectors.is_empty() {
        Ok(vec![telescope(mission, index, it)?])
    } else {
        it.detectors.iter().map(|named| detector(mission, (index, it), named)).collect()
    }
}

/// The lines of sight through which the plan sees targets: all telescopes, in the mission's order.
///
/// # Errors
/// [`SightError::Rotation`] or [`SightError::Field`] where checked values are refused.
pub fn of_plan(mission: &Mission) -> Result<Vec<SightLine>, SightError> {
    let mut lines = Vec::new();
    for (index, it) in mission.telescopes.iter().enumerate() {
        lines.extend(of_telescope(mission, index, it)?);
    }
    Ok(lines)
}

/// The lines of sight of a telescope, a detector or, by `all`, of all detectors.
///
/// # Errors
/// [`SightError`] names what the mission does not have, or what is ambiguous.
pub fn select(
    mission: &Mission,
    telescope_name: Option<&str>,
    detector_name: Option<&str>,
) -> Result<Vec<SightLine>, SightError> {
    if telescope_name.is_none() && detector_name.is_none() {
        return Ok(vec![boresight(mission)?]);
    }
    let mut telescopes: Vec<(usize, &Telescope)> = mission.telescopes.iter().enumerate().collect();
    if let Some(name) = telescope_name {
        let known: Vec<&str> = mission.telescopes.iter().map(|it| it.name.as_str()).collect();
        let found = in_any_case(name, &known);
        telescopes.retain(|(_, it)| Some(it.name.as_str()) == found);
        if telescopes.is_empty() {
            return Err(SightError::NoSuchTelescope {
                name: name.to_owned(),
                known: mission.telescopes.iter().map(|it| it.name.clone()).collect(),
            });
        }
    }
    match detector_name {
        None => telescopes.iter().try_fold(Vec::new(), |mut lines, (index, it)| {
            lines.extend(of_telescope(mission, *index, it)?);
            Ok(lines)
        }),
        Some(all) if all.eq_ignore_ascii_case("all") => {
            let named = named_detectors(&telescopes);
            if named.is_empty() {
                return Err(SightError::NoDetectors);
            }
            named.iter().map(|(of, it)| detector(mission, *of, it)).collect()
        }
        Some(name) => Ok(vec![one_detector(mission, &telescopes, name)?]),
    }
}

type Named<'m> = ((usize, &'m Telescope), &'m NamedDetector);

fn named_detectors<'m>(telescopes: &[(usize, &'m Telescope)]) -> Vec<Named<'m>> {
    let pairs = |of: &(usize, &'m Telescope)| {
        let of = *of;
        of.1.detectors.iter().map(move |named| (of, named))
    };
    telescopes.iter().flat_map(pairs).collect()
}

fn one_detector(
    mission: &Mission,
    telescopes: &[(usize, &Telescope)],
    name: &str,
) -> Result<SightLine, SightError> {
    let named = named_detectors(telescopes);
    let full = |((_, it), detector): &Named<'_>| format!("{}/{}", it.name, detector.name);
    let exact: Vec<_> = named.iter().filter(|it| it.1.name == name || full(it) == name).collect();
    let is = |text: &str| text.eq_ignore_ascii_case(name);
    let matching = if exact.is_empty() {
        named.iter().filter(|it| is(&it.1.name) || is(&full(it))).collect()
    } else {
        exact
    };
    match matching[..] {
        [(of, found)] => detector(mission, *of, found),
        [] => Err(SightError::NoSuchDetector {
            name: name.to_owned(),
            known: named.iter().map(full).collect(),
        }),
        _ => Err(SightError::AmbiguousDetector {
            name: name.to_owned(),
            matching: matching.iter().map(|it| full(it)).collect(),
        }),
    }
}
