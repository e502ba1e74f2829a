//! The options of `missions`, `pointing`, `transits` and `visits`.

use super::figures::FigureArgs;
use super::instants::InstantArgs;
use super::meaning::meaning;
use super::sight::SightArgs;
use crate::cli::places::DEFAULT_NSIDE;
use crate::cli::quantities::arcseconds;
use clap::{ArgAction, Args};

/// `missions`.
#[derive(Debug, Clone, Args)]
pub struct MissionsArgs {
    /// A preset to show or a mission file to check; none lists the presets
    pub name: Option<String>,
    /// Print the mission with every key explicit
    #[arg(long)]
    pub resolved: bool,
}

/// `pointing`.
#[derive(Debug, Clone, Args)]
#[command(mut_args(meaning(&[
    (
        "step",
        "SECONDS",
        "Seconds between rows on the scan clock, such as 0.05; needed unless --at or --format aem is \
         there",
    ),
    ("telescope", "NAME", "This telescope's line of sight"),
    (
        "detector",
        "NAME",
        "A detector, TELESCOPE/NAME where ambiguous; without it the mission boresight",
    ),
])))]
pub struct PointingArgs {
    /// When rows are.
    #[command(flatten)]
    pub instants: InstantArgs,
    /// The line of sight.
    #[command(flatten)]
    pub sight: SightArgs,
    /// Largest error of interpolation between samples of an AEM, in seconds of arc; 1 without it
    #[arg(long, value_name = "ARCSEC", value_parser = arcseconds, allow_hyphen_values = true,
          conflicts_with = "step")]
    pub aem_error_arcsec: Option<f64>,
    /// When an AEM says it was made: 2032-03-01T00:00:00Z; without it `SOURCE_DATE_EPOCH`, or the
    /// mission's start
    #[arg(long, value_name = "TIME")]
    pub stamp: Option<String>,
}

/// `transits`.
#[derive(Debug, Clone, Args)]
pub struct TransitsArgs {
    /// Only these targets: mars,jupiter
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub target: Vec<String>,
    /// The lines of sight.
    #[command(flatten)]
    pub sight: SightArgs,
}

/// `visits`.
#[derive(Debug, Clone, Args)]
#[command(mut_args(meaning(&[
    ("png", "DIR", "Write histograms of revisit, gap and dwell into this folder, as PNG"),
    ("svg", "DIR", "Write them as SVG"),
])))]
#[expect(clippy::struct_excessive_bools, reason = "each is an option of its own")]
pub struct VisitsArgs {
    /// These targets: mars,jupiter; without any place named, all of the mission's
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub target: Vec<String>,
    /// Pixels of the sky by number: 0,7200
    #[arg(long, value_name = "N", value_delimiter = ',')]
    pub pixel: Vec<u32>,
    /// The pixel that holds a colatitude and longitude: 45deg,180deg; again and again
    #[arg(long, value_name = "THETA,PHI", action = ArgAction::Append, allow_hyphen_values = true)]
    pub theta_phi: Vec<String>,
    /// The three pixels of the paper's section 6.2, which are (0, 0), (45, 180) and (90, 180) deg
    #[arg(long)]
    pub paper_pixels: bool,
    /// A direction, geometric, visited as a target is: 210deg,-5deg; again and again
    #[arg(long, value_name = "LON,LAT", action = ArgAction::Append, allow_hyphen_values = true)]
    pub direction: Vec<String>,
    /// Pixels and directions are galactic, not ecliptic
    #[arg(long)]
    pub galactic: bool,
    /// The pixels' resolution, a power of two
    #[arg(long, value_name = "N", default_value_t = DEFAULT_NSIDE)]
    pub nside: u32,
    /// Pixels are numbered in NESTED order, not in RING order
    #[arg(long)]
    pub nested: bool,
    /// The lines of sight.
    #[command(flatten)]
    pub sight: SightArgs,
    /// Count samples as the paper does, not crossings
    #[arg(long)]
    pub sampled: bool,
    /// Sampling rate in Hz; without it the mission's
    #[arg(long, value_name = "HZ", requires = "sampled", allow_hyphen_values = true)]
    pub rate: Option<String>,
    /// Pictures.
    #[command(flatten)]
    pub figures: FigureArgs,
}
