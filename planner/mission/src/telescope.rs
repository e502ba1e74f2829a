//! What does the spacecraft carry: telescopes, their plates, fields of view and detectors.
//!
//! Frames: `boresight_quaternion_xyzw` takes telescope components to the mission boresight frame,
//! a detector's `quaternion_xyzw` takes detector components to its telescope's. What leaves here is
//! `Rotation<Detector, Boresight>`, the product. `hwp_sign` +1 is the sense of the crossing angle.
//!
//! Detectors are listed, or come from the key `detectors` (`mission::focal_plane`).
//!
//! # Example
//! A grid of detectors 4 deg apart over the field of view of LiteBIRD's first telescope:
//! ```
//! use mission::{Mission, Override};
//!
//! let grid = Override::set("telescope.0.detectors={ grid_deg = 4.0 }")?;
//! let lft = &Mission::load("litebird", &[grid])?.telescopes[0];
//! assert_eq!((lft.name.as_str(), lft.fwhm_arcmin.text()), ("LFT", "23.7"));
//! assert!(lft.detectors.len() > 1);
//! let field = lft.field_of_view.ok_or("no field of view")?;
//! assert_eq!(field.centre().xyz(), [0.0, 0.0, 1.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::detector::{Kinds, rotation};
use crate::fault::{Problem, Warning};
use crate::focal_plane::{FocalPlane, Mount};
use crate::number::Number;
use crate::reading::range::Range;
use crate::reading::section::{Section, duplicates};
use crate::receiver::{Channel, FWHM, Receiver};
use crate::rounding;
use crate::scan::{PHASE, phase_of_degrees};
use onboard_core::field_of_view::FieldOfView;
use onboard_core::frame::{self, Boresight};
use onboard_core::phase::Rotor;
use onboard_core::rotation::Rotation;
use std::path::Path;

pub use crate::detector::NamedDetector;

/// A telescope as mounted.
#[derive(Debug, Clone)]
pub struct Telescope {
    /// Unique in the mission.
    pub name: String,
    /// Telescope frame into mission boresight frame.
    pub rotation: Rotation<frame::Telescope, Boresight>,
    /// Rate of the half-wave plate.
    pub hwp_rate_rpm: Option<Number>,
    /// The half-wave plate with its sign and start phase.
    pub hwp: Option<Rotor>,
    /// Full width of the beam at half maximum.
    pub fwhm_arcmin: Number,
    /// The same in radians.
    pub fwhm_rad: f64,
    /// Frequency that stands for its band; sources have no known strength without it.
    pub frequency_ghz: Option<Number>,
    /// The same with the rest of what it measures with.
    pub receiver: Receiver,
    /// Its kinds of detectors.
    pub channels: Vec<Channel>,
    /// `None` is the circle of `calibration.radius_deg`.
    pub field_of_view: Option<FieldOfView>,
    /// The detectors: listed, of an instrument model, or of a grid.
    pub detectors: Vec<NamedDetector>,
    /// Spacing of the grid that laid them out, where one did.
    pub detector_grid_deg: Option<Number>,
    /// What should be known about them.
    pub(crate) warning: Option<Warning>,
}

const HWP_RATE: Range = Range::positive("a rate", 1e6, "rpm")
    .if_negative("; hwp_sign = -1 reverses the plate, \"none\" removes it");
const RADIUS: Range = Range::positive("an angle", 180.0, "deg");
const SIDE: Range = Range::positive("an angle", 180.0, "deg").below_high();

impl Telescope {
    pub(crate) fn read(section: &mut Section<'_>, directory: &Path) -> Self {
        let name = section.name("name", None);
        let rotation = rotation(section, "boresight_quaternion_xyzw");
        let hwp_rate_rpm = section.optional_number("hwp_rate_rpm", &HWP_RATE);
        let sign = section.sign("hwp_sign");
        let phase = section.number("hwp_phase_deg", &PHASE, Some("0.0"));
        let fwhm_arcmin = section.number("fwhm_arcmin", &FWHM, None);
        let width = Some(fwhm_arcmin.clone());
        let receiver = Receiver::with_width(section, width, &Receiver::default());
        let field_of_view = field_of_view(section, rotation);
        let channels = section.tables("channel", |s| Channel::read(s, &receiver));
        duplicates(section, "channel", channels.iter().map(|channel| channel.name.as_str()));
        let kinds = Kinds { channels: &channels, telescope: &receiver };
        let listed = section.tables("detector", |s| NamedDetector::read(s, rotation, &kinds));
        duplicates(section, "detector", listed.iter().map(|detector| detector.name.as_str()));
        let mount = Mount { directory, rotation, field_of_view: field_of_view.as_ref(), kinds };
        let plane = FocalPlane::read(section, &mount);
        if !listed.is_empty() && plane.is_some() {
            let problem = Problem::Exclusive {
                first: section.key("detector"),
                second: section.key("detectors"),
            };
            section.fault(&section.place_of("detectors"), problem);
        }
        let plane =
            plane.unwrap_or_else(|| FocalPlane { detectors: listed, ..FocalPlane::default() });
        Self {
            name,
            rotation,
            hwp: hwp_rate_rpm.as_ref().and_then(|rpm| {
                let rate = rounding::turn_rate(&rpm.times(sign.into(), 60))?;
                Some(Rotor { rate, start: phase_of_degrees(&phase) })
            }),
            hwp_rate_rpm,
            fwhm_rad: rounding::radians(&fwhm_arcmin.times(1, 60)),
            fwhm_arcmin,
            frequency_ghz: receiver.frequency_ghz.clone(),
            field_of_view,
            detectors: plane.detectors,
            detector_grid_deg: plane.grid_deg,
            warning: plane.warning,
            receiver,
            channels,
        }
    }
}

fn field_of_view(
    section: &mut Section<'_>,
    rotation: Rotation<frame::Telescope, Boresight>,
) -> Option<FieldOfView> {
    section.inline("field_of_view", |section| {
        let circle = section.has("radius_deg");
        let rectangle = section.has("width_deg") || section.has("height_deg");
        if circle && rectangle {
            let side = if section.has("width_deg") { "width_deg" } else { "height_deg" };
            let problem =
                Problem::Exclusive { first: section.key("radius_deg"), second: section.key(side) };
            section.fault(&section.place_of("radius_deg"), problem);
        }
        if rectangle {
            let width = section.number("width_deg", &SIDE, None);
            let height = section.number("height_deg", &SIDE, None);
            section.knows(&["radius_deg"]);
            let rad = |n: &Number| rounding::radians(n.exact());
            FieldOfView::rectangle(rotation, rad(&width), rad(&height)).ok()
        } else {
            let radius = section.number("radius_deg", &RADIUS, None);
            section.knows(&["width_deg", "height_deg"]);
            FieldOfView::circle(rotation, rounding::radians(radius.exact())).ok()
        }
    })?
}
