//! The columns of a table: a name, and what each holds of a row.
//!
//! A name ends with its unit or its time scale (`_s`, `_deg`, `_utc`); what a column holds is its type.

use ephem::time::{format_tdb, format_utc};
use onboard_core::time::Instant;
use serde::{Serialize, Serializer};
use std::borrow::Cow;

/// A column of rows `R`.
#[derive(Debug)]
pub struct Column<R> {
    /// Its name.
    pub name: &'static str,
    /// What it holds of a row.
    pub field: Field<R>,
}

impl<R> Column<R> {
    /// A name, and what it stands for.
    #[must_use]
    pub const fn new(name: &'static str, field: Field<R>) -> Self {
        Self { name, field }
    }
}

/// What a column holds of a row, by its kind.
#[derive(Debug)]
pub enum Field<R> {
    /// A number with a fraction.
    Number(fn(&R) -> Option<f64>),
    /// A whole number.
    Whole(fn(&R) -> Option<i64>),
    /// A number of things.
    Count(fn(&R) -> Option<u64>),
    /// Yes or no.
    Truth(fn(&R) -> bool),
    /// Yes or no, where it is known.
    MaybeTruth(fn(&R) -> Option<bool>),
    /// Text.
    Word(fn(&R) -> Option<Cow<'_, str>>),
    /// An instant, told in UTC.
    Utc(fn(&R) -> Instant),
    /// An instant, told in TDB.
    Tdb(fn(&R) -> Instant),
    /// An instant, told in UTC, where it is known.
    MaybeUtc(fn(&R) -> Option<Instant>),
    /// An instant, told in TDB, where it is known.
    MaybeTdb(fn(&R) -> Option<Instant>),
}

impl<R> Field<R> {
    /// Its cell of a row.
    pub fn of<'r>(&self, row: &'r R) -> Cell<'r> {
        match self {
            Self::Number(of) => of(row).map_or(Cell::None, Cell::Number),
            Self::Whole(of) => of(row).map_or(Cell::None, Cell::Whole),
            Self::Count(of) => of(row).map_or(Cell::None, Cell::Count),
            Self::Truth(of) => Cell::Truth(of(row)),
            Self::MaybeTruth(of) => of(row).map_or(Cell::None, Cell::Truth),
            Self::Word(of) => of(row).map_or(Cell::None, Cell::Word),
            Self::Utc(of) => Cell::Utc(of(row)),
            Self::Tdb(of) => Cell::Tdb(of(row)),
            Self::MaybeUtc(of) => of(row).map_or(Cell::None, Cell::Utc),
            Self::MaybeTdb(of) => of(row).map_or(Cell::None, Cell::Tdb),
        }
    }
}

/// A value of a row.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell<'r> {
    /// Nothing is known or applies.
    None,
    /// A number with a fraction.
    Number(f64),
    /// A whole number.
    Whole(i64),
    /// A number of things.
    Count(u64),
    /// Yes or no.
    Truth(bool),
    /// Text.
    Word(Cow<'r, str>),
    /// An instant, told in UTC.
    Utc(Instant),
    /// An instant, told in TDB.
    Tdb(Instant),
}

/// As text formats write it: numbers in shortest round-trip form, times as ISO 8601.
impl Serialize for Cell<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::None => serializer.serialize_none(),
            Self::Number(number) => serializer.serialize_f64(*number),
            Self::Whole(number) => serializer.serialize_i64(*number),
            Self::Count(number) => serializer.serialize_u64(*number),
            Self::Truth(truth) => serializer.serialize_bool(*truth),
            Self::Word(word) => serializer.serialize_str(word),
            Self::Utc(at) => serializer.serialize_str(&format_utc(*at)),
            Self::Tdb(at) => serializer.serialize_str(&format_tdb(*at)),
        }
    }
}
