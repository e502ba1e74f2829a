//! `gyrfalcon telemetry decode`: what a spacecraft has sent, as rows.

use super::asked::world;
use super::delivered::deliver;
use super::told::warn;
use crate::cli::{DecodeArgs, SharedArgs, TelemetryVerb};
use crate::failure::Failure;
use formats::telemetry::{Fault, Reports, Summary, Wanted, columns};
use formats::uplink::spacecraft;
use planner::provenance::Provenance;
use serde_json::{Value, json};
use std::fs::File;

pub(super) fn run(shared: &SharedArgs, verb: &TelemetryVerb) -> Result<(), Failure> {
    match verb {
        TelemetryVerb::Decode(arguments) => decode(shared, arguments),
    }
}

/// Reads the file twice: nothing is written before all of it was found good.
fn decode(shared: &SharedArgs, arguments: &DecodeArgs) -> Result<(), Failure> {
    let world = world(shared)?;
    let path = &arguments.file;
    let refused = |fault: Fault| Failure::Input(format!("{}: {fault}", path.display()));
    let wanted = Wanted {
        spacecraft: spacecraft(&world.mission),
        telescopes: world.mission.telescopes.iter().map(|it| it.name.clone()).collect(),
        apid: arguments.apid,
        skip_damaged: arguments.skip_damaged,
    };
    let reports = || {
        let file = File::open(path).map_err(|error| Failure::file("read", path, &error))?;
        Ok::<_, Failure>(Reports::new(file, wanted.clone()))
    };
    let part = arguments.part();
    let summary = Summary::of(reports()?, part).map_err(refused)?;
    let warning = summary.passed.told().map(|told| format!("{}: {told}", path.display()));
    warn(shared, warning.as_slice());
    let rows = reports()?.filter(|row| row.as_ref().map_or(true, |it| part.has(&it.payload)));
    let provenance = Provenance::of(&world);
    deliver(shared, rows.map(|row| row.map_err(refused)), (&provenance, &columns(part)), || {
        let mut told: Value = summary.json();
        told["provenance"] = json!(provenance);
        Ok(told)
    })
}
