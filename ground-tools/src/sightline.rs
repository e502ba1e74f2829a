//! Which lines of sight are asked for: the mission boresight, telescopes, detectors.
//!
//! Without a name it is the mission boresight, evaluated once. A telescope without listed detectors
//! is seen through its field of view, or where it has none through the circle of
//! `calibration.radius_deg`; one with detectors through each of them.

use crate::failure::Failure;
use crate::findings::nearest_first;
use crate::mission::Mission;
use crate::mission::telescope::{NamedDetector, Telescope};
use onboard_core::field_of_view::{FieldOfView, FieldShape};
use onboard_core::frame::{Boresight, Detector};
use onboard_core::phase::Rotor;
use onboard_core::rotation::{Rotation, RotationError};

/// Stands where there is no telescope or no detector.
pub const NONE: &str = "-";

/// Where a field of view is and its size, as bits.
pub type View = ([u64; 4], [u64; 2]);

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
    pub fn view(&self) -> View {
        let (place, shape) = match self.field.shape() {
            FieldShape::Circle(radius) => {
                let [x, y, z] = self.field.centre().xyz();
                ([x, y, z, 0.0], [radius, 0.0])
            }
            FieldShape::Rectangle(width, height) => (self.rotation.to_xyzw(), [width, height]),
        };
        (place.map(f64::to_bits), shape.map(f64::to_bits))
    }
}

/// A telescope's frame read as a detector's: z its line of sight, x its x.
fn as_detector<F>(frame: Rotation<F, Boresight>) -> Result<Rotation<Detector, Boresight>, Failure> {
    Rotation::from_xyzw(frame.to_xyzw())
        .map_err(|error: RotationError| Failure::internal(format!("{error:?}")))
}

fn circle<F>(mission: &Mission, frame: Rotation<F, Boresight>) -> Result<FieldOfView, Failure> {
    FieldOfView::circle(frame, mission.calibration.radius_rad())
        .map_err(|error| Failure::internal(format!("{error:?}")))
}

/// The mission boresight, with the half-wave plate that all telescopes share, if they do.
///
/// # Errors
/// [`Failure::Internal`] where checked values are refused.
pub fn boresight(mission: &Mission) -> Result<SightLine, Failure> {
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
fn telescope(mission: &Mission, index: usize, it: &Telescope) -> Result<SightLine, Failure> {
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
) -> Result<SightLine, Failure> {
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
) -> Result<Vec<SightLine>, Failure> {
    if it.detectors.is_empty() {
        Ok(vec![telescope(mission, index, it)?])
    } else {
        it.detectors.iter().map(|named| detector(mission, (index, it), named)).collect()
    }
}

/// The lines of sight through which the plan sees targets: all telescopes, in the mission's order.
///
/// # Errors
/// [`Failure::Internal`] where checked values are refused.
pub fn of_plan(mission: &Mission) -> Result<Vec<SightLine>, Failure> {
    let mut lines = Vec::new();
    for (index, it) in mission.telescopes.iter().enumerate() {
        lines.extend(of_telescope(mission, index, it)?);
    }
    Ok(lines)
}

/// The lines of sight that `--telescope` and `--detector` name.
///
/// # Errors
/// [`Failure::Input`] names what the mission does not have, or what is ambiguous.
pub fn select(
    mission: &Mission,
    telescope_name: Option<&str>,
    detector_name: Option<&str>,
) -> Result<Vec<SightLine>, Failure> {
    if telescope_name.is_none() && detector_name.is_none() {
        return Ok(vec![boresight(mission)?]);
    }
    let mut telescopes: Vec<(usize, &Telescope)> = mission.telescopes.iter().enumerate().collect();
    if let Some(name) = telescope_name {
        telescopes.retain(|(_, it)| it.name == name);
        if telescopes.is_empty() {
            return Err(no_such(
                "--telescope",
                name,
                mission.telescopes.iter().map(|it| &*it.name),
            ));
        }
    }
    match detector_name {
        None => telescopes.iter().try_fold(Vec::new(), |mut lines, (index, it)| {
            lines.extend(of_telescope(mission, *index, it)?);
            Ok(lines)
        }),
        Some("all") => {
            let named = named_detectors(&telescopes);
            if named.is_empty() {
                return Err(Failure::Input(
                    "--detector all: the mission lists no detectors; add [[telescope.detector]] \
                     tables, or name a telescope with --telescope to see through its field of view"
                        .to_owned(),
                ));
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
) -> Result<SightLine, Failure> {
    let named = named_detectors(telescopes);
    let full = |((_, it), detector): &Named<'_>| format!("{}/{}", it.name, detector.name);
    let matching: Vec<_> =
        named.iter().filter(|it| it.1.name == name || full(it) == name).collect();
    match matching[..] {
        [(of, found)] => detector(mission, *of, found),
        [] => {
            let known: Vec<String> = named.iter().map(full).collect();
            Err(no_such("--detector", name, known.iter().map(String::as_str)))
        }
        _ => Err(Failure::Input(format!(
            "--detector {name} is ambiguous: one of {} is needed",
            matching.iter().map(|it| full(it)).collect::<Vec<_>>().join(", ")
        ))),
    }
}

/// Says what there is instead, the nearest first.
fn no_such<'n>(option: &str, name: &str, known: impl Iterator<Item = &'n str>) -> Failure {
    let known: Vec<&str> = known.collect();
    if known.is_empty() {
        return Failure::Input(format!("{option} {name}: the mission lists none"));
    }
    let known = nearest_first(name, known);
    Failure::Input(format!("{option} {name} is not in the mission: it has {known}"))
}
