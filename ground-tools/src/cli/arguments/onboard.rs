//! The options of `vectors` and `table`: what flight code is tested with, and what goes on board.

use super::instants::InstantArgs;
use super::meaning::meaning;
use super::sight::SightArgs;
use clap::{Args, Subcommand};
use std::num::NonZeroU32;
use std::path::PathBuf;

/// `vectors`.
#[derive(Debug, Clone, Args)]
#[command(mut_args(meaning(&[("telescope", "NAME", "This telescope's lines of sight")])))]
pub struct VectorsArgs {
    /// How many instants over the mission, both ends included; 1000 where nothing is said
    #[arg(long, value_name = "N", conflicts_with_all = ["at", "step"])]
    pub count: Option<NonZeroU32>,
    /// Draw the instants at random instead, the same for the same seed
    #[arg(long, value_name = "N", conflicts_with_all = ["at", "step"])]
    pub seed: Option<u64>,
    /// Instants that are named.
    #[command(flatten)]
    pub instants: InstantArgs,
    /// Transits of these targets only: mars,jupiter
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub target: Vec<String>,
    /// The lines of sight.
    #[command(flatten)]
    pub sight: SightArgs,
    /// Directions out of this uplink table, as the flight code reads it
    #[arg(long, value_name = "FILE")]
    pub table: Option<PathBuf>,
}

/// `table`.
#[derive(Debug, Clone, Subcommand)]
pub enum TableVerb {
    /// Fit the Sun and the targets over the mission, to --out (default uplink.tbl)
    Build {
        /// Largest error of a direction with its unit: 1mas, 0.01arcsec
        #[arg(long, value_name = "ANGLE", default_value = "1mas")]
        error: String,
        /// These bodies instead of the mission's targets: `mercury,venus,moon,earth,tau_a`
        #[arg(long, value_name = "NAME", value_delimiter = ',')]
        target: Vec<String>,
        /// Its number among the uplinks.
        #[command(flatten)]
        sequence: SequenceArgs,
    },
    /// Say what a table holds
    Inspect {
        /// The table
        file: PathBuf,
    },
    /// Say what changes when a second table follows a first one
    Diff {
        /// The table on board
        old: PathBuf,
        /// The table to follow it
        new: PathBuf,
    },
    /// Compare a table with the ephemeris; exit 1 where it misses
    Verify {
        /// The table
        file: PathBuf,
        /// Largest error of a direction that passes
        #[arg(long, value_name = "ANGLE", default_value = "1mas")]
        error: String,
    },
    /// Write a clock correlation, to --out (default clock.tbl)
    Clock(ClockArgs),
    /// Write the order to return to an older table, to --out (default rollback.tbl)
    Rollback {
        /// The active table, to be left
        active: PathBuf,
        /// The older table in the other slot, to return to
        older: PathBuf,
        /// Last time at which the order may be carried out: 2032-05-01T00:00:00Z
        #[arg(long, value_name = "TIME")]
        until: String,
    },
    /// Write the order to take a table of another spacecraft, to --out (default change.tbl)
    Change {
        /// The active table, to be left
        active: PathBuf,
        /// The other spacecraft's table, to be uploaded with the order
        new: PathBuf,
        /// Last time at which the order may be carried out: 2032-05-01T00:00:00Z
        #[arg(long, value_name = "TIME")]
        until: String,
    },
}

/// The number of what is sent up.
#[derive(Debug, Clone, Args)]
pub struct SequenceArgs {
    /// Its sequence number, above every earlier one by at most 1000; without it the one after --after
    #[arg(long, value_name = "N")]
    pub sequence: Option<u32>,
    /// The newest sequence number on board, in use or rolled back; 0 where there is none
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub after: u32,
}

/// `table clock`.
#[derive(Debug, Clone, Args)]
pub struct ClockArgs {
    /// The on-board counter at the reference
    #[arg(long, value_name = "N")]
    pub ticks: u64,
    /// The reference: 2032-04-01T00:00:00Z
    #[arg(long, value_name = "TIME")]
    pub at: String,
    /// Length of a tick in ns of TAI: 1000.0023, or a quotient such as 1e9/65536
    #[arg(long, value_name = "NS")]
    pub tick_ns: String,
    /// For how long after the reference it may be used: 7d
    #[arg(long, value_name = "DURATION")]
    pub valid_for: String,
    /// First time at which it may be used; without it the reference
    #[arg(long, value_name = "TIME")]
    pub valid_from: Option<String>,
    /// Standard uncertainty of the reference in ns
    #[arg(long, value_name = "NS", default_value_t = 0)]
    pub uncertainty_ns: u32,
    /// Its number among the records.
    #[command(flatten)]
    pub sequence: SequenceArgs,
}
