//! The options of `forecast`.

use super::meaning::meaning;
use super::sight::SightArgs;
use clap::{Args, ValueEnum};
use planner::information::{MONTH_DAYS, QUARTER_DAYS};
use std::path::PathBuf;

/// `forecast`.
#[derive(Debug, Clone, Args)]
#[command(mut_args(meaning(&[
    ("telescope", "NAME", "Only this telescope"),
    (
        "detector",
        "NAME|CHANNEL|all",
        "A detector, TELESCOPE/NAME where ambiguous, or those of a channel; without it all",
    ),
])))]
pub struct ForecastArgs {
    /// Only a plan's sessions: its folder, or its timeline.json
    #[arg(long, value_name = "PLAN")]
    pub plan: Option<PathBuf>,
    /// Only these targets: mars,jupiter
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub target: Vec<String>,
    /// Who looks.
    #[command(flatten)]
    pub sight: SightArgs,
    /// In windows of what length everything is measured anew
    #[arg(long, value_enum, default_value_t = Window::Mission)]
    pub window: Window,
    /// A folder for figures, PNG and SVG, and for the beam's map as FITS, of one detector or channel
    #[arg(long, value_name = "DIR")]
    pub figure: Option<PathBuf>,
}

/// The length of windows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Window {
    /// 30.4375 d
    Month,
    /// 91.3125 d
    Quarter,
    /// The whole mission
    Mission,
}

impl Window {
    /// Its days; `None` is the mission.
    #[must_use]
    pub const fn days(self) -> Option<f64> {
        match self {
            Self::Month => Some(MONTH_DAYS),
            Self::Quarter => Some(QUARTER_DAYS),
            Self::Mission => None,
        }
    }
}
