//! Which arrays does a SPICE DAF/SPK file hold.
//!
//! Reads the file record and the chain of summary records, and checks all that they point at:
//! identity, byte order, transfer damage, counts, addresses inside the file. No array is looked at.
//!
//! Method: NAIF's "DAF Required Reading": 1024-byte records, addresses in doubles from 1; a summary
//! record holds next, previous, count, then summaries of ND = 2 doubles and NI = 6 integers.
//!
//! Limits: integers and doubles are IEEE, of either byte order. A chain is followed at most once around the file.

mod error;

pub use error::{DafError, FilePart};

use crate::convert::count_from_f64;

const RECORD: usize = 1024;
const SUMMARY: usize = 40;
const SUMMARIES_PER_RECORD: usize = (RECORD - 24) / SUMMARY;

/// What text-mode transfers damage: line ends of all systems, and bytes above 127.
const TRANSFER_PROBE: &[u8; 28] = b"FTPSTR:\r:\n:\r\n:\r\x00:\x81:\x10\xce:ENDFTP";

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

/// In which order the bytes of a number stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    /// That of a file that [`summaries`] has taken.
    fn of(bytes: &[u8]) -> Self {
        if bytes.get(88..96) == Some(b"BIG-IEEE") { Self::Big } else { Self::Little }
    }

    fn f64(self, chunk: [u8; 8]) -> f64 {
        match self {
            Self::Little => f64::from_le_bytes(chunk),
            Self::Big => f64::from_be_bytes(chunk),
        }
    }

    fn i32_at(self, bytes: &[u8], offset: usize) -> Option<i32> {
        let chunk = *bytes.get(offset..)?.first_chunk()?;
        Some(match self {
            Self::Little => i32::from_le_bytes(chunk),
            Self::Big => i32::from_be_bytes(chunk),
        })
    }

    fn f64_at(self, bytes: &[u8], offset: usize) -> Option<f64> {
        bytes.get(offset..)?.first_chunk().map(|chunk| self.f64(*chunk))
    }
}

/// The doubles of a file, from its first byte; a rest of less than eight bytes is left out.
pub(crate) fn doubles(bytes: &[u8]) -> Vec<f64> {
    let order = ByteOrder::of(bytes);
    bytes.as_chunks::<8>().0.iter().map(|chunk| order.f64(*chunk)).collect()
}

/// The summaries of an SPK, in the order of the file.
pub(crate) fn summaries(bytes: &[u8]) -> Result<Vec<Summary>, DafError> {
    let too_short = || DafError::TooShort(bytes.len());
    let head = bytes.get(..RECORD).ok_or_else(too_short)?;
    check_identity(head)?;
    let order = ByteOrder::of(bytes);
    let integer = |offset: usize| order.i32_at(head, offset).ok_or_else(too_short);
    let (nd, ni) = (integer(8)?, integer(12)?);
    if (nd, ni) != (2, 6) {
        return Err(DafError::SummaryFormat { nd, ni });
    }
    let free = integer(84)?;
    let used = usize::try_from(free)
        .ok()
        .and_then(|free| free.checked_sub(1))
        .and_then(|doubles| doubles.checked_mul(8))
        .ok_or(DafError::FreeAddress(free))?;
    if used > bytes.len() {
        let part = FilePart::Data;
        return Err(DafError::Truncated { part, needed: used, found: bytes.len() });
    }
    let records = bytes.len().div_ceil(RECORD);
    let record_number = |end, found: i32| {
        usize::try_from(found)
            .ok()
            .filter(|number| (2..=records).contains(number))
            .ok_or(DafError::SummaryRecord { end, found, records })
    };
    let forward = record_number("first", integer(76)?)?;
    let backward = record_number("last", integer(80)?)?;
    let mut found = Vec::new();
    let (mut record, mut previous) = (forward, 0);
    for _ in 0..records {
        let next = read_record(bytes, record, previous, &mut found)?;
        if next == 0 {
            if record != backward {
                return Err(DafError::ChainEnd { found: backward, end: record });
            }
            return Ok(found);
        }
        (previous, record) = (record, next);
    }
    Err(DafError::ChainLoop)
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
        "LTL-IEEE" | "BIG-IEEE" => {}
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
        part: FilePart::SummaryRecord(record),
        needed: offset + RECORD,
        found: bytes.len(),
    };
    let content = bytes.get(offset..offset + RECORD).ok_or_else(cut)?;
    let records = bytes.len().div_ceil(RECORD);
    let order = ByteOrder::of(bytes);
    let control = |index: usize, what: &'static str, last: usize| {
        let found = order.f64_at(content, index * 8).unwrap_or(f64::NAN);
        count_from_f64(found).filter(|count| *count <= last).ok_or(DafError::Control {
            what,
            record,
            found,
            last,
        })
    };
    let next = control(0, "the next record", records)?;
    let before = control(1, "the previous record", records)?;
    let count = control(2, "the number of summaries", SUMMARIES_PER_RECORD)?;
    if before != previous {
        return Err(DafError::Previous { record, found: before, previous });
    }
    for index in 0..count {
        let number = found.len() + 1;
        found.push(read_summary((content, order), 24 + index * SUMMARY, number, bytes.len())?);
    }
    Ok(next)
}

fn read_summary(
    (content, order): (&[u8], ByteOrder),
    offset: usize,
    segment: usize,
    length: usize,
) -> Result<Summary, DafError> {
    let time = |offset| order.f64_at(content, offset).unwrap_or(f64::NAN);
    let integer = |index: usize| order.i32_at(content, offset + 16 + index * 4).unwrap_or(0);
    let (start_s, end_s) = (time(offset), time(offset + 8));
    // Two hundred thousand years: beyond any ephemeris, within any arithmetic here.
    let plausible = |time: f64| time.is_finite() && time.abs() < 6.4e12;
    if !(plausible(start_s) && plausible(end_s) && start_s < end_s) {
        return Err(DafError::Coverage { segment, start_s, end_s });
    }
    let (first, last) = (integer(4), integer(5));
    let refuse = |legal| DafError::Addresses { segment, first, last, legal };
    let (Ok(first @ 1..), Ok(end)) = (usize::try_from(first), usize::try_from(last)) else {
        return Err(refuse("positive"));
    };
    if end <= first {
        return Err(refuse("in rising order"));
    }
    if end > length / 8 {
        return Err(DafError::Truncated {
            part: FilePart::Segment(segment),
            needed: end.saturating_mul(8),
            found: length,
        });
    }
    if first <= 2 * RECORD / 8 {
        return Err(DafError::FirstAddress { segment, first });
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
