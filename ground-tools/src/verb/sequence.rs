//! Which sequence number goes with what is sent up: refused here where the spacecraft would refuse it.

use crate::cli::SequenceArgs;
use crate::failure::Failure;
use formats::products::ALWAYS;
use formats::uplink::legal;
use onboard_core::uplink::{Tables, check_sequence};
use std::path::Path;

/// The uplink table among a plan's files.
const UPLINK: &str = ALWAYS[4];

/// The number that is asked for, or the next one.
///
/// # Errors
/// [`Failure::Input`] where it does not follow the newest number on board.
pub(super) fn number(arguments: &SequenceArgs) -> Result<u32, Failure> {
    following(arguments, arguments.after, "--after N names the newest number on board")
}

/// As [`number`]; an earlier plan's uplink table counts as on board.
pub(super) fn number_after_plan(
    arguments: &SequenceArgs,
    earlier: Option<&Path>,
) -> Result<u32, Failure> {
    let before = earlier.and_then(|folder| {
        let bytes = std::fs::read(folder.join(UPLINK)).ok()?;
        Some(Tables::load(&bytes).ok()?.header().sequence)
    });
    match before {
        Some(before) if before > arguments.after => {
            following(arguments, before, "the plan of --against has the number before")
        }
        _ => number(arguments),
    }
}

fn following(arguments: &SequenceArgs, newest: u32, hint: &str) -> Result<u32, Failure> {
    let refuse = |option: String| {
        Err(Failure::Input(format!("{option} is not legal: {} are ({hint})", legal(newest))))
    };
    let Some(first) = newest.checked_add(1) else {
        let why = "no number is above it";
        return Err(Failure::Input(format!("--after {newest} is not legal: {why}")));
    };
    let sequence = arguments.sequence.unwrap_or(first);
    match check_sequence(sequence, Some(newest)) {
        Ok(()) => Ok(sequence),
        Err(_) => refuse(format!("--sequence {sequence}")),
    }
}
