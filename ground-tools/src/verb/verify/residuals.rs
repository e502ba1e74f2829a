//! How far each attitude of a history is off the mission, and off the fit.

use ephem::time::format_tdb;
use formats::history::History;
use onboard_core::attitude::attitude;
use onboard_core::ephemeris::EphemerisError;
use onboard_core::frame::{Boresight, Ecliptic};
use onboard_core::rotation::Rotation;
use onboard_core::sun::SunModel;
use planner::history_fit::rotation_vector;
use planner::history_fit::{Fit, Measured};
use planner::world::World;
use serde::Serialize;

pub(super) const ARCSECONDS_PER_RADIAN: f64 = 3600.0 * 180.0 / std::f64::consts::PI;

/// The columns of a file of them.
pub(super) const COLUMNS: [&str; 13] = [
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
pub(super) struct Row {
    pub(super) line: usize,
    pub(super) elapsed_s: f64,
    pub(super) time_tdb: String,
    pub(super) tai_ns: i64,
    pub(super) residual_x_arcsec: f64,
    pub(super) residual_y_arcsec: f64,
    pub(super) residual_z_arcsec: f64,
    pub(super) residual_arcsec: f64,
    pub(super) fit_x_arcsec: Option<f64>,
    pub(super) fit_y_arcsec: Option<f64>,
    pub(super) fit_z_arcsec: Option<f64>,
    pub(super) fit_arcsec: Option<f64>,
    pub(super) outlier: bool,
}

/// Each row's rotation from the model's to the measured attitude, about the boresight frame's axes.
pub(super) fn residuals(
    world: &World,
    sun: &SunModel<'_>,
    (history, measured): (&History, &[Measured]),
    fitted: Option<&Fit>,
) -> Result<Vec<Row>, EphemerisError> {
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
