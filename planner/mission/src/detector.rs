//! A detector as mounted, and the quaternions of a mission file.
//!
//! Frames: a detector's quaternion takes its components to the telescope's, the telescope's to those
//! of the mission boresight.

use crate::fault::Problem;
use crate::number::Number;
use crate::reading::canon::toml_string;
use crate::reading::range::Range;
use crate::reading::section::{Section, one_of};
use crate::receiver::{Channel, Receiver};
use crate::rounding;
use crate::scan::PHASE;
use onboard_core::frame::{self, Boresight};
use onboard_core::rotation::{NORM_TOLERANCE, Rotation, RotationError};

const COMPONENT: Range = Range::closed("a component", -1.000_001, 1.000_001, "");

/// A detector as mounted.
#[derive(Debug, Clone)]
pub struct NamedDetector {
    /// Unique in its telescope.
    pub name: String,
    /// Detector frame into mission boresight frame.
    pub rotation: Rotation<frame::Detector, Boresight>,
    /// Polarisation angle from the detector's x axis.
    pub polarisation_angle_deg: Number,
    /// The same in radians.
    pub polarisation_angle_rad: f64,
    /// Its channel, of the mission or of the instrument model.
    pub channel: Option<String>,
    /// What it measures with, the channel's or telescope's values where it has none of its own.
    pub receiver: Receiver,
}

/// What a telescope's detectors may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kinds<'k> {
    /// Its channels.
    pub(crate) channels: &'k [Channel],
    /// What the telescope says of all.
    pub(crate) telescope: &'k Receiver,
}

impl Kinds<'_> {
    /// What a channel's detectors measure with, or the telescope's where it is none of its channels.
    pub(crate) fn of(&self, channel: Option<&str>) -> &Receiver {
        let found = self.channels.iter().find(|it| Some(it.name.as_str()) == channel);
        found.map_or(self.telescope, |it| &it.receiver)
    }

    /// A detector's `channel`, one of the telescope's.
    fn read(&self, section: &mut Section<'_>) -> Option<String> {
        let node = section.find_some("channel");
        let legal: Vec<&str> = self.channels.iter().map(|it| it.name.as_str()).collect();
        let name = node.and_then(Section::text_of).filter(|name| legal.contains(name));
        if let (Some(node), None) = (node, name) {
            let need = if legal.is_empty() {
                "a [[telescope.channel]] of that name".to_owned()
            } else {
                one_of(&legal)
            };
            section.not_legal("channel", node, &need);
        }
        section.record("channel", toml_string(name.unwrap_or("none")));
        name.map(str::to_owned)
    }
}

impl NamedDetector {
    pub(crate) fn read(
        section: &mut Section<'_>,
        telescope: Rotation<frame::Telescope, Boresight>,
        kinds: &Kinds<'_>,
    ) -> Self {
        let name = section.name("name", None);
        let in_telescope: Rotation<frame::Detector, frame::Telescope> =
            rotation(section, "quaternion_xyzw");
        let angle = section.number("polarisation_angle_deg", &PHASE, Some("0.0"));
        let channel = kinds.read(section);
        let receiver = Receiver::read(section, kinds.of(channel.as_deref()));
        Self {
            name,
            channel,
            receiver,
            rotation: in_telescope.then(telescope),
            polarisation_angle_rad: rounding::radians(angle.exact()),
            polarisation_angle_deg: angle,
        }
    }
}

/// A unit quaternion; the identity where it is absent or faulty.
pub(crate) fn rotation<A, B>(section: &mut Section<'_>, key: &'static str) -> Rotation<A, B> {
    let Some(numbers) = section.numbers(key, &COMPONENT, ["0.0", "0.0", "0.0", "1.0"]) else {
        return Rotation::IDENTITY;
    };
    match Rotation::from_xyzw(numbers.map(|number| number.to_f64())) {
        Ok(rotation) => rotation,
        Err(error) => {
            let norm = match error {
                RotationError::NotUnit(norm) => norm,
                RotationError::NotFinite => f64::INFINITY,
            };
            let problem = Problem::OutOfRange {
                key: format!("the norm of {}", section.key(key)),
                value: norm.to_string(),
                need: format!("a unit quaternion [x, y, z, w] to {NORM_TOLERANCE:e}"),
                hint: "",
            };
            section.fault(&section.place_of(key), problem);
            Rotation::IDENTITY
        }
    }
}
