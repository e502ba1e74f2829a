//! I, Q and U out of a file.
//!
//! Columns are found by name, or taken in order where there are three. U has COSMO's sign; a file that
//! says nothing is COSMO.

use super::read::{Frames, Opened, with_file};
use super::{FitsError, FitsFileError, MapFrame};
use planner::healpix::{Nside, Ordering};
use std::io::Read;
use std::path::Path;

/// Names of columns in use for each Stokes parameter.
const NAMES: [&[&str]; 3] = [
    &["I", "T", "TEMPERATURE", "I_STOKES", "I_STOKE", "SIGNAL", "INTENSITY"],
    &[
        "Q",
        "Q_POLARISATION",
        "Q_POLARIZATION",
        "Q-POLARISATION",
        "Q-POLARIZATION",
        "Q_STOKES",
        "Q_STOKE",
    ],
    &[
        "U",
        "U_POLARISATION",
        "U_POLARIZATION",
        "U-POLARISATION",
        "U-POLARIZATION",
        "U_STOKES",
        "U_STOKE",
    ],
];

/// A polarised sky.
#[derive(Debug, Clone, PartialEq)]
pub struct StokesMap {
    /// Resolution.
    pub nside: Nside,
    /// In which order pixels stand.
    pub ordering: Ordering,
    /// Frame of longitudes and latitudes.
    pub frame: MapFrame,
    /// Unit of the first column, as written.
    pub unit: String,
    /// I by pixel, NaN where unobserved.
    pub i: Vec<f64>,
    /// Q.
    pub q: Vec<f64>,
    /// U, COSMO.
    pub u: Vec<f64>,
}

/// Reads a file of I, Q and U.
///
/// # Errors
/// [`FitsFileError`] with the path and what [`FitsError`] says.
pub fn read_stokes(path: &Path, frames: Frames) -> Result<StokesMap, FitsFileError> {
    with_file(path, |source| read_stokes_from(source, frames))
}

/// As [`read_stokes`], from bytes.
///
/// # Errors
/// [`FitsError`] says what is wrong and what would be legal.
pub fn read_stokes_from(source: &mut dyn Read, frames: Frames) -> Result<StokesMap, FitsError> {
    let opened = Opened::of(source, frames)?;
    let table = &opened.table;
    let values = opened.value_columns();
    let found = values.len();
    let columns = match NAMES.map(|names| opened.named(names)) {
        [Some(i), Some(q), Some(u)] => [i, q, u],
        _ => match values[..] {
            [i, q, u] => [i, q, u],
            _ => return Err(FitsError::Stokes { found, present: table.names() }),
        },
    };
    let iau = match table.keywords.text("POLCCONV").map(str::trim) {
        None | Some("" | "COSMO") => false,
        Some("IAU") => true,
        Some(_) => return Err(FitsError::Polcconv(table.keywords.shown("POLCCONV"))),
    };
    let unit = table.fields.get(columns[0]).map(|field| field.unit.clone()).unwrap_or_default();
    let mut maps = opened.read(source, &columns)?.into_iter();
    let mut next = || maps.next().unwrap_or_default();
    let (i, q, mut u) = (next(), next(), next());
    if iau {
        for value in &mut u {
            *value = -*value;
        }
    }
    Ok(StokesMap {
        nside: opened.nside,
        ordering: opened.ordering,
        frame: opened.frame,
        unit,
        i,
        q,
        u,
    })
}
