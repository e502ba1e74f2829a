//! The options of `verify`.

use super::meaning::meaning;
use super::sight::SightArgs;
use clap::{Args, ValueEnum};
use mission::number::Number;
use std::path::PathBuf;

/// `verify`.
#[derive(Debug, Clone, Args)]
#[command(mut_args(meaning(&[
    (
        "telescope",
        "NAME",
        "The quaternions are of this telescope's frame, not of the mission boresight's",
    ),
    (
        "detector",
        "NAME",
        "The quaternions are of this detector's frame; TELESCOPE/NAME where ambiguous",
    ),
])))]
pub struct VerifyArgs {
    /// The history: a CSV as pointing writes, or a CCSDS AEM in KVN or XML; - is standard input
    #[arg(default_value = "-")]
    pub file: PathBuf,
    /// A CSV's reference frame; an AEM names its own
    #[arg(long, value_name = "FRAME")]
    pub frame: Option<ReferenceFrame>,
    /// The quaternions take the reference frame's components to the body's, not back
    #[arg(long)]
    pub inverse: bool,
    /// Whose frame the quaternions are of.
    #[command(flatten)]
    pub sight: SightArgs,
    /// Largest residual that passes
    #[arg(long, value_name = "ANGLE", default_value = "1arcsec")]
    pub limit: String,
    /// What --limit is held against: the mission, every row; or the fit, the rows it used
    #[arg(long, value_name = "WHAT", default_value = "mission")]
    pub against: Against,
    /// Largest error of the periods that is looked for, in percent
    #[arg(long, value_name = "PERCENT", default_value = "1", value_parser = percent)]
    pub search: f64,
}

/// A reference frame of quaternions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ReferenceFrame {
    /// Ecliptic of J2000, as pointing writes
    Ecliptic,
    /// ICRF, EME2000 or J2000
    Icrf,
}

/// What residuals are held against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Against {
    /// The mission's periods, phases and alpha
    Mission,
    /// The fitted ones
    Fit,
}

/// A percentage above 0 and below 50, as a fraction.
fn percent(text: &str) -> Result<f64, String> {
    let value = Number::parse(text).map_err(|error| error.to_string())?.to_f64();
    if value > 0.0 && value < 50.0 {
        Ok(value / 100.0)
    } else {
        Err(format!("{text} %: a percentage above 0 and below 50 is needed"))
    }
}
