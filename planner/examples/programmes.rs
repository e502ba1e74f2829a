//! Writes the programmes whose optima are stored as text, for `tests/oracle/programs.py`.
//!
//!     cargo run --release -p planner --example programmes -- FOLDER

#![expect(clippy::unwrap_used, reason = "made-up programmes fit their numbers")]

#[expect(dead_code, reason = "the intervals are for the tests")]
#[path = "../tests/programs/mod.rs"]
mod programs;
#[path = "../tests/random/mod.rs"]
mod random;

use planner::program::Program;
use programs::{instance, stored};
use std::path::PathBuf;

/// The values, then a row per line: its limit, then choice:coefficient.
fn text(program: &Program) -> String {
    let values: Vec<String> = program.values.iter().map(ToString::to_string).collect();
    let rows = program.rows.iter().map(|row| {
        let terms: Vec<String> = row.terms.iter().map(|it| format!(" {}:{}", it.0, it.1)).collect();
        format!("{}{}\n", row.limit, terms.concat())
    });
    format!("{}\n{}", values.join(" "), rows.collect::<String>())
}

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    for (name, shape, seed) in stored() {
        std::fs::write(folder.join(format!("{name}.txt")), text(&instance(&shape, seed).program))?;
    }
    Ok(())
}
