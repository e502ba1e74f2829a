//! `gyrfalcon forecast`: what passes teach about detectors, and whether it is enough.
//!
//! Exit code 1 where a requirement of the mission is missed.

mod table;
mod figures;

use super::asked::world;
use super::earlier::Earlier;
use super::told::{print_json, tell, warn};
use crate::cli::{ForecastArgs, Format, SharedArgs};
use crate::failure::Failure;
use crate::output::Sink;
use formats::forecast::{
    Required, Told, columns, degeneracies, left_out, profile, required, sessions,
};
use formats::rows::{self as files, Layout};
use onboard_core::time::Duration;
use planner::information::{InformationError, Session, Teaching, looks};
use planner::progress::Quietly;
use planner::provenance::Provenance;
use planner::world::World;
use serde_json::{Value, json};
use std::path::Path;

pub(super) fn run(shared: &SharedArgs, arguments: &ForecastArgs) -> Result<(), Failure> {
    let mut world = world(shared)?;
    let planned_for = arguments
        .plan
        .as_deref()
        .map(|path| planned(path, &mut world, &arguments.target))
        .transpose()?;
    if planned_for.is_none() {
        world.keep_targets(&arguments.target)?;
    }
    let sight = &arguments.sight;
    let looks = looks(&world.mission, sight.telescope.as_deref(), sight.detector.as_deref())?;
    if let (true, [_, another, ..]) = (arguments.figure.is_some(), &looks[..]) {
        return Err(Failure::Input(format!(
            "--figure draws one beam: name it with --detector, such as --detector {}",
            another.key()
        )));
    }
    let tables = world.tables(&world.ground_options())?;
    let table = tables.parse()?;
    let days = arguments.window.days().map(|days| Duration::from_seconds(86_400.0 * days));
    let teaching = Teaching::of(&world, table, looks, (days, planned_for), &Quietly)?;
    warn(shared, &left_out(&world, &teaching));
    if let Some(folder) = &arguments.figure {
        figures::write(&world, &teaching, table, folder)?;
    }
    let provenance = Provenance::of(&world);
    if let Some(path) = &shared.out {
        let rows = teaching.rows.iter();
        let rows = rows.map(|row| Ok::<_, Failure>(Told::new(&world, &teaching.looks, row)));
        let format = format(shared, path).of_rows()?;
        let layout = Layout { format, provenance: &provenance, columns: &columns() };
        Sink::at(path).write_with(|out| files::write(out, rows, &layout))?;
    }
    let required = required(&world, &teaching);
    if shared.json {
        print_json(&summary(&world, &teaching, &required, &provenance)?)?;
    } else {
        tell(&table::text(&world, &teaching, &required))?;
    }
    let missed: Vec<String> =
        required.iter().filter(|it| it.is_missed()).map(Required::name).collect();
    if missed.is_empty() {
        return Ok(());
    }
    let name = &world.mission.name;
    Err(Failure::Check(format!("{name}: requirements are missed: {}", missed.join("; "))))
}

/// The form of rows: what is asked, or what the file's name ends with.
fn format(shared: &SharedArgs, path: &Path) -> Format {
    let ending = path.extension().and_then(|it| it.to_str()).unwrap_or_default();
    shared.format.unwrap_or(match ending {
        "parquet" => Format::Parquet,
        "jsonl" => Format::Jsonl,
        _ => Format::Csv,
    })
}

/// The sessions of a plan, of the targets that are asked for.
fn planned(path: &Path, world: &mut World, targets: &[String]) -> Result<Vec<Session>, Failure> {
    let earlier = Earlier::read(path, world)?;
    world.keep_targets(targets)?;
    Ok(sessions(world, &earlier.timeline))
}

fn summary(
    world: &World,
    teaching: &Teaching,
    required: &[Required],
    provenance: &Provenance,
) -> Result<Value, Failure> {
    let looks = &teaching.looks;
    let rows: Vec<Value> =
        teaching.rows.iter().map(|row| Told::new(world, looks, row).json()).collect();
    let mut apart = Vec::new();
    let mut profiles = Vec::new();
    for (look, of) in looks.iter().enumerate() {
        apart.extend(degeneracies(of, &teaching.errors(look)));
        profiles.push(profile(of, &teaching.lesson(look)));
    }
    Ok(json!({
        "rows": rows,
        "degeneracies": apart,
        "profiles": profiles,
        "requirements": required.iter().map(Required::json).collect::<Vec<_>>(),
        "left_out": left_out(world, teaching),
        "provenance": serde_json::to_value(provenance).map_err(Failure::internal)?,
    }))
}

impl From<InformationError> for Failure {
    fn from(error: InformationError) -> Self {
        match error {
            InformationError::Sight(error) => error.into(),
            InformationError::Search(error) => error.into(),
            InformationError::Unknown { .. } | InformationError::NoSignal { .. } => {
                Self::input(error)
            }
            InformationError::Table(_) | InformationError::Sky(_) | InformationError::Stopped => {
                Self::internal(error)
            }
        }
    }
}
