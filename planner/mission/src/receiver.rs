//! What does a receiver measure with: its beam, its band, its noise, its speed.
//!
//! The keys stand on a telescope, a channel or a detector; what a detector leaves out is its channel's,
//! and what that leaves out is the telescope's. Noise is thermodynamic, as CMB detectors are quoted;
//! `ellipticity` is the ratio of the beam's long to its short axis.
//!
//! Limits: nothing of it is required but a telescope's `fwhm_arcmin`; a band that reaches below
//! 0 Hz is refused (`receivers_have_their_own_sentences`).
//!
//! # Example
//! A channel of LiteBIRD, and what it leaves to its telescope:
//! ```
//! use mission::{Mission, Override};
//!
//! let faster = Override::set("telescope.HFT.time_constant_ms=2.5")?;
//! let hft = &Mission::load("litebird", &[faster])?.telescopes[2];
//! let h1 = hft.channels.iter().find(|it| it.name == "H1-195").ok_or("no such channel")?;
//! assert_eq!(h1.receiver.net_uk_rts.as_ref().map(|it| it.text()), Some("73.96"));
//! assert_eq!(h1.receiver.time_constant_ms.as_ref().map(|it| it.text()), Some("2.5"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::fault::Problem;
use crate::number::Number;
use crate::reading::range::Range;
use crate::reading::section::Section;
use crate::rounding;

/// What a receiver measures with, as far as it is known.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Receiver {
    /// Full width of the beam at half maximum.
    pub fwhm_arcmin: Option<Number>,
    /// Frequency that stands for the band.
    pub frequency_ghz: Option<Number>,
    /// Width of the band, which is flat about its frequency.
    pub bandwidth_ghz: Option<Number>,
    /// Noise-equivalent temperature of one detector, thermodynamic, in uK sqrt(s).
    pub net_uk_rts: Option<Number>,
    /// Long over short axis of the beam.
    pub ellipticity: Option<Number>,
    /// Frequency below which 1/f noise exceeds the white noise.
    pub knee_mhz: Option<Number>,
    /// Time constant of the detector's response.
    pub time_constant_ms: Option<Number>,
}

/// Detectors of one kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Unique in its telescope.
    pub name: String,
    /// What they measure with, the telescope's values where the channel has none.
    pub receiver: Receiver,
}

pub(crate) const FWHM: Range = Range::positive("an angle", 10800.0, "arcmin");
pub(crate) const FREQUENCY: Range = Range::positive("a frequency", 1e6, "GHz");
pub(crate) const BANDWIDTH: Range = Range::positive("a bandwidth", 1e6, "GHz");
pub(crate) const NET: Range = Range::positive("a noise", 1e12, "uK sqrt(s)");
pub(crate) const ELLIPTICITY: Range = Range::closed("a ratio of axes", 1.0, 100.0, "");
pub(crate) const KNEE: Range = Range::closed("a frequency", 0.0, 1e9, "mHz");
const TIME_CONSTANT: Range = Range::positive("a duration", 1e6, "ms");

impl Receiver {
    /// The keys of a channel or a detector over those of what it belongs to.
    pub(crate) fn read(section: &mut Section<'_>, below: &Self) -> Self {
        let fwhm_arcmin = section.optional_number("fwhm_arcmin", &FWHM);
        Self::with_width(section, fwhm_arcmin, below)
    }

    /// The keys but for the beam's width, which was read.
    pub(crate) fn with_width(
        section: &mut Section<'_>,
        fwhm_arcmin: Option<Number>,
        below: &Self,
    ) -> Self {
        let own = Self {
            fwhm_arcmin,
            frequency_ghz: section.optional_number("frequency_ghz", &FREQUENCY),
            bandwidth_ghz: section.optional_number("bandwidth_ghz", &BANDWIDTH),
            net_uk_rts: section.optional_number("net_uk_rts", &NET),
            ellipticity: section.optional_number("ellipticity", &ELLIPTICITY),
            knee_mhz: section.optional_number("knee_mhz", &KNEE),
            time_constant_ms: section.optional_number("time_constant_ms", &TIME_CONSTANT),
        };
        let whole = own.or(below);
        if own.bandwidth_ghz.is_some() || own.frequency_ghz.is_some() {
            whole.check_band(section);
        }
        whole
    }

    fn check_band(&self, section: &Section<'_>) {
        if let (Some(width), Some(centre)) = (&self.bandwidth_ghz, &self.frequency_ghz)
            && width.times(1, 1) >= centre.times(2, 1)
        {
            let key = if section.has("bandwidth_ghz") { "bandwidth_ghz" } else { "frequency_ghz" };
            let problem = Problem::OutOfRange {
                key: section.key("bandwidth_ghz"),
                value: width.text().to_owned(),
                need: format!("less than twice the frequency, {} GHz,", centre.text()),
                hint: "",
            };
            section.fault(&section.place_of(key), problem);
        }
    }

    /// These values, and another's where there are none.
    #[must_use]
    pub fn or(&self, other: &Self) -> Self {
        let either =
            |own: &Option<Number>, other: &Option<Number>| own.as_ref().or(other.as_ref()).cloned();
        Self {
            fwhm_arcmin: either(&self.fwhm_arcmin, &other.fwhm_arcmin),
            frequency_ghz: either(&self.frequency_ghz, &other.frequency_ghz),
            bandwidth_ghz: either(&self.bandwidth_ghz, &other.bandwidth_ghz),
            net_uk_rts: either(&self.net_uk_rts, &other.net_uk_rts),
            ellipticity: either(&self.ellipticity, &other.ellipticity),
            knee_mhz: either(&self.knee_mhz, &other.knee_mhz),
            time_constant_ms: either(&self.time_constant_ms, &other.time_constant_ms),
        }
    }

    /// Full width of the beam at half maximum in radians.
    #[must_use]
    pub fn fwhm_rad(&self) -> Option<f64> {
        self.fwhm_arcmin.as_ref().map(|it| rounding::radians(&it.times(1, 60)))
    }
}

impl Channel {
    pub(crate) fn read(section: &mut Section<'_>, telescope: &Receiver) -> Self {
        let name = section.name("name", None);
        Self { name, receiver: Receiver::read(section, telescope) }
    }
}
