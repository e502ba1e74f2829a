//! The options of each verb.
//!
//! Limits: durations and angles are text here; the verbs read them, so that a fault names its option.

use clap::{ArgAction, Args, Subcommand, ValueEnum};
use formats::products;
use mission::number::Number;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};
use onboard_core::time::Duration;
use std::num::{NonZeroU32, NonZeroUsize};
use std::path::PathBuf;

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
pub struct PointingArgs {
    /// Seconds between rows on the scan clock, such as 0.05; needed unless --at or --format aem is
    /// there
    #[arg(long, value_name = "SECONDS", value_parser = step, conflicts_with = "at")]
    pub step: Option<Duration>,
    /// Elapsed seconds on the scan clock, such as 0,59.5,1234.567
    #[arg(long, value_name = "S1,S2,...", value_parser = elapsed, value_delimiter = ',')]
    pub at: Vec<Duration>,
    /// This telescope's line of sight
    #[arg(long, value_name = "NAME")]
    pub telescope: Option<String>,
    /// A detector, TELESCOPE/NAME where ambiguous; without it the mission boresight
    #[arg(long, value_name = "NAME")]
    pub detector: Option<String>,
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
    /// Only this telescope
    #[arg(long, value_name = "NAME")]
    pub telescope: Option<String>,
    /// A detector, TELESCOPE/NAME where ambiguous, or all; without it the mission boresight
    #[arg(long, value_name = "NAME|all")]
    pub detector: Option<String>,
}

/// `visits`.
#[derive(Debug, Clone, Args)]
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
    #[arg(long, value_name = "N", default_value_t = crate::cli::places::DEFAULT_NSIDE)]
    pub nside: u32,
    /// Pixels are numbered in NESTED order, not in RING order
    #[arg(long)]
    pub nested: bool,
    /// Only this telescope
    #[arg(long, value_name = "NAME")]
    pub telescope: Option<String>,
    /// A detector, TELESCOPE/NAME where ambiguous, or all; without it the mission boresight
    #[arg(long, value_name = "NAME|all")]
    pub detector: Option<String>,
    /// Count samples as the paper does, not crossings
    #[arg(long)]
    pub sampled: bool,
    /// Sampling rate in Hz; without it the mission's
    #[arg(long, value_name = "HZ", requires = "sampled", allow_hyphen_values = true)]
    pub rate: Option<String>,
    /// Write histograms of revisit, gap and dwell into this folder, as PNG
    #[arg(long, value_name = "DIR")]
    pub png: Option<PathBuf>,
    /// Write them as SVG
    #[arg(long, value_name = "DIR")]
    pub svg: Option<PathBuf>,
}

/// `survey`.
#[derive(Debug, Clone, Args)]
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
    /// Only this telescope: its detectors, or its line of sight where it lists none
    #[arg(long, value_name = "NAME")]
    pub telescope: Option<String>,
    /// A detector, TELESCOPE/NAME where ambiguous, or all; without it the mission boresight
    #[arg(long, value_name = "NAME|all")]
    pub detector: Option<String>,
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
    /// A folder for pictures as PNG
    #[arg(long, value_name = "DIR")]
    pub png: Option<PathBuf>,
    /// A folder for pictures as SVG
    #[arg(long, value_name = "DIR")]
    pub svg: Option<PathBuf>,
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
}

impl From<SkyFrame> for formats::fits::MapFrame {
    fn from(frame: SkyFrame) -> Self {
        match frame {
            SkyFrame::Ecliptic => Self::Ecliptic,
            SkyFrame::Galactic => Self::Galactic,
        }
    }
}

/// `resonance`.
#[derive(Debug, Clone, Args)]
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
    /// A folder for the figure as PNG
    #[arg(long, value_name = "DIR")]
    pub png: Option<PathBuf>,
    /// A folder for the figure as SVG
    #[arg(long, value_name = "DIR")]
    pub svg: Option<PathBuf>,
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

/// `vectors`.
#[derive(Debug, Clone, Args)]
pub struct VectorsArgs {
    /// How many instants over the mission, both ends included; 1000 where nothing is said
    #[arg(long, value_name = "N", conflicts_with_all = ["at", "step"])]
    pub count: Option<NonZeroU32>,
    /// Draw the instants at random instead, the same for the same seed
    #[arg(long, value_name = "N", conflicts_with_all = ["at", "step"])]
    pub seed: Option<u64>,
    /// Seconds between instants on the scan clock, such as 0.05
    #[arg(long, value_name = "SECONDS", value_parser = step, conflicts_with = "at")]
    pub step: Option<Duration>,
    /// Elapsed seconds on the scan clock, such as 0,59.5,1234.567
    #[arg(long, value_name = "S1,S2,...", value_parser = elapsed, value_delimiter = ',')]
    pub at: Vec<Duration>,
    /// Transits of these targets only: mars,jupiter
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub target: Vec<String>,
    /// This telescope's lines of sight
    #[arg(long, value_name = "NAME")]
    pub telescope: Option<String>,
    /// A detector, TELESCOPE/NAME where ambiguous, or all; without it the mission boresight
    #[arg(long, value_name = "NAME|all")]
    pub detector: Option<String>,
    /// Directions out of this uplink table, as the flight code reads it
    #[arg(long, value_name = "FILE")]
    pub table: Option<PathBuf>,
}

/// `verify`.
#[derive(Debug, Clone, Args)]
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
    /// The quaternions are of this telescope's frame, not of the mission boresight's
    #[arg(long, value_name = "NAME")]
    pub telescope: Option<String>,
    /// The quaternions are of this detector's frame; TELESCOPE/NAME where ambiguous
    #[arg(long, value_name = "NAME")]
    pub detector: Option<String>,
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
        /// The uplink's sequence number, growing with every uplink
        #[arg(long, value_name = "N", default_value_t = 1)]
        sequence: u32,
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
    /// The record's sequence number, growing with every record
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub sequence: u32,
}

/// `plan`.
#[derive(Debug, Clone, Args)]
pub struct PlanArgs {
    /// Write into a folder that is not empty and that plan did not write
    #[arg(long)]
    pub force: bool,
    /// Exit 1 where a check of the plan fails
    #[arg(long)]
    pub strict: bool,
    /// The uplink table's sequence number, growing with every uplink
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub sequence: u32,
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
    /// The products that were asked for, each once.
    #[must_use]
    pub fn also(&self) -> Vec<products::Also> {
        let all = self.also.contains(&Also::All);
        let pairs = [
            (Also::Parquet, products::Also::Parquet),
            (Also::AemXml, products::Also::AemXml),
            (Also::Ppl, products::Also::Ppl),
            (Also::Stk, products::Also::Stk),
            (Also::Ck, products::Also::Ck),
        ];
        let wanted = |it: &&(Also, products::Also)| all || self.also.contains(&it.0);
        pairs.iter().filter(wanted).map(|it| it.1).collect()
    }
}

/// The products of `plan`.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Products")]
pub struct ProductArgs {
    /// Products beside those that are always written: parquet,stk
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

/// An error of interpolation in seconds of arc.
fn arcseconds(text: &str) -> Result<f64, String> {
    let value = Number::parse(text).map_err(|error| error.to_string())?.to_f64();
    if (1e-3..=60.0).contains(&value) {
        Ok(value)
    } else {
        Err(format!("{text} arcsec: an error from 0.001 to 60 arcsec is needed"))
    }
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

/// Elapsed seconds, exact to the nanosecond.
fn elapsed(text: &str) -> Result<Duration, String> {
    let number = Number::parse(text).map_err(|error| error.to_string())?;
    let ns = number.exact() * BigRational::from_integer(1_000_000_000.into());
    if !ns.is_integer() || ns.is_negative() {
        return Err(format!("{text} s: a number from 0 with at most 9 decimals is needed"));
    }
    let ns = ns.numer().to_i64();
    ns.map(Duration::from_ns).ok_or_else(|| format!("{text} s: a number below 292 years is needed"))
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

fn step(text: &str) -> Result<Duration, String> {
    let step = elapsed(text)?;
    if step == Duration::ZERO { Err("a step above 0 s is needed".to_owned()) } else { Ok(step) }
}
