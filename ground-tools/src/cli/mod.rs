//! What did the user ask for: the raw arguments of every verb.
//!
//! The options that change the mission are overrides of its keys: `--set` in its order, then the
//! dedicated ones. [`mission`] applies them, and a fault names the option.
//!
//! Limits: `--sun circular` without a longitude takes the mission's, else the real one at the start.

mod arguments;
pub mod places;

pub use arguments::*;

use crate::failure::Failure;
use clap::{ArgAction, Args, ColorChoice, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use formats::rows;
use mission::fault::{Fault, MissionError, Problem};
use mission::number::Number;
use mission::presets;
use mission::quantity;
use mission::{Mission, Override};
use num_rational::BigRational;
use std::path::{Path, PathBuf};

/// Plans how a spinning, precessing space telescope looks at the sky, and when it can calibrate on
/// planets.
#[derive(Debug, Clone, Parser)]
#[command(name = "gyrfalcon", version, propagate_version = true)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub verb: Verb,
    /// What every verb takes.
    #[command(flatten)]
    pub shared: SharedArgs,
}

/// The verbs.
#[derive(Debug, Clone, Subcommand)]
pub enum Verb {
    /// List the presets, show one, or check a mission file
    Missions(MissionsArgs),
    /// Limits on periods and half-wave plates, per telescope, with pass or fail
    Constraints,
    /// Attitude, direction, crossing angle and plate angle over a span
    Pointing(PointingArgs),
    /// Passes of targets through the line of sight or through detectors
    Transits(TransitsArgs),
    /// Visits of targets, sky pixels or directions: how often, how long, when again
    Visits(VisitsArgs),
    /// Hits and cross-link moments of each pixel of the sky: numbers, maps, pictures
    Survey(SurveyArgs),
    /// Moire resonance of precession, spin and orbit: a bound over the tolerances, pass or fail
    Resonance(ResonanceArgs),
    /// Test vectors for flight code: attitudes, directions, plate angles, transits
    Vectors(VectorsArgs),
    /// An attitude history against the mission: residuals, fitted periods and phases, outliers
    Verify(VerifyArgs),
    /// The onboard ephemeris tables
    #[command(subcommand)]
    Table(TableVerb),
    /// The calibration timeline
    Plan(PlanArgs),
    /// The page of a plan again, from its timeline.json
    Report(ReportArgs),
    /// Completions for a shell, on standard output
    Completions {
        /// The shell
        shell: Shell,
    },
}

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
    /// The mission's start with its scale: "2032-04-01T00:00:00 TDB", 2032-04-01T00:00:00Z
    #[arg(long, global = true, value_name = "TIME")]
    pub start: Option<String>,
    /// The mission's length with its unit: 20d, 3.2h, 192.348min, 1.5y (365.25 d each)
    #[arg(long, global = true, value_name = "SPAN")]
    pub duration: Option<String>,
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

/// The mission with the overrides of the command line.
///
/// # Errors
/// [`MissionError`] names the option or the file, the key, the value and the legal range.
pub fn mission(shared: &SharedArgs) -> Result<Mission, MissionError> {
    Mission::load(&shared.mission, &overrides(shared)?)
}

/// The overrides in their order.
fn overrides(shared: &SharedArgs) -> Result<Vec<Override>, MissionError> {
    let mut overrides = Vec::new();
    for text in &shared.set {
        overrides.push(Override::set(text)?);
    }
    let mut option =
        |option: &str, key: &str, value: &str| overrides.push(Override::option(option, key, value));
    if let Some(sun) = &shared.sun {
        match sun.strip_prefix("circular:") {
            None => option("--sun", "orbit.sun", sun),
            Some(longitude) => {
                let longitude = longitude.strip_suffix("deg").unwrap_or(longitude);
                option("--sun", "orbit.sun", "circular");
                option("--sun", "orbit.start_longitude_deg", longitude);
            }
        }
    }
    if let Some(observer) = &shared.observer {
        option("--observer", "orbit.observer", observer);
    }
    if shared.geometric {
        option("--geometric", "orbit.aberration", "false");
    }
    if let Some(trajectory) = &shared.trajectory {
        option("--trajectory", "orbit.trajectory", &from_here(trajectory, &shared.mission));
    }
    if let Some(start) = &shared.start {
        option("--start", "span.start", start);
    }
    if let Some(duration) = &shared.duration {
        let seconds = quantity::seconds(duration).map_err(|error| Fault {
            origin: "--duration".to_owned(),
            line: None,
            problem: Problem::Quantity(error),
        })?;
        let days = Number::from_exact(seconds / BigRational::from_integer(86400.into()));
        option("--duration", "span.duration_days", days.text());
    }
    Ok(overrides)
}

/// A path typed in the current folder, for a mission whose paths count from its own.
fn from_here(path: &str, mission: &str) -> String {
    let elsewhere = presets::find(mission).is_none()
        && Path::new(mission).parent().is_some_and(|folder| !folder.as_os_str().is_empty());
    if path == "l2" || !elsewhere {
        return path.to_owned();
    }
    std::path::absolute(path)
        .map_or_else(|_| path.to_owned(), |path| path.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use mission::orbit::{Observer, Sun, Trajectory};
    use onboard_core::time::Duration;

    fn parse(arguments: &str) -> Result<Cli, String> {
        let words = std::iter::once("gyrfalcon").chain(arguments.split_whitespace());
        Cli::try_parse_from(words).map_err(|error| error.to_string())
    }

    fn load(arguments: &str) -> Result<Mission, String> {
        mission(&parse(arguments)?.shared).map_err(|error| error.to_string())
    }

    #[test]
    fn the_definitions_are_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn dedicated_options_come_after_the_overrides() {
        let mission = load(
            "transits --set orbit.observer=earth --observer sun --geometric --duration 1.5y \
             --sun circular:191.37579428901796 --start 2033-01-01T00:00:00Z --mission pico",
        )
        .unwrap();
        assert_eq!(mission.name, "PICO");
        assert_eq!(mission.orbit.observer, Observer::Sun);
        assert_eq!(mission.orbit.sun, Sun::Circular);
        assert_eq!(mission.orbit.start_longitude_deg.unwrap().text(), "191.37579428901796");
        assert!(!mission.orbit.aberration);
        assert_eq!(mission.span.duration_days.text(), "547.875");
        assert_eq!(mission.span.start.year, 2033);
        let third = load("plan --duration 8h").unwrap();
        assert_eq!(third.span.duration_days.text(), "1/3");
        assert_eq!(third.span.duration.ns(), 28_800_000_000_000);
    }

    #[test]
    fn the_default_is_litebird_as_it_stands() {
        let default = load("plan").unwrap();
        assert_eq!(default.digest(), Mission::load("litebird", &[]).unwrap().digest());
    }

    #[test]
    fn a_fault_names_its_option() {
        for (arguments, sentence) in [
            (
                "plan --duration 20",
                "--duration: 20 has no unit: one of ns, us, ms, s, min, h, d, y is needed",
            ),
            (
                "plan --duration 0d",
                "--duration: span.duration_days = 0 is out of range: a duration above 0 and at most \
                 36525 days is needed",
            ),
            (
                "plan --sun round",
                "--sun: orbit.sun = round is not legal: \"ephemeris\" or \"circular\" is needed",
            ),
            (
                "plan --sun circular:x",
                "--sun: orbit.start_longitude_deg = x is not legal: an angle from -360 to 360 deg is \
                 needed",
            ),
            (
                "plan --observer moon",
                "--observer: orbit.observer = moon is not legal: \"spacecraft\" or \"earth\" or \"sun\" \
                 is needed",
            ),
            (
                "plan --set x",
                "--set: x is not an override: key=value is needed, such as scan.alpha_deg=47.5",
            ),
        ] {
            assert_eq!(load(arguments).unwrap_err(), sentence);
        }
        assert!(
            load("plan --start 2033-01-01T00:00:00").unwrap_err().starts_with("--start: span.")
        );
    }

    #[test]
    fn a_trajectory_counts_from_where_it_is_typed() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("m.toml");
        std::fs::write(&file, "base = \"pico\"").unwrap();
        let path = |arguments: String| {
            let mission = load(&arguments).unwrap();
            let Trajectory::File(file) = &mission.orbit.trajectory else { panic!() };
            mission.path(file)
        };
        assert_eq!(path("plan --trajectory a.bsp".to_owned()), Path::new("a.bsp"));
        let here = path(format!("plan --trajectory a.bsp --mission {}", file.display()));
        assert_eq!(here, std::path::absolute("a.bsp").unwrap());
    }

    #[test]
    fn elapsed_seconds_are_exact() {
        let at = |text: &str| match parse(&format!("pointing --at {text}"))?.verb {
            Verb::Pointing(arguments) => Ok(arguments.at),
            _ => Err("another verb".to_owned()),
        };
        let times = at("0,59.5,94672799.947000001").unwrap();
        let expected = [0, 59_500_000_000, 94_672_799_947_000_001].map(Duration::from_ns);
        assert_eq!(times, expected);
        assert!(at("1.0000000001").unwrap_err().contains("with at most 9 decimals is needed"));
        assert!(at("1e12").unwrap_err().contains("below 292 years"));
        assert!(at("x").unwrap_err().contains("is not a number"));
        assert!(parse("pointing --step 0").unwrap_err().contains("a step above 0 s is needed"));
        assert!(parse("pointing --step 1 --at 2").is_err());
    }
}
