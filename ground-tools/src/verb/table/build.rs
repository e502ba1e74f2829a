//! `gyrfalcon table build`: a container of fitted directions, without a plan.

use crate::cli::quantities::angle_rad;
use crate::cli::{SequenceArgs, SharedArgs};
use crate::failure::Failure;
use crate::output::Sink;
use crate::verb::asked::world;
use crate::verb::told::{print_json, tell, warn};
use ephem::fit::{FitOptions, MILLIARCSECOND_RAD};
use ephem::source::Source;
use formats::sequence::number;
use formats::uplink::{Contents, slow_checks};
use serde_json::{Value, json};
use std::fmt::Write;

const DEFAULT_FILE: &str = "uplink.tbl";

pub(super) fn run(
    shared: &SharedArgs,
    error: &str,
    bodies: &[String],
    sequence: &SequenceArgs,
) -> Result<(), Failure> {
    let sequence = number(sequence.sequence, sequence.after).map_err(Failure::Input)?;
    let mut world = world(shared)?;
    warn(shared, &slow_checks(&world));
    if !bodies.is_empty() {
        let known = std::mem::take(&mut world.targets);
        for name in bodies {
            let own = known.iter().find(|source| source.name() == name).cloned();
            let source = own.map_or_else(|| Source::by_name(name).map_err(Failure::input), Ok)?;
            world.targets.push(source);
        }
    }
    let tolerance_rad = angle_rad("--error", error)?;
    if tolerance_rad <= 0.0 {
        return Err(Failure::Input(format!(
            "--error {error}: an angle above 0 is needed, such as 1mas"
        )));
    }
    let options =
        FitOptions { tolerance_rad, rough_tolerance_rad: tolerance_rad, ..FitOptions::UPLINK };
    let tables = world.tables(&options)?;
    let contents =
        Contents { world: &world, ephemeris: &tables.fitted.bytes, sessions: None, sequence };
    let bytes = contents.to_bytes()?;
    let path = shared.out.clone().unwrap_or_else(|| DEFAULT_FILE.into());
    let sink = Sink::at(&path);
    sink.write(&bytes)?;
    let rows = tables.fitted.bodies.iter().map(|it| {
        json!({
            "body": it.body,
            "name": it.name,
            "spans": it.spans,
            "granules": it.granules,
            "coefficients": it.coefficients,
            "bytes": it.bytes,
            "max_error_mas": it.max_error_rad / MILLIARCSECOND_RAD,
        })
    });
    if sink == Sink::Stdout {
        return Ok(());
    }
    if shared.json {
        return print_json(&json!({
            "bytes": bytes.len(),
            "ephemeris_bytes": tables.fitted.bytes.len(),
            "bodies": rows.collect::<Vec<Value>>(),
        }));
    }
    let mut text = format!(
        "{}: {} bytes, of which ephemeris {}\n\n{:<18} {:>8} {:>6} {:>7} {:>14}\n",
        path.display(),
        bytes.len(),
        tables.fitted.bytes.len(),
        "body",
        "granules",
        "terms",
        "bytes",
        "error (mas)"
    );
    for it in &tables.fitted.bodies {
        let _ = writeln!(
            text,
            "{:<18} {:>8} {:>6} {:>7} {:>14.3e}",
            it.name,
            it.granules,
            it.coefficients,
            it.bytes,
            it.max_error_rad / MILLIARCSECOND_RAD
        );
    }
    tell(&text)
}
