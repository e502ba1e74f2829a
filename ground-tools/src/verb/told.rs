//! What a person or a program is told: warnings, text, JSON.

use crate::cli::SharedArgs;
use crate::failure::Failure;
use crate::message::for_terminal;
use crate::output::to_stdout;
use serde::Serialize;
use std::fmt::Display;

/// Warnings go to standard error, unless quiet.
#[expect(clippy::print_stderr, reason = "warnings belong on standard error")]
pub(super) fn warn<W: Display>(shared: &SharedArgs, warnings: &[W]) {
    if !shared.quiet {
        for warning in warnings {
            eprintln!("warning: {}", for_terminal(&warning.to_string()));
        }
    }
}

/// An object as one line.
pub(super) fn json_line(value: &impl Serialize) -> Result<String, Failure> {
    let mut text = serde_json::to_string(value).map_err(Failure::internal)?;
    text.push('\n');
    Ok(text)
}

/// An object on standard output, one line.
pub(super) fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    to_stdout(json_line(value)?.as_bytes())
}

/// Text for a person on standard output.
pub(super) fn tell(text: &str) -> Result<(), Failure> {
    to_stdout(text.as_bytes())
}
