//! One map out of a file.
//!
//! Values come in the file's own order, NaN where unobserved: [`UNSEEN`] (to 1e-5, so single precision
//! is recognised), NaN, or `TNULL` in a column of whole numbers.

use super::table::{Table, find_map};
use super::{FitsError, FitsFileError, MapFrame, UNSEEN};
use planner::healpix::{Nside, Ordering};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Which column of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnChoice<'a> {
    /// By number, from 0.
    Index(usize),
    /// By name, in any case of letters.
    Name(&'a str),
}

/// In which frames a map may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frames<'a> {
    /// Those accepted.
    pub accepted: &'a [MapFrame],
    /// What a file without `COORDSYS` is taken for; none refuses it.
    pub unsaid: Option<MapFrame>,
}

/// A map.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Resolution.
    pub nside: Nside,
    /// In which order pixels stand.
    pub ordering: Ordering,
    /// Frame of longitudes and latitudes.
    pub frame: MapFrame,
    /// The column's name.
    pub name: String,
    /// The column's unit, as written.
    pub unit: String,
    /// Values by pixel, NaN where unobserved.
    pub values: Vec<f64>,
}

/// Reads a column of a file.
///
/// # Errors
/// [`FitsFileError`] with the path and what [`FitsError`] says.
pub fn read_map(path: &Path, column: ColumnChoice, frames: Frames) -> Result<Map, FitsFileError> {
    with_file(path, |source| read_map_from(source, column, frames))
}

/// As [`read_map`], from bytes.
///
/// # Errors
/// [`FitsError`] says what is wrong and what would be legal.
pub fn read_map_from(
    source: &mut dyn Read,
    column: ColumnChoice,
    frames: Frames,
) -> Result<Map, FitsError> {
    let opened = Opened::of(source, frames)?;
    let column = opened.column(column)?;
    let values = opened.read(source, &[column])?.pop().unwrap_or_default();
    let field = opened.table.fields.get(column);
    Ok(Map {
        nside: opened.nside,
        ordering: opened.ordering,
        frame: opened.frame,
        name: field.map(|field| field.name.clone()).unwrap_or_default(),
        unit: field.map(|field| field.unit.clone()).unwrap_or_default(),
        values,
    })
}

/// Several columns of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Resolution.
    pub nside: Nside,
    /// In which order pixels stand.
    pub ordering: Ordering,
    /// Frame of longitudes and latitudes.
    pub frame: MapFrame,
    /// Each column's name, and its values by pixel, NaN where unobserved.
    pub columns: Vec<(String, Vec<f64>)>,
}

/// Reads columns of a file in one pass, of each the first that has one of its names.
///
/// # Errors
/// [`FitsFileError`] with the path and what [`FitsError`] says.
pub fn read_columns(
    path: &Path,
    wanted: &[&[&str]],
    frames: Frames,
) -> Result<Columns, FitsFileError> {
    with_file(path, |source| {
        let opened = Opened::of(source, frames)?;
        let missing = |names: &[&str]| FitsError::NoColumn {
            wanted: names.join(" or "),
            present: opened.table.names(),
        };
        let found: Vec<usize> = wanted
            .iter()
            .map(|names| opened.named(names).ok_or_else(|| missing(names)))
            .collect::<Result<_, _>>()?;
        let values = opened.read(source, &found)?;
        let name = |&at: &usize| opened.table.fields.get(at).map(|field| field.name.clone());
        let names = found.iter().map(|at| name(at).unwrap_or_default());
        Ok(Columns {
            nside: opened.nside,
            ordering: opened.ordering,
            frame: opened.frame,
            columns: names.zip(values).collect(),
        })
    })
}

pub(super) fn with_file<T>(
    path: &Path,
    read: impl FnOnce(&mut dyn Read) -> Result<T, FitsError>,
) -> Result<T, FitsFileError> {
    let blame = |error: FitsError| FitsFileError { path: path.to_owned(), error };
    let file = File::open(path).map_err(|error| blame(error.into()))?;
    read(&mut BufReader::with_capacity(1 << 16, file)).map_err(blame)
}

/// A map's table whose header has been checked.
pub(super) struct Opened {
    pub(super) table: Table,
    pub(super) nside: Nside,
    pub(super) ordering: Ordering,
    pub(super) frame: MapFrame,
}

impl Opened {
    pub(super) fn of(source: &mut dyn Read, frames: Frames) -> Result<Self, FitsError> {
        let table = find_map(source)?;
        let keywords = &table.keywords;
        let scheme = keywords.text("INDXSCHM").unwrap_or("IMPLICIT").trim();
        if scheme.eq_ignore_ascii_case("EXPLICIT") {
            return Err(FitsError::Explicit);
        }
        let ordering = match keywords.text("ORDERING").unwrap_or("").trim() {
            text if text.eq_ignore_ascii_case("RING") => Ordering::Ring,
            text if text.eq_ignore_ascii_case("NESTED") => Ordering::Nested,
            _ => return Err(FitsError::Ordering(keywords.shown("ORDERING"))),
        };
        let nside = keywords
            .integer("NSIDE")
            .and_then(|nside| Nside::new(u32::try_from(nside).ok()?).ok())
            .ok_or_else(|| FitsError::Nside(keywords.shown("NSIDE")))?;
        let whole = nside.pixels() - 1;
        let first = keywords.integer("FIRSTPIX").unwrap_or(0);
        let last = keywords.integer("LASTPIX").unwrap_or(i64::from(whole));
        if (first, last) != (0, i64::from(whole)) {
            return Err(FitsError::Part { first, last, whole });
        }
        let frame = match keywords.text("COORDSYS").map(str::trim) {
            None | Some("") => frames.unsaid,
            Some(text) => MapFrame::of(text).filter(|frame| frames.accepted.contains(frame)),
        };
        let frame = frame.ok_or_else(|| FitsError::Frame {
            found: keywords.shown("COORDSYS"),
            legal: frames.accepted.to_vec(),
        })?;
        Ok(Self { table, nside, ordering, frame })
    }

    fn column(&self, choice: ColumnChoice) -> Result<usize, FitsError> {
        let (found, wanted) = match choice {
            ColumnChoice::Index(index) => {
                (Some(index).filter(|&index| index < self.table.fields.len()), index.to_string())
            }
            ColumnChoice::Name(name) => (self.named(&[name]), name.to_owned()),
        };
        found.ok_or_else(|| FitsError::NoColumn { wanted, present: self.table.names() })
    }

    /// The first column with one of these names.
    pub(super) fn named(&self, names: &[&str]) -> Option<usize> {
        let is = |found: &str| names.iter().any(|name| name.eq_ignore_ascii_case(found));
        self.table.fields.iter().position(|field| is(&field.name))
    }

    /// Columns with one value per pixel each.
    pub(super) fn read(
        &self,
        source: &mut dyn Read,
        columns: &[usize],
    ) -> Result<Vec<Vec<f64>>, FitsError> {
        let pixels = self.nside.pixels();
        for field in columns.iter().filter_map(|&column| self.table.fields.get(column)) {
            let column = field.name.clone();
            if !field.is_numeric() {
                return Err(FitsError::Form { column, form: field.form.clone() });
            }
            let found = field.repeat.saturating_mul(self.table.rows);
            if found != u64::from(pixels) {
                let nside = self.nside.get();
                return Err(FitsError::Count { column, found, nside, pixels });
            }
        }
        let mut maps = self.table.read(source, columns)?;
        for value in maps.iter_mut().flatten() {
            if (*value - UNSEEN).abs() < 1e-5 * UNSEEN.abs() {
                *value = f64::NAN;
            }
        }
        Ok(maps)
    }
}
