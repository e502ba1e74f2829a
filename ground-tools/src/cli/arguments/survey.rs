//! The options of `survey`.

use super::figures::FigureArgs;
use super::meaning::meaning;
use super::sight::SightArgs;
use clap::{ArgAction, Args, ValueEnum};
use formats::fits::MapFrame;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// `survey`.
#[derive(Debug, Clone, Args)]
#[command(mut_args(meaning(&[(
    "telescope",
    "NAME",
    "Only this telescope: its detectors, or its line of sight where it lists none",
)])))]
#[expect(clippy::struct_excessive_bools, reason = "each is an option of its own")]
pub struct SurveyArgs {
    /// The map's resolution, a power of two up to 2048
    #[arg(long, value_name = "N", default_value_t = 128)]
    pub nside: u32,
    /// Sampling rate in Hz; without it the mission's
    #[arg(long, value_name = "HZ", allow_hyphen_values = true)]
    pub rate: Option<String>,
    /// An average exp(-i(n psi + m phi)), whole or half-integer: 2,4; again and again
    #[arg(long, visible_alias = "spin", value_name = "N,M", action = ArgAction::Append,
          allow_hyphen_values = true)]
    pub moment: Vec<String>,
    /// The lines of sight.
    #[command(flatten)]
    pub sight: SightArgs,
    /// A map for each detector, not one of all
    #[arg(long)]
    pub per_detector: bool,
    /// Files in NESTED order, not in RING order
    #[arg(long)]
    pub nested: bool,
    /// Galactic pixels and crossing angles, not ecliptic ones
    #[arg(long)]
    pub galactic: bool,
    /// Maps at earlier times too: 192.348min,1d,30d
    #[arg(long, value_name = "TIME", value_delimiter = ',')]
    pub snapshot: Vec<String>,
    /// The anti-Sun direction moves once per this time, not with every sample: 1d
    #[arg(long, value_name = "TIME")]
    pub orbit_step: Option<String>,
    /// Threads; without it one per core. Results do not depend on it
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Pictures.
    #[command(flatten)]
    pub figures: FigureArgs,
    /// A patch of the map as a picture of its own: 210deg,-5deg,20deg; again and again
    #[arg(long, value_name = "LON,LAT,SIDE", action = ArgAction::Append,
          allow_hyphen_values = true)]
    pub patch: Vec<String>,
    /// The targets' ways over the sky in the pictures
    #[arg(long)]
    pub tracks: bool,
    /// Colours of the pictures by logarithm
    #[arg(long)]
    pub log: bool,
    /// A sky of I, Q, U as HEALPix FITS: the map that the detectors make of it goes beside --out
    #[arg(long, value_name = "FITS")]
    pub sky: Option<PathBuf>,
    /// The frame of a --sky that does not name its own
    #[arg(long, value_name = "FRAME", requires = "sky")]
    pub sky_frame: Option<SkyFrame>,
}

/// The frame of a sky.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SkyFrame {
    /// Ecliptic longitude and latitude
    Ecliptic,
    /// Galactic longitude and latitude
    Galactic,
    /// Right ascension and declination, ICRF
    Equatorial,
}

impl From<SkyFrame> for MapFrame {
    fn from(frame: SkyFrame) -> Self {
        match frame {
            SkyFrame::Ecliptic => Self::Ecliptic,
            SkyFrame::Galactic => Self::Galactic,
            SkyFrame::Equatorial => Self::Equatorial,
        }
    }
}
