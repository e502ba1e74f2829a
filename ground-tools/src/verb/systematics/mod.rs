//! `gyrfalcon systematics`: what instrumental systematics leave in the maps, and what that does to r.
//!
//! Effects share one survey. Effects on the CMB are means over all its skies unless `--seed` draws
//! one; others act on the solar dipole. Spectra are rows, the biases a table or JSON.

mod options;
mod figure;

use super::asked::{sun_table, world};
use super::delivered::{deliver, sink};
use super::told::{print_json, tell};
use crate::cli::{SharedArgs, SystematicsArgs};
use crate::failure::Failure;
use crate::output::{Sink, fill_folder};
use crate::picture::{Figure, write_figures};
use formats::maps::write_residual;
use formats::products::Fill;
use formats::rows::Column;
use formats::rows::Field::{Count, Number, Word};
use options::{Named, Setting};
use planner::harmonics::{Complex64, Rings, Spectra};
use planner::progress::Quietly;
use planner::provenance::Provenance;
use planner::survey::input::SurveyInput;
use planner::survey::{MapFrame, SunSource, Survey, SurveySun};
use planner::systematics::timestream::Timestream;
use planner::systematics::{Found, Orientations, StudySky};
use serde_json::{Value, json};
use std::fmt::Write;

/// A degree of an effect's spectra.
struct Row<'r> {
    effect: &'r str,
    l: usize,
    found: &'r Found,
}

fn columns<'r>() -> [Column<Row<'r>>; 4] {
    [
        Column::new("effect", Word(|it| Some(it.effect.into()))),
        Column::new("ell", Count(|it| u64::try_from(it.l).ok())),
        Column::new("ee_uk2", Number(|it| it.found.ee.get(it.l).copied())),
        Column::new("bb_uk2", Number(|it| it.found.bb.get(it.l).copied())),
    ]
}

pub(super) fn run(shared: &SharedArgs, arguments: &SystematicsArgs) -> Result<(), Failure> {
    let setting = Setting::read(arguments)?;
    let mut world = world(shared)?;
    world.targets.clear();
    let lines = arguments.sight.lines(&world.mission)?;
    let rate = options::rate(arguments, &world)?;
    let input = SurveyInput::new(&world, &lines, &rate).map_err(Failure::input)?;
    let named = options::effects(arguments, &world, &lines, &setting)?;
    let source = match &input.circular_sun {
        Some(longitude) => SunSource::Circular(longitude.clone()),
        None => SunSource::Table(sun_table(&world.tables(&world.ground_options())?)?),
    };
    let survey = Survey {
        scan: input.scan,
        sun: SurveySun { source, step: None },
        detectors: input.detectors,
        nside: setting.nside,
        frame: MapFrame::Ecliptic,
        moments: options::moments(&named)?,
    };
    let span = 0..input.samples;
    let maps = survey.run(span.clone(), 0, &Quietly).map_err(Failure::internal)?;
    let orientations = Orientations::of_survey(&maps);
    let rings = Rings::new(setting.nside);
    let mut found = Vec::new();
    let mut compared = Vec::new();
    for Named { text, asked } in &named {
        let refused = |error| Failure::Input(format!("--effect {text}: {error}"));
        let one = asked
            .study(&orientations, &rings, &setting.likelihood, arguments.iterations)
            .map_err(refused)?;
        compared.push(match (&asked.sky, &one.residual) {
            (StudySky::Given(sky), Some(_)) if arguments.tod && !asked.polarimeter.pair => {
                let timestream =
                    Timestream::new(&rings, &asked.terms, sky).map_err(Failure::internal)?;
                let maps =
                    timestream.maps(&survey, span.clone(), &Quietly).map_err(Failure::internal)?;
                let [_, q, u] = maps.iqu();
                let p: Vec<Complex64> = (0..setting.nside.pixels())
                    .map(|ring| setting.nside.nested_of_ring(ring) as usize)
                    .map(|at| Complex64::new(q[at], u[at]))
                    .map(|p| if p.is_nan() { Complex64::ZERO } else { p })
                    .collect();
                let l_max = setting.likelihood.degrees[1];
                let alm =
                    rings.alm(2, &p, l_max, arguments.iterations).map_err(Failure::internal)?;
                Some(furthest(&Spectra::of(None, &alm).bb, &one.bb))
            }
            _ => None,
        });
        found.push(one);
    }

    let provenance = Provenance::of(&world);
    let mut files = Vec::new();
    if arguments.figures.asked() {
        let drawing = figure::figure(&world.mission.name, &named, &found, &setting)?;
        let figures = [Figure { stem: "systematics".to_owned(), drawing }];
        files = write_figures(arguments.figures.folders(), &figures)?;
    }
    if let Some(folder) = &arguments.maps {
        let names: Vec<String> =
            (1..=found.len()).map(|number| format!("residual-{number}.fits")).collect();
        let seen_by = lines.iter().map(|line| line.key()).collect::<Vec<_>>().join(" ");
        let mut fills: Vec<(&str, Fill<'_>)> = Vec::new();
        for (name, one) in names.iter().zip(&found) {
            let Some(residual) = &one.residual else { continue };
            let origin = (&provenance, seen_by.as_str());
            fills.push((
                name,
                Box::new(move |out| Ok(write_residual(out, residual, MapFrame::Ecliptic, origin)?)),
            ));
        }
        files.extend(fills.iter().map(|(name, _)| folder.join(name).display().to_string()));
        fill_folder(folder, fills)?;
    }
    let report = Report { named: &named, found: &found, compared: &compared, files: &files };
    if sink(shared) != Sink::Stdout {
        let rows = named.iter().zip(&found).flat_map(|(named, found)| {
            (2..found.bb.len()).map(move |l| Ok(Row { effect: &named.text, l, found }))
        });
        let quiet = SharedArgs { json: false, ..shared.clone() };
        deliver(&quiet, rows, (&provenance, &columns()), || Ok(()))?;
    }
    if shared.json {
        print_json(&report.json(&provenance)?)
    } else {
        tell(shared, &report.text(&setting))
    }
}

/// The largest relative difference of two spectra from l = 2.
fn furthest(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).skip(2).fold(0.0, |most, (a, b)| most.max((a / b - 1.0).abs()))
}

struct Report<'r> {
    named: &'r [Named],
    found: &'r [Found],
    /// Largest relative difference of BB from the timestream's.
    compared: &'r [Option<f64>],
    files: &'r [String],
}

impl Report<'_> {
    fn json(&self, provenance: &Provenance) -> Result<Value, Failure> {
        let each = |((named, found), compared): ((&Named, &Found), &Option<f64>)| {
            json!({
                "effect": named.text,
                "sky": named.sky(),
                "delta_r": found.bias.delta_r,
                "sigma_r": found.bias.sigma_r,
                "rms_uk": found.residual.as_ref().map(|it| it.rms_polarisation()),
                "unobserved_pixels": found.unobserved,
                "singular_pixels": found.singular,
                "timestream_difference": compared,
            })
        };
        let rows = self.named.iter().zip(self.found).zip(self.compared).map(each);
        Ok(json!({
            "effects": rows.collect::<Vec<Value>>(),
            "files": self.files,
            "provenance": serde_json::to_value(provenance).map_err(Failure::internal)?,
        }))
    }

    fn text(&self, setting: &Setting) -> String {
        let mut text = format!("{}\n\n", setting.told());
        let _ = writeln!(
            text,
            "{:<44} {:<10} {:>12} {:>12} {:>12}",
            "effect", "sky", "delta r", "BB l=2 uK2", "BB l=80 uK2"
        );
        for ((named, found), compared) in self.named.iter().zip(self.found).zip(self.compared) {
            let power = |l: usize| found.bb.get(l).map_or("-".to_owned(), |x| format!("{x:.4e}"));
            let _ = writeln!(
                text,
                "{:<44} {:<10} {:>12.4e} {:>12} {:>12}",
                named.text,
                named.sky(),
                found.bias.delta_r,
                power(2),
                power(80)
            );
            if found.unobserved + found.singular > 0 {
                let _ = writeln!(
                    text,
                    "  left out: {} pixel(s) without samples, {} whose angles do not tell I, Q and U \
                     apart",
                    found.unobserved, found.singular
                );
            }
            if let Some(off) = compared {
                let _ = writeln!(text, "  sample by sample: BB within {off:.1e} of it");
            }
        }
        if !self.files.is_empty() {
            let _ = writeln!(text, "\nwritten: {}", self.files.join(", "));
        }
        text
    }
}
