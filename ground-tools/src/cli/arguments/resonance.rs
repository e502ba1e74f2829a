//! The options of `resonance`.

use super::figures::FigureArgs;
use super::meaning::meaning;
use clap::Args;

/// `resonance`.
#[derive(Debug, Clone, Args)]
#[command(mut_args(meaning(&[
    ("png", "DIR", "A folder for the figure as PNG"),
    ("svg", "DIR", "A folder for the figure as SVG"),
])))]
pub struct ResonanceArgs {
    /// Resolution of the map whose hits are judged, a power of two up to 512; without it 128
    #[arg(long, value_name = "N", conflicts_with = "fwhm")]
    pub nside: Option<u32>,
    /// A beam's full width at half maximum instead of pixels: 30arcmin
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    pub fwhm: Option<String>,
    /// How well both periods are held instead of the mission's tolerance: 0.6s,0.06s
    #[arg(long, value_name = "PRECESSION,SPIN", allow_hyphen_values = true)]
    pub tolerance: Option<String>,
    /// Excess over the floor that passes, in percent
    #[arg(long, value_name = "PERCENT", default_value = "1", allow_hyphen_values = true)]
    pub allow: String,
    /// Rows of predicted sigma over precession periods in minutes: 192:193:0.0025
    #[arg(long, value_name = "LO:HI:STEP", allow_hyphen_values = true)]
    pub scan: Option<String>,
    /// The figure.
    #[command(flatten)]
    pub figures: FigureArgs,
    /// Recommend a precession period out of these minutes; without it within 0.25 % of the mission's
    #[arg(long, value_name = "LO:HI[:STEP]", allow_hyphen_values = true)]
    pub precession_range: Option<String>,
    /// Recommend a spin period out of these minutes too; without it the mission's
    #[arg(long, value_name = "LO:HI[:STEP]", allow_hyphen_values = true)]
    pub spin_range: Option<String>,
    /// Predict the means of these cross-link factors too: 1,2,4
    #[arg(long, value_name = "N,...", value_delimiter = ',')]
    pub crosslink: Vec<u32>,
    /// What holds the rates.
    #[command(flatten)]
    pub actuators: ActuatorArgs,
}

/// The tolerance out of what holds the rates, in place of `--tolerance`.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Actuators")]
pub struct ActuatorArgs {
    /// Error that control leaves in the precession's rate: 0.001arcsec/s
    #[arg(long, value_name = "RATE", allow_hyphen_values = true, conflicts_with = "tolerance")]
    pub precession_rate_error: Option<String>,
    /// Step in which wheels set the precession's rate
    #[arg(long, value_name = "RATE", allow_hyphen_values = true, conflicts_with = "tolerance")]
    pub precession_rate_step: Option<String>,
    /// Drift of the precession's rate: 0.0001arcsec/s/d
    #[arg(long, value_name = "DRIFT", allow_hyphen_values = true, conflicts_with = "tolerance")]
    pub precession_rate_drift: Option<String>,
    /// Error that control leaves in the spin's rate
    #[arg(long, value_name = "RATE", allow_hyphen_values = true, conflicts_with = "tolerance")]
    pub spin_rate_error: Option<String>,
    /// Step in which wheels set the spin's rate
    #[arg(long, value_name = "RATE", allow_hyphen_values = true, conflicts_with = "tolerance")]
    pub spin_rate_step: Option<String>,
    /// Drift of the spin's rate
    #[arg(long, value_name = "DRIFT", allow_hyphen_values = true, conflicts_with = "tolerance")]
    pub spin_rate_drift: Option<String>,
    /// Time between corrections of the rates: 7d
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, conflicts_with = "tolerance")]
    pub correct_every: Option<String>,
}
