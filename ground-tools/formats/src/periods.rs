//! The pointing periods of a plan: between which instants do the same sessions run, and how does the
//! telescope scan then.
//!
//! Directions are ecliptic. `scan_axis` is the anti-Sun direction about which the spin axis precesses;
//! the Sun stands opposite. Phases are those of [`onboard_core::scan`] at the period's start.
//!
//! Method: starts and ends of sessions cut the mission; in each part the set of running sessions is
//! constant, none of them in a period of survey.
//!
//! Limits: calibration does not change the scan: a period of calibration tells whose telescope is set
//! up for which target, setup and cooldown included.
//!
//! # Example
//! The periods of a day's plan: survey first, then Jupiter in two telescopes:
//! ```
//! use formats::{attitude::Motion, periods, timeline::timeline};
//! use mission::{Mission, Override};
//! use planner::plan::{Revision, plan};
//! use planner::{progress::Quietly, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=1")?])?;
//! let world = World::open(mission, None)?;
//! let plan = plan(&world, &Revision::default(), &Quietly)?;
//! let (timeline, sun) = (timeline(&world, &plan, None)?, world.sun(plan.offered.tables.parse()?)?);
//! let frame = onboard_core::rotation::Rotation::IDENTITY;
//! let motion = Motion { scan: &world.scan, sun, frame };
//! let mut csv = Vec::new();
//! periods::write(&mut csv, &timeline, &motion, (world.start, world.end))?;
//! let csv = String::from_utf8(csv)?;
//! assert!(csv.contains("\n1,survey,") && csv.contains("\n2,calibration,"));
//! assert!(csv.contains(",MFT-jupiter-000003;HFT-jupiter-000003,jupiter;jupiter,MFT;HFT,"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::attitude::Motion;
use crate::degrees;
use crate::error::WriteError;
use crate::rows::{self, Format, Layout};
use crate::timeline::{Session, Timeline};
use ephem::time::{format_tdb, format_utc};
use onboard_core::time::Instant;
use planner::world::TableFault;
use serde::Serialize;
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::io::Write;

const COLUMNS: [&str; 23] = [
    "period",
    "mode",
    "start_utc",
    "end_utc",
    "start_tdb",
    "end_tdb",
    "start_tai_ns",
    "end_tai_ns",
    "duration_s",
    "sessions",
    "targets",
    "telescopes",
    "alpha_deg",
    "beta_deg",
    "precession_period_s",
    "spin_period_s",
    "precession_phase_deg",
    "spin_phase_deg",
    "scan_axis_start_longitude_deg",
    "scan_axis_start_latitude_deg",
    "scan_axis_end_longitude_deg",
    "scan_axis_end_latitude_deg",
    "sun_start_longitude_deg",
];

#[derive(Serialize)]
struct Row {
    period: usize,
    mode: &'static str,
    start_utc: String,
    end_utc: String,
    start_tdb: String,
    end_tdb: String,
    start_tai_ns: i64,
    end_tai_ns: i64,
    duration_s: f64,
    sessions: String,
    targets: String,
    telescopes: String,
    alpha_deg: f64,
    beta_deg: f64,
    precession_period_s: f64,
    spin_period_s: f64,
    precession_phase_deg: f64,
    spin_phase_deg: f64,
    scan_axis_start_longitude_deg: f64,
    scan_axis_start_latitude_deg: f64,
    scan_axis_end_longitude_deg: f64,
    scan_axis_end_latitude_deg: f64,
    sun_start_longitude_deg: f64,
}

/// Writes the list as CSV.
///
/// # Errors
/// What the writer says, or [`TableFault`] beyond the Sun's table.
pub fn write(
    out: &mut dyn Write,
    timeline: &Timeline,
    motion: &Motion<'_>,
    mission: (Instant, Instant),
) -> Result<(), WriteError> {
    let periods = periods(&timeline.sessions, mission);
    let rows = periods
        .iter()
        .enumerate()
        .map(|(index, period)| row(index + 1, period, &timeline.sessions, motion));
    let layout = Layout { format: Format::Csv, provenance: &timeline.provenance, header: &COLUMNS };
    rows::write(out, rows, &layout).map(|_| ())
}

/// Start, end and the sessions that run, by position.
type Period = (Instant, Instant, Vec<usize>);

/// The periods of a mission, in order and without gaps.
fn periods(sessions: &[Session], (start, end): (Instant, Instant)) -> Vec<Period> {
    let span =
        |it: &Session| (it.start_tai_ns.max(start.tai_ns()), it.end_tai_ns.min(end.tai_ns()));
    let mut cuts: BTreeSet<i64> = BTreeSet::from([start.tai_ns(), end.tai_ns()]);
    // What begins and what ends at a cut, so that each session is looked at twice.
    let mut changes: Vec<(i64, bool, usize)> = Vec::new();
    for (index, session) in sessions.iter().enumerate() {
        let (from, until) = span(session);
        cuts.extend([from, until]);
        changes.extend([(from, true, index), (until, false, index)]);
    }
    changes.sort_unstable();
    let cuts: Vec<i64> = cuts.into_iter().collect();
    let mut running: BTreeSet<usize> = BTreeSet::new();
    let mut changes = changes.into_iter().peekable();
    let mut periods = Vec::new();
    for pair in cuts.windows(2) {
        while let Some((_, begins, index)) = changes.next_if(|it| it.0 <= pair[0]) {
            if begins {
                running.insert(index);
            } else {
                running.remove(&index);
            }
        }
        let [from, until] = [pair[0], pair[1]].map(Instant::from_tai_ns);
        periods.push((from, until, running.iter().copied().collect()));
    }
    periods
}

fn row(
    number: usize,
    (start, end, running): &Period,
    sessions: &[Session],
    motion: &Motion<'_>,
) -> Result<Row, TableFault> {
    let running: Vec<&Session> = running.iter().map(|&index| &sessions[index]).collect();
    let joined = |pick: &dyn Fn(&Session) -> &str| {
        running.iter().map(|it| pick(it)).collect::<Vec<_>>().join(";")
    };
    let parameters = motion.scan.parameters();
    let axis = |at: Instant| {
        let state = motion.sun.state(parameters.start, at);
        state.map(|it| it.direction).map_err(TableFault)
    };
    let (first, last) = (axis(*start)?, axis(*end)?);
    let (precession, spin) = motion.scan.phases(*start);
    let period_s = |rate: f64| TAU / rate;
    Ok(Row {
        period: number,
        mode: if running.is_empty() { "survey" } else { "calibration" },
        start_utc: format_utc(*start),
        end_utc: format_utc(*end),
        start_tdb: format_tdb(*start),
        end_tdb: format_tdb(*end),
        start_tai_ns: start.tai_ns(),
        end_tai_ns: end.tai_ns(),
        duration_s: end.since(*start).seconds(),
        sessions: joined(&|it| &it.id),
        targets: joined(&|it| &it.target),
        telescopes: joined(&|it| &it.telescope),
        alpha_deg: parameters.alpha_rad.to_degrees(),
        beta_deg: parameters.beta_rad.to_degrees(),
        precession_period_s: period_s(parameters.precession.rate.radians_per_second()),
        spin_period_s: period_s(parameters.spin.rate.radians_per_second()),
        precession_phase_deg: degrees::positive(precession.radians()),
        spin_phase_deg: degrees::positive(spin.radians()),
        scan_axis_start_longitude_deg: degrees::positive(first.longitude_rad()),
        scan_axis_start_latitude_deg: first.latitude_rad().to_degrees(),
        scan_axis_end_longitude_deg: degrees::positive(last.longitude_rad()),
        scan_axis_end_latitude_deg: last.latitude_rad().to_degrees(),
        sun_start_longitude_deg: degrees::positive(first.longitude_rad() + std::f64::consts::PI),
    })
}
