//! The options of `systematics`, checked: a sentence for each that is not legal.

use crate::cli::SystematicsArgs;
use crate::cli::quantities::{angle_rad, rate_hz};
use crate::failure::Failure;
use formats::fits::{Frames, MapFrame as FitsFrame, read_stokes};
use mission::number::{Number, nearest};
use mission::quantity;
use planner::harmonics::{Complex64, Rings};
use planner::healpix::Nside;
use planner::opportunities::SightLine;
use planner::survey::{MOST_MOMENTS, MapFrame, Moment};
use planner::systematics::effects::{ActsOn, EffectKind, KINDS, Measure, Motions};
use planner::systematics::{
    Asked, CmbSpectra, Likelihood, Polarimeter, SkyAlms, StudySky, TensorTilt, moments as needed,
    realisation, solar_dipole_uk,
};
use planner::world::World;
use std::path::Path;

/// Largest resolution.
const MOST_NSIDE: u32 = 1024;

/// What all effects share.
pub(super) struct Setting {
    pub nside: Nside,
    pub likelihood: Likelihood,
    /// The CMB as it is, and through the beam to the last degree asked for.
    pub cmb: CmbSpectra,
    seen: CmbSpectra,
    seed: Option<u64>,
    tilt: TensorTilt,
}

/// An effect as it was asked for.
pub(super) struct Named {
    pub text: String,
    pub asked: Asked,
}

impl Named {
    /// Which sky, in a word.
    pub(super) fn sky(&self) -> &'static str {
        match &self.asked.sky {
            StudySky::Mean(_) => "CMB, mean",
            StudySky::Given(sky) if sky.t.l_max() == 1 => "dipole",
            StudySky::Given(_) => "given",
        }
    }
}

impl Setting {
    pub(super) fn read(arguments: &SystematicsArgs) -> Result<Self, Failure> {
        let nside = Nside::new(arguments.nside)
            .map_err(|error| Failure::Input(format!("--nside: {error}")))?;
        if arguments.nside > MOST_NSIDE {
            return Err(Failure::Input(format!(
                "--nside {}: {MOST_NSIDE} at most for spectra",
                arguments.nside
            )));
        }
        let tilt =
            if arguments.consistency { TensorTilt::Consistency } else { TensorTilt::Scaleless };
        let cmb = CmbSpectra::embedded(tilt).map_err(Failure::internal)?;
        let last = arguments.cmb_lmax;
        if !(2..=cmb.l_max()).contains(&last) {
            return Err(Failure::Input(format!(
                "--cmb-lmax {last}: from 2 to {}, where the spectra end",
                cmb.l_max()
            )));
        }
        let fwhm_rad = angle_rad("--fwhm", &arguments.fwhm)?;
        let seen = cmb.through_beam(fwhm_rad.abs(), last);
        let wrong = || {
            Failure::Input(format!(
                "--degrees {}: first and last degree with a colon between, such as 2:191",
                arguments.degrees
            ))
        };
        let (from, to) = arguments.degrees.split_once(':').ok_or_else(wrong)?;
        let [from, to] = [from, to].map(|it| it.trim().parse::<usize>());
        let degrees = [from.map_err(|_| wrong())?, to.map_err(|_| wrong())?];
        if degrees[0] < 2 || degrees[1] < degrees[0] || degrees[1] > cmb.l_max() {
            return Err(Failure::Input(format!(
                "--degrees {}: a range within 2 and {}, where the spectra end",
                arguments.degrees,
                cmb.l_max()
            )));
        }
        let likelihood = Likelihood { degrees, ..Likelihood::new(&cmb.tensor_bb, &cmb.bb) };
        Ok(Self { nside, likelihood, cmb, seen, seed: arguments.seed, tilt })
    }

    /// In a line, what delta r depends on.
    pub(super) fn told(&self) -> String {
        let [from, to] = self.likelihood.degrees;
        let tilt = match self.tilt {
            TensorTilt::Scaleless => "n_t = 0",
            TensorTilt::Consistency => "n_t = -1/8 at r = 1",
        };
        format!(
            "N_side {}, delta r from l = {from} to {to}, tensors with {tilt}, CMB to l = {}",
            self.nside.get(),
            self.seen.l_max()
        )
    }
}

pub(super) fn rate(arguments: &SystematicsArgs, world: &World) -> Result<Number, Failure> {
    match &arguments.rate {
        None => Ok(world.mission.scan.sampling_rate_hz.clone()),
        Some(text) => rate_hz("--rate", text),
    }
}

/// The effects, each with its sky.
pub(super) fn effects(
    arguments: &SystematicsArgs,
    world: &World,
    lines: &[SightLine],
    setting: &Setting,
) -> Result<Vec<Named>, Failure> {
    let scan = &world.mission.scan;
    let plates: Vec<f64> =
        lines.iter().filter_map(|it| it.hwp).map(|it| it.rate.radians_per_second()).collect();
    let motions = Motions {
        plate_rad_s: plates.first().copied().unwrap_or(0.0),
        sweep_rad_s: scan.spin.rate.radians_per_second() * scan.beta_rad.sin(),
    };
    let angle_rad = lines.first().map_or(0.0, |it| it.polarisation_rad);
    if lines.iter().any(|it| (it.polarisation_rad - angle_rad).abs() > 1e-12) {
        return Err(Failure::Input(
            "--detector: detectors with different polarisation angles have residuals of their \
             own; name one"
                .to_owned(),
        ));
    }
    let given_sky =
        arguments.sky.as_deref().map(|path| sky(path, arguments.cmb_lmax)).transpose()?;
    let mut named = Vec::new();
    for text in &arguments.effect {
        let wrong = |what: String| Failure::Input(format!("--effect {text}: {what}"));
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let kind = EffectKind::named(name).map_err(|_| {
            let names: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
            wrong(format!("no such effect; there are {}", names.join(", ")))
        })?;
        if !kind.polarimeter.pair && plates.len() < lines.len() {
            let what = "the line of sight has no half-wave plate; --telescope names one that has";
            return Err(wrong(what.to_owned()));
        }
        let given = rest
            .split(',')
            .filter(|part| !part.is_empty())
            .map(|part| value(kind, part).map_err(wrong))
            .collect::<Result<Vec<_>, _>>()?;
        let effect = kind.effect(&given, &motions).map_err(|error| {
            let names: Vec<&str> = kind.parameters.iter().map(|it| it.0).collect();
            wrong(format!("{error}; parameters are {}", names.join(", ")))
        })?;
        let by_kind = || match (kind.acts_on, setting.seed) {
            (ActsOn::Dipole, _) => {
                StudySky::Given(SkyAlms::dipole(solar_dipole_uk(MapFrame::Ecliptic)))
            }
            (ActsOn::Cmb, None) => StudySky::Mean(setting.seen.clone()),
            (ActsOn::Cmb, Some(seed)) => {
                StudySky::Given(realisation(&setting.seen, setting.seen.l_max(), seed))
            }
        };
        let sky = given_sky.clone().map_or_else(by_kind, StudySky::Given);
        let polarimeter = Polarimeter { polarisation_rad: angle_rad, ..kind.polarimeter };
        named.push(Named {
            text: text.clone(),
            asked: Asked { terms: effect.terms(), polarimeter, sky },
        });
    }
    Ok(named)
}

/// A sky in ecliptic coordinates, by coefficients or by maps to degree `l_max`.
fn sky(path: &Path, l_max: usize) -> Result<SkyAlms, Failure> {
    let wrong = |what: String| Failure::Input(format!("--sky {}: {what}", path.display()));
    if path.extension().is_some_and(|it| it.eq_ignore_ascii_case("csv")) {
        let text =
            std::fs::read_to_string(path).map_err(|error| Failure::file("read", path, &error))?;
        return SkyAlms::from_csv(&text).map_err(|error| wrong(error.to_string()));
    }
    let frames = Frames { accepted: &[FitsFrame::Ecliptic], unsaid: Some(FitsFrame::Ecliptic) };
    let map = read_stokes(path, frames)?;
    let nside = map.nside;
    let ring = |values: &[f64]| -> Vec<f64> {
        let at = |ring| nside.numbered(map.ordering, nside.nested_of_ring(ring)) as usize;
        (0..nside.pixels()).map(|pixel| values[at(pixel)]).collect()
    };
    let [i, q, u] = [&map.i, &map.q, &map.u].map(|values| ring(values));
    if [&i, &q, &u].into_iter().flatten().any(|value| !value.is_finite() || *value < -1e30) {
        return Err(wrong("pixels without a value; a whole sky is needed".to_owned()));
    }
    let p: Vec<Complex64> = q.iter().zip(&u).map(|(q, u)| Complex64::new(*q, *u)).collect();
    let l_max = l_max.min(3 * nside.get() as usize - 1);
    SkyAlms::of_maps(&Rings::new(nside), &i, &p, l_max).map_err(|error| wrong(error.to_string()))
}

/// `key=value`.
fn value(kind: &EffectKind, part: &str) -> Result<(String, f64), String> {
    let (key, text) = part.split_once('=').ok_or_else(|| format!("{part}: KEY=VALUE is needed"))?;
    let measure = kind.parameters.iter().find(|it| it.0 == key).map_or(Measure::Number, |it| it.1);
    let value = match measure {
        Measure::Angle => quantity::degrees(text).map(|it| nearest(&it).to_radians()),
        Measure::Time => quantity::seconds(text).map(|it| nearest(&it)),
        Measure::Number => {
            let value = Number::parse(text).map_err(|error| format!("{key}: {error}"))?;
            return Ok((key.to_owned(), value.to_f64()));
        }
    };
    value.map(|value| (key.to_owned(), value)).map_err(|error| format!("{key}: {error}"))
}

/// The orientation functions that the effects need.
pub(super) fn moments(named: &[Named]) -> Result<Vec<Moment>, Failure> {
    let mut all: Vec<Moment> = Vec::new();
    for Named { asked, .. } in named {
        all.extend(needed(&asked.terms, &asked.polarimeter).map_err(Failure::input)?);
    }
    all.sort_unstable();
    all.dedup();
    if all.len() > MOST_MOMENTS {
        return Err(Failure::Input(format!(
            "--effect: {} orientation functions are needed; {MOST_MOMENTS} are collected at a time",
            all.len()
        )));
    }
    Ok(all)
}
