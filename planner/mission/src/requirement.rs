//! What must calibration teach: quantities, how well, how often, of which detectors.
//!
//! Method: `sigma` is a number with the unit of its quantity, kept as written and as a fraction, radians or
//! seconds. A level in dB is 10 log10 of the beam's response, so -30 dB is a thousandth of its peak.
//!
//! Limits: detectors of an instrument model are known by name once the model is read, so a name is
//! checked after the telescopes.
//!
//! # Example
//! The gain of each of HFT's detectors to 0.2 % every 30 days:
//! ```
//! use mission::{Mission, requirement::Quantity};
//!
//! let text = r#"
//! base = "litebird"
//! [[calibration.requirement]]
//! quantity = "gain"
//! sigma = "0.2 %"
//! every_days = 30
//! telescope = "HFT"
//! "#;
//! let mission = Mission::from_toml(text, "mine.toml", std::path::Path::new(""), &[])?;
//! let it = &mission.calibration.requirements[0];
//! assert_eq!((it.quantity, it.sigma(), it.telescope.as_str()), (Quantity::Gain, 0.002, "HFT"));
//! # Ok::<(), mission::fault::MissionError>(())
//! ```

use crate::number::Number;
use crate::reading::canon::toml_string;
use crate::reading::range::Range;
use crate::reading::section::{Section, is_name};
use crate::telescope::Telescope;
use std::f64::consts::PI;

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// The gain, as a fraction of itself.
    Gain,
    /// Where the beam points, along each axis of the detector's frame.
    Offset,
    /// The beam's width, as a fraction of itself.
    Width,
    /// Each component of the beam's ellipticity.
    Ellipticity,
    /// The time constant of the detector.
    TimeConstant,
    /// The angle of polarisation.
    PolarisationAngle,
    /// The beam's response, normalised to its peak.
    BeamLevel,
}

impl Quantity {
    /// All, with their keys.
    pub const EACH: [(&'static str, Self); 7] = [
        ("gain", Self::Gain),
        ("offset", Self::Offset),
        ("width", Self::Width),
        ("ellipticity", Self::Ellipticity),
        ("time_constant", Self::TimeConstant),
        ("polarisation_angle", Self::PolarisationAngle),
        ("beam_level", Self::BeamLevel),
    ];

    /// Its key.
    #[must_use]
    pub fn key(self) -> &'static str {
        Self::EACH.iter().find(|it| it.1 == self).map_or("", |it| it.0)
    }

    /// Units of its errors, with what one of each is in the natural one: fraction, radian, second.
    const fn units(self) -> &'static [(&'static str, f64)] {
        const ARCSEC: f64 = PI / 648_000.0;
        match self {
            Self::Gain | Self::Width | Self::Ellipticity => &[("%", 1e-2)],
            Self::Offset => {
                &[("arcsec", ARCSEC), ("arcmin", 60.0 * ARCSEC), ("deg", 3600.0 * ARCSEC)]
            }
            Self::PolarisationAngle => {
                &[("deg", 3600.0 * ARCSEC), ("arcmin", 60.0 * ARCSEC), ("arcsec", ARCSEC)]
            }
            Self::TimeConstant => &[("ms", 1e-3), ("us", 1e-6), ("s", 1.0)],
            Self::BeamLevel => &[("dB", 0.0)],
        }
    }
}

/// Whose errors are meant when nobody is named.
pub const ALL: &str = "all";

/// An error that calibration must reach.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Requirement {
    /// What is measured.
    pub quantity: Quantity,
    /// The largest error at one standard deviation, as written.
    pub sigma_text: String,
    /// Its number.
    number: Number,
    /// Its unit.
    unit: &'static str,
    /// Up to which angle from the beam's centre a level must be known.
    pub radius_arcmin: Option<Number>,
    /// In each window of that length; without it over the mission.
    pub every_days: Option<Number>,
    /// A telescope, a channel, a detector, or [`ALL`].
    pub telescope: String,
}

const DAYS: Range = Range::positive("a duration", 36525.0, "days");
const RADIUS: Range = Range::positive("an angle", 10800.0, "arcmin");

impl Requirement {
    pub(crate) fn read(section: &mut Section<'_>) -> Option<Self> {
        let quantity = section.has("quantity");
        if !quantity {
            let keys = Quantity::EACH.map(|it| it.0).join(", ");
            section.find("quantity");
            section.missing("quantity", &format!("one of {keys}"));
        }
        let quantity = if quantity { section.choice("quantity", &Quantity::EACH) } else { None };
        let sigma = sigma(section, quantity);
        let level = quantity == Some(Quantity::BeamLevel);
        let radius_arcmin = if level {
            Some(section.number("radius_arcmin", &RADIUS, None))
        } else {
            section.optional_number("radius_arcmin", &RADIUS)
        };
        if let (Some(quantity), Some(_), false, Some(node)) =
            (quantity, &radius_arcmin, level, section.node_of("radius_arcmin"))
        {
            let need = format!("quantity = \"beam_level\", not \"{}\",", quantity.key());
            section.not_legal("radius_arcmin", node, &need);
        }
        let every_days = section.optional_number("every_days", &DAYS);
        let node = section.find("telescope");
        let telescope = match node {
            None => ALL.to_owned(),
            Some(node) => {
                let text = Section::text_of(node).unwrap_or_default().to_owned();
                if text != ALL && !text.split('/').all(is_name) {
                    let need = "\"all\", or the name of a telescope, a channel or a detector,";
                    section.not_legal("telescope", node, &need);
                }
                text
            }
        };
        section.record("telescope", toml_string(&telescope));
        let (sigma_text, number, unit) = sigma?;
        let quantity = quantity?;
        Some(Self { quantity, sigma_text, number, unit, radius_arcmin, every_days, telescope })
    }

    /// The largest error: a fraction, radians, or seconds; of a level the fraction of the peak.
    #[must_use]
    pub fn sigma(&self) -> f64 {
        let number = self.number.to_f64();
        match self.quantity.units().iter().find(|it| it.0 == self.unit) {
            Some((_, scale)) if *scale > 0.0 => number * scale,
            _ => 10_f64.powf(number / 10.0),
        }
    }

    /// Whether it speaks of a telescope's detector, or of its boresight, in a channel.
    #[must_use]
    pub fn concerns(&self, telescope: &str, channel: Option<&str>, detector: Option<&str>) -> bool {
        let said = self.telescope.as_str();
        let in_telescope = |name: &str| {
            said.split_once('/').is_some_and(|(first, rest)| first == telescope && rest == name)
        };
        said == ALL
            || said == telescope
            || [channel, detector].into_iter().flatten().any(|it| it == said || in_telescope(it))
    }

    /// Whether any of the mission's detectors is meant.
    pub(crate) fn has_subject(&self, telescopes: &[Telescope]) -> bool {
        telescopes.iter().any(|it| {
            self.concerns(&it.name, None, None)
                || it.channels.iter().any(|of| self.concerns(&it.name, Some(&of.name), None))
                || it
                    .detectors
                    .iter()
                    .any(|of| self.concerns(&it.name, of.channel.as_deref(), Some(&of.name)))
        })
    }
}

/// The text of an error, its number and its unit.
fn sigma(
    section: &mut Section<'_>,
    quantity: Option<Quantity>,
) -> Option<(String, Number, &'static str)> {
    let units = quantity.map_or(&[][..], Quantity::units);
    let names: Vec<&str> = units.iter().map(|it| it.0).collect();
    let (what, sample) = match quantity {
        Some(Quantity::BeamLevel) => ("a level below 0 with its unit", "\"-30 dB\""),
        Some(Quantity::Offset) => ("a positive error with its unit", "\"1 arcsec\""),
        Some(Quantity::TimeConstant) => ("a positive error with its unit", "\"1 ms\""),
        Some(Quantity::PolarisationAngle) => ("a positive error with its unit", "\"0.1 deg\""),
        _ => ("a positive error with its unit", "\"0.2 %\""),
    };
    let need = format!("{what} ({}), such as {sample},", names.join(", "));
    let Some(node) = section.find("sigma") else {
        section.missing("sigma", &need.trim_end_matches(','));
        return None;
    };
    let text = Section::text_of(node).unwrap_or_default().trim().to_owned();
    section.record("sigma", toml_string(&text));
    quantity?;
    let digits = text.trim_end_matches(|c: char| c.is_alphabetic() || c == '%');
    let unit = text.get(digits.len()..).unwrap_or_default();
    let unit = names.iter().copied().find(|it| *it == unit);
    let number = Number::parse(digits.trim()).ok().filter(|it| {
        let value = it.to_f64();
        let size = if quantity == Some(Quantity::BeamLevel) { -value } else { value };
        0.0 < size && size <= 1e6
    });
    if let (Some(number), Some(unit)) = (number, unit) {
        return Some((text, number, unit));
    }
    section.not_legal("sigma", node, &need);
    None
}
