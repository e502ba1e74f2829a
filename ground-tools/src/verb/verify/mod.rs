//! `gyrfalcon verify`: an attitude history against the mission.

mod report;

use super::{mission, print_json, sink, table, tell};
use crate::cli::{Against, Format, ReferenceFrame, SharedArgs, VerifyArgs};
use crate::failure::Failure;
use crate::output::Sink;
use ephem::apparent::OBLIQUITY_ARCSEC;
use ephem::time::format_tdb;
use formats::history::{History, Reference};
use formats::rows::{self, Layout};
use onboard_core::attitude::attitude;
use onboard_core::frame::{Boresight, Detector, Ecliptic, Icrf};
use onboard_core::rotation::Rotation;
use onboard_core::sun::SunModel;
use planner::history_fit::{FEWEST_ROWS, Fit, FitError, Measured, fit, rotation_vector};
use planner::opportunities::select;
use planner::provenance::Provenance;
use planner::world::TableFault;
use planner::world::World;
use report::{ARCSECONDS_PER_RADIAN, Report};
use serde::Serialize;
use std::io::Read;
use std::path::Path;

const COLUMNS: [&str; 13] = [
    "line",
    "elapsed_s",
    "time_tdb",
    "tai_ns",
    "residual_x_arcsec",
    "residual_y_arcsec",
    "residual_z_arcsec",
    "residual_arcsec",
    "fit_x_arcsec",
    "fit_y_arcsec",
    "fit_z_arcsec",
    "fit_arcsec",
    "outlier",
];

/// One row's residuals.
#[derive(Debug, Clone, Serialize)]
struct Row {
    line: usize,
    elapsed_s: f64,
    time_tdb: String,
    tai_ns: i64,
    residual_x_arcsec: f64,
    residual_y_arcsec: f64,
    residual_z_arcsec: f64,
    residual_arcsec: f64,
    fit_x_arcsec: Option<f64>,
    fit_y_arcsec: Option<f64>,
    fit_z_arcsec: Option<f64>,
    fit_arcsec: Option<f64>,
    outlier: bool,
}

pub(super) fn run(shared: &SharedArgs, arguments: &VerifyArgs) -> Result<(), Failure> {
    let limit_arcsec = table::angle("--limit", &arguments.limit)? * ARCSECONDS_PER_RADIAN;
    let mut world = World::open(mission(shared)?, shared.ephemeris.as_deref())?;
    let name = file_name(&arguments.file);
    let history = History::parse(&read(&arguments.file)?, world.start)
        .map_err(|error| Failure::Input(format!("{name}: {error}")))?;
    let measured = measured(&world, &history, arguments, &name)?;
    world.targets.clear();
    let tables = world.tables(&world.ground_options())?;
    let sun = world.sun(tables.parse()?)?;
    let fitted = match fit(&world.scan, &sun, &measured, arguments.search) {
        Ok(fitted) => Ok(fitted),
        Err(FitError::Few(rows)) => {
            return Err(Failure::Input(format!(
                "{name}: it has attitudes at {rows} times: {FEWEST_ROWS} or more are needed"
            )));
        }
        Err(FitError::Sun(error)) => return Err(TableFault(error).into()),
        Err(FitError::Precession(ambiguous)) => Err(("precession", ambiguous)),
        Err(FitError::Spin(ambiguous)) => Err(("spin", ambiguous)),
    };
    let rows =
        residuals(&world, &sun, (&history, &measured), fitted.as_ref().ok()).map_err(TableFault)?;
    let provenance = Provenance::of(&world);
    if shared.out.is_some() && !(shared.json && sink(shared) == Sink::Stdout) {
        let layout = Layout {
            format: shared.format.unwrap_or(Format::Csv).of_rows()?,
            provenance: &provenance,
            header: &COLUMNS,
        };
        let all = rows.iter().cloned().map(Ok::<_, Failure>);
        sink(shared).write_with(|out| rows::write(out, all, &layout))?;
    }
    let against_fit = arguments.against == Against::Fit;
    let mut report = Report::new(&world, &history, &rows, (fitted, limit_arcsec, against_fit));
    report.judge_resonance();
    if shared.json {
        print_json(&report.json(&provenance)?)?;
    } else if sink(shared) != Sink::Stdout || shared.out.is_none() {
        tell(shared, &report.text(&name))?;
    }
    if report.failed.is_empty() {
        Ok(())
    } else {
        Err(Failure::Check(format!("{name}: {}", report.failed.join("; "))))
    }
}

fn file_name(file: &Path) -> String {
    if file.as_os_str() == "-" { "standard input".to_owned() } else { file.display().to_string() }
}

fn read(file: &Path) -> Result<String, Failure> {
    let fail = |error| Failure::file("read", Path::new(&file_name(file)), &error);
    if file.as_os_str() == "-" {
        let mut text = String::new();
        std::io::stdin().lock().read_to_string(&mut text).map_err(fail)?;
        Ok(text)
    } else {
        std::fs::read_to_string(file).map_err(fail)
    }
}

/// The rows as attitudes of the boresight frame in the ecliptic.
fn measured(
    world: &World,
    history: &History,
    arguments: &VerifyArgs,
    name: &str,
) -> Result<Vec<Measured>, Failure> {
    let lines =
        select(&world.mission, arguments.telescope.as_deref(), arguments.detector.as_deref())?;
    let [line] = &lines[..] else {
        return Err(Failure::Input(format!(
            "a history is of one frame, not of {}: name one with --detector",
            lines.len()
        )));
    };
    let reference = match (arguments.frame, history.reference) {
        (Some(_), Some(_)) => {
            return Err(Failure::Input(format!(
                "--frame is for a CSV: {name} is an {} and names its frames",
                history.form
            )));
        }
        (_, Some(own)) => own,
        (Some(ReferenceFrame::Icrf), None) => Reference::Icrf,
        (_, None) => Reference::Ecliptic,
    };
    // Components in ICRF to components in the ecliptic.
    let tilt = Rotation::<Icrf, Ecliptic>::about_x(-(OBLIQUITY_ARCSEC / 3600.0).to_radians());
    let to_detector = line.rotation.inverse();
    history
        .rows
        .iter()
        .map(|row| {
            if row.at < world.start || row.at > world.end {
                return Err(Failure::Input(format!(
                    "{name}: line {}: {} TDB lies outside the mission, {} to {} TDB: other --start \
                     or --duration are needed",
                    row.line,
                    format_tdb(row.at),
                    format_tdb(world.start),
                    format_tdb(world.end)
                )));
            }
            let [x, y, z, w] = row.quaternion;
            let xyzw = if arguments.inverse { [-x, -y, -z, w] } else { [x, y, z, w] };
            let refused = |error| Failure::internal(format!("{error:?}"));
            let sensor: Rotation<Detector, Ecliptic> = match reference {
                Reference::Ecliptic => Rotation::from_xyzw(xyzw).map_err(refused)?,
                Reference::Icrf => Rotation::from_xyzw(xyzw).map_err(refused)?.then(tilt),
            };
            Ok(Measured { at: row.at, attitude: to_detector.then(sensor) })
        })
        .collect()
}

/// Each row's rotation from the model's to the measured attitude, about the boresight frame's axes.
fn residuals(
    world: &World,
    sun: &SunModel<'_>,
    (history, measured): (&History, &[Measured]),
    fitted: Option<&Fit>,
) -> Result<Vec<Row>, onboard_core::ephemeris::EphemerisError> {
    let vector = |model: Rotation<Boresight, Ecliptic>, seen: Rotation<Boresight, Ecliptic>| {
        // Seen = error, then model.
        rotation_vector(seen.then(model.inverse())).map(|it| it * ARCSECONDS_PER_RADIAN)
    };
    let length = |[x, y, z]: [f64; 3]| x.hypot(y).hypot(z);
    history
        .rows
        .iter()
        .zip(measured)
        .enumerate()
        .map(|(index, (row, seen))| {
            let off = vector(attitude(&world.scan, sun, row.at)?, seen.attitude);
            let rest = match fitted {
                Some(fit) => Some(vector(fit.attitude(&world.scan, sun, row.at)?, seen.attitude)),
                None => None,
            };
            Ok(Row {
                line: row.line,
                elapsed_s: world.scan.elapsed(row.at).seconds(),
                time_tdb: format_tdb(row.at),
                tai_ns: row.at.tai_ns(),
                residual_x_arcsec: off[0],
                residual_y_arcsec: off[1],
                residual_z_arcsec: off[2],
                residual_arcsec: length(off),
                fit_x_arcsec: rest.map(|it| it[0]),
                fit_y_arcsec: rest.map(|it| it[1]),
                fit_z_arcsec: rest.map(|it| it[2]),
                fit_arcsec: rest.map(length),
                outlier: fitted.is_some_and(|fit| !fit.used[index]),
            })
        })
        .collect()
}
