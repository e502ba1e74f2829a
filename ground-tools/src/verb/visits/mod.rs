//! `gyrfalcon visits`: how often places are visited, for how long, and when again.
//!
//! Targets and directions are visited as `transits` has it: inside the circle about the line of sight,
//! or inside a telescope's field of view. A pixel is visited by the line of sight itself (of a
//! telescope without listed detectors, its centre).

mod figures;

use super::asked::{sun_table, world};
use super::delivered::{form, sink};
use super::told::{print_json, tell};
use crate::cli::places::{FixedPlace, Numbering, PlaceShape, direction};
use crate::cli::quantities::rate_hz;
use crate::cli::{SharedArgs, VisitsArgs};
use crate::failure::Failure;
use crate::output::Sink;
use crate::output::figures::write_figures;
use ephem::time::format_tdb;
use figures::Setting;
use formats::rows::Field::{Number, Tdb, Whole, Word};
use formats::rows::{self, Column, Layout};
use formats::visits::{Mark, Report, clipped, marks, text};
use num_traits::{Signed, ToPrimitive, Zero};
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::time::{Duration, Instant};
use planner::opportunities::SightLine;
use planner::opportunities::search;
use planner::provenance::Provenance;
use planner::survey::MapFrame;
use planner::visits::{
    Counting, LineOfSight, Sampling, Sun, Visit, VisitStatistics, Wait, sampled, waits,
};
use planner::world::{Tables, World};
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write;
use std::num::NonZeroU64;

/// A visit, and how long since the one before.
struct Row<'v> {
    place: &'v Visited<'v>,
    visit: Visit,
    wait: Wait,
}

fn columns<'v>() -> [Column<Row<'v>>; 11] {
    [
        Column::new("target", Word(|it| Some(it.place.name.into()))),
        Column::new("telescope", Word(|it| Some((&it.place.line.telescope_name).into()))),
        Column::new("detector", Word(|it| Some((&it.place.line.detector_name).into()))),
        Column::new("entry_tdb", Tdb(|it| it.visit.entry)),
        Column::new("exit_tdb", Tdb(|it| it.visit.exit)),
        Column::new("entry_tai_ns", Whole(|it| Some(it.visit.entry.tai_ns()))),
        Column::new("exit_tai_ns", Whole(|it| Some(it.visit.exit.tai_ns()))),
        Column::new("dwell_s", Number(|it| Some(it.visit.dwell().seconds()))),
        Column::new("revisit_s", Number(|it| it.wait.revisit.map(Duration::seconds))),
        Column::new("gap_s", Number(|it| it.wait.gap.map(Duration::seconds))),
        Column::new(
            "clipped",
            Word(|it| Some(clipped(it.visit.entry_clipped, it.visit.exit_clipped).into())),
        ),
    ]
}

/// All that the verb tells, and all that its figures need.
#[derive(Serialize)]
struct Summary<'p> {
    /// `crossings` or `samples`.
    counting: &'static str,
    /// Sampling rate in Hz, where samples are counted.
    rate_hz: Option<f64>,
    marks: Vec<Mark>,
    places: Vec<Report>,
    /// Figures' files.
    figures: Vec<String>,
    provenance: &'p Provenance,
}

/// The visits of one place through one line of sight.
struct Visited<'v> {
    name: &'v str,
    line: &'v SightLine,
    visits: Vec<Visit>,
}

pub(super) fn run(shared: &SharedArgs, arguments: &VisitsArgs) -> Result<(), Failure> {
    let places = places(arguments)?;
    let mut world = world(shared)?;
    let rate = arguments.sampled.then(|| rate(arguments, &world)).transpose()?;
    if arguments.target.is_empty() && !places.is_empty() {
        world.targets.clear();
    } else {
        world.keep_targets(&arguments.target)?;
    }
    let lines = arguments.sight.lines(&world.mission)?;
    if arguments.figures.asked() {
        figures::check(world.targets.len() + places.len(), lines.len())?;
    }
    let tables = world.tables(&world.ground_options())?;
    let table = tables.parse()?;

    let mut found = target_visits(&world, table, &lines)?;
    found.extend(place_visits(&world, &tables, &lines, &places)?);
    if let Some((_, rate_hz)) = rate {
        let sampling = Sampling { start: world.start, rate_hz };
        for it in &mut found {
            it.visits = sampled(&it.visits, &sampling);
        }
    }
    let counting = if rate.is_some() { Counting::Samples } else { Counting::Crossings };
    let provenance = Provenance::of(&world);
    write_rows(shared, &found, counting, &provenance)?;

    let span = world.end.since(world.start);
    let reports: Vec<Report> = found
        .iter()
        .map(|it| {
            let statistics = VisitStatistics::of(&it.visits, counting, span);
            Report::new(it.name, (&it.line.telescope_name, &it.line.detector_name), &statistics)
        })
        .collect();
    let rate_hz = rate.map(|(rate_hz, _)| rate_hz);
    let counted = match rate_hz {
        None => "by crossings".to_owned(),
        Some(rate_hz) => format!("by samples at {rate_hz} Hz"),
    };
    let counted = format!("{counted}, {} to {} TDB", date(world.start), date(world.end));
    let marks = marks(&world);
    let figures = if arguments.figures.asked() {
        let setting = Setting { mission: &world.mission.name, counted: &counted, marks: &marks };
        write_figures(arguments.figures.folders(), &figures::figures(&setting, &reports)?)?
    } else {
        Vec::new()
    };
    let summary = Summary {
        counting: if rate.is_some() { "samples" } else { "crossings" },
        rate_hz,
        marks,
        places: reports,
        figures,
        provenance: &provenance,
    };
    if shared.json {
        print_json(&summary)
    } else if shared.out.is_some() && sink(shared) == Sink::Stdout {
        Ok(())
    } else {
        let title = format!("{}: visits {counted}", world.mission.name);
        let mut text = text(&title, &summary.marks, &summary.places);
        if !summary.figures.is_empty() {
            let _ = write!(text, "\nFigures written:\n{}\n", summary.figures.join("\n"));
        }
        tell(&text)
    }
}

fn date(at: Instant) -> String {
    let text = format_tdb(at);
    text.get(..10).unwrap_or(&text).to_owned()
}

/// The pixels and directions named, in the order of the options.
fn places(arguments: &VisitsArgs) -> Result<Vec<FixedPlace>, Failure> {
    let frame = if arguments.galactic { MapFrame::Galactic } else { MapFrame::Ecliptic };
    let numbering = Numbering::new(arguments.nside, arguments.nested, frame)?;
    let mut places = Vec::new();
    if arguments.paper_pixels {
        places.extend(numbering.of_the_paper());
    }
    for number in &arguments.pixel {
        places.push(numbering.pixel(*number)?);
    }
    for text in &arguments.theta_phi {
        places.push(numbering.holding(text)?);
    }
    for text in &arguments.direction {
        places.push(direction(text, frame)?);
    }
    Ok(places)
}

/// The sampling rate in Hz, and as a ratio.
fn rate(arguments: &VisitsArgs, world: &World) -> Result<(f64, (NonZeroU64, NonZeroU64)), Failure> {
    let number: mission::number::Number = match &arguments.rate {
        None => world.mission.scan.sampling_rate_hz.clone(),
        Some(text) => rate_hz("--rate", text)?,
    };
    let exact = number.exact();
    if exact.is_negative() || exact.is_zero() {
        return Err(Failure::Input(format!("--rate {number}: a rate above 0 Hz is needed")));
    }
    let part = |part: &num_bigint::BigInt| part.to_u64().and_then(NonZeroU64::new);
    match (part(exact.numer()), part(exact.denom())) {
        (Some(above), Some(below)) => Ok((number.to_f64(), (above, below))),
        _ => Err(Failure::Input(format!(
            "--rate {number}: a rate that is a ratio of numbers below 2^64 is needed"
        ))),
    }
}

/// The targets' visits: their transits, target by target, line by line.
fn target_visits<'v>(
    world: &'v World,
    table: EphemerisTable<'_>,
    lines: &'v [SightLine],
) -> Result<Vec<Visited<'v>>, Failure> {
    let mut visited: Vec<Visited<'v>> = world
        .targets
        .iter()
        .flat_map(|target| lines.iter().map(move |line| (target.name(), line)))
        .map(|(name, line)| Visited { name, line, visits: Vec::new() })
        .collect();
    for it in search(world, table, lines)? {
        visited[it.target * lines.len() + it.line].visits.push(Visit::from(&it.transit));
    }
    Ok(visited)
}

/// The visits of pixels and directions, place by place, line by line.
fn place_visits<'v>(
    world: &'v World,
    tables: &Tables,
    lines: &'v [SightLine],
    places: &'v [FixedPlace],
) -> Result<Vec<Visited<'v>>, Failure> {
    let sun = match world.circular_sun {
        Some(longitude) => Sun::Circular(longitude),
        None => Sun::Table(sun_table(tables)?),
    };
    let pairs: Vec<(&FixedPlace, &SightLine)> =
        places.iter().flat_map(|place| lines.iter().map(move |line| (place, line))).collect();
    pairs
        .par_iter()
        .map(|&(place, line)| {
            let sight = LineOfSight {
                scan: world.scan,
                sun: sun.clone(),
                detector: line.rotation,
                ends: (world.start, world.end),
            };
            let visits = match place.shape {
                PlaceShape::Pixel(pixel) => sight.pixel_visits(&pixel),
                PlaceShape::Direction(there) => sight.field_visits(there, &line.field),
            };
            let visits = visits
                .map_err(|error| Failure::internal(format!("visits of {}: {error}", place.name)))?;
            Ok(Visited { name: &place.name, line, visits })
        })
        .collect()
}

/// Rows go to `--out`, ordered by entry, then as the places are.
fn write_rows(
    shared: &SharedArgs,
    found: &[Visited<'_>],
    counting: Counting,
    provenance: &Provenance,
) -> Result<(), Failure> {
    let format = form(shared)?.of_rows()?;
    let sink = sink(shared);
    if shared.out.is_none() || (shared.json && sink == Sink::Stdout) {
        return Ok(());
    }
    let mut rows: Vec<(usize, Visit, Wait)> = Vec::new();
    for (index, it) in found.iter().enumerate() {
        let waits = waits(&it.visits, counting);
        rows.extend(it.visits.iter().zip(waits).map(|(visit, wait)| (index, *visit, wait)));
    }
    rows.sort_by_key(|(index, visit, _)| (visit.entry, *index));
    let rows = rows
        .into_iter()
        .map(|(index, visit, wait)| Ok::<_, Failure>(Row { place: &found[index], visit, wait }));
    let layout = Layout { format, provenance, columns: &columns() };
    sink.write_with(|out| rows::write(out, rows, &layout))?;
    Ok(())
}
