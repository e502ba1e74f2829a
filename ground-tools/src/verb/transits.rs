//! `gyrfalcon transits`: every passage of the targets through a line of sight.

use super::asked::world;
use super::delivered::deliver;
use crate::cli::{SharedArgs, TransitsArgs};
use crate::failure::Failure;
use ephem::time::{format_tdb, format_utc};
use formats::degrees;
use onboard_core::attitude::sweep;
use onboard_core::hwp::hwp_phase;
use onboard_core::sun::SunModel;
use planner::opportunities::SightLine;
use planner::opportunities::{Found, search};
use planner::provenance::Provenance;
use planner::world::TableFault;
use planner::world::World;
use serde::Serialize;
use serde_json::{Map, Value, json};

const COLUMNS: [&str; 20] = [
    "target",
    "telescope",
    "detector",
    "entry_tdb",
    "exit_tdb",
    "closest_tdb",
    "entry_utc",
    "exit_utc",
    "entry_tai_ns",
    "exit_tai_ns",
    "closest_tai_ns",
    "dwell_s",
    "min_separation_deg",
    "psi_deg",
    "scan_speed_deg_s",
    "scan_beam_angle_deg",
    "hwp_angle_deg",
    "spin_count",
    "precession_count",
    "clipped",
];

#[derive(Serialize)]
struct Row<'w> {
    target: &'w str,
    telescope: &'w str,
    detector: &'w str,
    entry_tdb: String,
    exit_tdb: String,
    closest_tdb: String,
    entry_utc: String,
    exit_utc: String,
    entry_tai_ns: i64,
    exit_tai_ns: i64,
    closest_tai_ns: i64,
    dwell_s: f64,
    min_separation_deg: f64,
    psi_deg: f64,
    scan_speed_deg_s: f64,
    scan_beam_angle_deg: f64,
    hwp_angle_deg: Option<f64>,
    spin_count: u64,
    precession_count: u64,
    clipped: &'static str,
}

pub(super) fn run(shared: &SharedArgs, arguments: &TransitsArgs) -> Result<(), Failure> {
    let mut world = world(shared)?;
    world.keep_targets(&arguments.target)?;
    let lines = arguments.sight.lines(&world.mission)?;
    let tables = world.tables(&world.ground_options())?;
    let table = tables.parse()?;
    let found = search(&world, table, &lines)?;
    let sun = world.sun(table)?;
    let provenance = Provenance::of(&world);
    let rows = found.iter().map(|it| row(&world, &sun, &lines[it.line], it));
    deliver(shared, rows, (&provenance, &COLUMNS), || summary(&world, &lines, &found, &provenance))
}

fn row<'w>(
    world: &'w World,
    sun: &SunModel<'_>,
    line: &'w SightLine,
    found: &Found,
) -> Result<Row<'w>, Failure> {
    let transit = &found.transit;
    let at = transit.closest;
    let seen = sweep(&world.scan, sun, line.rotation, at).map_err(TableFault)?;
    let (precession_count, spin_count) = world.scan.turns(at);
    Ok(Row {
        target: world.targets[found.target].name(),
        telescope: &line.telescope_name,
        detector: &line.detector_name,
        entry_tdb: format_tdb(transit.entry),
        exit_tdb: format_tdb(transit.exit),
        closest_tdb: format_tdb(at),
        entry_utc: format_utc(transit.entry),
        exit_utc: format_utc(transit.exit),
        entry_tai_ns: transit.entry.tai_ns(),
        exit_tai_ns: transit.exit.tai_ns(),
        closest_tai_ns: at.tai_ns(),
        dwell_s: transit.dwell().seconds(),
        min_separation_deg: transit.min_separation_rad.to_degrees(),
        psi_deg: degrees::signed(seen.crossing_angle_rad),
        scan_speed_deg_s: seen.speed_rad_s.to_degrees(),
        scan_beam_angle_deg: degrees::signed(seen.scan_beam_angle_rad),
        hwp_angle_deg: line
            .hwp
            .map(|plate| degrees::positive(hwp_phase(&world.scan, plate, at).radians())),
        spin_count,
        precession_count,
        clipped: match (transit.entry_clipped, transit.exit_clipped) {
            (false, false) => "",
            (true, false) => "entry",
            (false, true) => "exit",
            (true, true) => "both",
        },
    })
}

/// Counts and hours; with lines of sight named, hours by line first.
fn summary(
    world: &World,
    lines: &[SightLine],
    found: &[Found],
    provenance: &Provenance,
) -> Result<Value, Failure> {
    let mut dwell_ns = vec![vec![0_i64; world.targets.len()]; lines.len()];
    for it in found {
        dwell_ns[it.line][it.target] += it.transit.dwell().ns();
    }
    let hours_of = |line: usize| {
        let by_target = world.targets.iter().zip(&dwell_ns[line]);
        let mut hours: Map<String, Value> =
            by_target.map(|(it, ns)| (it.name().to_owned(), json!(in_hours(*ns)))).collect();
        hours.insert("total".to_owned(), json!(in_hours(dwell_ns[line].iter().sum())));
        Value::Object(hours)
    };
    let integrated = match lines {
        [line] if line.telescope.is_none() => hours_of(0),
        _ => Value::Object(
            lines.iter().enumerate().map(|(index, line)| (line.key(), hours_of(index))).collect(),
        ),
    };
    let instants = found.iter().map(|it| it.transit.entry);
    Ok(json!({
        "transits": found.len(),
        "integrated_hours": integrated,
        "first_tdb": instants.clone().min().map(format_tdb),
        "last_tdb": found.iter().map(|it| it.transit.exit).max().map(format_tdb),
        "provenance": serde_json::to_value(provenance).map_err(Failure::internal)?,
    }))
}

#[expect(clippy::cast_precision_loss, reason = "292 years in ns, shown in hours")]
fn in_hours(ns: i64) -> f64 {
    ns as f64 / 3.6e12
}
