//! Whether requirements are met, in words and as JSON.

use super::lines::shown;
use super::told::Told;
use ephem::time::format_utc;
use mission::number::Number;
use mission::requirement::Requirement;
use planner::information::{Teaching, Verdict, Why};
use planner::world::World;
use serde_json::{Value, json};

/// A requirement with its verdict.
#[derive(Debug, Clone)]
pub struct Required<'m> {
    /// What is required.
    pub requirement: &'m Requirement,
    /// The verdict; `None` where no detector or channel that was asked for is meant.
    pub verdict: Option<Verdict>,
    /// The row that misses it most, or meets it least, under its names.
    pub worst: Option<Told>,
}

/// The requirements of a mission with what passes, or a plan's sessions, say of them.
#[must_use]
pub fn required<'m>(world: &'m World, teaching: &Teaching) -> Vec<Required<'m>> {
    let all = &world.mission.calibration.requirements;
    all.iter()
        .zip(teaching.verdicts())
        .map(|(requirement, verdict)| {
            let worst = verdict.map(|it| Told::new(world, &teaching.looks, &it.worst));
            Required { requirement, verdict, worst }
        })
        .collect()
}

impl Required<'_> {
    /// What is required: `gain 0.2 % every 30 d of HFT`.
    #[must_use]
    pub fn name(&self) -> String {
        let it = self.requirement;
        let every = it.every_days.as_ref().map(|days| format!(" every {days} d"));
        let radius = it.radius_arcmin.as_ref().map(|radius| format!(" out to {radius} arcmin"));
        format!(
            "{} {}{}{} of {}",
            it.quantity.key(),
            it.sigma_text,
            radius.unwrap_or_default(),
            every.unwrap_or_default(),
            it.telescope
        )
    }

    /// Whether it is missed; one that speaks of nobody is not.
    #[must_use]
    pub fn is_missed(&self) -> bool {
        self.verdict.is_some_and(|it| it.met < it.of)
    }

    /// Whether it is met: `met in all 36 cases`, `MISSED in 3 of 36 cases`, by how much and why.
    #[must_use]
    pub fn sentence(&self) -> String {
        let (Some(verdict), Some(worst)) = (self.verdict, &self.worst) else {
            return "speaks of no detector or channel that is judged".to_owned();
        };
        let value = match worst.sigma {
            Some(sigma) => format!("{} {}", shown(Some(sigma)), worst.unit),
            None => "not measured".to_owned(),
        };
        let from = &format_utc(worst.window.0)[..10];
        let until = &format_utc(worst.window.1)[..10];
        let place = format!(
            "{}/{} ({} {value}, {from} to {until})",
            worst.telescope, worst.detector, worst.quantity
        );
        let missed = verdict.of - verdict.met;
        if missed == 0 {
            let cases =
                if verdict.of == 1 { "its case" } else { &format!("all {} cases", verdict.of) };
            return format!("met in {cases}, least by {place}");
        }
        let reasons: Vec<String> = Why::EACH
            .iter()
            .zip(verdict.missed)
            .filter(|(_, count)| *count > 0)
            .map(|(why, count)| format!("{} {count}", why.word()))
            .collect();
        format!(
            "MISSED in {missed} of {} cases ({}), most by {place}",
            verdict.of,
            reasons.join(", ")
        )
    }

    /// As `--json` has it.
    #[must_use]
    pub fn json(&self) -> Value {
        let it = self.requirement;
        let missed = |why: usize| self.verdict.map(|it| it.missed[why]);
        json!({
            "quantity": it.quantity.key(),
            "sigma": it.sigma_text,
            "radius_arcmin": it.radius_arcmin.as_ref().map(Number::to_f64),
            "telescope": it.telescope,
            "every_days": it.every_days.as_ref().map(Number::to_f64),
            "met": self.verdict.map(|it| it.met == it.of),
            "rows": self.verdict.map(|it| it.of),
            "rows_met": self.verdict.map(|it| it.met),
            "missed_by_geometry": missed(0),
            "missed_by_noise": missed(1),
            "missed_by_budget": missed(2),
            "worst": self.worst.as_ref().map(Told::json),
        })
    }
}
