//! The options of `plan` and `report`.

use super::onboard::SequenceArgs;
use crate::cli::quantities::arcseconds;
use clap::{Args, ValueEnum};
use formats::products;
use std::path::PathBuf;

/// `plan`.
#[derive(Debug, Clone, Args)]
pub struct PlanArgs {
    /// Write into a folder that is not empty and that plan did not write
    #[arg(long)]
    pub force: bool,
    /// Exit 1 where a check of the plan fails
    #[arg(long)]
    pub strict: bool,
    /// The uplink table's number among the uplinks.
    #[command(flatten)]
    pub sequence: SequenceArgs,
    /// What a person asks of the schedule.
    #[command(flatten)]
    pub revision: RevisionArgs,
    /// What the files hold and say.
    #[command(flatten)]
    pub products: ProductArgs,
}

/// What a person asks of the schedule.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Schedule")]
pub struct RevisionArgs {
    /// End the search after this time, 20s, with the best schedule so far; outputs then depend on the
    /// machine
    #[arg(long, value_name = "DURATION")]
    pub time_limit: Option<String>,
    /// An earlier plan of this mission to stay close to: its folder, or its timeline.json
    #[arg(long, value_name = "PLAN")]
    pub against: Option<PathBuf>,
    /// What each session added to or dropped from the earlier plan must bring to the objective; a
    /// tenth of what its sessions bring on average, unless said
    #[arg(long, value_name = "OBJECTIVE", requires = "against", allow_negative_numbers = true)]
    pub change_price: Option<f64>,
    /// Before this time the earlier plan stays as it is: 2032-06-01T00:00:00Z
    #[arg(long, value_name = "TIME", requires = "against")]
    pub freeze_until: Option<String>,
    /// Sessions that must stand, by id: HFT-mars-000012,...
    #[arg(long, value_name = "ID,...", value_delimiter = ',')]
    pub fix: Vec<String>,
    /// Sessions that must not stand, by id
    #[arg(long, value_name = "ID,...", value_delimiter = ',')]
    pub forbid: Vec<String>,
}

/// A product on request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Also {
    /// timeline.parquet: the timeline as Apache Parquet
    Parquet,
    /// attitude.aem: the attitude as CCSDS AEM
    Aem,
    /// attitude.xml: the AEM in XML
    AemXml,
    /// pointing-periods.csv: what is observed when, between sessions too
    Ppl,
    /// attitude.a and sessions.int, for STK
    Stk,
    /// attitude.bc, clock.tsc and frame.tf, for SPICE
    Ck,
    /// All of them
    All,
}

impl ProductArgs {
    /// The products that were asked for, each once; attitudes of all the mission are an AEM's.
    #[must_use]
    pub fn also(&self) -> Vec<products::Also> {
        let all = self.also.contains(&Also::All);
        let pairs = [
            (Also::Parquet, products::Also::Parquet),
            (Also::Aem, products::Also::Aem),
            (Also::AemXml, products::Also::AemXml),
            (Also::Ppl, products::Also::Ppl),
            (Also::Stk, products::Also::Stk),
            (Also::Ck, products::Also::Ck),
        ];
        let whole = self.also.is_empty() && self.aem_span == AttitudeSpan::All;
        let wanted = |it: &&(Also, products::Also)| {
            all || self.also.contains(&it.0) || (whole && it.0 == Also::Aem)
        };
        pairs.iter().filter(wanted).map(|it| it.1).collect()
    }
}

/// The products of `plan`.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Products")]
pub struct ProductArgs {
    /// Products beside those that are always written: aem,parquet
    #[arg(long, value_name = "PRODUCT,...", value_delimiter = ',')]
    pub also: Vec<Also>,
    /// Largest error of interpolation between samples of the attitude, in seconds of arc
    #[arg(long, value_name = "ARCSEC", default_value = "1", value_parser = arcseconds,
          allow_hyphen_values = true)]
    pub aem_error_arcsec: f64,
    /// Attitudes of the sessions, or of all the mission
    #[arg(long, value_name = "SPAN", default_value = "sessions")]
    pub aem_span: AttitudeSpan,
    /// When the files say they were made: 2032-03-01T00:00:00Z; without it `SOURCE_DATE_EPOCH`, or
    /// the mission's start
    #[arg(long, value_name = "TIME")]
    pub stamp: Option<String>,
    /// The spacecraft's NAIF number in SPICE kernels
    #[arg(long, value_name = "ID", default_value_t = -999, allow_negative_numbers = true,
          value_parser = clap::value_parser!(i32).range(-2_000_000..=-1))]
    pub naif_id: i32,
}

/// Where attitudes are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum AttitudeSpan {
    /// Each session, padded
    Sessions,
    /// The whole mission
    All,
}

/// `report`.
#[derive(Debug, Clone, Args)]
pub struct ReportArgs {
    /// The folder that plan wrote
    #[arg(value_name = "PLANFOLDER")]
    pub folder: PathBuf,
    /// An earlier plan to show the difference from: its folder, or its timeline.json
    #[arg(long, value_name = "PLAN")]
    pub against: Option<PathBuf>,
}
