//! The options of `telemetry`: what a spacecraft has sent.

use clap::{Args, Subcommand, ValueEnum};
use formats::telemetry::Part;
use onboard_core::telemetry::MAX_APID;
use std::path::PathBuf;

/// `telemetry`.
#[derive(Debug, Clone, Subcommand)]
pub enum TelemetryVerb {
    /// Rows of a file of payloads, or of CCSDS space packets that hold them
    Decode(DecodeArgs),
}

/// `telemetry decode`.
#[derive(Debug, Clone, Args)]
pub struct DecodeArgs {
    /// The file
    pub file: PathBuf,
    /// Events alone, or housekeeping alone, with their own columns
    #[arg(long, value_name = "WHAT")]
    pub only: Option<Only>,
    /// The packets of this APID alone
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=i64::from(MAX_APID)))]
    pub apid: Option<u16>,
    /// Pass damage over to the next whole payload, and say how much there was
    #[arg(long)]
    pub skip_damaged: bool,
}

/// A part of the payloads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Only {
    /// What the sequencers report
    Events,
    /// How they are
    Housekeeping,
}

impl DecodeArgs {
    /// Which payloads become rows.
    #[must_use]
    pub fn part(&self) -> Part {
        match self.only {
            None => Part::All,
            Some(Only::Events) => Part::Events,
            Some(Only::Housekeeping) => Part::Housekeeping,
        }
    }
}
