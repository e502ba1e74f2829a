//! `gyrfalcon pointing`: attitude, direction, crossing angle and plate angle over a span.

use super::{deliver, format, world};
use crate::cli::{PointingArgs, SharedArgs};
use crate::degrees;
use crate::failure::Failure;
use crate::passes::told;
use crate::provenance::Provenance;
use crate::rows;
use crate::sightline::{SightLine, select};
use crate::world::World;
use ephem::time::format_tdb;
use onboard_core::attitude::sweep;
use onboard_core::hwp::hwp_phase;
use onboard_core::sun::SunModel;
use onboard_core::time::Duration;
use serde::Serialize;

const COLUMNS: [&str; 16] = [
    "elapsed_s",
    "time_tdb",
    "tai_ns",
    "q_x",
    "q_y",
    "q_z",
    "q_w",
    "x",
    "y",
    "z",
    "longitude_deg",
    "latitude_deg",
    "psi_deg",
    "hwp_deg",
    "scan_speed_deg_s",
    "scan_beam_angle_deg",
];

/// Most rows of one call: some 20 GB of text.
const MAX_ROWS: i64 = 100_000_000;

#[derive(Serialize)]
struct Row {
    elapsed_s: f64,
    time_tdb: String,
    tai_ns: i64,
    q_x: f64,
    q_y: f64,
    q_z: f64,
    q_w: f64,
    x: f64,
    y: f64,
    z: f64,
    longitude_deg: f64,
    latitude_deg: f64,
    psi_deg: f64,
    hwp_deg: Option<f64>,
    scan_speed_deg_s: f64,
    scan_beam_angle_deg: f64,
}

#[derive(Serialize)]
struct Summary {
    rows: usize,
    telescope: String,
    detector: String,
    provenance: Provenance,
}

pub(super) fn run(shared: &SharedArgs, arguments: &PointingArgs) -> Result<(), Failure> {
    let mut world = world(shared)?;
    let lines =
        select(&world.mission, arguments.telescope.as_deref(), arguments.detector.as_deref())?;
    let [line] = &lines[..] else {
        return Err(Failure::Input(format!(
            "pointing is of one line of sight, not of {}: name one with --detector",
            lines.len()
        )));
    };
    let times = times(&world, arguments)?;
    world.targets.clear();
    let tables = world.tables(&world.ground_options())?;
    let sun = world.sun(tables.parse()?)?;
    let found = times
        .iter()
        .map(|elapsed| row(&world, &sun, line, *elapsed))
        .collect::<Result<Vec<Row>, _>>()?;
    let provenance = Provenance::of(&world);
    let rows_written = found.len();
    let bytes = rows::write(found.into_iter(), format(shared), &provenance, &COLUMNS)?;
    let summary = Summary {
        rows: rows_written,
        telescope: line.telescope_name.clone(),
        detector: line.detector_name.clone(),
        provenance,
    };
    deliver(shared, &bytes, &summary)
}

/// The elapsed times asked for, within the mission.
fn times(world: &World, arguments: &PointingArgs) -> Result<Vec<Duration>, Failure> {
    let whole = world.mission.span.duration;
    if let Some(beyond) = arguments.at.iter().find(|elapsed| **elapsed > whole) {
        return Err(Failure::Input(format!(
            "--at {} lies beyond the mission: a number of seconds from 0 to {} is needed (or a \
             longer --duration)",
            beyond.seconds(),
            whole.seconds()
        )));
    }
    let Some(step) = arguments.step else { return Ok(arguments.at.clone()) };
    let count = whole.ns() / step.ns();
    if count >= MAX_ROWS {
        return Err(Failure::Input(format!(
            "--step {} s over {} s gives {} rows: at most {MAX_ROWS} are written, so a longer step \
             or a shorter --duration is needed",
            step.seconds(),
            whole.seconds(),
            count.saturating_add(1)
        )));
    }
    Ok((0..=count).map(|index| Duration::from_ns(index * step.ns())).collect())
}

fn row(
    world: &World,
    sun: &SunModel<'_>,
    line: &SightLine,
    elapsed: Duration,
) -> Result<Row, Failure> {
    let at = world.start.plus(elapsed);
    let seen = sweep(&world.scan, sun, line.rotation, at)
        .map_err(|error| Failure::internal(told(error)))?;
    let [q_x, q_y, q_z, q_w] = seen.attitude.to_xyzw();
    let [x, y, z] = seen.direction.xyz();
    Ok(Row {
        elapsed_s: elapsed.seconds(),
        time_tdb: format_tdb(at),
        tai_ns: at.tai_ns(),
        q_x,
        q_y,
        q_z,
        q_w,
        x,
        y,
        z,
        longitude_deg: degrees::positive(seen.direction.longitude_rad()),
        latitude_deg: seen.direction.latitude_rad().to_degrees(),
        psi_deg: degrees::signed(seen.crossing_angle_rad),
        hwp_deg: line
            .hwp
            .map(|plate| degrees::positive(hwp_phase(&world.scan, plate, at).radians())),
        scan_speed_deg_s: seen.speed_rad_s.to_degrees(),
        scan_beam_angle_deg: degrees::signed(seen.scan_beam_angle_rad),
    })
}
