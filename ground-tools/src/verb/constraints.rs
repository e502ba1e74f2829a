//! `gyrfalcon constraints`: what speeds and half-wave plates demand, per telescope.

use super::asked::mission;
use super::delivered::{answer, answer_json};
use crate::cli::SharedArgs;
use crate::failure::Failure;
use mission::Mission;
use mission::telescope::Telescope;
use planner::constraints::{
    Coherence, Defined, KineticConstraints, Optics, Scan, kinetic_constraints,
};
use serde::Serialize;
use std::fmt::Write;

#[derive(Serialize)]
struct Summary {
    full_sky: bool,
    telescopes: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    name: String,
    omega_max_plus_deg_s: f64,
    omega_max_minus_deg_s: f64,
    tau_s: Option<f64>,
    t_beta_lower_plus_min: Option<f64>,
    t_beta_lower_minus_min: Option<f64>,
    t_alpha_lower_plus_min: Option<f64>,
    t_alpha_lower_minus_min: Option<f64>,
    modulation_ok: Option<bool>,
    sampling_ok: Option<bool>,
    /// Why values are null.
    reasons: Vec<String>,
}

pub(super) fn run(shared: &SharedArgs) -> Result<(), Failure> {
    let mission = mission(shared)?;
    let found: Vec<KineticConstraints> = mission
        .telescopes
        .iter()
        .map(|telescope| {
            kinetic_constraints(&scan(&mission), &optics(&mission, telescope))
                .map_err(Failure::internal)
        })
        .collect::<Result<_, _>>()?;
    if shared.json {
        let telescopes =
            mission.telescopes.iter().zip(&found).map(|(it, found)| row(it, found)).collect();
        return answer_json(
            shared,
            &Summary { full_sky: mission.scan.covers_full_sky(), telescopes },
        );
    }
    answer(shared, &table(&mission, &found))
}

fn scan(mission: &Mission) -> Scan {
    let same_way =
        mission.scan.precession.rate.is_negative() == mission.scan.spin.rate.is_negative();
    Scan {
        alpha_rad: mission.scan.alpha_rad,
        beta_rad: mission.scan.beta_rad,
        precession_period_s: mission.scan.precession_period_min.to_f64() * 60.0,
        spin_period_s: mission.scan.spin_period_min.to_f64() * 60.0,
        coherence: if same_way { Coherence::Plus } else { Coherence::Minus },
    }
}

fn optics(mission: &Mission, telescope: &Telescope) -> Optics {
    Optics {
        fwhm_rad: telescope.fwhm_rad,
        hwp_rate_hz: telescope.hwp_rate_rpm.as_ref().map(|rpm| rpm.to_f64() / 60.0),
        sampling_rate_hz: mission.scan.sampling_rate_hz.to_f64(),
        n_mod: mission.scan.n_mod.to_f64(),
        n_margin: mission.scan.n_margin.to_f64(),
    }
}

fn minutes(seconds: &Defined<f64>) -> Option<f64> {
    seconds.as_ref().ok().map(|seconds| seconds / 60.0)
}

fn row(telescope: &Telescope, found: &KineticConstraints) -> Row {
    Row {
        name: telescope.name.clone(),
        omega_max_plus_deg_s: found.omega_max_plus_rad_s.to_degrees(),
        omega_max_minus_deg_s: found.omega_max_minus_rad_s.to_degrees(),
        tau_s: found.tau_s.ok(),
        t_beta_lower_plus_min: minutes(&found.t_beta_lower_plus_s),
        t_beta_lower_minus_min: minutes(&found.t_beta_lower_minus_s),
        t_alpha_lower_plus_min: minutes(&found.t_alpha_lower_plus_s),
        t_alpha_lower_minus_min: minutes(&found.t_alpha_lower_minus_s),
        modulation_ok: found.modulation_ok.ok(),
        sampling_ok: found.sampling_ok.ok(),
        reasons: reasons(found),
    }
}

/// One row of the table.
type Pick = fn(&KineticConstraints) -> Option<f64>;

/// The distinct reasons why values are undefined.
fn reasons(found: &KineticConstraints) -> Vec<String> {
    let numbers = [
        found.tau_s,
        found.t_beta_lower_plus_s,
        found.t_beta_lower_minus_s,
        found.t_alpha_lower_plus_s,
        found.t_alpha_lower_minus_s,
    ];
    let mut reasons: Vec<String> =
        numbers.iter().filter_map(|value| value.err()).map(|why| why.to_string()).collect();
    reasons.dedup();
    reasons
}

fn table(mission: &Mission, found: &[KineticConstraints]) -> String {
    let scan = &mission.scan;
    let mut text = format!(
        "{}: alpha {} deg, beta {} deg, T_alpha {} min, T_beta {} min\nfull sky: {}\n\n",
        mission.name,
        scan.alpha_deg,
        scan.beta_deg,
        scan.precession_period_min,
        scan.spin_period_min,
        if scan.covers_full_sky() { "yes" } else { "no" }
    );
    let names = mission.telescopes.iter().map(|it| it.name.as_str());
    line(&mut text, "", names.map(str::to_owned));
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
    let rows: [(&str, Pick); 7] = [
        ("omega_max+ (deg/s)", |it| Some(it.omega_max_plus_rad_s.to_degrees())),
        ("omega_max- (deg/s)", |it| Some(it.omega_max_minus_rad_s.to_degrees())),
        ("tau (s)", |it| it.tau_s.ok()),
        ("T_beta_lower+ (min)", |it| minutes(&it.t_beta_lower_plus_s)),
        ("T_beta_lower- (min)", |it| minutes(&it.t_beta_lower_minus_s)),
        ("T_alpha_lower+ (min)", |it| minutes(&it.t_alpha_lower_plus_s)),
        ("T_alpha_lower- (min)", |it| minutes(&it.t_alpha_lower_minus_s)),
    ];
    for (name, pick) in rows {
        line(&mut text, name, found.iter().map(|it| number(pick(it))));
    }
    let verdict = |value: Defined<bool>| match value {
        Ok(true) => "pass".to_owned(),
        Ok(false) => "FAIL".to_owned(),
        Err(_) => "-".to_owned(),
    };
    line(&mut text, "modulation", found.iter().map(|it| verdict(it.modulation_ok)));
    line(&mut text, "sampling", found.iter().map(|it| verdict(it.sampling_ok)));
    for (telescope, found) in mission.telescopes.iter().zip(found) {
        for reason in reasons(found) {
            let _ = writeln!(text, "\n{}: {reason}", telescope.name);
        }
    }
    text
}

fn line(text: &mut String, name: &str, cells: impl Iterator<Item = String>) {
    let _ = write!(text, "{name:<22}");
    for cell in cells {
        let _ = write!(text, " {cell:>10}");
    }
    text.push('\n');
}
