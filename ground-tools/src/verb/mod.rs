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
mod systematics;
mod vectors;
mod verify;
mod telemetry;
mod table;
mod plan;
mod report;

use crate::cli::{Cli, SharedArgs, Verb};
use crate::failure::Failure;
use clap::CommandFactory;
use delivered::{form, sink};

/// Does what the command line says.
///
/// # Errors
/// [`Failure`] with the exit code and a sentence.
pub fn run(cli: &Cli) -> Result<(), Failure> {
    let shared = &cli.shared;
    check_form(shared, &cli.verb)?;
    match &cli.verb {
        Verb::Missions(arguments) => missions::run(shared, arguments),
        Verb::Constraints => constraints::run(shared),
        Verb::Pointing(arguments) => pointing::run(shared, arguments),
        Verb::Transits(arguments) => transits::run(shared, arguments),
        Verb::Visits(arguments) => visits::run(shared, arguments),
        Verb::Forecast(arguments) => forecast::run(shared, arguments),
        Verb::Survey(arguments) => survey::run(shared, arguments),
        Verb::Resonance(arguments) => resonance::run(shared, arguments),
        Verb::Systematics(arguments) => systematics::run(shared, arguments),
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

/// Refuses a form of rows where none are written, and one that `--out` does not say, before the work.
fn check_form(shared: &SharedArgs, verb: &Verb) -> Result<(), Failure> {
    let has_rows = match verb {
        Verb::Pointing(_)
        | Verb::Transits(_)
        | Verb::Visits(_)
        | Verb::Vectors(_)
        | Verb::Verify(_)
        | Verb::Telemetry(_) => true,
        Verb::Resonance(arguments) => arguments.scan.is_some(),
        _ => false,
    };
    match (has_rows, shared.format) {
        (true, _) => form(shared).map(drop),
        (false, Some(_)) => Err(Failure::Input(
            "--format is the form of rows, and none are written here: pointing, transits, visits, \
             vectors, verify, telemetry and resonance --scan write them"
                .to_owned(),
        )),
        (false, None) => Ok(()),
    }
}
