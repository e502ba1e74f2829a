//! What `verify` says: counts, residuals, fit, verdict.
//!
//! A period counts as within tolerance when the mission's half-width holds the fitted value with
//! three standard errors on both sides, as outside when it holds none of that, else it is undecided.

use crate::failure::Failure;
use ephem::time::format_tdb;
use formats::degrees;
use formats::history::{ARCSECONDS_PER_RADIAN, History, Residual};
use formats::resonance;
use mission::number::Number;
use onboard_core::phase::Rotor;
use onboard_core::scan::ScanParameters;
use planner::history_fit::{Ambiguous, Estimate, Fit, Observable, Turning};
use planner::provenance::Provenance;
use planner::resonance::Tolerance;
use planner::resonance::check::{Checked, ResonanceCheck};
use planner::world::World;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::fmt::Write;

/// A gap is longer than this many median steps.
const GAP_STEPS: i64 = 5;
/// Standard errors on either side of a fitted period.
const SURE: f64 = 3.0;
/// Outliers and gaps that the text shows.
const SHOWN: usize = 8;

/// Everything that is reported.
pub(super) struct Report<'r> {
    world: &'r World,
    history: &'r History,
    rows: &'r [Residual],
    fit: Result<Fit, (&'static str, Ambiguous)>,
    limit_arcsec: f64,
    against_fit: bool,
    median_step_ns: i64,
    /// Indices of the rows before gaps.
    gaps: Vec<usize>,
    within: Option<bool>,
    /// Of the fitted periods within three standard errors.
    resonance: Option<Checked>,
    /// Why the check fails; empty where it passes.
    pub(super) failed: Vec<String>,
}

/// Root mean square and largest value per axis, and of the whole.
struct Spread {
    rms: [f64; 4],
    max: [f64; 4],
}

impl Spread {
    fn of(rows: impl Iterator<Item = [f64; 4]>) -> Self {
        let (mut sum, mut max, mut count) = ([0.0; 4], [0.0_f64; 4], 0.0);
        for row in rows {
            for ((sum, max), value) in sum.iter_mut().zip(&mut max).zip(row) {
                *sum += value * value;
                *max = max.max(value.abs());
            }
            count += 1.0;
        }
        Self { rms: sum.map(|it: f64| (it / f64::max(count, 1.0)).sqrt()), max }
    }

    fn json(&self) -> Value {
        let named = |[x, y, z, total]: [f64; 4]| json!({"x": x, "y": y, "z": z, "total": total});
        json!({"rms": named(self.rms), "max": named(self.max)})
    }
}

/// A fitted period beside the mission's, s.
struct Period {
    seconds: f64,
    sigma: f64,
    offset: f64,
}

impl Period {
    fn new(rotor: Rotor, turning: &Turning) -> Self {
        let model = rotor.rate.radians_per_second();
        let rate = model + turning.rate.offset;
        // T = 2 pi / |rate|; the difference without cancellation.
        let seconds = TAU / rate.abs();
        let offset = -TAU / model.abs() * turning.rate.offset / rate;
        Self { seconds, sigma: seconds * (turning.rate.sigma / rate).abs(), offset }
    }

    fn within(&self, tolerance: &Number) -> Option<bool> {
        let (tolerance, reach) = (tolerance.to_f64(), SURE * self.sigma);
        if self.offset.abs() + reach <= tolerance {
            Some(true)
        } else if self.offset.abs() - reach > tolerance {
            Some(false)
        } else {
            None
        }
    }
}

fn pull(estimate: &Estimate) -> f64 {
    estimate.offset / estimate.sigma
}

impl<'r> Report<'r> {
    pub(super) fn new(
        world: &'r World,
        history: &'r History,
        rows: &'r [Residual],
        (fit, limit_arcsec, against_fit): (Result<Fit, (&'static str, Ambiguous)>, f64, bool),
    ) -> Self {
        let steps: Vec<i64> =
            history.rows.windows(2).map(|pair| pair[1].at.since(pair[0].at).ns()).collect();
        let mut sorted = steps.clone();
        sorted.sort_unstable();
        let median_step_ns = sorted.get(sorted.len() / 2).copied().unwrap_or(0);
        let longest = median_step_ns.saturating_mul(GAP_STEPS);
        let gaps = (0..steps.len()).filter(|index| steps[*index] > longest).collect();
        let mut report = Self {
            world,
            history,
            rows,
            fit,
            limit_arcsec,
            against_fit,
            median_step_ns,
            gaps,
            within: None,
            resonance: None,
            failed: Vec::new(),
        };
        report.judge();
        report
    }

    /// Whether the fitted periods beat on the sky, three standard errors either way.
    pub(super) fn judge_resonance(&mut self) {
        let Ok(Fit { precession: Some(precession), spin, .. }) = &self.fit else { return };
        let parameters = self.world.scan.parameters();
        let Ok(mut check) = ResonanceCheck::of_mission(self.world) else { return };
        let fitted = Period::new(parameters.precession, precession);
        let spin = Period::new(parameters.spin, spin);
        check.motion.precession_period_s =
            fitted.seconds.copysign(check.motion.precession_period_s);
        check.motion.spin_period_s = spin.seconds.copysign(check.motion.spin_period_s);
        check.demand.tolerance =
            Tolerance { precession_s: SURE * fitted.sigma, spin_s: SURE * spin.sigma };
        // What cannot be judged is null.
        self.resonance = check.certify().ok();
    }

    fn judge(&mut self) {
        let tolerance = &self.world.mission.tolerance;
        let parameters = *self.world.scan.parameters();
        match &self.fit {
            Err((what, ambiguous)) => self.failed.push(format!(
                "rows {} s apart fit {what} rates that differ by a whole turn from row to row: the \
                 periods are ambiguous; rows closer together, or a smaller --search, are needed",
                ambiguous.lag_s
            )),
            Ok(fit) => {
                if let Some(precession) = &fit.precession {
                    let periods = [
                        (
                            "precession",
                            Period::new(parameters.precession, precession),
                            &tolerance.precession_period_s,
                        ),
                        ("spin", Period::new(parameters.spin, &fit.spin), &tolerance.spin_period_s),
                    ];
                    let judged = periods.each_ref().map(|(_, it, box_s)| it.within(box_s));
                    self.within = match judged {
                        [Some(true), Some(true)] => Some(true),
                        [Some(false), _] | [_, Some(false)] => Some(false),
                        _ => None,
                    };
                    for (name, it, box_s) in periods {
                        if it.within(box_s) == Some(false) {
                            self.failed.push(format!(
                                "the {name} period is off by {:.6} s +- {:.6} s, beyond the \
                                 tolerance of {} s",
                                it.offset,
                                it.sigma,
                                box_s.text()
                            ));
                        }
                    }
                }
            }
        }
        let judged = |row: &&Residual| !self.against_fit || !row.outlier;
        let size = |row: &Residual| {
            if self.against_fit { row.fit_arcsec.unwrap_or(0.0) } else { row.residual_arcsec }
        };
        let beyond: Vec<&Residual> =
            self.rows.iter().filter(judged).filter(|row| size(row) > self.limit_arcsec).collect();
        let worst = beyond.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
        if let Some(worst) = worst {
            self.failed.push(format!(
                "{} of {} rows are off the {} by more than {} arcsec; the worst is line {} with \
                 {:.6} arcsec",
                beyond.len(),
                self.rows.len(),
                if self.against_fit { "fit" } else { "mission" },
                self.limit_arcsec,
                worst.line,
                size(worst)
            ));
        }
    }

    fn spreads(&self) -> (Spread, Option<Spread>) {
        let all = self.rows.iter().map(|it| {
            [it.residual_x_arcsec, it.residual_y_arcsec, it.residual_z_arcsec, it.residual_arcsec]
        });
        let used = self.rows.iter().filter(|it| !it.outlier);
        let fitted = used.filter_map(|it| {
            Some([it.fit_x_arcsec?, it.fit_y_arcsec?, it.fit_z_arcsec?, it.fit_arcsec?])
        });
        (Spread::of(all), self.fit.is_ok().then(|| Spread::of(fitted)))
    }

    fn outliers(&self) -> impl Iterator<Item = &Residual> {
        self.rows.iter().filter(|row| row.outlier)
    }

    fn verdict(&self) -> &'static str {
        if self.failed.is_empty() { "pass" } else { "fail" }
    }

    pub(super) fn json(&self, provenance: &Provenance) -> Result<Value, Failure> {
        let (residual, fitted) = self.spreads();
        let outliers: Vec<Value> = self
            .outliers()
            .map(|it| {
                json!({
                    "line": it.line,
                    "elapsed_s": it.elapsed_s,
                    "time_tdb": format_tdb(it.at),
                    "residual_arcsec": it.residual_arcsec,
                    "fit_arcsec": it.fit_arcsec,
                })
            })
            .collect();
        let gaps: Vec<Value> = self
            .gaps
            .iter()
            .map(|index| {
                let (before, after) = (&self.rows[*index], &self.rows[index + 1]);
                json!({
                    "from_tdb": format_tdb(before.at),
                    "to_tdb": format_tdb(after.at),
                    "from_line": before.line,
                    "to_line": after.line,
                    "seconds": after.elapsed_s - before.elapsed_s,
                })
            })
            .collect();
        let ambiguous = self.fit.as_ref().err().map(|(what, it)| {
            json!({"what": what, "lag_s": it.lag_s, "other_rate_offset_rad_s": it.other_rate_rad_s})
        });
        Ok(json!({
            "verdict": self.verdict(),
            "failed": self.failed,
            "form": self.history.form,
            "rows": self.rows.len(),
            "used": self.fit.as_ref().ok().map(|_| self.rows.len() - outliers.len()),
            "first_tdb": self.rows.first().map(|row| format_tdb(row.at)),
            "last_tdb": self.rows.last().map(|row| format_tdb(row.at)),
            "median_step_s": seconds(self.median_step_ns),
            "limit_arcsec": self.limit_arcsec,
            "against": if self.against_fit { "fit" } else { "mission" },
            "residual_arcsec": residual.json(),
            "fit_residual_arcsec": fitted.map(|it| it.json()),
            "sigma_arcsec": self.fit.as_ref().ok().map(|it| it.sigma_rad * ARCSECONDS_PER_RADIAN),
            "outliers": outliers,
            "gaps": gaps,
            "ambiguous": ambiguous,
            "fit": self.fit.as_ref().ok().map(|fit| fit_json(self.world.scan.parameters(), fit)),
            "periods_within_tolerance": self.within,
            "resonance": self.resonance.as_ref().map(|it| resonance::json(it, None)),
            "provenance": serde_json::to_value(provenance).map_err(Failure::internal)?,
        }))
    }

    pub(super) fn text(&self, name: &str) -> String {
        let mut text = String::new();
        // Writing to a String cannot fail.
        let _ = self.write(&mut text, name);
        text
    }

    fn write(&self, out: &mut String, name: &str) -> std::fmt::Result {
        let outliers = self.outliers().count();
        writeln!(
            out,
            "{name}: {}, {} rows every {} s, {outliers} outliers, {} gaps",
            self.history.form,
            self.rows.len(),
            seconds(self.median_step_ns),
            self.gaps.len()
        )?;
        let (residual, fitted) = self.spreads();
        writeln!(out, "\n{:<24} {:>12} {:>12} {:>12} {:>12}", "arcsec", "x", "y", "z", "total")?;
        let mut line = |name: &str, [x, y, z, total]: [f64; 4]| {
            writeln!(out, "{name:<24} {x:>12.6} {y:>12.6} {z:>12.6} {total:>12.6}")
        };
        line("off the mission, rms", residual.rms)?;
        line("off the mission, largest", residual.max)?;
        if let Some(fitted) = fitted {
            line("off the fit, rms", fitted.rms)?;
            line("off the fit, largest", fitted.max)?;
        }
        if let Ok(fit) = &self.fit {
            fit_text(out, self.world.scan.parameters(), fit)?;
        }
        for row in self.outliers().take(SHOWN) {
            let fit = row.fit_arcsec.unwrap_or(0.0);
            writeln!(
                out,
                "outlier: line {}, {} TDB, {fit:.3} arcsec",
                row.line,
                format_tdb(row.at)
            )?;
        }
        if outliers > SHOWN {
            writeln!(out, "and {} more outliers", outliers - SHOWN)?;
        }
        for index in self.gaps.iter().take(SHOWN) {
            let (before, after) = (&self.rows[*index], &self.rows[index + 1]);
            let length = after.elapsed_s - before.elapsed_s;
            writeln!(
                out,
                "gap: {length} s after line {}, {} TDB",
                before.line,
                format_tdb(before.at)
            )?;
        }
        if self.gaps.len() > SHOWN {
            writeln!(out, "and {} more gaps", self.gaps.len() - SHOWN)?;
        }
        let within = match self.within {
            Some(true) => "within tolerance",
            Some(false) => "beyond tolerance",
            None => "not decided by this history",
        };
        writeln!(out, "\nperiods: {within}")?;
        if let Some(resonance) = &self.resonance {
            writeln!(out, "resonance of the fitted periods: {}", resonance::sentence(resonance))?;
        }
        writeln!(out, "verdict: {}", self.verdict())
    }
}

fn seconds(ns: i64) -> f64 {
    onboard_core::time::Duration::from_ns(ns).seconds()
}

fn observable(fit: &Fit) -> &'static str {
    match fit.observable {
        Observable::Both => "both",
        Observable::Sum => "sum",
        Observable::Difference => "difference",
    }
}

/// Ratio of the precession to the spin period, and its standard error.
fn ratio(parameters: &ScanParameters, fit: &Fit) -> Option<(f64, f64)> {
    let precession = fit.precession?;
    let wa = parameters.precession.rate.radians_per_second() + precession.rate.offset;
    let wb = parameters.spin.rate.radians_per_second() + fit.spin.rate.offset;
    let (da, db) = (precession.rate.sigma / wa, fit.spin.rate.sigma / wb);
    let together = fit.rate_covariance / (wa * wb);
    let ratio = (wb / wa).abs();
    Some((ratio, ratio * (da * da + db * db - 2.0 * together).max(0.0).sqrt()))
}

fn fit_json(parameters: &ScanParameters, fit: &Fit) -> Value {
    let turning = |rotor: Rotor, it: &Turning| {
        let period = Period::new(rotor, it);
        json!({
            "period_s": period.seconds,
            "period_sigma_s": period.sigma,
            "period_offset_s": period.offset,
            "period_pull": pull(&it.rate),
            "epoch_phase_offset_deg": it.at_epoch.offset.to_degrees(),
            "epoch_phase_sigma_deg": it.at_epoch.sigma.to_degrees(),
            "epoch_phase_pull": pull(&it.at_epoch),
            "start_phase_deg": degrees::positive(rotor.start.radians() + it.at_start.offset),
            "start_phase_offset_deg": it.at_start.offset.to_degrees(),
            "start_phase_sigma_deg": it.at_start.sigma.to_degrees(),
            "start_phase_pull": pull(&it.at_start),
        })
    };
    let alone = fit.observable != Observable::Both;
    let ratio = ratio(parameters, fit);
    json!({
        "observable": observable(fit),
        "epoch_tdb": format_tdb(fit.epoch),
        "epoch_tai_ns": fit.epoch.tai_ns(),
        "precession": fit.precession.map(|it| turning(parameters.precession, &it)),
        "spin": (!alone).then(|| turning(parameters.spin, &fit.spin)),
        "combined": alone.then(|| json!({
            "rate_offset_deg_s": fit.spin.rate.offset.to_degrees(),
            "rate_sigma_deg_s": fit.spin.rate.sigma.to_degrees(),
            "epoch_phase_offset_deg": fit.spin.at_epoch.offset.to_degrees(),
            "epoch_phase_sigma_deg": fit.spin.at_epoch.sigma.to_degrees(),
        })),
        "alpha": fit.alpha.map(|it| json!({
            "deg": (parameters.alpha_rad + it.offset).to_degrees(),
            "offset_deg": it.offset.to_degrees(),
            "sigma_deg": it.sigma.to_degrees(),
            "pull": pull(&it),
        })),
        "ratio": ratio.map(|it| it.0),
        "ratio_sigma": ratio.map(|it| it.1),
    })
}

fn fit_text(out: &mut String, parameters: &ScanParameters, fit: &Fit) -> std::fmt::Result {
    writeln!(out, "\n{:<28} {:>20} {:>14} {:>10}", "fitted", "value", "sigma", "pull")?;
    let mut line = |name: &str, value: f64, sigma: f64, pull: f64| {
        writeln!(out, "{name:<28} {value:>20.9} {sigma:>14.3e} {pull:>10.2}")
    };
    let Some(precession) = &fit.precession else {
        let what = observable(fit);
        line(
            &format!("{what} at the epoch (deg)"),
            fit.spin.at_epoch.offset.to_degrees(),
            fit.spin.at_epoch.sigma.to_degrees(),
            pull(&fit.spin.at_epoch),
        )?;
        return writeln!(
            out,
            "alpha lies within 1 deg of the axis: only the phases' {what} is observable"
        );
    };
    for (name, rotor, it) in
        [("precession", parameters.precession, precession), ("spin", parameters.spin, &fit.spin)]
    {
        let period = Period::new(rotor, it);
        line(&format!("{name} period (s)"), period.seconds, period.sigma, pull(&it.rate))?;
        line(
            &format!("{name} phase at start (deg)"),
            degrees::positive(rotor.start.radians() + it.at_start.offset),
            it.at_start.sigma.to_degrees(),
            pull(&it.at_start),
        )?;
    }
    if let Some(alpha) = &fit.alpha {
        let degrees = (parameters.alpha_rad + alpha.offset).to_degrees();
        line("alpha (deg)", degrees, alpha.sigma.to_degrees(), pull(alpha))?;
    }
    if let Some((ratio, sigma)) = ratio(parameters, fit) {
        writeln!(out, "{:<28} {ratio:>20.9} {sigma:>14.3e}", "ratio of the periods")?;
    }
    Ok(())
}
