//! One module per verb, and what they share: warnings, summaries, where results go.

mod missions;
mod constraints;
mod pointing;
mod transits;
mod visits;
mod survey;
mod resonance;
mod vectors;
mod verify;
mod table;
mod plan;
mod report;

use crate::cli::{Cli, Format, SharedArgs, Verb};
use crate::failure::Failure;
use crate::output::{Sink, to_stdout};
use clap::CommandFactory;
use formats::rows::{self, Column, Layout};
use mission::Mission;
use planner::provenance::Provenance;
use planner::world::World;
use serde::Serialize;
use std::fmt::Display;

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
        Verb::Survey(arguments) => survey::run(shared, arguments),
        Verb::Resonance(arguments) => resonance::run(shared, arguments),
        Verb::Vectors(arguments) => vectors::run(shared, arguments),
        Verb::Verify(arguments) => verify::run(shared, arguments),
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

/// The mission of the command line, its warnings told.
fn mission(shared: &SharedArgs) -> Result<Mission, Failure> {
    let mission = crate::cli::mission(shared)?;
    warn(shared, &mission.warnings);
    Ok(mission)
}

/// The mission of the command line among the planets.
fn world(shared: &SharedArgs) -> Result<World, Failure> {
    Ok(World::open(mission(shared)?, shared.ephemeris.as_deref())?)
}

/// Warnings go to standard error, unless quiet.
#[expect(clippy::print_stderr, reason = "warnings belong on standard error")]
fn warn<W: Display>(shared: &SharedArgs, warnings: &[W]) {
    if !shared.quiet {
        for warning in warnings {
            eprintln!("warning: {warning}");
        }
    }
}

/// Where rows go.
fn sink(shared: &SharedArgs) -> Sink {
    shared.out.as_ref().map_or(Sink::Stdout, |path| {
        if path.as_os_str() == "-" { Sink::Stdout } else { Sink::File(path.clone()) }
    })
}

/// Rows go to `--out` or standard output; with `--json` a summary goes to standard output, and rows
/// only to a file.
fn deliver<R, S: Serialize>(
    shared: &SharedArgs,
    rows: impl Iterator<Item = Result<R, Failure>>,
    (provenance, columns): (&Provenance, &[Column<R>]),
    summary: impl FnOnce() -> Result<S, Failure>,
) -> Result<(), Failure> {
    let sink = sink(shared);
    if !(shared.json && sink == Sink::Stdout) {
        let format = shared.format.unwrap_or(Format::Csv).of_rows()?;
        let layout = Layout { format, provenance, columns };
        sink.write_with(|out| rows::write(out, rows, &layout))?;
    }
    if shared.json { print_json(&summary()?) } else { Ok(()) }
}

/// Which ends of a span in view are the mission's own.
const fn clipped(entry: bool, exit: bool) -> &'static str {
    match (entry, exit) {
        (false, false) => "",
        (true, false) => "entry",
        (false, true) => "exit",
        (true, true) => "both",
    }
}

/// An object on standard output, one line.
fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let mut text = serde_json::to_string(value).map_err(Failure::internal)?;
    text.push('\n');
    to_stdout(text.as_bytes())
}

/// Text for a person on standard output, unless quiet.
fn tell(shared: &SharedArgs, text: &str) -> Result<(), Failure> {
    if shared.quiet { Ok(()) } else { to_stdout(text.as_bytes()) }
}
