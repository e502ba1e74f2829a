//! `gyrfalcon pointing`: attitude, direction, crossing angle and plate angle over a span, as rows or
//! as an attitude ephemeris message.

use super::asked::world;
use super::delivered::{deliver, sink};
use super::told::print_json;
use crate::cli::{Format, PointingArgs, SharedArgs};
use crate::failure::Failure;
use crate::output::Sink;
use crate::output::stamp::stamp;
use ephem::time::format_tdb;
use formats::attitude::{Attitudes, Motion, Span};
use formats::attitude::{BodyFrame, Message, Notation};
use formats::degrees;
use onboard_core::attitude::sweep;
use onboard_core::hwp::hwp_phase;
use onboard_core::sun::SunModel;
use onboard_core::time::Duration;
use planner::opportunities::{NONE, SightLine};
use planner::provenance::Provenance;
use planner::world::TableFault;
use planner::world::World;
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
    let lines = arguments.sight.lines(&world.mission)?;
    let [line] = &lines[..] else {
        return Err(Failure::Input(format!(
            "pointing is of one line of sight, not of {}: name one with --detector",
            lines.len()
        )));
    };
    let instants = &arguments.instants;
    let times = instants.within(world.mission.span.duration)?;
    let is_message = shared.format == Some(Format::Aem);
    match (is_message, instants.step.is_some(), instants.at.is_empty()) {
        (true, _, false) => {
            return Err(Failure::Input(
                "--at names single instants, and an AEM holds a span that can be interpolated: leave \
                 it out, or choose csv, jsonl or parquet"
                    .to_owned(),
            ));
        }
        (false, false, true) => {
            return Err(Failure::Input(
                "pointing needs instants: --step SECONDS, --at S1,S2,... or --format aem"
                    .to_owned(),
            ));
        }
        (false, ..) if arguments.aem_error_arcsec.is_some() || arguments.stamp.is_some() => {
            return Err(Failure::Input(
                "--aem-error-arcsec and --stamp are of an AEM: --format aem is needed".to_owned(),
            ));
        }
        _ => {}
    }
    world.targets.clear();
    let tables = world.tables(&world.ground_options())?;
    let sun = world.sun(tables.parse()?)?;
    let provenance = Provenance::of(&world);
    if is_message {
        let attitudes = attitudes(&world, (sun, line), arguments, &provenance)?;
        return deliver_message(shared, &world, line, attitudes);
    }
    let rows = times.clone().map(|elapsed| row(&world, &sun, line, elapsed));
    deliver(shared, rows, (&provenance, &COLUMNS), || {
        Ok(Summary {
            rows: times.clone().count(),
            telescope: line.telescope_name.clone(),
            detector: line.detector_name.clone(),
            provenance: provenance.clone(),
        })
    })
}

/// What the message of a line of sight is made from.
fn attitudes<'w>(
    world: &'w World,
    (sun, line): (SunModel<'w>, &SightLine),
    arguments: &PointingArgs,
    provenance: &'w Provenance,
) -> Result<Attitudes<'w>, Failure> {
    let motion = Motion { scan: &world.scan, sun, frame: line.rotation };
    let step = match arguments.instants.step {
        None => motion.step((arguments.aem_error_arcsec.unwrap_or(1.0) / 3600.0).to_radians()),
        Some(step) => motion.step_of(step).map_err(|legal| {
            Failure::Input(format!("--step {} cannot be an AEM's: {legal}", step.seconds()))
        })?,
    };
    let stamp = stamp(arguments.stamp.as_deref(), world.start)?;
    Ok(Attitudes { product: &world.mission.product, provenance, stamp, motion, step })
}

/// The whole span as one segment, to `--out` or standard output.
fn deliver_message(
    shared: &SharedArgs,
    world: &World,
    line: &SightLine,
    attitudes: Attitudes<'_>,
) -> Result<(), Failure> {
    let span = Span::whole((world.start, world.end));
    let frame = match (line.telescope_name.as_str(), line.detector_name.as_str()) {
        (NONE, _) => BodyFrame::Boresight,
        (telescope, NONE) => BodyFrame::Instrument(telescope.to_owned()),
        _ => BodyFrame::Instrument(line.key()),
    };
    let rows = span.count(attitudes.step.step);
    let sink = sink(shared);
    if !(shared.json && sink == Sink::Stdout) {
        let message = Message { notation: Notation::Kvn, frame, attitudes };
        sink.write_with(|out| message.write(out, &[span], &|_| String::new()))?;
    }
    if shared.json {
        print_json(&Summary {
            rows,
            telescope: line.telescope_name.clone(),
            detector: line.detector_name.clone(),
            provenance: attitudes.provenance.clone(),
        })
    } else {
        Ok(())
    }
}

fn row(
    world: &World,
    sun: &SunModel<'_>,
    line: &SightLine,
    elapsed: Duration,
) -> Result<Row, Failure> {
    let at = world.start.plus(elapsed);
    let seen = sweep(&world.scan, sun, line.rotation, at).map_err(TableFault)?;
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
