//! What each verb does: one module per verb, after what they share.

mod told;
mod asked;
mod delivered;
mod earlier;

mod missions;
mod constraints;
mod pointing;
mod transits;
mod visits;
mod forecast;
mod survey;
mod resonance;
mod vectors;
mod verify;
mod telemetry;
mod table;
mod plan;
mod report;

use crate::cli::{Cli, Verb};
use crate::failure::Failure;
use clap::CommandFactory;
use delivered::sink;

/// Does what the command line says.
///
/// # Errors
/// [`Failure`] with the exit code and a sentence.
pub fn run(cli: &Cli) -> Result<(), Failure> {
    let shared = &cli.shared;
    match &cli.verb {
        Verb::Missions(arguments) => missions::run(shared, arguments),
        Verb::Constraints => constraints::run(shared),
        Verb::Pointing(arguments) => pointing::run(shared, arguments),
        Verb::Transits(arguments) => transits::run(shared, arguments),
        Verb::Visits(arguments) => visits::run(shared, arguments),
        Verb::Forecast(arguments) => forecast::run(shared, arguments),
        Verb::Survey(arguments) => survey::run(shared, arguments),
        Verb::Resonance(arguments) => resonance::run(shared, arguments),
        Verb::Vectors(arguments) => vectors::run(shared, arguments),
        Verb::Verify(arguments) => verify::run(shared, arguments),
        Verb::Telemetry(verb) => telemetry::run(shared, verb),
        Verb::Table(verb) => table::run(shared, verb),
        Verb::Plan(arguments) => plan::run(shared, arguments),
        Verb::Report(arguments) => report::run(shared, arguments),
        Verb::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Cli::command(), "gyrfalcon", &mut script);
            sink(shared).write(&script)
        }
    }
}
