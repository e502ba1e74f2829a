//! `gyrfalcon survey`: how often, and at which angles, each pixel of the sky is seen.
//!
//! Without names the mission boresight looks; several detectors share one map, or have one each with
//! `--per-detector`. Snapshots are written when they are reached, the rest at the end; an interrupt
//! keeps the snapshots.

mod options;
mod sky;
mod products;
mod watch;

use super::{mission, print_json, tell, warn};
use crate::cli::{SharedArgs, SurveyArgs};
use crate::failure::Failure;
use crate::output::Sink;
use formats::survey::{MapReport, Snapshot, Summary, SurveyReport, text, who};
use onboard_core::time::Duration;
use planner::healpix::{Nside, Ordering};
use planner::mapmaking::Sky;
use planner::opportunities::{NONE, SightLine, select};
use planner::provenance::Provenance;
use planner::survey::input::SurveyInput;
use planner::survey::{
    Collector, Isa, MapFrame, Moment, SunSource, SunTable, Survey, SurveyDetector, SurveyError,
    SurveyMaps, SurveyStatistics, SurveySun, Sweeping, map_bytes,
};
use planner::world::{Tables, World};
use products::{Layout, Pictures, beside, tracks, write_fits};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::path::PathBuf;
use std::sync::Arc;
use watch::Watch;

/// Mean orbital rate for the scan-beam angle: 360 deg in 365.25 d.
const ORBIT_RAD_S: f64 = TAU / 31_557_600.0;

pub(super) fn run(shared: &SharedArgs, arguments: &SurveyArgs) -> Result<(), Failure> {
    let nside = options::nside(arguments.nside, arguments.moment.len())?;
    let moments = options::moments(&arguments.moment)?;
    let isa = options::isa()?;
    let patches = options::patches(&arguments.patch)?;
    let step = options::step(arguments)?;
    if shared.json && shared.out.as_ref().is_some_and(|path| path.as_os_str() == "-") {
        return Err(Failure::Input(
            "--json and --out -: standard output takes one of the two; name a file".to_owned(),
        ));
    }

    let sky = sky::asked(shared, arguments)?;
    let mut world = World::open(mission(shared)?, shared.ephemeris.as_deref())?;
    world.avoided.clear();
    if !arguments.tracks {
        world.targets.clear();
    }
    let lines =
        select(&world.mission, arguments.telescope.as_deref(), arguments.detector.as_deref())?;
    let rate = options::rate(arguments, &world)?;
    options::check_plates(&world, &lines, &moments)?;
    warn(shared, &options::slow_sampling(&world, &lines, &rate));
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
        (None, Some(tables)) => {
            let table = SunTable::new(tables.fitted.bytes.as_slice());
            SunSource::Table(
                table.map_err(|error| Failure::internal(format!("the fitted table: {error:?}")))?,
            )
        }
        (None, None) => return Err(Failure::internal("neither a circular Sun nor a table")),
    };
    let drawn = match table {
        Some(table) if arguments.tracks => {
            let targets: Vec<(String, i32)> =
                world.targets.iter().map(|it| (it.name().to_owned(), it.body())).collect();
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
            png: arguments.png.clone(),
            svg: arguments.svg.clone(),
            patches,
            tracks: drawn,
            log: arguments.log,
        },
        out: shared.out.clone(),
        provenance: Provenance::of(&world),
        rate_hz: rate.to_f64(),
        sky: sky.map(Arc::new),
    };

    let watch = Watch::on_interrupt()?;
    let groups: Vec<&[SightLine]> =
        if arguments.per_detector { lines.chunks(1).collect() } else { vec![&lines] };
    let passes = if arguments.sky.is_some() { 2 } else { 1 };
    let total = input.samples * lines.len() as u64 * passes;
    let mut files = Vec::new();
    let reports = watch.shown(shared, total, || {
        let mut first = 0;
        let mut reports = Vec::new();
        for group in &groups {
            let detectors = &input.detectors[first..first + group.len()];
            first += group.len();
            let several = groups.len() > 1;
            reports.push(session.group(group, detectors, several, &watch, &mut files)?);
        }
        Ok(reports)
    })?;

    session.deliver(shared, arguments.per_detector, (&reports, &files))
}

/// All that does not change between the maps of one command.
struct Session<'w> {
    world: &'w World,
    input: &'w SurveyInput,
    sun: SurveySun,
    nside: Nside,
    moments: &'w [Moment],
    layout: Layout,
    isa: Isa,
    threads: usize,
    snapshots: &'w [(String, Duration, u64)],
    pictures: Pictures,
    out: Option<PathBuf>,
    provenance: Provenance,
    rate_hz: f64,
    sky: Option<Arc<Sky>>,
}

impl Session<'_> {
    fn title(&self) -> String {
        let days = self.world.end.since(self.world.start).seconds() / 86_400.0;
        format!("{}: survey of {days} d at {} Hz", self.world.mission.name, self.rate_hz)
    }

    fn deliver(
        &self,
        shared: &SharedArgs,
        per_detector: bool,
        (reports, files): (&[SurveyReport], &[String]),
    ) -> Result<(), Failure> {
        let Some(first) = reports.first() else {
            return Err(Failure::internal("no line of sight"));
        };
        if shared.json {
            print_json(&Summary {
                first,
                per_detector: per_detector.then_some(reports),
                files,
                provenance: &self.provenance,
            })
        } else if shared.out.as_ref().is_some_and(|path| path.as_os_str() == "-") {
            Ok(())
        } else {
            let mut told = text(&self.title(), reports);
            if !files.is_empty() {
                told.push_str("\nwritten: ");
                told.push_str(&files.join(", "));
                told.push('\n');
            }
            tell(shared, &told)
        }
    }

    /// One map: collected, with its snapshots, and written.
    fn group(
        &self,
        lines: &[SightLine],
        detectors: &[SurveyDetector],
        several: bool,
        watch: &Watch,
        files: &mut Vec<String>,
    ) -> Result<SurveyReport, Failure> {
        let survey = Survey {
            scan: self.input.scan.clone(),
            sun: self.sun.clone(),
            detectors: detectors.to_vec(),
            nside: self.nside,
            frame: self.layout.frame,
            moments: self.moments.to_vec(),
        };
        let (telescope, detector) = seen_by(lines);
        let name = if several { format!("-{telescope}-{detector}") } else { String::new() };
        let mut collector = Collector::new(survey.clone(), self.isa).map_err(failed)?;
        let mut from = 0;
        let mut snapshots = Vec::new();
        for (after, elapsed, samples) in self.snapshots {
            self.collect(&mut collector, from..*samples, watch, files)?;
            from = *samples;
            let maps = collector.maps();
            let map = MapReport::new(self.nside.get(), &SurveyStatistics::of(&maps));
            self.write(&maps, (&name, Some(after)), (&telescope, &detector), files)?;
            snapshots.push(Snapshot { after: after.clone(), elapsed_s: elapsed.seconds(), map });
        }
        self.collect(&mut collector, from..self.input.samples, watch, files)?;
        let maps = collector.finish();
        let map = MapReport::new(self.nside.get(), &SurveyStatistics::of(&maps));
        self.write(&maps, (&name, None), (&telescope, &detector), files)?;
        let sky = self
            .sky
            .as_ref()
            .map(|sky| self.observe(survey, (lines, sky, &name), watch, files))
            .transpose()?;
        let amplitude = detectors
            .par_iter()
            .map(|it| self.sweeping(it).amplitude_rad())
            .reduce(|| 0.0, f64::max);
        Ok(SurveyReport {
            telescope,
            detector,
            detectors: lines.len(),
            rate_hz: self.rate_hz,
            scan_beam_amplitude_deg: amplitude.to_degrees(),
            map,
            snapshots,
            sky,
        })
    }

    fn collect(
        &self,
        collector: &mut Collector,
        span: std::ops::Range<u64>,
        watch: &Watch,
        files: &[String],
    ) -> Result<(), Failure> {
        collector.collect(span, self.threads, watch).map_err(|error| match error {
            SurveyError::Stopped => {
                let kept = if files.is_empty() {
                    "nothing is written".to_owned()
                } else {
                    format!("what --snapshot asked for stays: {}", files.join(", "))
                };
                let done = watch.samples();
                Failure::Check(format!("interrupted after {done} samples: {kept}"))
            }
            other => failed(other),
        })
    }

    fn write(
        &self,
        maps: &SurveyMaps,
        (name, after): (&str, Option<&str>),
        (telescope, detector): (&str, &str),
        files: &mut Vec<String>,
    ) -> Result<(), Failure> {
        let suffix = after.map_or(name.to_owned(), |after| format!("{name}-{after}"));
        let suffix = suffix.as_str();
        let after = after.map_or(String::new(), |after| format!(", after {after}"));
        if let Some(path) = &self.out {
            let to_stdout = path.as_os_str() == "-";
            if !to_stdout || suffix.is_empty() {
                let path = beside(path, suffix);
                let sink = if to_stdout { Sink::Stdout } else { Sink::File(path.clone()) };
                let seen_by = who(telescope, detector);
                write_fits(&sink, maps, self.layout, &self.provenance, &seen_by)?;
                if !to_stdout {
                    files.push(path.display().to_string());
                }
            }
        }
        let title = format!("{}, {}{}", self.title(), who(telescope, detector), after);
        files.extend(self.pictures.write(maps, self.layout.frame, (&title, suffix))?);
        Ok(())
    }

    fn sweeping(&self, detector: &SurveyDetector) -> Sweeping {
        let scan = &self.world.mission.scan;
        Sweeping {
            alpha_rad: scan.alpha_rad,
            polar_rad: detector.polar_rad(scan.beta_rad),
            orbit_rad_s: ORBIT_RAD_S,
            precession_rad_s: scan.precession.rate.radians_per_second(),
            spin_rad_s: scan.spin.rate.radians_per_second(),
        }
    }
}

/// What a survey cannot have on checked input.
fn failed(error: SurveyError) -> Failure {
    match error {
        SurveyError::Ephemeris(error) => Failure::internal(format!("{error:?}")),
        other => Failure::internal(other),
    }
}

/// Telescope and detector of a map.
fn seen_by(lines: &[SightLine]) -> (String, String) {
    match lines {
        [only] => (only.telescope_name.clone(), only.detector_name.clone()),
        [first, rest @ ..] => {
            let one = rest.iter().all(|it| it.telescope_name == first.telescope_name);
            let telescope = if one { first.telescope_name.clone() } else { "all".to_owned() };
            (telescope, "all".to_owned())
        }
        [] => (NONE.to_owned(), NONE.to_owned()),
    }
}
