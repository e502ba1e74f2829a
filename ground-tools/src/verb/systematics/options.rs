//! The options of `systematics`, checked: a sentence for each that is not legal.

use crate::cli::SystematicsArgs;
use crate::cli::quantities::angle_rad;
use crate::failure::Failure;
use mission::number::{Number, nearest};
use mission::quantity;
use onboard_core::phase::Rotor;
use planner::healpix::Nside;
use planner::opportunities::SightLine;
use planner::survey::{MOST_MOMENTS, Moment};
use planner::systematics::effects::{EffectKind, KINDS, Measure, Motions};
use planner::systematics::{
    CmbSpectra, Dipole, Likelihood, Polarimeter, TensorTilt, Term, moments as needed, white_noise,
};
use planner::world::World;

/// What all effects share.
pub(super) struct Setting {
    pub likelihood: Likelihood,
    /// The CMB as it is.
    pub cmb: CmbSpectra,
    /// The CMB through the beam, to the last degree asked for.
    pub seen: CmbSpectra,
    pub dipole: Dipole,
    tilt: TensorTilt,
    noise_uk_arcmin: f64,
}

/// An effect as it was asked for.
pub(super) struct Named {
    pub text: String,
    pub kind: &'static EffectKind,
    pub terms: Vec<Term>,
    pub polarimeter: Polarimeter,
    /// Amplitude and phase, where it has a closed form on a dipole.
    pub leak: Option<[f64; 2]>,
}

impl Setting {
    pub(super) fn read(arguments: &SystematicsArgs) -> Result<Self, Failure> {
        let tilt =
            if arguments.consistency { TensorTilt::Consistency } else { TensorTilt::Scaleless };
        let cmb = CmbSpectra::embedded(tilt).map_err(Failure::internal)?;
        let (last, end) = (arguments.cmb_lmax, cmb.l_max());
        if !(2..=end).contains(&last) {
            let what = format!("--cmb-lmax {last}: from 2 to {end}, where the spectra end");
            return Err(Failure::Input(what));
        }
        let fwhm_rad = angle_rad("--fwhm", &arguments.fwhm)?;
        if !(0.0..=1.0).contains(&fwhm_rad) {
            let what = format!("--fwhm {}: from 0 to 57 deg", arguments.fwhm);
            return Err(Failure::Input(what));
        }
        let noise_uk_arcmin = number("--noise", &arguments.noise, [0.0, 1e6])?;
        let f_sky = number("--f-sky", &arguments.f_sky, [0.0, 1.0])?;
        if f_sky <= 0.0 {
            return Err(Failure::Input("--f-sky 0: above 0 and at most 1".to_owned()));
        }
        let degrees = degrees(&arguments.degrees, end)?;
        let likelihood = Likelihood { degrees, f_sky, ..Likelihood::new(&cmb.tensor_bb, &cmb.bb) };
        let likelihood = likelihood.with_noise(&white_noise(noise_uk_arcmin, fwhm_rad, end));
        let dipole = arguments.dipole.as_deref().map_or(Ok(Dipole::SOLAR), dipole)?;
        let seen = cmb.through_beam(fwhm_rad, last);
        Ok(Self { likelihood, cmb, seen, dipole, tilt, noise_uk_arcmin })
    }

    /// Pixels must be fine enough for the degrees.
    pub(super) fn check_pixels(&self, nside: Nside) -> Result<(), Failure> {
        let [from, to] = self.likelihood.degrees;
        let most = 3 * nside.get() as usize - 1;
        if to <= most {
            return Ok(());
        }
        Err(Failure::Input(format!(
            "--degrees {from}:{to}: maps of N_side {} have l up to {most}; a larger --nside or a \
             lower last degree fits",
            nside.get()
        )))
    }

    /// In a line, what delta r depends on.
    pub(super) fn told(&self, nside: Nside) -> String {
        let [from, to] = self.likelihood.degrees;
        let tilt = match self.tilt {
            TensorTilt::Scaleless => "n_t = 0",
            TensorTilt::Consistency => "n_t = -1/8 at r = 1",
        };
        let noise = if self.noise_uk_arcmin > 0.0 {
            format!(", noise of {} uK arcmin", self.noise_uk_arcmin)
        } else {
            String::new()
        };
        format!(
            "N_side {}, delta r from l = {from} to {to}, tensors with {tilt}, CMB to l = {}{noise}",
            nside.get(),
            self.seen.l_max()
        )
    }
}

/// A number within limits.
fn number(option: &str, text: &str, [least, most]: [f64; 2]) -> Result<f64, Failure> {
    let wrong = |what: String| Failure::Input(format!("{option} {text}: {what}"));
    let value = Number::parse(text).map_err(|error| wrong(error.to_string()))?.to_f64();
    if (least..=most).contains(&value) {
        Ok(value)
    } else {
        Err(wrong(format!("from {least} to {most}")))
    }
}

/// First and last degree, with a colon between.
fn degrees(text: &str, end: usize) -> Result<[usize; 2], Failure> {
    let wrong = |what: String| Failure::Input(format!("--degrees {text}: {what}"));
    let parts: Vec<Option<usize>> =
        text.split(':').map(|part| part.trim().parse::<usize>().ok()).collect();
    let &[Some(from), Some(to)] = parts.as_slice() else {
        return Err(wrong("first and last degree with a colon between, such as 2:191".to_owned()));
    };
    if from < 2 || to < from || to > end {
        return Err(wrong(format!("a range within 2 and {end}, where the spectra end")));
    }
    Ok([from, to])
}

/// Amplitude, longitude and latitude.
fn dipole(text: &str) -> Result<Dipole, Failure> {
    let wrong = |what: &str| Failure::Input(format!("--dipole {text}: {what}"));
    let parts: Vec<&str> = text.split(',').collect();
    let &[amplitude, longitude, latitude] = parts.as_slice() else {
        return Err(wrong(
            "amplitude in uK, galactic longitude and latitude with commas between, such as \
             3362.08,264.021deg,48.253deg",
        ));
    };
    let amplitude_uk = number("--dipole", amplitude, [0.0, 1e9])?;
    let [longitude_deg, latitude_deg] = [longitude, latitude].map(quantity::degrees);
    let angle = |it: Result<_, _>| it.map(|it| nearest(&it));
    let longitude_deg = angle(longitude_deg).map_err(|error| wrong(&error.to_string()))?;
    let latitude_deg = angle(latitude_deg).map_err(|error| wrong(&error.to_string()))?;
    if latitude_deg.abs() > 90.0 {
        return Err(wrong("a latitude from -90 to 90 deg"));
    }
    Ok(Dipole { amplitude_uk, longitude_deg, latitude_deg })
}

/// The lines of sight. Where none is named and telescopes have different plates, the boresight looks
/// through the fastest; the second says so.
pub(super) fn lines(
    arguments: &SystematicsArgs,
    world: &World,
) -> Result<(Vec<SightLine>, Option<String>), Failure> {
    let mut lines = arguments.sight.lines(&world.mission)?;
    if arguments.sight.telescope.is_some() || arguments.sight.detector.is_some() {
        return Ok((lines, None));
    }
    let speed = |plate: &Rotor| plate.rate.radians_per_second().abs();
    let plates = world.mission.telescopes.iter().filter_map(|it| Some((it.hwp?, &it.name)));
    let fastest = plates.max_by(|a, b| speed(&a.0).total_cmp(&speed(&b.0)));
    let (Some((plate, name)), [line]) = (fastest, lines.as_mut_slice()) else {
        return Ok((lines, None));
    };
    if line.hwp.is_some() {
        return Ok((lines, None));
    }
    line.hwp = Some(plate);
    let told = format!(
        "the telescopes' half-wave plates differ: the boresight looks through that of {name}, the \
         fastest; --telescope names another"
    );
    Ok((lines, Some(told)))
}

/// The effects asked for.
pub(super) fn effects(
    arguments: &SystematicsArgs,
    world: &World,
    lines: &[SightLine],
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
    let named = |text: &String| -> Result<Named, Failure> {
        let wrong = |what: String| Failure::Input(format!("--effect {text}: {what}"));
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let kind = EffectKind::named(name).map_err(|_| {
            let names: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
            wrong(format!("no such effect; there are {}", names.join(", ")))
        })?;
        let given = rest
            .split(',')
            .filter(|part| !part.is_empty())
            .map(|part| value(kind, part).map_err(wrong))
            .collect::<Result<Vec<_>, _>>()?;
        let effect = kind.effect(&given, &motions).map_err(|error| {
            let names: Vec<&str> = kind.parameters.iter().map(|it| it.0).collect();
            wrong(format!("{error}; parameters are {}", names.join(", ")))
        })?;
        if !kind.polarimeter.pair && plates.len() < lines.len() {
            let what = "the line of sight has no half-wave plate; --telescope names one that has";
            return Err(wrong(what.to_owned()));
        }
        Ok(Named {
            text: text.clone(),
            kind,
            terms: effect.terms(),
            polarimeter: Polarimeter { polarisation_rad: angle_rad, ..kind.polarimeter },
            leak: kind.leak(&given),
        })
    };
    arguments.effect.iter().map(named).collect()
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
    for Named { terms, polarimeter, .. } in named {
        all.extend(needed(terms, polarimeter).map_err(Failure::input)?);
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
