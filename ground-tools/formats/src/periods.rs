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
use crate::rows::Field::{Count, Number, Tdb, Utc, Whole, Word};
use crate::rows::{self, Column, Format, Layout};
use crate::timeline::{Session, Timeline};
use onboard_core::direction::Direction;
use onboard_core::frame::Ecliptic;
use onboard_core::phase::{Phase, Rotor};
use onboard_core::scan::ScanParameters;
use onboard_core::time::Instant;
use planner::world::TableFault;
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};
use std::io::Write;

/// A period, and how the telescope scans in it.
struct Row<'t> {
    number: u64,
    start: Instant,
    end: Instant,
    /// The sessions that run.
    running: Vec<&'t Session>,
    parameters: ScanParameters,
    /// Precession and spin at the start.
    phases: (Phase, Phase),
    /// The anti-Sun direction at start and end.
    axis: [Direction<Ecliptic>; 2],
}

fn columns<'t>() -> [Column<Row<'t>>; 23] {
    [
        Column::new("period", Count(|it| Some(it.number))),
        Column::new("mode", Word(|it| Some(it.mode().into()))),
        Column::new("start_utc", Utc(|it| it.start)),
        Column::new("end_utc", Utc(|it| it.end)),
        Column::new("start_tdb", Tdb(|it| it.start)),
        Column::new("end_tdb", Tdb(|it| it.end)),
        Column::new("start_tai_ns", Whole(|it| Some(it.start.tai_ns()))),
        Column::new("end_tai_ns", Whole(|it| Some(it.end.tai_ns()))),
        Column::new("duration_s", Number(|it| Some(it.end.since(it.start).seconds()))),
        Column::new("sessions", Word(|it| Some(it.joined(|it| &it.id)))),
        Column::new("targets", Word(|it| Some(it.joined(|it| &it.target)))),
        Column::new("telescopes", Word(|it| Some(it.joined(|it| &it.telescope)))),
        Column::new("alpha_deg", Number(|it| Some(it.parameters.alpha_rad.to_degrees()))),
        Column::new("beta_deg", Number(|it| Some(it.parameters.beta_rad.to_degrees()))),
        Column::new("precession_period_s", Number(|it| Some(period_s(it.parameters.precession)))),
        Column::new("spin_period_s", Number(|it| Some(period_s(it.parameters.spin)))),
        Column::new(
            "precession_phase_deg",
            Number(|it| Some(degrees::positive(it.phases.0.radians()))),
        ),
        Column::new("spin_phase_deg", Number(|it| Some(degrees::positive(it.phases.1.radians())))),
        Column::new(
            "scan_axis_start_longitude_deg",
            Number(|it| Some(degrees::positive(it.axis[0].longitude_rad()))),
        ),
        Column::new(
            "scan_axis_start_latitude_deg",
            Number(|it| Some(it.axis[0].latitude_rad().to_degrees())),
        ),
        Column::new(
            "scan_axis_end_longitude_deg",
            Number(|it| Some(degrees::positive(it.axis[1].longitude_rad()))),
        ),
        Column::new(
            "scan_axis_end_latitude_deg",
            Number(|it| Some(it.axis[1].latitude_rad().to_degrees())),
        ),
        Column::new(
            "sun_start_longitude_deg",
            Number(|it| Some(degrees::positive(it.axis[0].longitude_rad() + PI))),
        ),
    ]
}

impl Row<'_> {
    fn mode(&self) -> &'static str {
        if self.running.is_empty() { "survey" } else { "calibration" }
    }

    fn joined(&self, pick: impl Fn(&Session) -> &str) -> Cow<'_, str> {
        self.running.iter().map(|it| pick(it)).collect::<Vec<_>>().join(";").into()
    }
}

fn period_s(rotor: Rotor) -> f64 {
    TAU / rotor.rate.radians_per_second()
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
    let (format, provenance) = (Format::Csv, &timeline.provenance);
    let layout = Layout { format, provenance, columns: &columns() };
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

fn row<'t>(
    number: usize,
    (start, end, running): &Period,
    sessions: &'t [Session],
    motion: &Motion<'_>,
) -> Result<Row<'t>, TableFault> {
    let parameters = *motion.scan.parameters();
    let axis = |at: Instant| {
        let state = motion.sun.state(parameters.start, at);
        state.map(|it| it.direction).map_err(TableFault)
    };
    Ok(Row {
        number: u64::try_from(number).unwrap_or(u64::MAX),
        start: *start,
        end: *end,
        running: running.iter().map(|&index| &sessions[index]).collect(),
        parameters,
        phases: motion.scan.phases(*start),
        axis: [axis(*start)?, axis(*end)?],
    })
}
