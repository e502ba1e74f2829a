//! `gyrfalcon survey`: how often, and at which angles, each pixel of the sky is seen.
//!
//! Without names the mission boresight looks; several detectors share one map, or have one each with
//! `--per-detector`. Snapshots are written when they are reached, the rest at the end; an interrupt
//! keeps the snapshots.

mod options;
mod sky;
mod products;

use super::{mission, print_json, tell, warn};
use crate::cli::{SharedArgs, SurveyArgs};
use crate::failure::Failure;
use crate::output::Sink;
use formats::survey::{MapReport, Snapshot, Summary, SurveyReport, text, who};
use indicatif::{ProgressBar, ProgressStyle};
use onboard_core::time::Duration;
use planner::healpix::{Nside, Ordering};
use planner::mapmaking::Sky;
use planner::opportunities::{NONE, SightLine, select};
use planner::provenance::Provenance;
use planner::survey::input::SurveyInput;
use planner::survey::{
    Collector, Isa, MapFrame, Moment, Progress, SunSource, Survey, SurveyDetector, SurveyMaps,
    SurveyStatistics, SurveySun, Sweeping,
};
use planner::world::{Tables, World};
use products::{Layout, Pictures, beside, tracks, write_fits};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration as Wait;

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
    let input = SurveyInput::new(&world, &lines, &rate)?;
    let snapshots = options::snapshots(arguments, &world, &input)?;
    let frame = if arguments.galactic { MapFrame::Galactic } else { MapFrame::Ecliptic };
    let ordering = if arguments.nested { Ordering::Nested } else { Ordering::Ring };
    let layout = Layout { ordering, frame };

    // The circular Sun needs no table; tracks do.
    let needs_table = input.circular_sun.is_none() || arguments.tracks;
    let tables = needs_table.then(|| world.tables(&world.ground_options())).transpose()?;
    let table = tables.as_ref().map(Tables::parse).transpose()?;
    let source = match (input.circular_sun, table) {
        (Some(longitude), _) => SunSource::Circular(longitude),
        (None, Some(table)) => SunSource::Table(world.sun(table)?),
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
    let besides = if sky.is_some() { sky::bytes(nside) } else { 0 };
    let session = Session {
        world: &world,
        input: &input,
        sun: SurveySun { source, step },
        nside,
        moments: &moments,
        layout,
        isa,
        pool: options::pool(arguments.threads, nside, moments.len(), besides)?,
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
        sky: sky.as_ref(),
    };

    let progress = Arc::new(Progress::default());
    let handler = Arc::clone(&progress);
    ctrlc::set_handler(move || handler.stop()).map_err(Failure::internal)?;
    let groups: Vec<&[SightLine]> =
        if arguments.per_detector { lines.chunks(1).collect() } else { vec![&lines] };
    let passes = if arguments.sky.is_some() { 2 } else { 1 };
    let total = input.samples * lines.len() as u64 * passes;
    let bar = bar(shared, total);
    let mut files = Vec::new();
    let reports = shown(&bar, &progress, || {
        let mut first = 0;
        let mut reports = Vec::new();
        for group in &groups {
            let detectors = &input.detectors[first..first + group.len()];
            first += group.len();
            let several = groups.len() > 1;
            reports.push(session.group(group, detectors, several, &progress, &mut files)?);
        }
        Ok(reports)
    })?;

    session.deliver(shared, arguments.per_detector, (&reports, &files))
}

/// All that does not change between the maps of one command.
struct Session<'w> {
    world: &'w World,
    input: &'w SurveyInput,
    sun: SurveySun<'w>,
    nside: Nside,
    moments: &'w [Moment],
    layout: Layout,
    isa: Isa,
    pool: ThreadPool,
    snapshots: &'w [(String, Duration, u64)],
    pictures: Pictures,
    out: Option<PathBuf>,
    provenance: Provenance,
    rate_hz: f64,
    sky: Option<&'w Sky>,
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
        progress: &Progress,
        files: &mut Vec<String>,
    ) -> Result<SurveyReport, Failure> {
        let survey = Survey {
            scan: self.input.scan,
            sun: self.sun,
            detectors,
            nside: self.nside,
            frame: self.layout.frame,
            moments: self.moments,
        };
        let (telescope, detector) = seen_by(lines);
        let name = if several { format!("-{telescope}-{detector}") } else { String::new() };
        let mut collector = Collector::new(&survey, self.isa);
        let mut from = 0;
        let mut snapshots = Vec::new();
        for (after, elapsed, samples) in self.snapshots {
            self.collect(&mut collector, from..*samples, progress, files)?;
            from = *samples;
            let maps = collector.merged();
            let map = MapReport::new(self.nside.get(), &SurveyStatistics::of(maps));
            self.write(maps, (&name, Some(after)), (&telescope, &detector), files)?;
            snapshots.push(Snapshot { after: after.clone(), elapsed_s: elapsed.seconds(), map });
        }
        self.collect(&mut collector, from..self.input.samples, progress, files)?;
        let maps = collector.finish();
        let map = MapReport::new(self.nside.get(), &SurveyStatistics::of(&maps));
        self.write(&maps, (&name, None), (&telescope, &detector), files)?;
        let sky = self
            .sky
            .map(|sky| self.observe(&survey, (lines, sky, &name), progress, files))
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
        collector: &mut Collector<'_>,
        span: std::ops::Range<u64>,
        progress: &Progress,
        files: &[String],
    ) -> Result<(), Failure> {
        let whole = collector
            .collect(span, &self.pool, progress)
            .map_err(|error| Failure::internal(format!("{error:?}")))?;
        if whole {
            return Ok(());
        }
        let kept = if files.is_empty() {
            "nothing is written".to_owned()
        } else {
            format!("what --snapshot asked for stays: {}", files.join(", "))
        };
        let done = progress.samples();
        Err(Failure::Check(format!("interrupted after {done} samples: {kept}")))
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
            polar_rad: detector.polar_rad(&self.input.scan),
            orbit_rad_s: ORBIT_RAD_S,
            precession_rad_s: scan.precession.rate.radians_per_second(),
            spin_rad_s: scan.spin.rate.radians_per_second(),
        }
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

/// A bar on standard error where that is a terminal.
fn bar(shared: &SharedArgs, total: u64) -> ProgressBar {
    if shared.quiet {
        return ProgressBar::hidden();
    }
    let style = "{wide_bar} {percent:>3}%  {msg}  {eta} left";
    let bar = ProgressBar::new(total);
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    bar
}

/// Does the work while the bar follows its progress.
fn shown<T>(
    bar: &ProgressBar,
    progress: &Progress,
    work: impl FnOnce() -> Result<T, Failure>,
) -> Result<T, Failure> {
    let (done, ended) = std::sync::mpsc::channel::<()>();
    let result = std::thread::scope(|scope| {
        scope.spawn(move || {
            while ended.recv_timeout(Wait::from_millis(100))
                == Err(std::sync::mpsc::RecvTimeoutError::Timeout)
            {
                bar.set_position(progress.samples());
                bar.set_message(format!("{:.1} M samples/s", bar.per_sec() / 1e6));
            }
        });
        let result = work();
        drop(done);
        result
    });
    bar.finish_and_clear();
    result
}
