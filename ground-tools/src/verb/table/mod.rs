//! `gyrfalcon table`: build, inspect, diff and verify what goes on board; clock correlations and
//! rollback orders.

mod check;
mod diff;
mod inspect;
mod records;

use super::{print_json, tell, warn, world};
use crate::cli::{SharedArgs, TableVerb};
use crate::failure::Failure;
use crate::output::Sink;
use ephem::fit::{FitOptions, MILLIARCSECOND_RAD};
use ephem::kernel::body_name;
use ephem::source::{SUN_AS_TARGET, Source};
use formats::uplink::{Contents, contents_told, digest, slow_checks};
use mission::Mission;
use mission::quantity;
use mission::rounding;
use onboard_core::ephemeris::{EphemerisTable, SUN};
use onboard_core::uplink::{AvoidanceRecord, Tables};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

const DEFAULT_FILE: &str = "uplink.tbl";

pub(super) fn run(shared: &SharedArgs, verb: &TableVerb) -> Result<(), Failure> {
    match verb {
        TableVerb::Build { error, target, sequence } => build(shared, error, target, *sequence),
        TableVerb::Inspect { file } => inspect::run(shared, file),
        TableVerb::Diff { old, new } => diff::run(shared, old, new),
        TableVerb::Verify { file, error } => check::run(shared, file, error),
        TableVerb::Clock(arguments) => records::clock(shared, arguments),
        TableVerb::Rollback { active, older, until } => {
            records::rollback(shared, active, older, until)
        }
    }
}

/// An angle of the command line in radians.
pub(super) fn angle(option: &str, text: &str) -> Result<f64, Failure> {
    let degrees =
        quantity::degrees(text).map_err(|error| Failure::Input(format!("{option}: {error}")))?;
    Ok(rounding::radians(&degrees))
}

fn build(
    shared: &SharedArgs,
    error: &str,
    bodies: &[String],
    sequence: u32,
) -> Result<(), Failure> {
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
    let tolerance_rad = angle("--error", error)?;
    let options =
        FitOptions { tolerance_rad, rough_tolerance_rad: tolerance_rad, ..FitOptions::UPLINK };
    let tables = world.tables(&options)?;
    let contents =
        Contents { world: &world, ephemeris: &tables.fitted.bytes, sessions: None, sequence };
    let bytes = contents.to_bytes()?;
    let path = shared.out.clone().unwrap_or_else(|| DEFAULT_FILE.into());
    let sink = if path.as_os_str() == "-" { Sink::Stdout } else { Sink::File(path.clone()) };
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
    if shared.json {
        if sink == Sink::Stdout {
            return Ok(());
        }
        return print_json(&json!({
            "bytes": bytes.len(),
            "ephemeris_bytes": tables.fitted.bytes.len(),
            "bodies": rows.collect::<Vec<Value>>(),
        }));
    }
    if sink == Sink::Stdout {
        return Ok(());
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
    tell(shared, &text)
}

pub(super) fn read(file: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(file).map_err(|error| Failure::file("read", file, &error))
}

/// A container's tables, as the flight core reads them.
fn load<'b>(file: &Path, bytes: &'b [u8]) -> Result<Tables<'b>, Failure> {
    Tables::load(bytes)
        .map_err(|error| Failure::Input(format!("{}: {}", file.display(), contents_told(error))))
}

/// The ephemeris of an uplink table that was built for this mission.
pub(super) fn ephemeris<'b>(
    file: &Path,
    bytes: &'b [u8],
    mission: &Mission,
) -> Result<EphemerisTable<'b>, Failure> {
    let tables = load(file, bytes)?;
    if digest(mission) != tables.header().mission_digest {
        return Err(Failure::Input(format!(
            "{}: it was built for another mission (its digest differs): one of table build with \
             the same --mission, --set, --start and --duration is needed",
            file.display()
        )));
    }
    Ok(tables.ephemeris())
}

/// Bytes as hexadecimal digits.
fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

/// The name of a body in a table.
fn name(number: i32) -> String {
    match number {
        SUN => "sun_to_spacecraft".to_owned(),
        SUN_AS_TARGET => "sun".to_owned(),
        own if own >= onboard_core::ephemeris::FIRST_USER_BODY => format!("source {own}"),
        body => body_name(body).to_owned(),
    }
}

/// An avoidance limit in words; degrees to nine places.
fn avoidance_told(limit: &AvoidanceRecord) -> String {
    let degrees = (limit.angle_rad.to_degrees() * 1e9).round() / 1e9;
    format!("{} by {degrees} deg", name(limit.body))
}
