//! Headers and rows of a FITS file as bytes come in.
//!
//! Method: [FITS4, sections 3 and 7.3]. Sizes that a header claims are never believed: a row is held
//! only as far as the file has bytes for it.

use super::card::{CARD, Keywords};
use super::error::Beginning;
use super::{BLOCK, FitsError};
use std::io::Read;

/// Most cards of a header.
const MOST_CARDS: usize = 50_000;

/// A column of a table.
#[derive(Debug)]
pub(super) struct Field {
    /// `TTYPE`, or the column's number.
    pub(super) name: String,
    /// `TFORM`.
    pub(super) form: String,
    /// `TUNIT`.
    pub(super) unit: String,
    /// Values of a row.
    pub(super) repeat: u64,
    code: u8,
    offset: u64,
    scale: f64,
    zero: f64,
    null: Option<i64>,
}

/// The header of a table, and where its rows are.
#[derive(Debug)]
pub(super) struct Table {
    pub(super) keywords: Keywords,
    pub(super) fields: Vec<Field>,
    pub(super) rows: u64,
    row_bytes: u64,
}

/// Reads up to the table that holds a HEALPix map.
pub(super) fn find_map(source: &mut dyn Read) -> Result<Table, FitsError> {
    let primary = read_header(source, true)?.ok_or(FitsError::NotFits(Beginning::Empty))?;
    skip_data(source, &primary)?;
    while let Some(keywords) = read_header(source, false)? {
        let is = |keyword, value: &str| {
            keywords.text(keyword).is_some_and(|text| text.trim().eq_ignore_ascii_case(value))
        };
        if is("XTENSION", "BINTABLE") && is("PIXTYPE", "HEALPIX") {
            return Table::of(keywords);
        }
        skip_data(source, &keywords)?;
    }
    Err(FitsError::NoMap)
}

/// The next header; none at the file's end or before bytes that are no header.
fn read_header(source: &mut dyn Read, first: bool) -> Result<Option<Keywords>, FitsError> {
    let mut keywords = Keywords::default();
    let mut block = Vec::with_capacity(BLOCK);
    for number in 0..MOST_CARDS.div_ceil(BLOCK / CARD) {
        block.clear();
        source.take(BLOCK as u64).read_to_end(&mut block)?;
        if number == 0 {
            let begins = if first { &b"SIMPLE  = "[..] } else { &b"XTENSION"[..] };
            if !block.starts_with(begins) {
                return if first {
                    Err(FitsError::NotFits(Beginning::of(&block)))
                } else {
                    Ok(None)
                };
            }
        }
        if block.len() < BLOCK {
            return Err(FitsError::Truncated("a header"));
        }
        if !block.chunks(CARD).all(|card| keywords.take(card)) {
            return Ok(Some(keywords));
        }
    }
    Err(FitsError::Endless(MOST_CARDS))
}

fn illegal(keywords: &Keywords, keyword: &str, legal: &'static str) -> FitsError {
    FitsError::Header { keyword: keyword.to_owned(), value: keywords.shown(keyword), legal }
}

fn size(keywords: &Keywords, keyword: &str) -> Result<u64, FitsError> {
    keywords
        .integer(keyword)
        .and_then(|value| u64::try_from(value).ok())
        .ok_or_else(|| illegal(keywords, keyword, "a whole number from 0 is needed"))
}

/// Passes over what a header describes: `|BITPIX| / 8 GCOUNT (PCOUNT + NAXIS1 .. NAXISn)` bytes.
fn skip_data(source: &mut dyn Read, keywords: &Keywords) -> Result<(), FitsError> {
    const LEGAL: &str = "the data would be larger than any file";
    let axes = size(keywords, "NAXIS")?;
    if axes > 999 {
        return Err(illegal(keywords, "NAXIS", "0 to 999 is needed"));
    }
    let mut values = u64::from(axes > 0);
    for axis in 1..=axes {
        let keyword = format!("NAXIS{axis}");
        values = values
            .checked_mul(size(keywords, &keyword)?)
            .ok_or_else(|| illegal(keywords, &keyword, LEGAL))?;
    }
    let or = |keyword, default| match keywords.integer(keyword) {
        Some(_) => size(keywords, keyword),
        None => Ok(default),
    };
    let bits = keywords
        .integer("BITPIX")
        .filter(|bits| [8, 16, 32, 64, -32, -64].contains(bits))
        .ok_or_else(|| illegal(keywords, "BITPIX", "8, 16, 32, 64, -32 or -64 is needed"))?;
    let bytes = (values.checked_add(or("PCOUNT", 0)?))
        .and_then(|values| values.checked_mul(or("GCOUNT", 1).ok()?))
        .and_then(|values| values.checked_mul(bits.unsigned_abs() / 8))
        .and_then(|bytes| bytes.checked_next_multiple_of(BLOCK as u64))
        .ok_or_else(|| illegal(keywords, "PCOUNT", LEGAL))?;
    let bytes = if axes == 0 { 0 } else { bytes };
    if std::io::copy(&mut source.take(bytes), &mut std::io::sink())? == bytes {
        Ok(())
    } else {
        Err(FitsError::Truncated("the data of an extension"))
    }
}

/// Bytes of `repeat` values of a type; none for an unknown one.
fn width(code: u8, repeat: u64) -> Option<u64> {
    let one = match code {
        b'X' => return Some(repeat.div_ceil(8)),
        b'L' | b'B' | b'A' => 1,
        b'I' => 2,
        b'J' | b'E' => 4,
        b'K' | b'D' | b'C' | b'P' => 8,
        b'M' | b'Q' => 16,
        _ => return None,
    };
    repeat.checked_mul(one)
}

impl Table {
    fn of(keywords: Keywords) -> Result<Self, FitsError> {
        let count = size(&keywords, "TFIELDS")?;
        if count > 999 {
            return Err(illegal(&keywords, "TFIELDS", "0 to 999 is needed"));
        }
        let (row_bytes, rows) = (size(&keywords, "NAXIS1")?, size(&keywords, "NAXIS2")?);
        let mut fields = Vec::new();
        let mut end = 0_u64;
        for number in 1..=count {
            let key = |name| format!("{name}{number}");
            let illegal_form = || {
                illegal(
                    &keywords,
                    &key("TFORM"),
                    "a count and one of L X B I J K A E D C M P Q is needed",
                )
            };
            let form = keywords.text(&key("TFORM")).ok_or_else(illegal_form)?.trim();
            let digits = form.find(|c: char| !c.is_ascii_digit()).ok_or_else(illegal_form)?;
            let (repeat, rest) = form.split_at(digits);
            let repeat = if repeat.is_empty() { Ok(1) } else { repeat.parse() };
            let repeat = repeat.map_err(|_| illegal_form())?;
            let code = rest.bytes().next().ok_or_else(illegal_form)?;
            let bytes = width(code, repeat).ok_or_else(illegal_form)?;
            let name = keywords.text(&key("TTYPE")).unwrap_or("").trim();
            fields.push(Field {
                name: if name.is_empty() { number.to_string() } else { name.to_owned() },
                form: form.to_owned(),
                unit: keywords.text(&key("TUNIT")).unwrap_or("").to_owned(),
                repeat,
                code,
                offset: end,
                scale: keywords.real(&key("TSCAL")).unwrap_or(1.0),
                zero: keywords.real(&key("TZERO")).unwrap_or(0.0),
                null: keywords.integer(&key("TNULL")),
            });
            end = end.checked_add(bytes).ok_or_else(illegal_form)?;
        }
        if end != row_bytes {
            return Err(illegal(&keywords, "NAXIS1", "the sum of the columns' widths is needed"));
        }
        Ok(Self { keywords, fields, rows, row_bytes })
    }

    /// The first column with one of these names, in letters of any case.
    pub(super) fn named(&self, names: &[&str]) -> Option<usize> {
        let is = |found: &str| names.iter().any(|name| name.eq_ignore_ascii_case(found));
        self.fields.iter().position(|field| is(&field.name))
    }

    /// The resolution whose whole sky the first column of numbers holds: 12 `nside`^2 values.
    pub(super) fn nside_of_values(&self) -> Option<u32> {
        let field = self.fields.iter().find(|it| it.is_numeric())?;
        let values = field.repeat.checked_mul(self.rows)?;
        let nside = u32::try_from((values / 12).isqrt()).ok()?;
        (u64::from(nside).pow(2).checked_mul(12)? == values).then_some(nside)
    }

    /// Names of all columns.
    pub(super) fn names(&self) -> String {
        let names: Vec<_> = self.fields.iter().map(|field| field.name.as_str()).collect();
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    }

    /// Columns by their numbers from 0, row after row.
    pub(super) fn read(
        &self,
        source: &mut dyn Read,
        columns: &[usize],
    ) -> Result<Vec<Vec<f64>>, FitsError> {
        let mut values = vec![Vec::new(); columns.len()];
        let mut row = Vec::new();
        for _ in 0..self.rows {
            row.clear();
            source.take(self.row_bytes).read_to_end(&mut row)?;
            if row.len() as u64 != self.row_bytes {
                return Err(FitsError::Truncated("its table"));
            }
            for (&column, values) in columns.iter().zip(&mut values) {
                if let Some(field) = self.fields.get(column) {
                    field.read(&row, values)?;
                }
            }
        }
        Ok(values)
    }
}

impl Field {
    fn read(&self, row: &[u8], values: &mut Vec<f64>) -> Result<(), FitsError> {
        let unreadable = || FitsError::Form { column: self.name.clone(), form: self.form.clone() };
        let bytes = width(self.code, self.repeat)
            .and_then(|bytes| {
                let start = usize::try_from(self.offset).ok()?;
                row.get(start..start.checked_add(usize::try_from(bytes).ok()?)?)
            })
            .ok_or_else(unreadable)?;
        let scaled = |value: f64| self.zero + self.scale * value;
        #[expect(clippy::cast_precision_loss, reason = "a map's values are f64")]
        let whole = |value: i64| {
            if self.null == Some(value) { f64::NAN } else { scaled(value as f64) }
        };
        match self.code {
            b'B' => values.extend(bytes.iter().map(|&byte| whole(i64::from(byte)))),
            b'I' => values.extend(each(bytes).map(|b| whole(i64::from(i16::from_be_bytes(b))))),
            b'J' => values.extend(each(bytes).map(|b| whole(i64::from(i32::from_be_bytes(b))))),
            b'K' => values.extend(each(bytes).map(|b| whole(i64::from_be_bytes(b)))),
            b'E' => values.extend(each(bytes).map(|b| scaled(f64::from(f32::from_be_bytes(b))))),
            b'D' => values.extend(each(bytes).map(|b| scaled(f64::from_be_bytes(b)))),
            _ => return Err(unreadable()),
        }
        Ok(())
    }

    /// Whether it holds numbers that [`Table::read`] reads.
    pub(super) const fn is_numeric(&self) -> bool {
        matches!(self.code, b'B' | b'I' | b'J' | b'K' | b'E' | b'D')
    }
}

/// Values of `N` bytes each.
fn each<const N: usize>(bytes: &[u8]) -> impl Iterator<Item = [u8; N]> {
    bytes.as_chunks().0.iter().copied()
}
