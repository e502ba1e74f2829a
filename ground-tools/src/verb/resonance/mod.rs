//! `gyrfalcon resonance`: do precession, spin and orbit beat on the sky, within tolerance.
//!
//! The check covers a year unless `--duration` says otherwise.
//! With `--scan` rows of predictions are written; they are not judged unless `--json` or a figure is
//! asked for.

mod options;
mod figure;

use super::asked::world;
use super::delivered::{answer, answer_json, deliver, sink};
use super::told::print_json;
use crate::cli::{ResonanceArgs, SharedArgs};
use crate::failure::Failure;
use crate::output::Sink;
use crate::output::figures::{Figure, write_figures};
use figure::{Point, figure};
use formats::resonance::{json as checked_json, minutes, sentence};
use formats::rows::Column;
use formats::rows::Field::{Number, Whole};
use options::{Actuators, Periods};
use planner::provenance::Provenance;
use planner::resonance::check::{Checked, ResonanceCheck};
use planner::resonance::{
    CertificateError, Choice, Crosslink, Recommendation, Tolerance, tolerance_after,
};
use planner::world::World;
use serde_json::{Value, json};
use std::fmt::Write;

/// Halvings of the time after which the rates have drifted out.
const HALVINGS: u32 = 24;
/// Times after a correction that are tried, in seconds: ten years.
const LONGEST_S: f64 = 3.155_76e8;
/// Shortest survey that is judged, in days: over less the orbit hardly moves the pattern.
const LEAST_DAYS: f64 = 30.0;
/// Points of a figure without a scan.
const FIGURE_POINTS: u32 = 400;

/// The columns of a scan.
fn columns<'p>() -> [Column<&'p Point>; 5] {
    [
        Column::new("precession_period_min", Number(|it| Some(it.minutes))),
        Column::new("sigma_predicted", Number(|it| Some(it.sigma))),
        Column::new("p", Whole(|it| it.strongest.map(|it| it[0].into()))),
        Column::new("q", Whole(|it| it.strongest.map(|it| it[1].into()))),
        Column::new("m", Whole(|it| it.strongest.map(|it| it[2].into()))),
    ]
}

pub(super) fn run(shared: &SharedArgs, arguments: &ResonanceArgs) -> Result<(), Failure> {
    let window = options::window(arguments)?;
    let allowed = options::allowed(&arguments.allow)?;
    options::orders(&arguments.crosslink)?;
    let tolerance = arguments.tolerance.as_deref().map(options::tolerance).transpose()?;
    let actuators = Actuators::read(&arguments.actuators)?;
    let scan = arguments.scan.as_deref().map(Periods::scan).transpose()?;
    if shared.from.is_some() || shared.until.is_some() {
        return Err(Failure::Input(
            "resonances are judged from the mission's start on: leave --from and --until out, or choose \
             --duration"
                .to_owned(),
        ));
    }
    let mut world = world(shared)?;
    world.targets.clear();
    let span_s = world.end.since(world.start).seconds();
    let duration_s = shared.duration.is_some().then_some(span_s);
    if let Some(days) = duration_s.map(|it| it / 86_400.0).filter(|it| *it < LEAST_DAYS) {
        return Err(Failure::Input(format!(
            "--duration: resonances are not judged over {days} d: {LEAST_DAYS} d or more are needed"
        )));
    }
    let mut check = ResonanceCheck::new(&world, window, duration_s)?;
    check.demand.allowed = allowed;
    if let Some(tolerance) = tolerance {
        check.demand.tolerance = tolerance;
    }
    if let Some(it) = &actuators {
        let since_s = it.correct_every_s;
        check.demand.tolerance = tolerance_after(&check.motion, &it.precession, &it.spin, since_s);
    }
    let candidates = options::candidates(arguments, &check.motion, actuators.as_ref())?;
    let candidates = candidates.unwrap_or_else(|| check.nearby());
    let spin_min = minutes(check.motion.spin_period_s);
    if let (Some(periods), Some(text)) = (&scan, &arguments.scan) {
        let shortest = periods.minutes().next().unwrap_or(0.0);
        if shortest <= spin_min {
            return Err(Failure::Input(format!(
                "--scan {text}: precession periods above the spin period, {spin_min} min, are needed"
            )));
        }
    }
    let points: Vec<Point> =
        scan.iter().flat_map(Periods::minutes).map(|minutes| point(&mut check, minutes)).collect();
    let provenance = Provenance::of(&world);
    let drawn = arguments.figures.asked();
    if scan.is_some() && !shared.json && !drawn {
        return rows(shared, &points, &provenance);
    }

    let checked = check.certify().map_err(Failure::input)?;
    let recommended = check.recommend(&candidates).map_err(Failure::input)?;
    let crosslinks = check.crosslinks(&arguments.crosslink);
    let lasting = actuators.map(|it| lasting(&mut check, &checked, &it)).transpose()?;
    if scan.is_some() && !(shared.json && sink(shared) == Sink::Stdout) {
        rows(shared, &points, &provenance)?;
    }
    let mut files = Vec::new();
    if drawn {
        let points = if points.len() > 1 { points } else { around(&mut check, &checked) };
        let title = format!(
            "{}: hits of {:.2} d at {}",
            world.mission.name,
            checked.motion.duration_s / 86_400.0,
            options::scale(arguments)
        );
        let drawing = figure(&title, &points, &checked, recommended.as_ref())?;
        let figures = [Figure { stem: "resonance".to_owned(), drawing }];
        files = write_figures(arguments.figures.folders(), &figures)?;
    }
    let report = Report {
        world: &world,
        checked: &checked,
        recommended: recommended.as_ref(),
        crosslinks,
        lasting,
    };
    if shared.json {
        let json = report.json(&provenance, &files)?;
        let told = if scan.is_none() { answer_json(shared, &json) } else { print_json(&json) };
        told?;
    } else if scan.is_none() {
        answer(shared, &report.text(&options::scale(arguments), &files))?;
    }
    if checked.certificate.passes {
        Ok(())
    } else {
        Err(Failure::Check(format!("{}: resonance: {}", world.mission.name, sentence(&checked))))
    }
}

fn point(check: &mut ResonanceCheck, minutes: f64) -> Point {
    let (sigma, strongest) = check.predict(minutes * 60.0);
    Point { minutes, sigma, strongest }
}

/// Points about the tolerance box and the mission's surroundings.
fn around(check: &mut ResonanceCheck, checked: &Checked) -> Vec<Point> {
    let nominal = minutes(checked.motion.precession_period_s);
    let eta = (checked.motion.precession_period_s / checked.motion.spin_period_s).abs();
    let box_min = (checked.tolerance.precession_s + eta * checked.tolerance.spin_s) / 60.0;
    let half = (0.0025 * nominal).max(2.0 * box_min).min(0.5 * nominal);
    (0..=FIGURE_POINTS)
        .map(|i| nominal + half * (2.0 * f64::from(i) / f64::from(FIGURE_POINTS) - 1.0))
        .map(|minutes| point(check, minutes))
        .collect()
}

fn rows(shared: &SharedArgs, points: &[Point], provenance: &Provenance) -> Result<(), Failure> {
    let rows = points.iter().map(Ok);
    // The summary is the verb's own.
    let shared = SharedArgs { json: false, ..shared.clone() };
    deliver(&shared, rows, (provenance, &columns()), || Ok(()))
}

/// What the actuators make of the periods, and for how long.
#[derive(Debug, Clone, Copy)]
struct Lasting {
    tolerance: Tolerance,
    correct_every_s: f64,
    /// Time after a correction at which the box no longer passes; none within ten years.
    free_for_s: Option<f64>,
}

/// How long after a correction the periods stay where no resonance matters: the longest time whose
/// tolerance passes.
fn lasting(
    check: &mut ResonanceCheck,
    checked: &Checked,
    actuators: &Actuators,
) -> Result<Lasting, Failure> {
    let Actuators { precession, spin, correct_every_s } = actuators;
    let floor = checked.certificate.sigma_floor;
    let motion = checked.motion;
    let mut passes = |since_s: f64| {
        match check.passes(tolerance_after(&motion, precession, spin, since_s), floor) {
            // Wider than the period.
            Err(CertificateError::Tolerance { .. }) => Ok(false),
            other => other.map_err(Failure::input),
        }
    };
    let free_for_s = if passes(LONGEST_S)? {
        None
    } else if passes(0.0)? {
        let (mut low, mut high) = (0.0, LONGEST_S);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if passes(middle)? {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(low)
    } else {
        Some(0.0)
    };
    Ok(Lasting { tolerance: checked.tolerance, correct_every_s: *correct_every_s, free_for_s })
}

impl Lasting {
    fn json(&self) -> Value {
        json!({
            "precession_tolerance_s": self.tolerance.precession_s,
            "spin_tolerance_s": self.tolerance.spin_s,
            "correct_every_s": self.correct_every_s,
            "moire_free_for_s": self.free_for_s,
        })
    }

    fn text(&self) -> String {
        let free = match self.free_for_s {
            None => "they stay free of resonance for ten years or more".to_owned(),
            Some(seconds) if seconds > 0.0 => {
                format!(
                    "they leave the Moire-free interval {:.3} d after a correction",
                    seconds / 86_400.0
                )
            }
            Some(_) => "they are outside the Moire-free interval from the start".to_owned(),
        };
        format!(
            "actuators: {:.3} d after a correction the periods hold within {:.4} s and {:.5} s; {free}",
            self.correct_every_s / 86_400.0,
            self.tolerance.precession_s,
            self.tolerance.spin_s
        )
    }
}

struct Report<'r> {
    world: &'r World,
    checked: &'r Checked,
    recommended: Option<&'r Recommendation>,
    /// None where pixels stay unobserved.
    crosslinks: Option<Vec<Crosslink>>,
    lasting: Option<Lasting>,
}

impl Report<'_> {
    fn json(&self, provenance: &Provenance, files: &[String]) -> Result<Value, Failure> {
        let mut value = checked_json(self.checked, self.recommended);
        value["actuators"] = self.lasting.as_ref().map_or(Value::Null, Lasting::json);
        value["crosslink"] = self.crosslinks.as_ref().map_or(Value::Null, |it| {
            let each = |it: &Crosslink| json!({"n": it.order, "mean": it.mean});
            it.iter().map(each).collect()
        });
        value["files"] = json!(files);
        value["provenance"] = serde_json::to_value(provenance).map_err(Failure::internal)?;
        Ok(value)
    }

    fn text(&self, scale: &str, files: &[String]) -> String {
        let Checked { motion, tolerance, certificate, allowed } = self.checked;
        let scan = &self.world.mission.scan;
        let rounded = |seconds: f64| (seconds * 1e6).round() / 1e6;
        let mut text = format!(
            "{}: resonance of precession, spin and orbit, hits of {:.2} d at {scale}\n\
             alpha {} deg, beta {} deg, T_alpha {} min +- {} s, T_beta {} min +- {} s, ratio {:.6}\n\n",
            self.world.mission.name,
            motion.duration_s / 86_400.0,
            scan.alpha_deg,
            scan.beta_deg,
            minutes(motion.precession_period_s),
            rounded(tolerance.precession_s),
            minutes(motion.spin_period_s),
            rounded(tolerance.spin_s),
            (motion.precession_period_s / motion.spin_period_s).abs()
        );
        let _ = writeln!(text, "{}\n", sentence(self.checked));
        let _ = writeln!(text, "{:<34} {:>12} {:>10}", "sigma_hits / mean", "value", "excess");
        let excess = |sigma: f64| 100.0 * (sigma / certificate.sigma_floor - 1.0);
        for (name, sigma) in [
            ("smooth, without resonances", certificate.sigma_smooth),
            ("floor within 0.25 % of T_alpha", certificate.sigma_floor),
            ("predicted at the periods", certificate.sigma_predicted),
            ("bound within tolerance", certificate.sigma_bound),
            ("allowed", certificate.sigma_floor * (1.0 + allowed)),
        ] {
            let _ = writeln!(text, "{name:<34} {sigma:>12.6} {:>8.2} %", excess(sigma));
        }
        match &self.crosslinks {
            None => text.push_str("\nno cross-link means: the scan leaves pixels unobserved\n"),
            Some(means) if means.is_empty() => {}
            Some(means) => {
                let _ =
                    writeln!(text, "\n{:<34} {:>12} {:>10}", "mean of |h_n|^2", "value", "smooth");
                for it in means {
                    let name = format!("n = {}", it.order);
                    let _ = writeln!(text, "{name:<34} {:>12.6} {:>10.6}", it.mean, it.smooth_mean);
                }
            }
        }
        if let Some(found) = self.recommended {
            let _ = writeln!(
                text,
                "\n{:<34} {:>12} {:>10} {:>10} {:>8} {:>10}",
                "periods to fly", "T_alpha min", "T_beta min", "bound", "excess", "survives"
            );
            for (name, choice) in [
                ("smallest bound", &found.quietest),
                ("largest tolerance", &found.sturdiest),
                ("golden ratio (Hoang et al. 2017)", &found.golden),
            ] {
                let _ = writeln!(text, "{name:<34} {}", row(choice));
            }
            text.push_str("(survives: how many times the tolerance still passes)\n");
        }
        if let Some(lasting) = &self.lasting {
            let _ = writeln!(text, "\n{}", lasting.text());
        }
        if !files.is_empty() {
            let _ = writeln!(text, "\nwritten: {}", files.join(", "));
        }
        text
    }
}

fn row(choice: &Choice) -> String {
    let Choice { precession_period_s, spin_period_s, certificate, tolerances_survived } = choice;
    let most = planner::resonance::MOST_TOLERANCES;
    let more = if *tolerances_survived > 0.98 * most { ">" } else { "" };
    format!(
        "{:>12.4} {:>10.4} {:>10.6} {:>6.2} % {:>10}",
        minutes(*precession_period_s),
        minutes(*spin_period_s),
        certificate.sigma_bound,
        100.0 * certificate.excess,
        format!("{more}{tolerances_survived:.2}")
    )
}
