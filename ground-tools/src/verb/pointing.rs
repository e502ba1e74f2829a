//! `gyrfalcon pointing`: attitude, direction, crossing angle and plate angle over a span, as rows or
//! as an attitude ephemeris message.

use super::asked::{window, world};
use super::delivered::{deliver, form, sink};
use super::told::print_json;
use crate::cli::{Format, PointingArgs, SharedArgs};
use crate::failure::Failure;
use crate::output::Sink;
use crate::output::stamp::stamp;
use formats::attitude::{Attitudes, Motion, Span};
use formats::attitude::{BodyFrame, Message, Notation};
use formats::degrees;
use formats::rows::Column;
use formats::rows::Field::{Number, Tdb, Whole};
use onboard_core::attitude::{Sweep, sweep};
use onboard_core::hwp::hwp_phase;
use onboard_core::phase::Phase;
use onboard_core::sun::SunModel;
use onboard_core::time::{Duration, Instant};
use planner::opportunities::{NONE, SightLine};
use planner::provenance::Provenance;
use planner::world::TableFault;
use planner::world::World;
use serde::Serialize;

/// What a line of sight does at an instant.
struct Row {
    elapsed: Duration,
    at: Instant,
    seen: Sweep,
    hwp: Option<Phase>,
}

fn columns() -> [Column<Row>; 16] {
    [
        Column::new("elapsed_s", Number(|it| Some(it.elapsed.seconds()))),
        Column::new("time_tdb", Tdb(|it| it.at)),
        Column::new("tai_ns", Whole(|it| Some(it.at.tai_ns()))),
        Column::new("q_x", Number(|it| Some(it.seen.attitude.to_xyzw()[0]))),
        Column::new("q_y", Number(|it| Some(it.seen.attitude.to_xyzw()[1]))),
        Column::new("q_z", Number(|it| Some(it.seen.attitude.to_xyzw()[2]))),
        Column::new("q_w", Number(|it| Some(it.seen.attitude.to_xyzw()[3]))),
        Column::new("x", Number(|it| Some(it.seen.direction.xyz()[0]))),
        Column::new("y", Number(|it| Some(it.seen.direction.xyz()[1]))),
        Column::new("z", Number(|it| Some(it.seen.direction.xyz()[2]))),
        Column::new(
            "longitude_deg",
            Number(|it| Some(degrees::positive(it.seen.direction.longitude_rad()))),
        ),
        Column::new(
            "latitude_deg",
            Number(|it| Some(it.seen.direction.latitude_rad().to_degrees())),
        ),
        Column::new("psi_deg", Number(|it| Some(degrees::signed(it.seen.crossing_angle_rad)))),
        Column::new("hwp_deg", Number(|it| it.hwp.map(|it| degrees::positive(it.radians())))),
        Column::new("scan_speed_deg_s", Number(|it| Some(it.seen.speed_rad_s.to_degrees()))),
        Column::new(
            "scan_beam_angle_deg",
            Number(|it| Some(degrees::signed(it.seen.scan_beam_angle_rad))),
        ),
    ]
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
    let times = instants.within(window(&world))?;
    let is_message = form(shared)? == Format::Aem;
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
    deliver(shared, rows, (&provenance, &columns()), || {
        Ok(Summary {
            rows: times.clone().count(),
            telescope: line.telescope_name.clone(),
            detector: line.detector_name.clone(),
            provenance: provenance.clone(),
        })
    })
}

/// Shortest span of an AEM, whose times are written in microseconds.
pub(super) const SHORTEST_MESSAGE_NS: i64 = 1_000_000;

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
    if world.end.since(world.start).ns() < SHORTEST_MESSAGE_NS {
        return Err(Failure::Input(
            "an AEM covers 1 ms or more: a longer --duration is needed".to_owned(),
        ));
    }
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
    let at = world.zero().plus(elapsed);
    let seen = sweep(&world.scan, sun, line.rotation, at).map_err(TableFault)?;
    let hwp = line.hwp.map(|plate| hwp_phase(&world.scan, plate, at));
    Ok(Row { elapsed, at, seen, hwp })
}
