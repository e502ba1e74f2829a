//! `gyrfalcon verify`: an attitude history against the mission.

mod report;

use super::asked::world;
use super::delivered::{form, sink};
use super::told::{print_json, tell};
use crate::cli::quantities::angle_rad;
use crate::cli::{Against, ReferenceFrame, SharedArgs, VerifyArgs};
use crate::failure::Failure;
use crate::output::Sink;
use ephem::apparent::OBLIQUITY_ARCSEC;
use ephem::time::format_tdb;
use formats::history::{ARCSECONDS_PER_RADIAN, History, Reference, residual_columns, residuals};
use formats::rows::{self, Layout};
use onboard_core::frame::{Detector, Ecliptic, Icrf};
use onboard_core::rotation::Rotation;
use planner::history_fit::{FEWEST_ROWS, FitError, Measured, fit};
use planner::provenance::Provenance;
use planner::world::TableFault;
use planner::world::World;
use report::Report;
use std::io::Read;
use std::path::Path;

pub(super) fn run(shared: &SharedArgs, arguments: &VerifyArgs) -> Result<(), Failure> {
    let limit_arcsec = angle_rad("--limit", &arguments.limit)? * ARCSECONDS_PER_RADIAN;
    let mut world = world(shared)?;
    let name = file_name(&arguments.file);
    let history = History::parse(&read(&arguments.file)?, world.zero())
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
            format: form(shared)?.of_rows()?,
            provenance: &provenance,
            columns: &residual_columns(),
        };
        let all = rows.iter().map(Ok::<_, Failure>);
        sink(shared).write_with(|out| rows::write(out, all, &layout))?;
    }
    let against_fit = arguments.against == Against::Fit;
    let mut report = Report::new(&world, &history, &rows, (fitted, limit_arcsec, against_fit));
    report.judge_resonance();
    if shared.json {
        print_json(&report.json(&provenance)?)?;
    } else if sink(shared) != Sink::Stdout || shared.out.is_none() {
        tell(&report.text(&name))?;
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
    let lines = arguments.sight.lines(&world.mission)?;
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
                    "{name}: line {}: {} TDB lies outside the mission, {} to {} TDB: another \
                     --start, --duration or window is needed",
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
