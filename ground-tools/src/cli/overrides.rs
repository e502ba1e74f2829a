//! Which mission did the user ask for: a preset or a file, and the keys that options override.
//!
//! `--set` comes first, in its order, then the dedicated options; a fault names the option.
//!
//! Limits: `--sun circular` without a longitude takes the mission's, else the real one at the start.

use super::shared::SharedArgs;
use mission::fault::{Fault, MissionError, Problem};
use mission::number::Number;
use mission::presets;
use mission::quantity;
use mission::{Mission, Override};
use num_rational::BigRational;
use std::path::Path;

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
    if let Some(duration) = shared.duration.as_ref().filter(|_| shared.from.is_none()) {
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
    use crate::cli::Cli;
    use clap::Parser;
    use mission::orbit::{Observer, Sun, Trajectory};

    fn load(arguments: &str) -> Result<Mission, String> {
        let words = std::iter::once("gyrfalcon").chain(arguments.split_whitespace());
        let cli = Cli::try_parse_from(words).map_err(|error| error.to_string())?;
        mission(&cli.shared).map_err(|error| error.to_string())
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
                "--duration: 20 has no unit: one of ns, us, ms, s, min, h, d, w, y is needed",
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
}
