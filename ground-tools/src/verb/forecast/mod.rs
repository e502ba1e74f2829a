//! `gyrfalcon forecast`: what passes teach about detectors, and whether it is enough.

mod answer;
mod table;
mod figures;

use super::asked::world;
use super::earlier::Earlier;
use super::told::{print_json, tell, warn};
use crate::cli::{ForecastArgs, Format, SharedArgs};
use crate::failure::Failure;
use crate::output::Sink;
use answer::Answer;
use formats::forecast::{Told, columns, degeneracies};
use formats::rows::{self as files, Layout};
use mission::number::Number;
use onboard_core::time::{Duration, Instant};
use planner::information::{
    InformationError, Question, Session, Windows, forecast, looks, rows, verdicts, windows_of,
};
use planner::progress::Quietly;
use planner::provenance::Provenance;
use planner::world::World;
use serde_json::{Value, json};
use std::path::Path;

pub(super) fn run(shared: &SharedArgs, arguments: &ForecastArgs) -> Result<(), Failure> {
    let mut world = world(shared)?;
    let sessions = arguments
        .plan
        .as_deref()
        .map(|path| planned(path, &mut world, &arguments.target))
        .transpose()?;
    if sessions.is_none() {
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
    let requirements = &world.mission.calibration.requirements;
    let days = arguments.window.days().map(|days| Duration::from_seconds(86_400.0 * days));
    let windows = Windows::new((world.start, world.end), &windows_of(days, requirements));
    let question = Question { looks: &looks, windows: &windows, sessions: sessions.as_deref() };
    let found = forecast(&world, table, &question, &Quietly)?;
    let told = rows(&found, &looks, &windows, world.targets.len(), requirements);
    let answer = Answer {
        world: &world,
        looks: &looks,
        windows: &windows,
        sessions: sessions.as_deref(),
        forecast: found,
        rows: told,
    };
    warn(shared, &table::left_out(&answer));
    if let Some(folder) = &arguments.figure {
        figures::write(&answer, table, folder)?;
    }
    let provenance = Provenance::of(&world);
    if let Some(path) = &shared.out {
        let rows = answer.rows.iter().map(|row| Ok::<_, Failure>(Told::new(&world, &looks, row)));
        let format = format(shared, path).of_rows()?;
        let layout = Layout { format, provenance: &provenance, columns: &columns() };
        Sink::at(path).write_with(|out| files::write(out, rows, &layout))?;
    }
    if shared.json {
        return print_json(&summary(&answer, &provenance)?);
    }
    tell(shared, &table::text(&answer))
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
    let named = |name: &str| world.targets.iter().position(|it| it.name() == name);
    let carried = |name: &str| world.mission.telescopes.iter().position(|it| it.name == name);
    let mut sessions = Vec::new();
    for it in &earlier.timeline.sessions {
        let (Some(target), Some(telescope)) = (named(&it.target), carried(&it.telescope)) else {
            continue;
        };
        let from = Instant::from_tai_ns(it.start_tai_ns);
        let until = Instant::from_tai_ns(it.end_tai_ns);
        sessions.push(Session { target, telescope, from, until });
    }
    Ok(sessions)
}

fn summary(answer: &Answer<'_>, provenance: &Provenance) -> Result<Value, Failure> {
    let rows: Vec<Value> =
        answer.rows.iter().map(|row| Told::new(answer.world, answer.looks, row).json()).collect();
    let mut apart = Vec::new();
    for (look, of) in answer.looks.iter().enumerate() {
        apart.extend(degeneracies(of, &answer.errors(look)));
    }
    let requirements = &answer.world.mission.calibration.requirements;
    let verdicts: Vec<Value> = verdicts(&answer.rows, requirements.len())
        .iter()
        .zip(requirements)
        .map(|(verdict, it)| {
            json!({
                "quantity": it.quantity.key(),
                "sigma": it.sigma_text,
                "telescope": it.telescope,
                "every_days": it.every_days.as_ref().map(Number::to_f64),
                "met": verdict.is_some_and(|it| it.met == it.of),
                "rows": verdict.map(|it| it.of),
                "rows_met": verdict.map(|it| it.met),
                "worst": verdict.map(|it| Told::new(answer.world, answer.looks, &it.worst).json()),
            })
        })
        .collect();
    Ok(json!({
        "rows": rows,
        "degeneracies": apart,
        "requirements": verdicts,
        "left_out": table::left_out(answer),
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
