//! `gyrfalcon missions`: list the presets, show one, check a file.

use super::asked::mission;
use super::delivered::{answer, answer_json, sink};
use super::told::warn;
use crate::cli::{MissionsArgs, SharedArgs};
use crate::failure::Failure;
use mission::Mission;
use mission::occasions::{Blackouts, contacts};
use mission::presets;
use planner::world::World;
use serde::Serialize;
use std::fmt::Write;

#[derive(Serialize)]
struct Listed {
    preset: String,
    name: String,
    alpha_deg: f64,
    beta_deg: f64,
    precession_period_min: f64,
    spin_period_min: f64,
    telescopes: Vec<String>,
}

#[derive(Serialize)]
struct Checked<'m> {
    name: &'m str,
    sha256: String,
    warnings: Vec<String>,
}

pub(super) fn run(shared: &SharedArgs, arguments: &MissionsArgs) -> Result<(), Failure> {
    let Some(name) = &arguments.name else {
        if arguments.resolved {
            let mission = mission(shared)?;
            return sink(shared).write(mission.resolved_toml().as_bytes());
        }
        return list(shared);
    };
    let named = SharedArgs { mission: name.clone(), ..shared.clone() };
    let mission = mission(&named)?;
    if arguments.resolved {
        return sink(shared).write(mission.resolved_toml().as_bytes());
    }
    if presets::find(name).is_none() {
        check_files(shared, &mission)?;
    }
    if shared.json {
        return answer_json(
            shared,
            &Checked {
                name: &mission.name,
                sha256: mission.digest(),
                warnings: mission.warnings.iter().map(ToString::to_string).collect(),
            },
        );
    }
    match presets::find(name) {
        Some(text) if shared.set.is_empty() => sink(shared).write(text.as_bytes()),
        _ => answer(
            shared,
            &format!("{} is a mission: {}, SHA-256 {}\n", name, mission.name, mission.digest()),
        ),
    }
}

/// Reads the files that a mission names, as a plan would.
fn check_files(shared: &SharedArgs, mission: &Mission) -> Result<(), Failure> {
    let world = World::open(mission.clone(), shared.ephemeris.as_deref())?;
    warn(shared, world.far_trajectory().as_slice());
    if let Some(data) = &mission.calibration.schedule.data {
        contacts(mission, &data.contacts)?;
    }
    let blackouts = Blackouts::read(mission, (world.start, world.end))?;
    warn(shared, &blackouts.left_out());
    Ok(())
}

fn list(shared: &SharedArgs) -> Result<(), Failure> {
    let mut rows = Vec::new();
    for preset in presets::NAMES {
        let mission = Mission::load(preset, &[])?;
        rows.push(Listed {
            preset: preset.to_owned(),
            alpha_deg: mission.scan.alpha_deg.to_f64(),
            beta_deg: mission.scan.beta_deg.to_f64(),
            precession_period_min: mission.scan.precession_period_min.to_f64(),
            spin_period_min: mission.scan.spin_period_min.to_f64(),
            telescopes: mission.telescopes.iter().map(|it| it.name.clone()).collect(),
            name: mission.name,
        });
    }
    if shared.json {
        return answer_json(shared, &rows);
    }
    let mut text = format!(
        "{:<10} {:>6} {:>6} {:>14} {:>11}  telescopes\n",
        "preset", "alpha", "beta", "precession", "spin"
    );
    for row in &rows {
        let _ = writeln!(
            text,
            "{:<10} {:>5}d {:>5}d {:>10} min {:>7} min  {}",
            row.preset,
            row.alpha_deg,
            row.beta_deg,
            row.precession_period_min,
            row.spin_period_min,
            row.telescopes.join(", ")
        );
    }
    text.push_str("\ngyrfalcon missions NAME shows one; --resolved with every key explicit\n");
    answer(shared, &text)
}
