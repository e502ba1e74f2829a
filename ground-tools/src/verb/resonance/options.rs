//! The options of `resonance`, checked: a sentence for each that is not legal.

use crate::cli::quantities::angle_rad;
use crate::cli::{ActuatorArgs, ResonanceArgs};
use crate::failure::Failure;
use formats::resonance::minutes;
use mission::number::{Number, nearest};
use mission::quantity;
use mission::rounding;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use planner::healpix::Nside;
use planner::resonance::check::NSIDE;
use planner::resonance::{Actuator, MAX_ORDER, Motion, Tolerance, Window};

/// Rows of a scan, at most.
const MOST_ROWS: u32 = 1_000_000;
/// Candidates for a recommendation, at most.
const MOST_CANDIDATES: usize = 5000;
/// Steps of a range that names none.
const PRECESSION_STEPS: i64 = 50;
const SPIN_STEPS: i64 = 10;

pub(super) fn window(arguments: &ResonanceArgs) -> Result<Window, Failure> {
    if let Some(text) = &arguments.fwhm {
        return Window::beam(angle_rad("--fwhm", text)?)
            .map_err(|error| Failure::Input(format!("--fwhm {text}: {error}")));
    }
    let nside = arguments.nside.unwrap_or(NSIDE);
    let wrong = |error: String| Failure::Input(format!("--nside {nside}: {error}"));
    let nside = Nside::new(nside).map_err(|error| wrong(error.to_string()))?;
    Window::pixel(nside).map_err(|error| wrong(error.to_string()))
}

/// What judges are named by.
pub(super) fn scale(arguments: &ResonanceArgs) -> String {
    match &arguments.fwhm {
        Some(text) => format!("a beam of {text}"),
        None => format!("N_side {}", arguments.nside.unwrap_or(NSIDE)),
    }
}

/// The allowed excess as a fraction.
pub(super) fn allowed(text: &str) -> Result<f64, Failure> {
    let number = text.strip_suffix('%').unwrap_or(text);
    let wrong = |what: String| Failure::Input(format!("--allow {text}: {what}"));
    let percent = Number::parse(number).map_err(|error| wrong(error.to_string()))?.to_f64();
    if (0.0..=1000.0).contains(&percent) {
        Ok(percent / 100.0)
    } else {
        Err(wrong("a percentage from 0 to 1000 is needed".to_owned()))
    }
}

/// Orders of cross-link means.
pub(super) fn orders(orders: &[u32]) -> Result<(), Failure> {
    match orders.iter().find(|order| !(1..=MAX_ORDER).contains(*order)) {
        None => Ok(()),
        Some(order) => Err(Failure::Input(format!(
            "--crosslink {order}: orders from 1 to {MAX_ORDER} are needed"
        ))),
    }
}

/// `PRECESSION,SPIN` with their units.
pub(super) fn tolerance(text: &str) -> Result<Tolerance, Failure> {
    let wrong = |what: String| Failure::Input(format!("--tolerance {text}: {what}"));
    let (precession, spin) = text.split_once(',').ok_or_else(|| {
        wrong("those of precession and spin with a comma between are needed: 0.6s,0.06s".to_owned())
    })?;
    let seconds = |text: &str| -> Result<f64, Failure> {
        let exact = quantity::seconds(text).map_err(|error| wrong(error.to_string()))?;
        if exact.is_negative() {
            return Err(wrong(format!("{text} is negative: a tolerance from 0 s is needed")));
        }
        Ok(nearest(&exact))
    };
    Ok(Tolerance { precession_s: seconds(precession)?, spin_s: seconds(spin)? })
}

/// Periods in minutes, ends included, and no more than there is room for.
#[derive(Debug, Clone)]
pub(super) struct Periods {
    low: BigRational,
    step: BigRational,
    count: u32,
}

impl Periods {
    /// `LO:HI:STEP`.
    pub(super) fn scan(text: &str) -> Result<Self, Failure> {
        Self::parse("--scan", text, None)
    }

    /// `LO:HI` or `LO:HI:STEP` of candidates.
    fn candidates(option: &str, text: &str, steps: i64) -> Result<Self, Failure> {
        Self::parse(option, text, Some(steps))
    }

    fn parse(option: &str, text: &str, steps: Option<i64>) -> Result<Self, Failure> {
        let wrong = |what: &str| Failure::Input(format!("{option} {text}: {what}"));
        let parts: Vec<&str> = text.split(':').collect();
        let (low, high, step) = match (parts.as_slice(), steps) {
            ([low, high, step], _) => (low, high, Some(step)),
            ([low, high], Some(_)) => (low, high, None),
            _ => return Err(wrong("LO:HI:STEP in minutes is needed, such as 192:193:0.0025")),
        };
        let exact = |part: &str| {
            let number = Number::parse(part).map_err(|error| wrong(&error.to_string()))?;
            Ok::<_, Failure>(number.exact().clone())
        };
        let (low, high) = (exact(low)?, exact(high)?);
        if !low.is_positive() {
            return Err(wrong("a start above 0 min is needed"));
        }
        if high <= low {
            return Err(wrong("the range has no width: an end above the start is needed"));
        }
        let step = match step {
            Some(step) => exact(step)?,
            None => (&high - &low) / BigRational::from_integer(steps.unwrap_or(1).into()),
        };
        if !step.is_positive() {
            return Err(wrong("a step above 0 min is needed"));
        }
        let count = ((&high - &low) / &step).floor().to_integer().to_u32();
        let count = count.filter(|count| *count < MOST_ROWS).ok_or_else(|| {
            wrong(&format!("at most {MOST_ROWS} steps are taken: a larger step is needed"))
        })?;
        Ok(Self { low, step, count: count + 1 })
    }

    /// In minutes, each rounded once.
    pub(super) fn minutes(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.count).map(|i| nearest(&self.at(i)))
    }

    /// In seconds.
    fn seconds(&self) -> Vec<f64> {
        let sixty = BigRational::from_integer(60.into());
        (0..self.count).map(|i| nearest(&(self.at(i) * &sixty))).collect()
    }

    fn at(&self, i: u32) -> BigRational {
        &self.low + &self.step * BigRational::from_integer(i.into())
    }

    /// Ends in seconds.
    fn ends_s(&self) -> [f64; 2] {
        let sixty = BigRational::from_integer(60.into());
        [0, self.count - 1].map(|i| nearest(&(self.at(i) * &sixty)))
    }
}

/// Pairs of periods in seconds to recommend from; none where no range is named.
pub(super) fn candidates(
    arguments: &ResonanceArgs,
    motion: &Motion,
    actuators: Option<&Actuators>,
) -> Result<Option<Vec<[f64; 2]>>, Failure> {
    if arguments.precession_range.is_none() && arguments.spin_range.is_none() {
        return Ok(None);
    }
    let of = |option: &str,
              text: &Option<String>,
              steps: i64,
              own: f64,
              wheel: Option<&Actuator>| {
        let Some(text) = text else { return Ok(vec![own.abs()]) };
        let range = Periods::candidates(option, text, steps)?;
        match wheel.filter(|it| it.step_rad_s > 0.0) {
            None => Ok(range.seconds()),
            Some(wheel) => {
                let periods = wheel.periods_s(range.ends_s());
                if periods.is_empty() {
                    return Err(Failure::Input(format!(
                        "{option} {text}: no period in it can be set in steps of {} rad/s: a wider \
                         range is needed",
                        wheel.step_rad_s
                    )));
                }
                Ok(periods)
            }
        }
    };
    let precession = of(
        "--precession-range",
        &arguments.precession_range,
        PRECESSION_STEPS,
        motion.precession_period_s,
        actuators.map(|it| &it.precession),
    )?;
    let spin = of(
        "--spin-range",
        &arguments.spin_range,
        SPIN_STEPS,
        motion.spin_period_s,
        actuators.map(|it| &it.spin),
    )?;
    let count = precession.len().saturating_mul(spin.len());
    if count > MOST_CANDIDATES {
        return Err(Failure::Input(format!(
            "--precession-range and --spin-range make {count} pairs; at most {MOST_CANDIDATES} are \
             compared: larger steps are needed"
        )));
    }
    let (Some(&shortest), Some(&longest)) = (precession.first(), spin.last()) else {
        return Err(Failure::internal("a range without periods"));
    };
    if longest >= shortest {
        return Err(Failure::Input(format!(
            "--precession-range and --spin-range: the spin period {} min must be shorter than the \
             precession period {} min",
            minutes(longest),
            minutes(shortest)
        )));
    }
    Ok(Some(spin.iter().flat_map(|&b| precession.iter().map(move |&a| [a, b])).collect()))
}

/// What holds the rates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Actuators {
    pub(super) precession: Actuator,
    pub(super) spin: Actuator,
    /// Time between corrections.
    pub(super) correct_every_s: f64,
}

impl Actuators {
    /// Where any option names one.
    pub(super) fn read(arguments: &ActuatorArgs) -> Result<Option<Self>, Failure> {
        let it = arguments;
        let precession =
            [&it.precession_rate_error, &it.precession_rate_step, &it.precession_rate_drift];
        let spin = [&it.spin_rate_error, &it.spin_rate_step, &it.spin_rate_drift];
        let correct_every = &it.correct_every;
        if precession.iter().chain(&spin).all(|it| it.is_none()) {
            return match correct_every {
                None => Ok(None),
                Some(text) => Err(Failure::Input(format!(
                    "--correct-every {text}: an error, step or drift of a rate is needed with it"
                ))),
            };
        }
        let correct_every_s = match correct_every {
            None => 0.0,
            Some(text) => {
                let wrong =
                    |what: String| Failure::Input(format!("--correct-every {text}: {what}"));
                let exact = quantity::seconds(text).map_err(|error| wrong(error.to_string()))?;
                if exact.is_negative() {
                    return Err(wrong("a time from 0 s is needed".to_owned()));
                }
                nearest(&exact)
            }
        };
        let axis = |name: &str, [error, step, drift]: [&Option<String>; 3]| {
            Ok::<_, Failure>(Actuator {
                error_rad_s: rate(&format!("--{name}-rate-error"), error.as_ref(), 1)?,
                step_rad_s: rate(&format!("--{name}-rate-step"), step.as_ref(), 1)?,
                drift_rad_s2: rate(&format!("--{name}-rate-drift"), drift.as_ref(), 2)?,
            })
        };
        Ok(Some(Self {
            precession: axis("precession", precession)?,
            spin: axis("spin", spin)?,
            correct_every_s,
        }))
    }
}

/// An angle per time, or per time and time, in radians and seconds; 0 where not named.
fn rate(option: &str, text: Option<&String>, times: usize) -> Result<f64, Failure> {
    let Some(text) = text else { return Ok(0.0) };
    let example = if times == 1 { "0.001arcsec/s" } else { "0.001arcsec/s/d" };
    let wrong = |what: &str| Failure::Input(format!("{option} {text}: {what}"));
    let mut parts = text.split('/');
    let angle =
        quantity::degrees(parts.next().unwrap_or("")).map_err(|error| wrong(&error.to_string()))?;
    let units: Vec<&str> = parts.collect();
    if units.len() != times {
        return Err(wrong(&format!("an angle per time is needed, such as {example}")));
    }
    let mut per = rounding::radians(&angle);
    for unit in units {
        let unit = quantity::seconds(&format!("1{unit}"))
            .map_err(|_| wrong(&format!("a unit of time is needed after /, such as {example}")))?;
        per /= nearest(&unit);
    }
    if angle.is_negative() || (!angle.is_zero() && !per.is_finite()) {
        return Err(wrong("a rate from 0 is needed"));
    }
    Ok(per)
}
