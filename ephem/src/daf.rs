//! Which arrays does a SPICE DAF/SPK file hold.
//!
//! Reads the file record and the chain of summary records, and checks all that they point at:
//! identity, byte order, transfer damage, counts, addresses inside the file. No array is looked at.
//!
//! Method: NAIF's "DAF Required Reading": 1024-byte records, addresses in doubles from 1; a summary
//! record holds next, previous, count, then summaries of ND = 2 doubles and NI = 6 integers.
//!
//! Limits: little-endian files only. A chain is followed at most once around the file.

use crate::convert::count_from_f64;
use thiserror::Error;

const RECORD: usize = 1024;
const SUMMARY: usize = 40;
const SUMMARIES_PER_RECORD: usize = (RECORD - 24) / SUMMARY;

/// What text-mode transfers damage: line ends of all systems, and bytes above 127.
const TRANSFER_PROBE: &[u8; 28] = b"FTPSTR:\r:\n:\r\n:\r\x00:\x81:\x10\xce:ENDFTP";

/// Why a file is not a usable SPK.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DafError {
    /// Shorter than a DAF can be.
    #[error("is too short to be an SPK: {0} bytes, and the file record alone takes 1024")]
    TooShort(usize),
    /// Not a DAF at all.
    #[error("is not a SPICE DAF: it begins with '{0}' instead of 'DAF/SPK'")]
    NotDaf(String),
    /// A DAF of another kind.
    #[error("is a SPICE file of type '{0}', not an SPK ('DAF/SPK')")]
    NotSpk(String),
    /// Written on a big-endian machine.
    #[error(
        "is big-endian (BIG-IEEE); only little-endian (LTL-IEEE) is read: convert it with NAIF's bingo"
    )]
    BigEndian,
    /// No known byte order.
    #[error("has the unknown byte order '{0}': legal is LTL-IEEE")]
    ByteOrder(String),
    /// Line ends were translated on the way.
    #[error("was damaged by a transfer in text mode: copy it again in binary mode")]
    TextTransfer,
    /// The file ends before what it describes.
    #[error("is truncated: {what} ends at byte {needed}, the file at byte {found}")]
    Truncated {
        /// What lies beyond the end.
        what: String,
        /// Bytes needed.
        needed: usize,
        /// Bytes there.
        found: usize,
    },
    /// A number of the file's structure is impossible.
    #[error("is damaged: {what} is {found}; legal is {legal}")]
    Structure {
        /// Which number.
        what: String,
        /// Its value.
        found: String,
        /// What it may be.
        legal: String,
    },
}

/// One array's summary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Summary {
    /// Coverage in TDB seconds since J2000.
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
    pub(crate) target: i32,
    pub(crate) center: i32,
    pub(crate) frame: i32,
    pub(crate) data_type: i32,
    /// Index of the first double, from 0, and of the one after the last.
    pub(crate) first: usize,
    pub(crate) end: usize,
}

fn structure(
    what: impl Into<String>,
    found: impl core::fmt::Display,
    legal: impl Into<String>,
) -> DafError {
    DafError::Structure { what: what.into(), found: found.to_string(), legal: legal.into() }
}

/// The doubles of a file, from its first byte; a rest of less than eight bytes is left out.
pub(crate) fn doubles(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks::<8>().0.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect()
}

/// The summaries of an SPK, in the order of the file.
pub(crate) fn summaries(bytes: &[u8]) -> Result<Vec<Summary>, DafError> {
    let too_short = || DafError::TooShort(bytes.len());
    let head = bytes.get(..RECORD).ok_or_else(too_short)?;
    check_identity(head)?;
    let integer = |offset: usize| i32_at(head, offset).ok_or_else(too_short);
    let (nd, ni) = (integer(8)?, integer(12)?);
    if (nd, ni) != (2, 6) {
        return Err(structure("the summary format (ND, NI)", format!("({nd}, {ni})"), "(2, 6)"));
    }
    let free = integer(84)?;
    let used = usize::try_from(free)
        .ok()
        .and_then(|free| free.checked_sub(1))
        .and_then(|doubles| doubles.checked_mul(8))
        .ok_or_else(|| structure("the first free address", free, "positive"))?;
    if used > bytes.len() {
        let what = "its data".to_owned();
        return Err(DafError::Truncated { what, needed: used, found: bytes.len() });
    }
    let records = bytes.len().div_ceil(RECORD);
    let record_number = |what: &str, value: i32| {
        usize::try_from(value)
            .ok()
            .filter(|number| (2..=records).contains(number))
            .ok_or_else(|| structure(what, value, format!("2 to {records} (the file's records)")))
    };
    let forward = record_number("the first summary record's number", integer(76)?)?;
    let backward = record_number("the last summary record's number", integer(80)?)?;
    let mut found = Vec::new();
    let (mut record, mut previous) = (forward, 0);
    for _ in 0..records {
        let next = read_record(bytes, record, previous, &mut found)?;
        if next == 0 {
            if record != backward {
                return Err(structure(
                    "the last summary record's number",
                    backward,
                    format!("{record}, where the chain ends"),
                ));
            }
            return Ok(found);
        }
        (previous, record) = (record, next);
    }
    Err(structure("the chain of summary records", "a loop", "a chain that ends"))
}

fn check_identity(head: &[u8]) -> Result<(), DafError> {
    let text = |range: core::ops::Range<usize>| {
        head.get(range).map(|bytes| bytes.escape_ascii().to_string()).unwrap_or_default()
    };
    let word = text(0..8);
    match word.trim_end() {
        "DAF/SPK" => {}
        other if other.starts_with("DAF/") || other.starts_with("NAIF/DAF") => {
            return Err(DafError::NotSpk(other.to_owned()));
        }
        other => return Err(DafError::NotDaf(other.to_owned())),
    }
    match text(88..96).as_str() {
        "LTL-IEEE" => {}
        "BIG-IEEE" => return Err(DafError::BigEndian),
        other => return Err(DafError::ByteOrder(other.to_owned())),
    }
    let probe = head.get(699..727).unwrap_or_default();
    if probe != TRANSFER_PROBE && probe.iter().any(|&byte| byte != 0) {
        return Err(DafError::TextTransfer);
    }
    Ok(())
}

/// Appends one record's summaries; the number of the next record, 0 at the end of the chain.
fn read_record(
    bytes: &[u8],
    record: usize,
    previous: usize,
    found: &mut Vec<Summary>,
) -> Result<usize, DafError> {
    let offset = (record - 1) * RECORD;
    let cut = || DafError::Truncated {
        what: format!("summary record {record}"),
        needed: offset + RECORD,
        found: bytes.len(),
    };
    let content = bytes.get(offset..offset + RECORD).ok_or_else(cut)?;
    let records = bytes.len().div_ceil(RECORD);
    let control = |index: usize, what: &str, last: usize| {
        let value = f64_at(content, index * 8).unwrap_or(f64::NAN);
        count_from_f64(value).filter(|count| *count <= last).ok_or_else(|| {
            structure(
                format!("{what} of summary record {record}"),
                value,
                format!("a whole number, 0 to {last}"),
            )
        })
    };
    let next = control(0, "the next record", records)?;
    let before = control(1, "the previous record", records)?;
    let count = control(2, "the number of summaries", SUMMARIES_PER_RECORD)?;
    if before != previous {
        return Err(structure(
            format!("the previous record of summary record {record}"),
            before,
            previous.to_string(),
        ));
    }
    for index in 0..count {
        let number = found.len() + 1;
        found.push(read_summary(content, 24 + index * SUMMARY, number, bytes.len())?);
    }
    Ok(next)
}

fn read_summary(
    content: &[u8],
    offset: usize,
    number: usize,
    length: usize,
) -> Result<Summary, DafError> {
    let time = |offset| f64_at(content, offset).unwrap_or(f64::NAN);
    let integer = |index: usize| i32_at(content, offset + 16 + index * 4).unwrap_or(0);
    let (start_s, end_s) = (time(offset), time(offset + 8));
    // Two hundred thousand years: beyond any ephemeris, within any arithmetic here.
    let plausible = |time: f64| time.is_finite() && time.abs() < 6.4e12;
    if !(plausible(start_s) && plausible(end_s) && start_s < end_s) {
        return Err(structure(
            format!("the coverage of segment {number} (TDB seconds)"),
            format!("{start_s} to {end_s}"),
            "finite, the end after the start",
        ));
    }
    let (first, last) = (integer(4), integer(5));
    let addresses = (usize::try_from(first), usize::try_from(last));
    let (Ok(first @ 1..), Ok(end)) = addresses else {
        return Err(structure(
            format!("the addresses of segment {number}"),
            format!("{first} to {last}"),
            "positive",
        ));
    };
    if end <= first {
        return Err(structure(
            format!("the addresses of segment {number}"),
            format!("{first} to {end}"),
            "in rising order",
        ));
    }
    if end > length / 8 {
        return Err(DafError::Truncated {
            what: format!("segment {number}"),
            needed: end.saturating_mul(8),
            found: length,
        });
    }
    if first <= 2 * RECORD / 8 {
        return Err(structure(
            format!("the first address of segment {number}"),
            first,
            "beyond the file's first records (257 or more)",
        ));
    }
    Ok(Summary {
        start_s,
        end_s,
        target: integer(0),
        center: integer(1),
        frame: integer(2),
        data_type: integer(3),
        first: first - 1,
        end,
    })
}

fn i32_at(bytes: &[u8], offset: usize) -> Option<i32> {
    bytes.get(offset..)?.first_chunk().map(|chunk| i32::from_le_bytes(*chunk))
}

fn f64_at(bytes: &[u8], offset: usize) -> Option<f64> {
    bytes.get(offset..)?.first_chunk().map(|chunk| f64::from_le_bytes(*chunk))
}
