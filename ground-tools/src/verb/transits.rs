//! `gyrfalcon transits`: every passage of the targets through a line of sight.

use super::asked::world;
use super::delivered::deliver;
use super::told::warn;
use crate::cli::{SharedArgs, TransitsArgs};
use crate::failure::Failure;
use crate::output::memory::available_bytes;
use ephem::time::format_tdb;
use formats::degrees;
use formats::rows::Column;
use formats::rows::Field::{Count, Number, Tdb, Utc, Whole, Word};
use formats::visits::clipped;
use onboard_core::attitude::{Sweep, sweep};
use onboard_core::hwp::hwp_phase;
use onboard_core::phase::Phase;
use onboard_core::sun::SunModel;
use onboard_core::transit::Transit;
use planner::opportunities::SightLine;
use planner::opportunities::{Found, search};
use planner::provenance::Provenance;
use planner::world::TableFault;
use planner::world::World;
use serde_json::{Map, Value, json};

/// A transit, and what the line of sight does at closest approach.
struct Row<'w> {
    target: &'w str,
    line: &'w SightLine,
    transit: &'w Transit,
    closest: Sweep,
    hwp: Option<Phase>,
    /// Completed turns of precession and spin.
    turns: (u64, u64),
}

fn columns<'w>() -> [Column<Row<'w>>; 20] {
    [
        Column::new("target", Word(|it| Some(it.target.into()))),
        Column::new("telescope", Word(|it| Some((&it.line.telescope_name).into()))),
        Column::new("detector", Word(|it| Some((&it.line.detector_name).into()))),
        Column::new("entry_tdb", Tdb(|it| it.transit.entry)),
        Column::new("exit_tdb", Tdb(|it| it.transit.exit)),
        Column::new("closest_tdb", Tdb(|it| it.transit.closest)),
        Column::new("entry_utc", Utc(|it| it.transit.entry)),
        Column::new("exit_utc", Utc(|it| it.transit.exit)),
        Column::new("entry_tai_ns", Whole(|it| Some(it.transit.entry.tai_ns()))),
        Column::new("exit_tai_ns", Whole(|it| Some(it.transit.exit.tai_ns()))),
        Column::new("closest_tai_ns", Whole(|it| Some(it.transit.closest.tai_ns()))),
        Column::new("dwell_s", Number(|it| Some(it.transit.dwell().seconds()))),
        Column::new(
            "min_separation_deg",
            Number(|it| Some(it.transit.min_separation_rad.to_degrees())),
        ),
        Column::new("psi_deg", Number(|it| Some(degrees::signed(it.closest.crossing_angle_rad)))),
        Column::new("scan_speed_deg_s", Number(|it| Some(it.closest.speed_rad_s.to_degrees()))),
        Column::new(
            "scan_beam_angle_deg",
            Number(|it| Some(degrees::signed(it.closest.scan_beam_angle_rad))),
        ),
        Column::new("hwp_angle_deg", Number(|it| it.hwp.map(|it| degrees::positive(it.radians())))),
        Column::new("spin_count", Count(|it| Some(it.turns.1))),
        Column::new("precession_count", Count(|it| Some(it.turns.0))),
        Column::new(
            "clipped",
            Word(|it| Some(clipped(it.transit.entry_clipped, it.transit.exit_clipped).into())),
        ),
    ]
}

pub(super) fn run(shared: &SharedArgs, arguments: &TransitsArgs) -> Result<(), Failure> {
    let mut world = world(shared)?;
    world.keep_targets(&arguments.target)?;
    let lines = arguments.sight.lines(&world.mission)?;
    let tables = world.tables(&world.ground_options())?;
    let table = tables.parse()?;
    enough_memory(shared, &world, lines.len())?;
    let found = search(&world, table, &lines)?;
    let sun = world.sun(table)?;
    let provenance = Provenance::of(&world);
    let rows = found.iter().map(|it| row(&world, &sun, &lines[it.line], it));
    deliver(shared, rows, (&provenance, &columns()), || {
        summary(&world, &lines, &found, &provenance)
    })
}

/// Bytes that the passes of a target through a line of sight take in a day, measured on LiteBIRD.
const BYTES_PER_DAY: u64 = 100;
/// From here on the need is told.
const MUCH: u64 = 1_000_000_000;

/// Tells how much memory a large search may need, and refuses one for which there is not enough.
fn enough_memory(shared: &SharedArgs, world: &World, lines: usize) -> Result<(), Failure> {
    let days = world.end.since(world.start).ns().unsigned_abs().div_ceil(86_400_000_000_000);
    let pairs = (lines as u64).saturating_mul(world.targets.len() as u64);
    let bytes = days.saturating_mul(pairs).saturating_mul(BYTES_PER_DAY);
    let gigabytes = bytes / MUCH;
    match available_bytes() {
        Some(left) if bytes > left => Err(Failure::Input(format!(
            "the passes of {} targets through {lines} lines of sight in {days} d may take {gigabytes} \
             GB of memory, and {} GB are left: a shorter --duration, or fewer of --target or \
             --detector fit",
            world.targets.len(),
            left / MUCH
        ))),
        _ if bytes > MUCH => {
            warn(shared, &[format!("the passes may take {gigabytes} GB of memory")]);
            Ok(())
        }
        _ => Ok(()),
    }
}

fn row<'w>(
    world: &'w World,
    sun: &SunModel<'_>,
    line: &'w SightLine,
    found: &'w Found,
) -> Result<Row<'w>, Failure> {
    let transit = &found.transit;
    let at = transit.closest;
    Ok(Row {
        target: world.targets[found.target].name(),
        line,
        transit,
        closest: sweep(&world.scan, sun, line.rotation, at).map_err(TableFault)?,
        hwp: line.hwp.map(|plate| hwp_phase(&world.scan, plate, at)),
        turns: world.scan.turns(at),
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
