//! How far each attitude of a history is off the mission, and off the fit.

use super::History;
use crate::rows::Column;
use crate::rows::Field::{Count, Number, Tdb, Truth, Whole};
use onboard_core::attitude::attitude;
use onboard_core::ephemeris::EphemerisError;
use onboard_core::frame::{Boresight, Ecliptic};
use onboard_core::rotation::Rotation;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use planner::history_fit::rotation_vector;
use planner::history_fit::{Fit, Measured};
use planner::world::World;

/// Arcseconds in a radian.
pub const ARCSECONDS_PER_RADIAN: f64 = 3600.0 * 180.0 / std::f64::consts::PI;

/// One row's residuals.
#[derive(Debug)]
pub struct Residual {
    /// Line in the file.
    pub line: usize,
    /// Seconds of the scan clock.
    pub elapsed_s: f64,
    /// When it was.
    pub at: Instant,
    /// About x, against the mission.
    pub residual_x_arcsec: f64,
    /// About y, against the mission.
    pub residual_y_arcsec: f64,
    /// About z, against the mission.
    pub residual_z_arcsec: f64,
    /// The whole, against the mission.
    pub residual_arcsec: f64,
    /// About x, against the fit.
    pub fit_x_arcsec: Option<f64>,
    /// About y, against the fit.
    pub fit_y_arcsec: Option<f64>,
    /// About z, against the fit.
    pub fit_z_arcsec: Option<f64>,
    /// The whole, against the fit.
    pub fit_arcsec: Option<f64>,
    /// The fit did not use it.
    pub outlier: bool,
}

/// The columns of a file of them.
#[must_use]
pub fn residual_columns<'r>() -> [Column<&'r Residual>; 13] {
    [
        Column::new("line", Count(|it| u64::try_from(it.line).ok())),
        Column::new("elapsed_s", Number(|it| Some(it.elapsed_s))),
        Column::new("time_tdb", Tdb(|it| it.at)),
        Column::new("tai_ns", Whole(|it| Some(it.at.tai_ns()))),
        Column::new("residual_x_arcsec", Number(|it| Some(it.residual_x_arcsec))),
        Column::new("residual_y_arcsec", Number(|it| Some(it.residual_y_arcsec))),
        Column::new("residual_z_arcsec", Number(|it| Some(it.residual_z_arcsec))),
        Column::new("residual_arcsec", Number(|it| Some(it.residual_arcsec))),
        Column::new("fit_x_arcsec", Number(|it| it.fit_x_arcsec)),
        Column::new("fit_y_arcsec", Number(|it| it.fit_y_arcsec)),
        Column::new("fit_z_arcsec", Number(|it| it.fit_z_arcsec)),
        Column::new("fit_arcsec", Number(|it| it.fit_arcsec)),
        Column::new("outlier", Truth(|it| it.outlier)),
    ]
}

/// Each row's rotation from the model's to the measured attitude, about the boresight frame's axes.
///
/// # Errors
/// [`EphemerisError`] where the Sun's table has no direction.
pub fn residuals(
    world: &World,
    sun: &SunModel<'_>,
    (history, measured): (&History, &[Measured]),
    fitted: Option<&Fit>,
) -> Result<Vec<Residual>, EphemerisError> {
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
            Ok(Residual {
                line: row.line,
                elapsed_s: world.scan.elapsed(row.at).seconds(),
                at: row.at,
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
