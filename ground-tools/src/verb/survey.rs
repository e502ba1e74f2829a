//! `gyrfalcon survey`: how often, and at which angles, each pixel of the sky is seen.
//!
//! Without names the mission boresight looks; several detectors share one map, or have one each with
//! `--per-detector`. Snapshots are written when they are reached, the rest at the end; an interrupt
//! keeps the snapshots.

use super::{mission, print_json, tell, warn};
use crate::cli::{SharedArgs, SurveyArgs};
use crate::failure::Failure;
use crate::memory::available_bytes;
use crate::number::Number;
use crate::output::Sink;
use crate::picture::View;
use crate::places::angles;
use crate::provenance::Provenance;
use crate::quantity;
use crate::rounding;
use crate::sightline::{NONE, SightLine, select};
use crate::survey_input::SurveyInput;
use crate::survey_products::{Layout, Pictures, beside, tracks, write_fits};
use crate::survey_report::{MapReport, Snapshot, Summary, SurveyReport, text, who};
use crate::world::World;
use indicatif::{ProgressBar, ProgressStyle};
use onboard_core::sun::SunModel;
use onboard_core::time::Duration;
use planner::healpix::{MAX_NSIDE, Nside, Ordering};
use planner::survey::{
    Collector, Isa, MOST_MOMENTS, MapFrame, Moment, Progress, SunSource, Survey, SurveyDetector,
    SurveyMaps, SurveyStatistics, SurveySun, Sweeping, map_bytes,
};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::f64::consts::TAU;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration as Wait;

/// Mean orbital rate for the scan-beam angle: 360 deg in 365.25 d.
const ORBIT_RAD_S: f64 = TAU / 31_557_600.0;

pub(super) fn run(shared: &SharedArgs, arguments: &SurveyArgs) -> Result<(), Failure> {
    let nside = nside(arguments.nside, arguments.moment.len())?;
    let moments = moments(&arguments.moment)?;
    let isa = isa()?;
    let patches = patches(&arguments.patch)?;
    let step = step(arguments)?;
    if shared.json && shared.out.as_ref().is_some_and(|path| path.as_os_str() == "-") {
        return Err(Failure::Input(
            "--json and --out -: standard output takes one of the two; name a file".to_owned(),
        ));
    }

    let mut world = World::open(mission(shared)?, shared.ephemeris.as_deref())?;
    world.avoided.clear();
    if !arguments.tracks {
        world.targets.clear();
    }
    let lines =
        select(&world.mission, arguments.telescope.as_deref(), arguments.detector.as_deref())?;
    let rate = rate(arguments, &world)?;
    check_plates(&world, &lines, &moments)?;
    warn(shared, &slow_sampling(&world, &lines, &rate));
    let input = SurveyInput::new(&world, &lines, &rate)?;
    let snapshots = snapshots(arguments, &world, &input)?;
    let frame = if arguments.galactic { MapFrame::Galactic } else { MapFrame::Ecliptic };
    let ordering = if arguments.nested { Ordering::Nested } else { Ordering::Ring };
    let layout = Layout { ordering, frame };

    let tables = world.tables(&world.ground_options())?;
    let table = tables.parse()?;
    let source = match (input.circular_sun, world.sun(table)?) {
        (Some(longitude), _) => SunSource::Circular(longitude),
        (None, model @ SunModel::Table(_)) => SunSource::Table(model),
        (None, SunModel::Circular(_)) => {
            return Err(Failure::internal("a circular Sun without its longitude"));
        }
    };
    let drawn = if arguments.tracks {
        let targets: Vec<(String, i32)> =
            world.targets.iter().map(|it| (it.name().to_owned(), it.body())).collect();
        tracks(table, &targets, (world.start, world.end), frame)
    } else {
        Vec::new()
    };
    let session = Session {
        world: &world,
        input: &input,
        sun: SurveySun { source, step },
        nside,
        moments: &moments,
        layout,
        isa,
        pool: pool(arguments.threads, nside, moments.len())?,
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
    };

    let progress = Arc::new(Progress::default());
    let handler = Arc::clone(&progress);
    ctrlc::set_handler(move || handler.stop()).map_err(Failure::internal)?;
    let groups: Vec<&[SightLine]> =
        if arguments.per_detector { lines.chunks(1).collect() } else { vec![&lines] };
    let total = input.samples * lines.len() as u64;
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

    let Some(first) = reports.first() else { return Err(Failure::internal("no line of sight")) };
    if shared.json {
        print_json(&Summary {
            first,
            per_detector: arguments.per_detector.then_some(&reports),
            files: &files,
            provenance: &session.provenance,
        })
    } else if shared.out.as_ref().is_some_and(|path| path.as_os_str() == "-") {
        Ok(())
    } else {
        let mut told = text(&session.title(), &reports);
        if !files.is_empty() {
            told.push_str("\nwritten: ");
            told.push_str(&files.join(", "));
            told.push('\n');
        }
        tell(shared, &told)
    }
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
}

impl Session<'_> {
    fn title(&self) -> String {
        let days = self.world.end.since(self.world.start).seconds() / 86_400.0;
        format!("{}: survey of {days} d at {} Hz", self.world.mission.name, self.rate_hz)
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
        let amplitude = detectors.iter().map(|it| self.sweeping(it).amplitude_rad());
        Ok(SurveyReport {
            telescope,
            detector,
            detectors: lines.len(),
            rate_hz: self.rate_hz,
            scan_beam_amplitude_deg: amplitude.fold(0.0, f64::max).to_degrees(),
            map,
            snapshots,
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

fn nside(nside: u32, moments: usize) -> Result<Nside, Failure> {
    Nside::new(nside).map_err(|error| {
        let size = if nside.is_power_of_two() && nside > MAX_NSIDE {
            let bytes = 12.0 * f64::from(nside).powi(2) * 8.0 * (1.0 + 2.0 * moments_f64(moments));
            format!(" (its map would take {})", gigabytes(bytes))
        } else {
            String::new()
        };
        Failure::Input(format!("--nside: {error}{size}"))
    })
}

#[expect(clippy::cast_precision_loss, reason = "a size in words")]
fn moments_f64(moments: usize) -> f64 {
    moments as f64
}

fn gigabytes(bytes: f64) -> String {
    format!("{:.1} GB", bytes / 1e9)
}

/// Threads, and that their maps fit the memory: fewer threads where that is needed.
fn pool(asked: Option<NonZeroUsize>, nside: Nside, moments: usize) -> Result<ThreadPool, Failure> {
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let mut threads = asked.map_or(cores, NonZeroUsize::get);
    let each = map_bytes(nside, moments);
    if let Some(available) = available_bytes() {
        let fitting = usize::try_from(available / each.max(1)).unwrap_or(usize::MAX);
        if fitting == 0 {
            #[expect(clippy::cast_precision_loss, reason = "a size in words")]
            return Err(Failure::Input(format!(
                "--nside {}: a map with {moments} moment(s) takes {}, and {} of memory are left; a \
                 smaller --nside or fewer --moment fit",
                nside.get(),
                gigabytes(each as f64),
                gigabytes(available as f64)
            )));
        }
        threads = threads.min(fitting);
    }
    ThreadPoolBuilder::new().num_threads(threads).build().map_err(Failure::internal)
}

fn moments(texts: &[String]) -> Result<Vec<Moment>, Failure> {
    let moments: Vec<Moment> = texts
        .iter()
        .map(|text| {
            let wrong = |what: &str| Failure::Input(format!("--moment {text}: {what}"));
            let (n, m) = text
                .split_once(',')
                .ok_or_else(|| wrong("n and m with a comma between are needed, such as 2,4"))?;
            let order = |text: &str| {
                text.trim().parse::<f64>().map_err(|_| {
                    wrong("two numbers are needed, whole or half-integer, such as 2,4 or -0.5,2")
                })
            };
            Moment::new(order(n)?, order(m)?).map_err(|error| wrong(&error.to_string()))
        })
        .collect::<Result<_, _>>()?;
    if moments.len() > MOST_MOMENTS {
        return Err(Failure::Input(format!(
            "--moment: {} of them; at most {MOST_MOMENTS} are collected at a time",
            moments.len()
        )));
    }
    Ok(moments)
}

/// The instruction set of `GYRFALCON_ISA`, else the best.
fn isa() -> Result<Isa, Failure> {
    match std::env::var("GYRFALCON_ISA") {
        Ok(name) => Isa::named(&name)
            .map_err(|error| Failure::Input(format!("GYRFALCON_ISA={name}: {error}"))),
        Err(_) => Ok(Isa::best()),
    }
}

fn rate(arguments: &SurveyArgs, world: &World) -> Result<Number, Failure> {
    match &arguments.rate {
        None => Ok(world.mission.scan.sampling_rate_hz.clone()),
        Some(text) => {
            quantity::hertz(text).map_err(|error| Failure::Input(format!("--rate: {error}")))
        }
    }
}

fn step(arguments: &SurveyArgs) -> Result<Option<Duration>, Failure> {
    let Some(text) = &arguments.orbit_step else { return Ok(None) };
    let wrong = |what: &str| Failure::Input(format!("--orbit-step {text}: {what}"));
    let exact = quantity::seconds(text).map_err(|error| wrong(&error.to_string()))?;
    let step = rounding::duration(&exact).filter(|step| step.ns() > 0);
    step.map(Some).ok_or_else(|| wrong("a time above 0 s is needed"))
}

/// Patches as `LON,LAT,SIDE`, with what their files' names say.
fn patches(texts: &[String]) -> Result<Vec<(String, View)>, Failure> {
    texts
        .iter()
        .enumerate()
        .map(|(index, text)| {
            let [longitude, latitude, side] =
                angles("--patch", text, ["longitude", "latitude", "side"])?;
            if latitude.abs() > 90.0 || !(0.0..120.0).contains(&side) || side <= 0.0 {
                return Err(Failure::Input(format!(
                    "--patch {text}: a latitude from -90 to 90 deg and a side above 0 and below \
                     120 deg are needed"
                )));
            }
            let view = View::Patch {
                longitude_rad: longitude.to_radians(),
                latitude_rad: latitude.to_radians(),
                side_rad: side.to_radians(),
            };
            Ok((format!("-patch{}", index + 1), view))
        })
        .collect()
}

/// Times of snapshots in their order: as written, elapsed, samples before.
fn snapshots(
    arguments: &SurveyArgs,
    world: &World,
    input: &SurveyInput,
) -> Result<Vec<(String, Duration, u64)>, Failure> {
    let span = world.end.since(world.start);
    let mut snapshots = arguments
        .snapshot
        .iter()
        .map(|text| {
            let wrong = |what: String| Failure::Input(format!("--snapshot {text}: {what}"));
            let exact = quantity::seconds(text).map_err(|error| wrong(error.to_string()))?;
            let elapsed = rounding::duration(&exact)
                .filter(|it| it.ns() > 0 && it.ns() <= span.ns())
                .ok_or_else(|| {
                    let days = span.seconds() / 86_400.0;
                    wrong(format!("a time above 0 s and up to the mission's {days} d is needed"))
                })?;
            Ok((text.clone(), elapsed, input.samples_before(elapsed.ns())))
        })
        .collect::<Result<Vec<_>, Failure>>()?;
    snapshots.sort_by_key(|it| it.1.ns());
    Ok(snapshots)
}

/// A moment with m needs a plate before every detector.
fn check_plates(world: &World, lines: &[SightLine], moments: &[Moment]) -> Result<(), Failure> {
    let Some(moment) = moments.iter().find(|it| it.needs_plate()) else { return Ok(()) };
    let Some(line) = lines.iter().find(|line| line.hwp.is_none()) else { return Ok(()) };
    let with: Vec<&str> = world
        .mission
        .telescopes
        .iter()
        .filter(|it| it.hwp.is_some())
        .map(|it| it.name.as_str())
        .collect();
    let who = if line.telescope.is_some() {
        format!("{} has no half-wave plate", line.key())
    } else if with.len() > 1 {
        "the telescopes' half-wave plates differ, so the mission boresight has none".to_owned()
    } else {
        "the mission has no half-wave plate".to_owned()
    };
    let remedy = if with.is_empty() {
        "m = 0 is needed, or a telescope with hwp_rate_rpm".to_owned()
    } else {
        format!("m = 0 is needed, or --telescope {}", with.join(" or "))
    };
    Err(Failure::Input(format!("--moment {},{}: {who}; {remedy}", moment.n(), moment.m())))
}

/// The sampling condition of each telescope that looks, where it does not hold.
fn slow_sampling(world: &World, lines: &[SightLine], rate: &Number) -> Vec<String> {
    let margin = world.mission.scan.n_margin.to_f64();
    let mut told: Vec<String> = Vec::new();
    for line in lines {
        let Some(plate) = line.hwp else { continue };
        let hz = (plate.rate.radians_per_second() / TAU).abs();
        let needed = 8.0 * margin * hz;
        if hz >= rate.to_f64() / (8.0 * margin) {
            let sentence = format!(
                "sampling_ok fails for {}: {rate} Hz is not above 8 n_margin f_phi = {needed} Hz, so \
                 the plate's modulation is sampled too slowly",
                if line.telescope.is_some() { &line.telescope_name } else { "the boresight" }
            );
            if !told.contains(&sentence) {
                told.push(sentence);
            }
        }
    }
    told
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
