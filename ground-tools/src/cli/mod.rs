//! What did the user ask for: the raw arguments of every verb, and the mission that they name.

pub mod places;
pub(crate) mod quantities;
mod shared;
mod arguments;
mod overrides;
mod window;

pub use arguments::*;
pub use overrides::mission;
pub use shared::{Format, SharedArgs};
pub use window::{Window, window};

use clap::{Parser, Subcommand};
use clap_complete::Shell;

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
    /// What passes teach: errors of gain, pointing, beam, time constant, polarisation angle
    Forecast(ForecastArgs),
    /// Hits and cross-link moments of each pixel of the sky: numbers, maps, pictures
    Survey(SurveyArgs),
    /// Moire resonance of precession, spin and orbit: a bound over the tolerances, pass or fail
    Resonance(ResonanceArgs),
    /// Instrumental systematics through the scan: spectra of what they leave, and the bias on r
    Systematics(SystematicsArgs),
    /// Test vectors for flight code: attitudes, directions, plate angles, transits
    Vectors(VectorsArgs),
    /// An attitude history against the mission: residuals, fitted periods and phases, outliers
    Verify(VerifyArgs),
    /// What the spacecraft has sent: events, states, housekeeping
    #[command(subcommand)]
    Telemetry(TelemetryVerb),
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

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definitions_are_sound() {
        Cli::command().debug_assert();
    }
}
