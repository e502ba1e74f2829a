//! Orientation functions: of a survey of the mission, or of an earlier one's file.

use crate::cli::quantities::rate_hz;
use crate::cli::{SharedArgs, SystematicsArgs};
use crate::failure::Failure;
use crate::output::memory::available_bytes;
use crate::verb::asked::sun_table;
use crate::verb::survey::{refused, slow_sampling};
use crate::verb::told::warn;
use formats::fits::FitsError;
use formats::maps::{OrientationMaps, read_orientations};
use planner::healpix::Nside;
use planner::opportunities::SightLine;
use planner::progress::Quietly;
use planner::survey::input::SurveyInput;
use planner::survey::{MapFrame, Moment, SunSource, Survey, SurveySun, map_bytes};
use planner::systematics::Orientations;
use planner::world::World;
use std::path::Path;

/// Largest resolution.
const MOST_NSIDE: u32 = 1024;

/// How the sky was seen.
pub(super) struct Scan {
    pub orientations: Orientations,
    pub frame: MapFrame,
    /// The survey and the number of its samples, unless it was an earlier one.
    pub survey: Option<(Survey, u64)>,
}

impl Scan {
    /// Of an earlier survey, with all that the effects need.
    pub(super) fn earlier(path: &Path, moments: &[Moment]) -> Result<Self, Failure> {
        let OrientationMaps { nside, frame, hits, functions } = read_orientations(path, moments)
            .map_err(|failure| match failure.error {
                FitsError::NoColumn { .. } => {
                    Failure::Input(format!("--survey {failure}; {}", needed(moments)))
                }
                _ => Failure::Input(format!("--survey {failure}")),
            })?;
        if nside.get() > MOST_NSIDE {
            let what = format!("--survey {}: N_side {MOST_NSIDE} at most", path.display());
            return Err(Failure::Input(what));
        }
        let functions = moments.iter().copied().zip(functions);
        let orientations =
            Orientations::of_moments(nside, hits, functions).map_err(Failure::internal)?;
        Ok(Self { orientations, frame, survey: None })
    }

    /// Of a new survey, with all that the effects need.
    pub(super) fn new(
        shared: &SharedArgs,
        arguments: &SystematicsArgs,
        (world, lines): (&World, &[SightLine]),
        moments: Vec<Moment>,
    ) -> Result<Self, Failure> {
        let nside = nside(arguments.nside)?;
        let rate = match &arguments.rate {
            None => world.mission.scan.sampling_rate_hz.clone(),
            Some(text) => rate_hz("--rate", text)?,
        };
        let input = SurveyInput::new(world, lines, &rate).map_err(|error| refused(&rate, error))?;
        warn(shared, &slow_sampling(world, lines, &rate));
        let source = match &input.circular_sun {
            Some(longitude) => SunSource::Circular(longitude.clone()),
            None => SunSource::Table(sun_table(&world.tables(&world.ground_options())?)?),
        };
        let threads = threads(nside, moments.len())?;
        let frame = frame(arguments);
        let survey = Survey {
            scan: input.scan,
            sun: SurveySun { source, step: None },
            detectors: input.detectors,
            nside,
            frame,
            moments,
        };
        let maps = survey.run(0..input.samples, threads, &Quietly).map_err(Failure::internal)?;
        let orientations = Orientations::of_survey(&maps);
        Ok(Self { orientations, frame, survey: Some((survey, input.samples)) })
    }
}

/// The frame of a new survey's maps.
pub(super) fn frame(arguments: &SystematicsArgs) -> MapFrame {
    if arguments.galactic { MapFrame::Galactic } else { MapFrame::Ecliptic }
}

pub(super) fn nside(nside: u32) -> Result<Nside, Failure> {
    if nside > MOST_NSIDE {
        let what = format!("--nside {nside}: {MOST_NSIDE} at most for spectra");
        return Err(Failure::Input(what));
    }
    Nside::new(nside).map_err(|error| Failure::Input(format!("--nside: {error}")))
}

/// What a survey has to be asked for.
fn needed(moments: &[Moment]) -> String {
    let each: Vec<String> =
        moments.iter().map(|it| format!("--moment {},{}", it.n(), it.m())).collect();
    format!("a survey for these effects is asked for with {}", each.join(" "))
}

/// How many threads, 0 for one per core, so that their maps fit the memory beside one more copy.
fn threads(nside: Nside, moments: usize) -> Result<usize, Failure> {
    let each = map_bytes(nside, moments);
    let Some(available) = available_bytes() else { return Ok(0) };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    match usize::try_from((available / each.max(1)).saturating_sub(1)).unwrap_or(usize::MAX) {
        0 => {
            #[expect(clippy::cast_precision_loss, reason = "a size in words")]
            let [needed, left] = [2 * each, available].map(|bytes| bytes as f64 / 1e9);
            Err(Failure::Input(format!(
                "--nside {}: {moments} orientation functions take {needed:.1} GB, and {left:.1} GB of \
                 memory are left; a smaller --nside or fewer --effect fit",
                nside.get()
            )))
        }
        fitting => Ok(fitting.min(cores)),
    }
}
