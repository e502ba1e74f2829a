//! Rows of errors, and what cannot be told apart.
//!
//! Units are those of the row: %, arcsec, ms, deg, arcmin, dB. A row without a value is of something that is
//! not measured; `requirement` is in the row's unit too.

use crate::rows::Column;
use crate::rows::Field::{MaybeTruth, Number, Utc, Word};
use ephem::time::format_utc;
use onboard_core::time::Instant;
use planner::information::{ANNULI, Errors, Lesson, Look, Row, decibel, inner_radius_fwhm};
use planner::world::World;
use serde_json::{Value, json};

/// The name of all targets together.
pub const ALL: &str = "all";

/// A row with the names that it stands under.
#[derive(Debug, Clone, PartialEq)]
pub struct Told {
    /// The telescope.
    pub telescope: String,
    /// The detector, or the channel on the telescope's axis.
    pub detector: String,
    /// The target, or [`ALL`].
    pub target: String,
    /// What is told.
    pub quantity: String,
    /// Its error in `unit`; of radii the radius.
    pub sigma: Option<f64>,
    /// The unit.
    pub unit: &'static str,
    /// The window's start and end.
    pub window: (Instant, Instant),
    /// The largest error allowed, in `unit`.
    pub requirement: Option<f64>,
    /// Whether it is met.
    pub met: Option<bool>,
    /// Why it is not: `geometry`, `noise` or `budget`.
    pub why: Option<&'static str>,
}

impl Told {
    /// A row under its names.
    #[must_use]
    pub fn new(world: &World, looks: &[Look], row: &Row) -> Self {
        let look = &looks[row.look];
        let target = row.target.map_or(ALL, |target| world.targets[target].name());
        Self {
            telescope: look.line.telescope_name.clone(),
            detector: look.name().to_owned(),
            target: target.to_owned(),
            quantity: row.quantity(),
            sigma: row.value.map(|value| row.told(value).1),
            unit: row.told(1.0).0,
            window: row.window,
            requirement: row.limit.map(|limit| row.told(limit).1),
            met: row.met(),
            why: row.why.map(planner::information::Why::word),
        }
    }

    /// As `forecast --json` has it.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "telescope": self.telescope,
            "detector": self.detector,
            "target": self.target,
            "quantity": self.quantity,
            "sigma": self.sigma,
            "unit": self.unit,
            "from_utc": format_utc(self.window.0),
            "until_utc": format_utc(self.window.1),
            "requirement": self.requirement,
            "met": self.met,
            "why": self.why,
        })
    }
}

/// The columns of rows.
#[must_use]
pub fn columns() -> [Column<Told>; 11] {
    [
        Column::new("telescope", Word(|it| Some((&it.telescope).into()))),
        Column::new("detector", Word(|it| Some((&it.detector).into()))),
        Column::new("target", Word(|it| Some((&it.target).into()))),
        Column::new("quantity", Word(|it| Some((&it.quantity).into()))),
        Column::new("sigma", Number(|it| it.sigma)),
        Column::new("unit", Word(|it| Some(it.unit.into()))),
        Column::new("from_utc", Utc(|it| it.window.0)),
        Column::new("until_utc", Utc(|it| it.window.1)),
        Column::new("requirement", Number(|it| it.requirement)),
        Column::new("met", MaybeTruth(|it| it.met)),
        Column::new("why", Word(|it| it.why.map(Into::into))),
    ]
}

/// What all targets together do not tell apart, as `forecast --json` has it.
#[must_use]
pub fn degeneracies(look: &Look, errors: &Errors) -> Vec<Value> {
    let one = |it: &planner::information::Degeneracy| {
        json!({
            "telescope": look.line.telescope_name,
            "detector": look.name(),
            "one": it.one.name(),
            "other": it.other.name(),
            "correlation": it.correlation,
            "broken_by": it.broken_by(),
        })
    };
    errors.degeneracies.iter().map(one).collect()
}

/// How well the response of a beam is known by all targets over the mission: the outer radii of annuli in
/// arcmin, and the level in dB of its error in a cell of each, null where nothing passed.
#[must_use]
pub fn profile(look: &Look, lesson: &Lesson) -> Value {
    let fwhm_arcmin =
        look.receiver.fwhm_arcmin.as_ref().map_or(0.0, mission::number::Number::to_f64);
    let level = |annulus: usize| Some(decibel(lesson.profile.error(annulus)));
    json!({
        "telescope": look.line.telescope_name,
        "detector": look.name(),
        "radius_arcmin":
            (0..ANNULI).map(|it| inner_radius_fwhm(it + 1) * fwhm_arcmin).collect::<Vec<_>>(),
        "level_db":
            (0..ANNULI).map(|it| level(it).filter(|it| it.is_finite())).collect::<Vec<_>>(),
    })
}
