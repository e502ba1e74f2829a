//! `gyrfalcon table verify`: a container against the ephemeris and the mission.

use super::container::{load, read};
use super::diff::changes;
use crate::cli::SharedArgs;
use crate::cli::quantities::angle_rad;
use crate::failure::Failure;
use crate::verb::asked::world;
use crate::verb::delivered::{answer, answer_json};
use ephem::fit::{FitOptions, MILLIARCSECOND_RAD};
use ephem::source::Source;
use ephem::verify::{BodyCheck, verify};
use formats::uplink::{Contents, contents_told, digest};
use onboard_core::uplink::Tables;
use planner::world::World;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// Instants per body at which a table is compared.
const SAMPLES: usize = 10_000;
/// Their seed: the same instants in every run.
const SEED: u64 = 1;

pub(super) fn run(shared: &SharedArgs, file: &Path, error: &str) -> Result<(), Failure> {
    let limit = angle_rad("--error", error)?;
    let bytes = read(file)?;
    let tables = load(file, &bytes)?;
    let mut world = world(shared)?;
    world.targets = world.sources();
    // Bodies beyond the mission's targets are known by their numbers.
    let known: Vec<Source> =
        ephem::source::names().filter_map(|name| Source::by_name(name).ok()).collect();
    for span in tables.ephemeris().spans() {
        let here = |source: &Source| source.body() == span.body;
        if !world.targets.iter().any(here) {
            world.targets.extend(known.iter().find(|source| here(source)).cloned());
        }
    }
    let same_mission = digest(&world.mission) == tables.header().mission_digest;
    let checks = verify(tables.ephemeris(), &world.sky, &world.targets, SAMPLES, SEED)
        .map_err(|error| Failure::Input(format!("{}: {error}", file.display())))?;
    let differing =
        same_mission.then(|| differing(&world, &tables)).transpose()?.unwrap_or_default();
    let good = |it: &BodyCheck| {
        it.max_error_rad <= limit && it.rate_over_bound <= 1.0 && it.acceleration_over_bound <= 1.0
    };
    let passed = same_mission && differing.is_empty() && checks.iter().all(good);
    if shared.json {
        let bodies: Vec<Value> = checks
            .iter()
            .map(|it| {
                json!({
                    "body": it.body,
                    "name": it.name,
                    "max_error_mas": it.max_error_rad / MILLIARCSECOND_RAD,
                    "rate_over_bound": it.rate_over_bound,
                    "acceleration_over_bound": it.acceleration_over_bound,
                    "ok": good(it),
                })
            })
            .collect();
        answer_json(
            shared,
            &json!({
                "verdict": if passed { "pass" } else { "fail" },
                "same_mission": same_mission,
                "differing": differing,
                "samples": SAMPLES,
                "bodies": bodies,
            }),
        )?;
    } else {
        let mut text = format!(
            "{:<18} {:>12} {:>12} {:>12}\n",
            "body", "error (mas)", "rate/bound", "acc/bound"
        );
        for it in &checks {
            let _ = writeln!(
                text,
                "{:<18} {:>12.6} {:>12.4} {:>12.4}  {}",
                it.name,
                it.max_error_rad / MILLIARCSECOND_RAD,
                it.rate_over_bound,
                it.acceleration_over_bound,
                if good(it) { "pass" } else { "FAIL" }
            );
        }
        answer(shared, &text)?;
    }
    if passed {
        return Ok(());
    }
    let mut why = Vec::new();
    if !same_mission {
        why.push("it was built for another mission (its digest differs)".to_owned());
    }
    if !differing.is_empty() {
        why.push(format!("it holds another {} than the mission gives", differing.join(", ")));
    }
    for it in checks.iter().filter(|it| !good(it)) {
        why.push(format!(
            "{} is off by {:.3} mas (allowed {:.3}), or moves beyond its bounds",
            it.name,
            it.max_error_rad / MILLIARCSECOND_RAD,
            limit / MILLIARCSECOND_RAD
        ));
    }
    Err(Failure::Check(format!("{}: {}", file.display(), why.join("; "))))
}

/// The fields of a container that are not what its mission gives; its sessions are not among them.
fn differing(world: &World, tables: &Tables<'_>) -> Result<Vec<String>, Failure> {
    let fitted = world.tables(&FitOptions::UPLINK)?.fitted.bytes;
    let sequence = tables.header().sequence;
    let contents = Contents { world, ephemeris: &fitted, sessions: None, sequence };
    let bytes = contents.to_bytes()?;
    let expected = Tables::load(&bytes).map_err(|error| Failure::internal(contents_told(error)))?;
    Ok(changes(tables, &expected).into_iter().map(|it| it.field).collect())
}
