//! One map out of a file.
//!
//! Values come in the file's own order, NaN where unobserved: [`UNSEEN`] or `BAD_DATA` (to 1e-5, so
//! single precision is recognised), NaN, `TNULL` in a column of whole numbers, or not listed.

use super::table::{Table, find_map};
use super::{FitsError, FitsFileError, MapFrame, UNSEEN};
use flate2::bufread::MultiGzDecoder;
use planner::healpix::{Nside, Ordering};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
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
    let mut source = BufReader::with_capacity(1 << 16, file);
    let begins = source.fill_buf().map_err(|error| blame(error.into()))?;
    if begins.starts_with(GZIP) {
        read(&mut MultiGzDecoder::new(source)).map_err(blame)
    } else {
        read(&mut source).map_err(blame)
    }
}

/// How a file compressed by gzip begins.
const GZIP: &[u8] = &[0x1f, 0x8b];

/// A map's table whose header has been checked.
pub(super) struct Opened {
    pub(super) table: Table,
    pub(super) nside: Nside,
    pub(super) ordering: Ordering,
    pub(super) frame: MapFrame,
    /// Column of the pixels' numbers, where they are listed, and the number of the first pixel.
    listed: Option<(usize, u32)>,
}

impl Opened {
    pub(super) fn of(source: &mut dyn Read, frames: Frames) -> Result<Self, FitsError> {
        let table = find_map(source)?;
        let keywords = &table.keywords;
        let scheme = keywords.text("INDXSCHM").unwrap_or("IMPLICIT").trim();
        let is_listed = scheme.eq_ignore_ascii_case("EXPLICIT");
        let ordering = match keywords.text("ORDERING").unwrap_or("").trim() {
            text if text.eq_ignore_ascii_case("RING") => Ordering::Ring,
            text if text.eq_ignore_ascii_case("NESTED") => Ordering::Nested,
            _ => return Err(FitsError::Ordering(keywords.shown("ORDERING"))),
        };
        let told = keywords.integer("NSIDE").and_then(|nside| u32::try_from(nside).ok());
        let is_told = keywords.shown("NSIDE") != "nothing";
        let nside = if is_told || is_listed { told } else { table.nside_of_values() };
        let nside = nside
            .and_then(|nside| Nside::new(nside).ok())
            .ok_or_else(|| FitsError::Nside(keywords.shown("NSIDE")))?;
        let whole = nside.pixels() - 1;
        let first = keywords.integer("FIRSTPIX").unwrap_or(0);
        let listed = is_listed.then(|| {
            let column = table.named(&["PIXEL", "PIX", "PIXELS", "HPXINDEX", "INDEX"]).unwrap_or(0);
            (column, u32::from(first == 1))
        });
        let last = keywords.integer("LASTPIX").unwrap_or(first.saturating_add(whole.into()));
        // Some count pixels from 1.
        if listed.is_none()
            && !([0, 1].contains(&first) && last.checked_sub(first) == Some(whole.into()))
        {
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
        Ok(Self { table, nside, ordering, frame, listed })
    }

    /// The columns that hold values, not numbers of pixels.
    pub(super) fn value_columns(&self) -> Vec<usize> {
        let numbers = self.listed.map(|it| it.0);
        (0..self.table.fields.len()).filter(|column| Some(*column) != numbers).collect()
    }

    fn column(&self, choice: ColumnChoice) -> Result<usize, FitsError> {
        let (found, wanted) = match choice {
            ColumnChoice::Index(index) => {
                (self.value_columns().get(index).copied(), index.to_string())
            }
            ColumnChoice::Name(name) => (self.named(&[name]), name.to_owned()),
        };
        found.ok_or_else(|| FitsError::NoColumn { wanted, present: self.table.names() })
    }

    /// The first column with one of these names.
    pub(super) fn named(&self, names: &[&str]) -> Option<usize> {
        self.table.named(names)
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
            if self.listed.is_none() && found != u64::from(pixels) {
                let nside = self.nside.get();
                return Err(FitsError::Count { column, found, nside, pixels });
            }
        }
        let mut maps = match self.listed {
            None => self.table.read(source, columns)?,
            Some(listed) => self.read_listed(source, columns, listed)?,
        };
        let marks = [Some(UNSEEN), self.table.keywords.real("BAD_DATA")];
        for value in maps.iter_mut().flatten() {
            let is = |mark: &f64| (*value - mark).abs() <= 1e-5 * mark.abs();
            if marks.iter().flatten().any(is) {
                *value = f64::NAN;
            }
        }
        Ok(maps)
    }

    /// Columns whose values belong to the pixels that another column lists; NaN elsewhere.
    fn read_listed(
        &self,
        source: &mut dyn Read,
        columns: &[usize],
        (numbers, first): (usize, u32),
    ) -> Result<Vec<Vec<f64>>, FitsError> {
        let name = |column: usize| {
            self.table.fields.get(column).map(|it| it.name.clone()).unwrap_or_default()
        };
        let all: Vec<usize> = std::iter::once(numbers).chain(columns.iter().copied()).collect();
        let mut read = self.table.read(source, &all)?.into_iter();
        let listed = read.next().unwrap_or_default();
        let pixels = self.nside.pixels();
        let mut places = Vec::with_capacity(listed.len());
        let mut is_taken = vec![false; pixels as usize];
        for found in listed {
            let wrong = || FitsError::Pixel {
                column: name(numbers),
                found,
                first,
                last: first + (pixels - 1),
            };
            let place = count_from(found - f64::from(first)).ok_or_else(wrong)?;
            let taken = is_taken.get_mut(place).ok_or_else(wrong)?;
            if std::mem::replace(taken, true) {
                return Err(wrong());
            }
            places.push(place);
        }
        read.zip(columns)
            .map(|(values, &column)| {
                if values.len() != places.len() {
                    let (found, needed) = (values.len(), places.len());
                    return Err(FitsError::Listed { column: name(column), found, needed });
                }
                let mut map = vec![f64::NAN; pixels as usize];
                for (&place, value) in places.iter().zip(values) {
                    if let Some(cell) = map.get_mut(place) {
                        *cell = value;
                    }
                }
                Ok(map)
            })
            .collect()
    }
}

/// A whole number from 0 that a pixel can have.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole and from 0 to 2^32"
)]
fn count_from(number: f64) -> Option<usize> {
    let legal = (0.0..4_294_967_296.0).contains(&number) && number.fract().abs() <= 0.0;
    legal.then_some(number as usize)
}
