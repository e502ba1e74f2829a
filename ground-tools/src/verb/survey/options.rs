//! The options of `survey`, checked: a sentence for each that is not legal.

use crate::cli::SurveyArgs;
use crate::cli::quantities::{angles_deg, rate_hz};
use crate::failure::Failure;
use crate::output::memory::available_bytes;
use mission::number::Number;
use mission::quantity;
use mission::rounding;
use onboard_core::time::Duration;
use pictures::View;
use planner::constraints::sampling_ok;
use planner::healpix::{MAX_NSIDE, Nside};
use planner::opportunities::SightLine;
use planner::survey::SamplingError;
use planner::survey::input::SurveyInput;
use planner::survey::{Isa, MOST_MOMENTS, Moment, map_bytes};
use planner::world::World;
use std::f64::consts::TAU;
use std::num::NonZeroUsize;

pub(super) fn nside(nside: u32, moments: usize) -> Result<Nside, Failure> {
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

/// Most threads of a core; more wait for each other.
const MOST_PER_CORE: usize = 4;

/// Says how many threads there will be where too many were asked for.
pub(super) fn many_threads(asked: Option<NonZeroUsize>) -> Option<String> {
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let most = cores * MOST_PER_CORE;
    let asked = asked.map(NonZeroUsize::get).filter(|it| *it > most)?;
    Some(format!("--threads {asked}: {most} are taken, {MOST_PER_CORE} for each of {cores} cores"))
}

/// How many threads, so that their maps fit the memory beside `besides` bytes: fewer than asked for
/// where that is needed.
pub(super) fn threads(
    asked: Option<NonZeroUsize>,
    nside: Nside,
    moments: usize,
    besides: u64,
) -> Result<usize, Failure> {
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let mut threads = asked.map_or(cores, NonZeroUsize::get).min(cores * MOST_PER_CORE);
    let each = map_bytes(nside, moments);
    if let Some(available) = available_bytes() {
        let left = available.saturating_sub(besides);
        let fitting = usize::try_from(left / each.max(1)).unwrap_or(usize::MAX);
        if fitting == 0 {
            #[expect(clippy::cast_precision_loss, reason = "a size in words")]
            return Err(Failure::Input(format!(
                "--nside {}: a map with {moments} moment(s) takes {}, and {} of memory are left; a \
                 smaller --nside or fewer --moment fit",
                nside.get(),
                gigabytes((each + besides) as f64),
                gigabytes(available as f64)
            )));
        }
        threads = threads.min(fitting);
    }
    Ok(threads)
}

pub(super) fn moments(texts: &[String]) -> Result<Vec<Moment>, Failure> {
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
pub(super) fn isa() -> Result<Isa, Failure> {
    match std::env::var("GYRFALCON_ISA") {
        Ok(name) => Isa::named(&name)
            .map_err(|error| Failure::Input(format!("GYRFALCON_ISA={name}: {error}"))),
        Err(_) => Ok(Isa::best()),
    }
}

/// Largest sampling rate of a mission.
const MOST_HZ: f64 = 1e9;

pub(super) fn rate(arguments: &SurveyArgs, world: &World) -> Result<Number, Failure> {
    match &arguments.rate {
        None => Ok(world.mission.scan.sampling_rate_hz.clone()),
        Some(text) => {
            let rate = rate_hz("--rate", text)?;
            if rate.to_f64() > MOST_HZ {
                return Err(Failure::Input(format!(
                    "--rate {text}: a rate above 0 and at most {MOST_HZ:e} Hz is needed, as of \
                     scan.sampling_rate_hz"
                )));
            }
            Ok(rate)
        }
    }
}

pub(super) fn step(arguments: &SurveyArgs) -> Result<Option<Duration>, Failure> {
    let Some(text) = &arguments.orbit_step else { return Ok(None) };
    let wrong = |what: &str| Failure::Input(format!("--orbit-step {text}: {what}"));
    let exact = quantity::seconds(text).map_err(|error| wrong(&error.to_string()))?;
    let step = rounding::duration(&exact).filter(|step| step.ns() > 0);
    step.map(Some).ok_or_else(|| wrong("a time above 0 s is needed"))
}

/// Patches as `LON,LAT,SIDE`, with what their files' names say.
pub(super) fn patches(texts: &[String]) -> Result<Vec<(String, View)>, Failure> {
    texts
        .iter()
        .enumerate()
        .map(|(index, text)| {
            let [longitude, latitude, side] =
                angles_deg("--patch", text, ["longitude", "latitude", "side"])?;
            if latitude.abs() > 90.0 || !(0.0..=150.0).contains(&side) || side <= 0.0 {
                return Err(Failure::Input(format!(
                    "--patch {text}: a latitude from -90 to 90 deg and a side above 0 and at \
                     most 150 deg are needed"
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
pub(super) fn snapshots(
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
pub(super) fn check_plates(
    world: &World,
    lines: &[SightLine],
    moments: &[Moment],
) -> Result<(), Failure> {
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
pub(in crate::verb) fn slow_sampling(
    world: &World,
    lines: &[SightLine],
    rate: &Number,
) -> Vec<String> {
    let margin = world.mission.scan.n_margin.to_f64();
    let mut told: Vec<String> = Vec::new();
    for line in lines {
        let Some(plate) = line.hwp else { continue };
        let hz = (plate.rate.radians_per_second() / TAU).abs();
        if !sampling_ok(hz, rate.to_f64(), margin) {
            let sentence = format!(
                "sampling_ok fails for {}: {rate} Hz is not above 8 n_margin f_phi = {:.4} Hz, so \
                 the plate's modulation is sampled too slowly",
                if line.telescope.is_some() { &line.telescope_name } else { "the boresight" },
                8.0 * margin * hz
            );
            if !told.contains(&sentence) {
                told.push(sentence);
            }
        }
    }
    told
}

/// Why a rate cannot be surveyed at.
pub(in crate::verb) fn refused(rate: &Number, error: SamplingError) -> Failure {
    Failure::Input(match error {
        SamplingError::NotPositive { .. } => format!("--rate {rate}: a rate above 0 Hz is needed"),
        SamplingError::TooSlow { least_hz, .. } => {
            format!("--rate {rate}: more than two samples per turn are needed, above {least_hz} Hz")
        }
        SamplingError::OutOfRange { .. } => {
            format!("--rate {rate}: a rate from 1e-9 to 1e18 Hz is needed")
        }
    })
}
