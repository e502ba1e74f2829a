//! The options that every verb takes, and the forms of rows.

use crate::failure::Failure;
use clap::{ArgAction, Args, ColorChoice, ValueEnum};
use formats::rows;
use mission::presets;
use std::path::PathBuf;

const SET_HELP: &str = "Set a key of the mission, again and again: --set scan.alpha_deg=47.5, --set \
                        telescope.HFT.fwhm_arcmin=20, --set calibration.targets=mars,jupiter";

/// The options that every verb takes.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Mission and output")]
pub struct SharedArgs {
    /// A preset (litebird, pico, planck, wmap, epic, core) or a mission file
    #[arg(long, global = true, value_name = "PRESET|FILE", default_value = presets::NAMES[0])]
    pub mission: String,
    /// Overrides of the mission's keys, in their order.
    #[arg(long, global = true, value_name = "KEY=VALUE", action = ArgAction::Append, help = SET_HELP)]
    pub set: Vec<String>,
    /// ephemeris, circular, or circular:LONGITUDE with the anti-Sun longitude at the start in deg
    #[arg(long, global = true, value_name = "MODEL")]
    pub sun: Option<String>,
    /// Whence targets are seen: spacecraft, earth or sun
    #[arg(long, global = true, value_name = "WHERE")]
    pub observer: Option<String>,
    /// Turn light time and aberration off
    #[arg(long, global = true)]
    pub geometric: bool,
    /// A planetary SPK instead of the embedded DE440 excerpt
    #[arg(long, global = true, value_name = "BSP")]
    pub ephemeris: Option<PathBuf>,
    /// The spacecraft's trajectory: l2, an SPK or a CCSDS OEM file
    #[arg(long, global = true, value_name = "BSP|OEM")]
    pub trajectory: Option<String>,
    /// Move the mission and its scan clock: "2032-04-01T00:00:00 TDB", 2032-04-01T00:00:00Z
    #[arg(long, global = true, value_name = "TIME")]
    pub start: Option<String>,
    /// The length of the mission, or from --from on, with its unit: 20d, 3.2h, 192.348min, 1.5y (365.25 d each)
    #[arg(long, global = true, value_name = "SPAN")]
    pub duration: Option<String>,
    /// Look at the mission from here on: 2033-05-01, "2033-05-01T12:00:00 TDB", or +30d after its start
    #[arg(long, global = true, value_name = "TIME")]
    pub from: Option<String>,
    /// Look at the mission until here: a time, or +30d after --from
    #[arg(long, global = true, value_name = "TIME", conflicts_with = "duration")]
    pub until: Option<String>,
    /// Where results go; - is standard output
    #[arg(long, global = true, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// The form of rows
    #[arg(long, global = true)]
    pub format: Option<Format>,
    /// Print a machine-readable summary on standard output
    #[arg(long, global = true)]
    pub json: bool,
    /// Neither progress nor warnings
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Colour on standard error
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    pub color: ColorChoice,
}

/// The form of rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Comma-separated values
    Csv,
    /// One JSON object per line
    Jsonl,
    /// Apache Parquet
    Parquet,
    /// A C99 header, of `vectors` alone
    C,
    /// A CCSDS attitude ephemeris message, of `pointing` alone
    Aem,
}

impl Format {
    /// The form of rows; a form that one verb alone writes is refused.
    ///
    /// # Errors
    /// [`Failure::Input`] says which verb takes it.
    pub fn of_rows(self) -> Result<rows::Format, Failure> {
        let alone = |format: &str, verb: &str| {
            Err(Failure::Input(format!(
                "--format {format} is a form of {verb} alone: csv, jsonl or parquet is needed"
            )))
        };
        match self {
            Self::Csv => Ok(rows::Format::Csv),
            Self::Jsonl => Ok(rows::Format::Jsonl),
            Self::Parquet => Ok(rows::Format::Parquet),
            Self::C => alone("c", "vectors"),
            Self::Aem => alone("aem", "pointing"),
        }
    }
}
