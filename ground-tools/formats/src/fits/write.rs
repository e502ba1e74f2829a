//! A map's file from its columns, value by value.
//!
//! Pixels stand in the order of [`MapHeader::ordering`]; the frame is the header's. A row holds 1024
//! pixels of each column where their number allows, one otherwise. NaN is written as [`UNSEEN`].
//!
//! Method: [FITS4, section 7.3], big-endian.
//!
//! Limits: 999 columns. Nothing of the data is held but a row of one column.

use super::{BLOCK, Card, MapFrame, Polcconv, UNSEEN};
use crate::error::WriteError;
use planner::healpix::{Nside, Ordering};
use planner::provenance::Provenance;
use std::io::Write;

/// Most columns of a table.
const MOST_COLUMNS: usize = 999;

/// What is true of every column of a map's file.
#[derive(Debug, Clone, PartialEq)]
pub struct MapHeader {
    /// Resolution.
    pub nside: Nside,
    /// In which order pixels stand.
    pub ordering: Ordering,
    /// Frame of longitudes and latitudes.
    pub frame: MapFrame,
    /// The table's name, `EXTNAME`.
    pub name: String,
    /// The sense of polarisation angles, where a column is Q or U.
    pub polcconv: Option<Polcconv>,
    /// What else is to be said, such as [`provenance_cards`].
    pub cards: Vec<Card>,
}

/// A column's values by pixel number in the file's order.
pub enum Values<'a> {
    /// Whole numbers, such as hits.
    Integer(&'a dyn Fn(u32) -> i64),
    /// Numbers in double precision; NaN where unobserved.
    Double(&'a dyn Fn(u32) -> f64),
    /// Numbers in single precision; NaN where unobserved.
    Single(&'a dyn Fn(u32) -> f32),
}

/// A map.
pub struct Column<'a> {
    /// Its name, `TTYPE`.
    pub name: &'a str,
    /// Its unit, `TUNIT`; empty where it has none.
    pub unit: &'a str,
    /// Its values.
    pub values: Values<'a>,
}

impl Values<'_> {
    const fn code(&self) -> char {
        match self {
            Self::Integer(_) => 'K',
            Self::Double(_) => 'D',
            Self::Single(_) => 'E',
        }
    }

    const fn bytes(&self) -> u32 {
        match self {
            Self::Integer(_) | Self::Double(_) => 8,
            Self::Single(_) => 4,
        }
    }

    fn put(&self, pixels: std::ops::Range<u32>, row: &mut Vec<u8>) {
        row.clear();
        match self {
            Self::Integer(value) => pixels.for_each(|pixel| row.extend(value(pixel).to_be_bytes())),
            Self::Double(value) => pixels.for_each(|pixel| {
                let value = value(pixel);
                row.extend(if value.is_nan() { UNSEEN } else { value }.to_be_bytes());
            }),
            Self::Single(value) => pixels.for_each(|pixel| {
                let value = value(pixel);
                row.extend(if value.is_nan() { UNSEEN_SINGLE } else { value }.to_be_bytes());
            }),
        }
    }
}

/// [`UNSEEN`] in single precision.
const UNSEEN_SINGLE: f32 = -1.6375e30;

/// Writes a file of one table, a column per map.
///
/// # Errors
/// What `out` failed with, or as [`write_table`].
pub fn write_maps(
    out: &mut dyn Write,
    header: &MapHeader,
    columns: &[Column],
) -> Result<(), WriteError> {
    write_primary(out)?;
    write_table(out, header, columns)
}

/// Writes what every file begins with; tables follow.
///
/// # Errors
/// What `out` failed with.
pub fn write_primary(out: &mut dyn Write) -> Result<(), WriteError> {
    let cards = [
        Card::logical("SIMPLE", true, "FITS"),
        Card::integer("BITPIX", 8, ""),
        Card::integer("NAXIS", 0, "no data here"),
        Card::logical("EXTEND", true, "tables follow"),
    ];
    Ok(out.write_all(&header_bytes(&cards)?)?)
}

/// Writes one table behind what was written before.
///
/// # Errors
/// What `out` failed with; [`WriteError::Refused`] for an illegal keyword or more than 999 columns.
pub fn write_table(
    out: &mut dyn Write,
    header: &MapHeader,
    columns: &[Column],
) -> Result<(), WriteError> {
    if columns.is_empty() || columns.len() > MOST_COLUMNS {
        let count = columns.len();
        let problem = format!("{count} columns in one table; 1 to {MOST_COLUMNS} are legal");
        return Err(WriteError::Refused(problem));
    }
    let pixels = header.nside.pixels();
    let per_row = if pixels.is_multiple_of(1024) { 1024 } else { 1 };
    out.write_all(&header_bytes(&table_cards(header, columns, per_row))?)?;

    let mut row = Vec::new();
    let mut written = 0;
    for first in (0..pixels).step_by(per_row as usize) {
        for column in columns {
            column.values.put(first..first + per_row, &mut row);
            out.write_all(&row)?;
            written += row.len();
        }
    }
    Ok(out.write_all(&vec![0; finished(written, BLOCK)])?)
}

/// Bytes that are missing to whole blocks.
pub(super) const fn finished(written: usize, block: usize) -> usize {
    written.next_multiple_of(block) - written
}

fn table_cards(header: &MapHeader, columns: &[Column], per_row: u32) -> Vec<Card> {
    let pixels = i64::from(header.nside.pixels());
    let row: i64 = columns.iter().map(|column| i64::from(column.values.bytes() * per_row)).sum();
    let mut cards = vec![
        Card::text("XTENSION", "BINTABLE", "binary table"),
        Card::integer("BITPIX", 8, ""),
        Card::integer("NAXIS", 2, ""),
        Card::integer("NAXIS1", row, "bytes of a row"),
        Card::integer("NAXIS2", pixels / i64::from(per_row), "rows"),
        Card::integer("PCOUNT", 0, ""),
        Card::integer("GCOUNT", 1, ""),
        Card::integer("TFIELDS", i64::try_from(columns.len()).unwrap_or(i64::MAX), "columns"),
    ];
    for (number, column) in (1..).zip(columns) {
        let form = format!("{per_row}{}", column.values.code());
        cards.push(Card::text(&format!("TTYPE{number}"), column.name, ""));
        cards.push(Card::text(&format!("TFORM{number}"), &form, ""));
        if !column.unit.is_empty() {
            cards.push(Card::text(&format!("TUNIT{number}"), column.unit, ""));
        }
    }
    cards.extend([
        Card::text("EXTNAME", &header.name, ""),
        Card::text("PIXTYPE", "HEALPIX", ""),
        Card::text("ORDERING", header.ordering.name(), "order of pixels"),
        Card::integer("NSIDE", i64::from(header.nside.get()), "resolution"),
        Card::integer("FIRSTPIX", 0, "first pixel"),
        Card::integer("LASTPIX", pixels - 1, "last pixel"),
        Card::text("INDXSCHM", "IMPLICIT", "pixels in order, all of them"),
        Card::text("OBJECT", "FULLSKY", ""),
        Card::text("COORDSYS", &header.frame.letter().to_string(), header.frame.name()),
        Card::real("BAD_DATA", UNSEEN, "unobserved, in columns of floats"),
    ]);
    if let Some(polcconv) = header.polcconv {
        cards.push(Card::text("POLCCONV", polcconv.name(), "sense of polarisation angles"));
    }
    cards.extend(header.cards.iter().cloned());
    cards
}

pub(super) fn header_bytes(cards: &[Card]) -> Result<Vec<u8>, WriteError> {
    if let Some(card) = cards.iter().find(|card| !card.is_legal()) {
        return Err(WriteError::Refused(format!("FITS card {card:?}")));
    }
    let mut header = Vec::new();
    for card in cards {
        card.put(&mut header);
    }
    header.extend(b"END");
    header.resize(header.len().next_multiple_of(BLOCK), b' ');
    Ok(header)
}

/// What every output says about where it comes from.
#[must_use]
pub fn provenance_cards(provenance: &Provenance) -> Vec<Card> {
    let optional = provenance.table_sha256.as_deref();
    let mut cards = vec![
        Card::text("MISSION", &provenance.mission, "mission"),
        Card::text("MISSSHA", &provenance.mission_sha256, ""),
        Card::text("KERNEL", &provenance.kernel, "planetary kernel"),
        Card::text("KERNSHA", &provenance.kernel_sha256, ""),
        Card::text("TRAJECT", &provenance.trajectory, "trajectory"),
    ];
    cards.extend(optional.map(|sha256| Card::text("TABLESHA", sha256, "")));
    cards.extend([
        Card::text("LEAPSEC", &provenance.last_leap_second, "last leap second known"),
        Card::text("STARTTDB", &provenance.start_tdb, "zero of the scan clock, TDB"),
        Card::integer("STARTTAI", provenance.start_tai_ns, "the same, ns of TAI since J2000"),
        Card::text("CREATOR", &provenance.program, "program"),
    ]);
    cards
}
