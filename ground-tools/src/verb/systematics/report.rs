//! What is told of the effects: a table, or JSON.

use super::options::{Named, Setting};
use super::outcome::Outcome;
use crate::failure::Failure;
use planner::healpix::Nside;
use planner::provenance::Provenance;
use planner::systematics::Residual;
use serde_json::{Value, json};
use std::fmt::Write;

/// What is told.
pub(super) struct Report<'r> {
    pub effects: Vec<(&'r Named, &'r Outcome)>,
    /// delta r of all effects together, where there are several.
    pub together: Option<f64>,
    pub first_seed: u64,
    pub files: &'r [String],
}

impl Report<'_> {
    pub(super) fn json(&self, provenance: &Provenance) -> Result<Value, Failure> {
        let each = |(named, outcome): &(&Named, &Outcome)| {
            let found = &outcome.found;
            json!({
                "effect": named.text,
                "sky": outcome.sky,
                "delta_r": found.bias.delta_r,
                "sigma_r": found.bias.sigma_r,
                "parts": outcome.parts.map(|[t, p]| json!({ "temperature": t, "polarisation": p })),
                "closed_form_delta_r": outcome.closed_form,
                "realisations": scatter(&outcome.skies).map(|[mean, deviation]| json!({
                    "first_seed": self.first_seed,
                    "mean": mean,
                    "standard_deviation": deviation,
                    "delta_r": outcome.skies,
                })),
                "rms_uk": found.residual.as_ref().map(Residual::rms_polarisation),
                "unobserved_pixels": found.unobserved,
                "singular_pixels": found.singular,
                "timestream": outcome.timestream.as_ref().map(|it| json!({
                    "bb_relative": it.bb,
                    "p_uk": it.p_uk,
                })),
            })
        };
        Ok(json!({
            "effects": self.effects.iter().map(each).collect::<Vec<Value>>(),
            "together_delta_r": self.together,
            "files": self.files,
            "provenance": serde_json::to_value(provenance).map_err(Failure::internal)?,
        }))
    }

    pub(super) fn text(&self, setting: &Setting, nside: Nside) -> String {
        let mut text = format!("{}\n\n", setting.told(nside));
        let width = self.effects.iter().map(|it| it.0.text.len()).fold(12, usize::max);
        let _ = writeln!(
            text,
            "{:<width$}  {:<9}  {:>10}  {:>10}  {:>10}",
            "effect", "sky", "delta r", "BB_2, uK2", "BB_80, uK2"
        );
        for (named, outcome) in &self.effects {
            let found = &outcome.found;
            let power = |l: usize| found.bb.get(l).map_or("-".to_owned(), |x| format!("{x:.3e}"));
            let _ = writeln!(
                text,
                "{:<width$}  {:<9}  {:>10.3e}  {:>10}  {:>10}",
                named.text,
                outcome.sky,
                found.bias.delta_r,
                power(2),
                power(80)
            );
            besides(&mut text, outcome, self.first_seed);
        }
        if let Some(together) = self.together {
            let _ = writeln!(text, "{:<width$}  {:<9}  {together:>10.3e}", "all together", "-");
        }
        if !self.files.is_empty() {
            let _ = writeln!(text, "\nwritten: {}", self.files.join(", "));
        }
        text
    }
}

/// Lines below an effect's numbers.
fn besides(text: &mut String, outcome: &Outcome, first_seed: u64) {
    if let Some([t, p]) = outcome.parts {
        let _ = writeln!(text, "  on T alone {t:.3e}, on E and B alone {p:.3e}");
    }
    if let Some(closed) = outcome.closed_form {
        let _ = writeln!(text, "  in closed form, without resonances {closed:.3e}");
    }
    if let Some([mean, deviation]) = scatter(&outcome.skies) {
        let _ = writeln!(
            text,
            "  {} skies from seed {first_seed}: {mean:.3e}, standard deviation {deviation:.1e}",
            outcome.skies.len()
        );
    }
    if let Some(compared) = &outcome.timestream {
        let _ = writeln!(
            text,
            "  sample by sample: BB within {:.1e} of it, P within {:.1e} uK",
            compared.bb, compared.p_uk
        );
    }
    let found = &outcome.found;
    if found.unobserved + found.singular > 0 {
        let _ = writeln!(
            text,
            "  left out: {} pixel(s) without samples, {} whose angles do not tell I, Q and U apart",
            found.unobserved, found.singular
        );
    }
}

/// Mean and standard deviation.
fn scatter(values: &[f64]) -> Option<[f64; 2]> {
    let count = f64::from(u32::try_from(values.len()).ok().filter(|&count| count > 1)?);
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Some([mean, (squares / (count - 1.0)).sqrt()])
}
