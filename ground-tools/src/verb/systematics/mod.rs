//! `gyrfalcon systematics`: what instrumental systematics leave in the maps, and what that does to r.
//!
//! Effects share one survey, or the file of an earlier one. Effects on the CMB are means over all its
//! skies unless `--seed` draws one; others act on the solar dipole. Spectra are rows, the biases a table
//! or JSON.

mod options;
mod scan;
mod sky;
mod outcome;
mod report;
mod figure;

use super::asked::world;
use super::delivered::{deliver, sink};
use super::told::{print_json, tell, warn};
use crate::cli::{SharedArgs, SystematicsArgs};
use crate::failure::Failure;
use crate::output::figures::{Figure, write_figures};
use crate::output::{Sink, fill_folder};
use formats::maps::write_residual;
use formats::products::Fill;
use formats::rows::Column;
use formats::rows::Field::{Count, Number, Word};
use options::{Named, Setting};
use outcome::{Outcome, Study, residuals};
use planner::harmonics::Rings;
use planner::opportunities::SightLine;
use planner::provenance::Provenance;
use planner::survey::MapFrame;
use report::Report;
use scan::Scan;
use sky::Skies;
use std::path::Path;

/// A degree of an effect's spectra.
struct Row<'r> {
    effect: &'r str,
    l: usize,
    outcome: &'r Outcome,
}

fn columns<'r>() -> [Column<Row<'r>>; 4] {
    [
        Column::new("effect", Word(|it| Some(it.effect.into()))),
        Column::new("ell", Count(|it| u64::try_from(it.l).ok())),
        Column::new("ee_uk2", Number(|it| it.outcome.found.ee.get(it.l).copied())),
        Column::new("bb_uk2", Number(|it| it.outcome.found.bb.get(it.l).copied())),
    ]
}

pub(super) fn run(shared: &SharedArgs, arguments: &SystematicsArgs) -> Result<(), Failure> {
    let rows_to_stdout = shared.out.is_some() && sink(shared) == Sink::Stdout;
    if shared.json && rows_to_stdout {
        return Err(Failure::Input(
            "--json and --out -: standard output takes one of the two; name a file".to_owned(),
        ));
    }
    let setting = Setting::read(arguments)?;
    let mut world = world(shared)?;
    world.targets.clear();
    let (lines, told) = options::lines(arguments, &world)?;
    warn(shared, told.as_slice());
    let named = options::effects(arguments, &world, &lines)?;
    let moments = options::moments(&named)?;
    // What can be refused is refused before the survey.
    let earlier =
        arguments.survey.as_deref().map(|path| Scan::earlier(path, &moments)).transpose()?;
    let nside = match &earlier {
        Some(scan) => scan.orientations.nside(),
        None => scan::nside(arguments.nside)?,
    };
    setting.check_pixels(nside)?;
    let frame = earlier.as_ref().map_or_else(|| scan::frame(arguments), |scan| scan.frame);
    let skies = Skies::read(arguments, &setting, frame)?;
    let scan = match earlier {
        Some(scan) => scan,
        None => Scan::new(shared, arguments, (&world, &lines), moments)?,
    };
    let rings = Rings::new(nside);
    let study = Study { arguments, world: &world, setting: &setting, scan: &scan, skies, rings };
    let outcomes = named.iter().map(|named| study.of(named)).collect::<Result<Vec<_>, _>>()?;
    let effects: Vec<(&Named, &Outcome)> = named.iter().zip(&outcomes).collect();

    let provenance = Provenance::of(&world);
    let mut files = Vec::new();
    if arguments.figures.asked() {
        let drawing = figure::spectra(&world.mission.name, &effects, &setting)?;
        let mut figures = vec![Figure { stem: "systematics".to_owned(), drawing }];
        for (number, residual) in residuals(&outcomes) {
            let which = (number, named[number - 1].text.as_str());
            figures.extend(figure::maps(which, residual, frame)?);
        }
        files = write_figures(arguments.figures.folders(), &figures)?;
    }
    if let Some(folder) = &arguments.maps {
        if residuals(&outcomes).next().is_none() {
            let what = "--maps: a mean over skies has no maps; --seed draws one sky";
            warn(shared, &[what]);
        }
        let seen_by = lines.iter().map(SightLine::key).collect::<Vec<_>>().join(" ");
        files.extend(write_maps(folder, &outcomes, frame, (&provenance, &seen_by))?);
    }
    let report = Report {
        together: together(&outcomes, &setting)?,
        effects,
        first_seed: arguments.seed.unwrap_or(0),
        files: &files,
    };
    if shared.out.is_some() {
        let rows = named.iter().zip(&outcomes).flat_map(|(named, outcome)| {
            (2..outcome.found.bb.len()).map(move |l| Ok(Row { effect: &named.text, l, outcome }))
        });
        let rows_alone = SharedArgs { json: false, ..shared.clone() };
        deliver(&rows_alone, rows, (&provenance, &columns()), || Ok(()))?;
    }
    match (shared.json, rows_to_stdout) {
        (true, _) => print_json(&report.json(&provenance)?),
        (false, true) => Ok(()),
        (false, false) => tell(&report.text(&setting, nside)),
    }
}

/// delta r of the sum of all spectra.
fn together(outcomes: &[Outcome], setting: &Setting) -> Result<Option<f64>, Failure> {
    let Some((first, others)) = outcomes.split_first().filter(|it| !it.1.is_empty()) else {
        return Ok(None);
    };
    let mut sum = first.found.bb.clone();
    for other in others {
        for (sum, power) in sum.iter_mut().zip(&other.found.bb) {
            *sum += power;
        }
    }
    let bias = setting.likelihood.bias(&sum).map_err(Failure::internal)?;
    Ok(Some(bias.delta_r))
}

/// Writes the residual's maps of the effects that have them; names the files.
fn write_maps(
    folder: &Path,
    outcomes: &[Outcome],
    frame: MapFrame,
    origin: (&Provenance, &str),
) -> Result<Vec<String>, Failure> {
    let named: Vec<(String, _)> = residuals(outcomes)
        .map(|(number, residual)| (format!("residual-{number}.fits"), residual))
        .collect();
    let fills: Vec<(&str, Fill<'_>)> = named
        .iter()
        .map(|(name, residual)| {
            let fill: Fill<'_> = Box::new(move |out| write_residual(out, residual, frame, origin));
            (name.as_str(), fill)
        })
        .collect();
    fill_folder(folder, fills)?;
    Ok(named.iter().map(|(name, _)| folder.join(name).display().to_string()).collect())
}
