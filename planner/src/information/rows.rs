//! What is told of a forecast: a row per look, target, window and quantity, and requirements beside them.
//!
//! Method: errors are those with all other parameters free. Rows without a target are of all targets
//! together: their information adds, each target's gain being known against its own brightness. A
//! requirement is held against those, in windows of its own length; it is met where every parameter of
//! its quantity, in every window, has an error and none is larger. A row that misses it is held against
//! all passes of its window ([`Why`]).

use super::errors::Errors;
use super::forecast::{Forecast, Lesson};
use super::parameter::Parameter;
use super::profile::decibel;
use super::sight::Look;
use super::window::Windows;
use mission::number::Number;
use mission::requirement::{Quantity, Requirement};
use onboard_core::time::{Duration, Instant};
use std::f64::consts::PI;

/// What a row tells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// A parameter's error.
    Parameter(Parameter),
    /// Radius up to which the response is known to a level, in dB, in rad.
    Known(f64),
    /// Radius up to which the beam exceeds its error, in rad.
    Seen,
    /// The response's error out to a radius in rad.
    Level(f64),
}

/// A row of a forecast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Who looks, by index.
    pub look: usize,
    /// The target by index; `None` for all together.
    pub target: Option<usize>,
    /// What is told.
    pub measure: Measure,
    /// Its value; `None` where it is not measured.
    pub value: Option<f64>,
    /// The window.
    pub window: (Instant, Instant),
    /// What is required, by index.
    pub requirement: Option<usize>,
    /// The largest error allowed.
    pub limit: Option<f64>,
    /// Why it is not reached; `None` where it is, or where nothing is required.
    pub why: Option<Why>,
}

/// Why an error is larger than allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Why {
    /// Nothing that passes in the window shows the quantity, or passes alike do not tell it from others.
    Geometry,
    /// All passes of the window together are not enough: noise is too large beside the signal.
    Noise,
    /// All passes would be enough; the plan's sessions hold too few of them.
    Budget,
}

impl Why {
    /// All, in the order of [`Verdict::missed`].
    pub const EACH: [Self; 3] = [Self::Geometry, Self::Noise, Self::Budget];

    /// Its word in outputs.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Geometry => "geometry",
            Self::Noise => "noise",
            Self::Budget => "budget",
        }
    }
}

impl Row {
    /// The row with the reason, from the value that all passes of its window give.
    pub(super) fn explained(self, all: Option<f64>) -> Self {
        let why = match (self.met(), all) {
            (None | Some(true), _) => None,
            (Some(false), None) => Some(Why::Geometry),
            (Some(false), Some(all)) if Some(all) <= self.limit => Some(Why::Budget),
            (Some(false), Some(_)) => Some(Why::Noise),
        };
        Self { why, ..self }
    }

    /// Whether the requirement is met; `None` where there is none.
    #[must_use]
    pub fn met(&self) -> Option<bool> {
        self.limit.map(|limit| self.value.is_some_and(|it| it <= limit))
    }

    /// The quantity's name in outputs.
    #[must_use]
    pub fn quantity(&self) -> String {
        match self.measure {
            Measure::Parameter(parameter) => parameter.name().to_owned(),
            Measure::Known(level) => format!("beam_known_to_{}_db", level.round()),
            Measure::Seen => "beam_seen".to_owned(),
            Measure::Level(_) => Quantity::BeamLevel.key().to_owned(),
        }
    }

    /// The unit of values in outputs, and the value in it.
    #[must_use]
    pub fn told(&self, value: f64) -> (&'static str, f64) {
        const ARCSEC: f64 = PI / 648_000.0;
        match self.measure {
            Measure::Parameter(parameter) => match parameter.quantity() {
                Quantity::Offset => ("arcsec", value / ARCSEC),
                Quantity::TimeConstant => ("ms", 1e3 * value),
                Quantity::PolarisationAngle => ("deg", value.to_degrees()),
                _ => ("%", 1e2 * value),
            },
            Measure::Known(_) | Measure::Seen => ("arcmin", value / (60.0 * ARCSEC)),
            Measure::Level(_) => ("dB", decibel(value)),
        }
    }
}

/// Lengths of windows: those of the plain rows, then one for each requirement.
#[must_use]
pub fn windows_of(plain: Option<Duration>, requirements: &[Requirement]) -> Vec<Option<Duration>> {
    let of = |it: &Requirement| {
        it.every_days.as_ref().map(|days| Duration::from_seconds(86_400.0 * days.to_f64()))
    };
    std::iter::once(plain).chain(requirements.iter().map(of)).collect()
}

/// Levels in dB to which the radius is told.
const LEVELS_DB: [f64; 2] = [-20.0, -30.0];

/// The rows of the first kind of windows, then those of requirements, the nth of which has the windows of
/// kind n + 1.
#[must_use]
pub fn rows(
    forecast: &Forecast,
    looks: &[Look],
    windows: &Windows,
    targets: usize,
    requirements: &[Requirement],
) -> Vec<Row> {
    let mut rows = Vec::new();
    for (look, of) in looks.iter().enumerate() {
        for window in windows.of_kind(0) {
            let span = windows.span(window);
            for target in 0..targets {
                let lesson = forecast.lesson(look, target, window);
                if lesson.passes > 0 {
                    plain(&mut rows, (look, Some(target)), of, lesson, span);
                }
            }
            plain(&mut rows, (look, None), of, &forecast.together(look, window), span);
        }
        for (index, it) in requirements.iter().enumerate() {
            let detector = Some(of.line.detector_name.as_str());
            if !it.concerns(&of.line.telescope_name, of.channel.as_deref(), detector) {
                continue;
            }
            for window in windows.of_kind(index + 1) {
                let span = windows.span(window);
                let lesson = forecast.together(look, window);
                required(&mut rows, (look, index), (of, it), &lesson, span);
            }
        }
    }
    rows
}

fn plain(
    rows: &mut Vec<Row>,
    (look, target): (usize, Option<usize>),
    of: &Look,
    lesson: &Lesson,
    window: (Instant, Instant),
) {
    let errors = Errors::of(&lesson.fisher);
    let fwhm_rad = of.receiver.fwhm_rad().unwrap_or_default();
    let row = |measure, value| Row {
        look,
        target,
        measure,
        value,
        window,
        requirement: None,
        limit: None,
        why: None,
    };
    for parameter in Parameter::EACH {
        rows.push(row(Measure::Parameter(parameter), errors.of_parameter(parameter)));
    }
    for level in LEVELS_DB {
        let known = lesson.profile.known_fwhm(10_f64.powf(level / 10.0));
        rows.push(row(Measure::Known(level), known.map(|it| it * fwhm_rad)));
    }
    let seen = lesson.profile.seen_fwhm();
    rows.push(row(Measure::Seen, (seen > 0.0).then_some(seen * fwhm_rad)));
}

fn required(
    rows: &mut Vec<Row>,
    (look, index): (usize, usize),
    (of, it): (&Look, &Requirement),
    lesson: &Lesson,
    window: (Instant, Instant),
) {
    let row = |measure, value| Row {
        look,
        target: None,
        measure,
        value,
        window,
        requirement: Some(index),
        limit: Some(it.sigma()),
        why: None,
    };
    if it.quantity == Quantity::BeamLevel {
        let radius_arcmin = it.radius_arcmin.as_ref().map_or(0.0, Number::to_f64);
        let radius_rad = (radius_arcmin / 60.0).to_radians();
        let worst = lesson.profile.worst_to(radius_rad / of.receiver.fwhm_rad().unwrap_or(1.0));
        rows.push(row(Measure::Level(radius_rad), worst.is_finite().then_some(worst)));
        return;
    }
    let errors = Errors::of(&lesson.fisher);
    for parameter in Parameter::EACH.into_iter().filter(|of| of.quantity() == it.quantity) {
        rows.push(row(Measure::Parameter(parameter), errors.of_parameter(parameter)));
    }
}

/// Whether a requirement is met, and where least.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// Rows that meet it.
    pub met: usize,
    /// All rows that it speaks of.
    pub of: usize,
    /// Rows that miss it, by reason, in the order of [`Why::EACH`].
    pub missed: [usize; 3],
    /// The row that misses it most, or meets it least.
    pub worst: Row,
}

/// What rows say of each requirement; `None` where no row speaks of it.
#[must_use]
pub fn verdicts(rows: &[Row], requirements: usize) -> Vec<Option<Verdict>> {
    let mut found: Vec<Option<Verdict>> = vec![None; requirements];
    let over = |row: &Row| row.value.unwrap_or(f64::INFINITY) / row.limit.unwrap_or(1.0);
    for row in rows {
        let Some(place) = row.requirement.and_then(|index| found.get_mut(index)) else { continue };
        let verdict = place.get_or_insert(Verdict { met: 0, of: 0, missed: [0; 3], worst: *row });
        verdict.met += usize::from(row.met() == Some(true));
        verdict.of += 1;
        for (missed, why) in verdict.missed.iter_mut().zip(Why::EACH) {
            *missed += usize::from(row.why == Some(why));
        }
        if over(row) > over(&verdict.worst) {
            verdict.worst = *row;
        }
    }
    found
}
