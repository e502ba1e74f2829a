//! `gyrfalcon survey`: how often, and at which angles, each pixel of the sky is seen.
//!
//! Without names the mission boresight looks; several detectors share one map, or have one each with
//! `--per-detector`. Snapshots are written when they are reached, the rest at the end; an interrupt
//! keeps the snapshots.

mod options;
mod watch;
mod pictures;
mod sky;
mod session;

use super::asked::{sun_table, world};
use super::told::warn;
use crate::cli::{SharedArgs, SurveyArgs};
use crate::failure::Failure;
use crate::output::Sink;
use ephem::source::title;
use formats::maps::Layout;
use pictures::{Pictures, tracks};
use planner::healpix::Ordering;
use planner::opportunities::SightLine;
use planner::provenance::Provenance;
use planner::survey::input::SurveyInput;
use planner::survey::{MapFrame, SunSource, SurveySun, map_bytes};
use planner::world::Tables;
use session::{Session, seen_by};
use std::collections::BTreeSet;
use std::sync::Arc;
use watch::Watch;

pub(super) use options::{refused, slow_sampling};

pub(super) fn run(shared: &SharedArgs, arguments: &SurveyArgs) -> Result<(), Failure> {
    let nside = options::nside(arguments.nside, arguments.moment.len())?;
    let moments = options::moments(&arguments.moment)?;
    let isa = options::isa()?;
    let patches = options::patches(&arguments.patch)?;
    let step = options::step(arguments)?;
    if shared.json && shared.out.as_deref().map(Sink::at) == Some(Sink::Stdout) {
        return Err(Failure::Input(
            "--json and --out -: standard output takes one of the two; name a file".to_owned(),
        ));
    }

    let sky = sky::asked(shared, arguments)?;
    let mut world = world(shared)?;
    world.avoided.clear();
    if !arguments.tracks {
        world.targets.clear();
    }
    let lines = arguments.sight.lines(&world.mission)?;
    let rate = options::rate(arguments, &world)?;
    options::check_plates(&world, &lines, &moments)?;
    warn(shared, &options::slow_sampling(&world, &lines, &rate));
    warn(shared, options::many_threads(arguments.threads).as_slice());
    let input =
        SurveyInput::new(&world, &lines, &rate).map_err(|error| options::refused(&rate, error))?;
    let snapshots = options::snapshots(arguments, &world, &input)?;
    let frame = if arguments.galactic { MapFrame::Galactic } else { MapFrame::Ecliptic };
    let ordering = if arguments.nested { Ordering::Nested } else { Ordering::Ring };
    let layout = Layout { ordering, frame };

    // The circular Sun needs no table; tracks do.
    let needs_table = input.circular_sun.is_none() || arguments.tracks;
    let tables = needs_table.then(|| world.tables(&world.ground_options())).transpose()?;
    let table = tables.as_ref().map(Tables::parse).transpose()?;
    let source = match (&input.circular_sun, &tables) {
        (Some(longitude), _) => SunSource::Circular(longitude.clone()),
        (None, Some(tables)) => SunSource::Table(sun_table(tables)?),
        (None, None) => return Err(Failure::internal("neither a circular Sun nor a table")),
    };
    let drawn = match table {
        Some(table) if arguments.tracks => {
            let targets: Vec<(String, i32)> =
                world.targets.iter().map(|it| (title(it.name()), it.body())).collect();
            tracks(table, &targets, (world.start, world.end), frame)
        }
        _ => Vec::new(),
    };
    let mut besides = if sky.is_some() { sky::bytes(nside) } else { 0 };
    if !snapshots.is_empty() {
        besides += map_bytes(nside, moments.len());
    }
    let session = Session {
        world: &world,
        input: &input,
        sun: SurveySun { source, step },
        nside,
        moments: &moments,
        layout,
        isa,
        threads: options::threads(arguments.threads, nside, moments.len(), besides)?,
        snapshots: &snapshots,
        pictures: Pictures {
            folders: arguments.figures.folders(),
            patches,
            tracks: drawn,
            log: arguments.log,
        },
        out: shared.out.clone(),
        provenance: Provenance::of(&world),
        rate_hz: rate.to_f64(),
        sky: sky.map(Arc::new),
    };

    let watch = Watch::on_interrupt();
    let groups: Vec<&[SightLine]> =
        if arguments.per_detector { lines.chunks(1).collect() } else { vec![&lines] };
    let passes = if arguments.sky.is_some() { 2 } else { 1 };
    let total = input.samples * lines.len() as u64 * passes;
    let mut files = Vec::new();
    let reports = watch.shown(shared, total, || {
        let mut first = 0;
        let mut reports = Vec::new();
        for (group, name) in groups.iter().zip(names(&groups)) {
            let detectors = &input.detectors[first..first + group.len()];
            first += group.len();
            reports.push(session.group(group, detectors, &name, &watch, &mut files)?);
        }
        Ok(reports)
    })?;

    session.deliver(shared, arguments.per_detector, (&reports, &files))
}

/// What the names of each map's files end with, nothing where there is one map. Names that a file
/// system may take for the same get a number.
fn names(groups: &[&[SightLine]]) -> Vec<String> {
    if groups.len() < 2 {
        return vec![String::new(); groups.len()];
    }
    let mut taken = BTreeSet::new();
    let name = |group: &&[SightLine]| {
        let (telescope, detector) = seen_by(group);
        let plain = format!("-{telescope}-{detector}");
        let numbered = (2_usize..).map(|number| format!("{plain}-{number}"));
        let mut all = std::iter::once(plain.clone()).chain(numbered);
        all.find(|it| taken.insert(it.to_lowercase())).unwrap_or_default()
    };
    groups.iter().map(name).collect()
}
