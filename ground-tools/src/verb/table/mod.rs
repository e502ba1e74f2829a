//! `gyrfalcon table`: build, inspect, diff and verify what goes on board; clock correlations and
//! orders.

pub(super) mod container;
mod words;
mod build;
mod check;
mod diff;
mod inspect;
mod records;

use crate::cli::{SharedArgs, TableVerb};
use crate::failure::Failure;

pub(super) fn run(shared: &SharedArgs, verb: &TableVerb) -> Result<(), Failure> {
    match verb {
        TableVerb::Build { error, target, sequence } => build::run(shared, error, target, sequence),
        TableVerb::Inspect { file } => inspect::run(shared, file),
        TableVerb::Diff { old, new } => diff::run(shared, old, new),
        TableVerb::Verify { file, error } => check::run(shared, file, error),
        TableVerb::Clock(arguments) => records::clock(shared, arguments),
        TableVerb::Rollback { active, older, until } => {
            records::rollback(shared, active, older, until)
        }
        TableVerb::Change { active, new, until } => records::change(shared, active, new, until),
    }
}
