//! What is known of a target's visits, as bytes that outlive a reset.
//!
//! | bytes of the record | field |
//! |---|---|
//! | 0..12 | head, kind `VIST`, version 1 ([`crate::record`]) |
//! | 12..16 | CRC-32 of the divisions: ends and spacing of dwell, revisit, gap |
//! | 16..20 | the caller's number for the target, u32 |
//! | 20..24 | bins of a histogram, u32 |
//! | 24..28, 28..32 | visits, clipped ones among them, u32 |
//! | 32..40, 40..48 | sum of the dwells, longest gap, i64 ns |
//! | 48..56, 56..64 | entry and exit of the last visit, i64 ns of TAI |
//! | 64..68 | 1 with a longest gap, 2 with a last visit, 4 its entry clipped, 8 its exit, u32 |
//! | 68.. | dwell, revisit, gap: counts by bin, below, above, u32 each |
//! | last 4 | CRC-32 |

use crate::bytes::{i64_at, instant_at, put, u32_at};
use crate::record::{FRAME_BYTES, Kind, RecordError};
use crate::time::Duration;
use crate::uplink::checksum;
use crate::visits::{Divisions, Histogram, LastVisit, TargetVisits};

const KIND: Kind = Kind { letters: *b"VIST", version: 1 };
const FIRST_COUNT: usize = 68;

/// Bytes of a saved [`TargetVisits`] with this many bins.
#[must_use]
pub const fn visits_record_bytes(bins: usize) -> usize {
    bins.saturating_mul(4).saturating_add(8).saturating_mul(3).saturating_add(FRAME_BYTES + 56)
}

impl<const BINS: usize> TargetVisits<BINS> {
    /// Writes the record to save: for this spacecraft (the identity in the tables' header), with the
    /// log's divisions and the caller's number for the target.
    ///
    /// # Errors
    /// [`RecordError::Length`] unless the record has [`visits_record_bytes`] bytes.
    pub fn to_record(
        &self,
        divisions: &Divisions,
        target: u32,
        spacecraft: u32,
        record: &mut [u8],
    ) -> Result<(), RecordError> {
        let fixed = Fixed {
            visits: self.visits,
            clipped: self.clipped,
            dwell_sum: self.dwell_sum,
            longest_gap: self.longest_gap,
            last: self.last,
        };
        let counts = [&self.dwell, &self.revisit, &self.gap]
            .map(|it| (it.counts.as_slice(), [it.under, it.over]));
        let origin = [identity(divisions), target, spacecraft];
        write(record, BINS, origin, &fixed, &counts)
    }

    /// Reads a saved record of the same log.
    ///
    /// # Errors
    /// [`RecordError`] when it is damaged, of another version or spacecraft, or when divisions, number
    /// of bins or target are others.
    // REQ-VISIT-2.
    pub fn from_record(
        record: &[u8],
        divisions: &Divisions,
        target: u32,
        spacecraft: u32,
    ) -> Result<Self, RecordError> {
        let fixed = open(record, BINS, [identity(divisions), target, spacecraft])?;
        let mut visits = Self {
            visits: fixed.visits,
            clipped: fixed.clipped,
            dwell_sum: fixed.dwell_sum,
            longest_gap: fixed.longest_gap,
            last: fixed.last,
            dwell: Histogram::EMPTY,
            revisit: Histogram::EMPTY,
            gap: Histogram::EMPTY,
        };
        let mut rest = record.get(FIRST_COUNT..).unwrap_or(&[]);
        for histogram in [&mut visits.dwell, &mut visits.revisit, &mut visits.gap] {
            let Histogram { counts, under, over } = histogram;
            rest = read_counts(rest, counts, under, over);
        }
        Ok(visits)
    }
}

/// What a record holds beside its histograms.
struct Fixed {
    visits: u32,
    clipped: u32,
    dwell_sum: Duration,
    longest_gap: Option<Duration>,
    last: Option<LastVisit>,
}

/// Writes a record; `origin` is divisions, target and spacecraft.
#[inline(never)]
fn write(
    record: &mut [u8],
    bins: usize,
    [divisions, target, spacecraft]: [u32; 3],
    fixed: &Fixed,
    histograms: &[(&[u32], [u32; 2]); 3],
) -> Result<(), RecordError> {
    if record.len() != visits_record_bytes(bins) {
        return Err(RecordError::Length(record.len()));
    }
    record.fill(0);
    put(record, 12, divisions.to_le_bytes());
    put(record, 16, target.to_le_bytes());
    put(record, 20, narrow(bins).to_le_bytes());
    put(record, 24, fixed.visits.to_le_bytes());
    put(record, 28, fixed.clipped.to_le_bytes());
    put(record, 32, fixed.dwell_sum.ns().to_le_bytes());
    let mut flags = 0_u32;
    if let Some(gap) = fixed.longest_gap {
        put(record, 40, gap.ns().to_le_bytes());
        flags |= 1;
    }
    if let Some(last) = fixed.last {
        put(record, 48, last.entry.tai_ns().to_le_bytes());
        put(record, 56, last.exit.tai_ns().to_le_bytes());
        flags |= 2;
        flags |= u32::from(last.entry_clipped).wrapping_shl(2);
        flags |= u32::from(last.exit_clipped).wrapping_shl(3);
    }
    put(record, 64, flags.to_le_bytes());
    let mut offset = FIRST_COUNT;
    for (counts, outside) in histograms {
        for count in counts.iter().chain(outside) {
            put(record, offset, count.to_le_bytes());
            offset = offset.wrapping_add(4);
        }
    }
    KIND.seal(record, spacecraft);
    Ok(())
}

/// Checks a record, and reads what is beside its histograms.
#[inline(never)]
fn open(
    record: &[u8],
    bins: usize,
    [divisions, target, spacecraft]: [u32; 3],
) -> Result<Fixed, RecordError> {
    if record.len() != visits_record_bytes(bins) {
        return Err(RecordError::Length(record.len()));
    }
    KIND.open(record, spacecraft)?;
    let same = u32_at(record, 12) == Some(divisions)
        && u32_at(record, 16) == Some(target)
        && u32_at(record, 20) == Some(narrow(bins));
    if !same {
        return Err(RecordError::OtherOrigin);
    }
    read_fixed(record).ok_or(RecordError::Damaged)
}

#[inline(never)]
fn read_fixed(record: &[u8]) -> Option<Fixed> {
    let flags = u32_at(record, 64)?;
    let has = |flag: u32| flags & flag != 0;
    let gap = Duration::from_ns(i64_at(record, 40)?);
    let last = LastVisit {
        entry: instant_at(record, 48)?,
        exit: instant_at(record, 56)?,
        entry_clipped: has(4),
        exit_clipped: has(8),
    };
    Some(Fixed {
        visits: u32_at(record, 24)?,
        clipped: u32_at(record, 28)?,
        dwell_sum: Duration::from_ns(i64_at(record, 32)?),
        longest_gap: has(1).then_some(gap),
        last: has(2).then_some(last),
    })
}

/// Reads a histogram's counters, whose number was checked; what follows them.
#[inline(never)]
fn read_counts<'r>(
    record: &'r [u8],
    counts: &mut [u32],
    under: &mut u32,
    over: &mut u32,
) -> &'r [u8] {
    let mut numbers = record.as_chunks::<4>().0.iter();
    for (count, bytes) in counts.iter_mut().chain([under, over]).zip(&mut numbers) {
        *count = u32::from_le_bytes(*bytes);
    }
    numbers.as_slice().as_flattened()
}

fn narrow(bins: usize) -> u32 {
    u32::try_from(bins).unwrap_or(u32::MAX)
}

/// What divisions are known by.
#[inline(never)]
fn identity(divisions: &Divisions) -> u32 {
    let mut bytes = [0; 51];
    put(&mut bytes, 0, divisions.dwell.to_le_bytes());
    put(&mut bytes, 17, divisions.revisit.to_le_bytes());
    put(&mut bytes, 34, divisions.gap.to_le_bytes());
    checksum(&bytes)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::time::Instant;
    use crate::visits::{Bins, Spacing};
    use std::vec;
    use std::vec::Vec;

    const BINS: usize = 3;

    fn divisions(high_s: f64) -> Divisions {
        let bins = |spacing| Bins::new(spacing, 1.0, high_s).unwrap();
        let dwell = bins(Spacing::Linear);
        Divisions { dwell, revisit: bins(Spacing::Logarithmic), gap: dwell }
    }

    fn some() -> TargetVisits<BINS> {
        let histogram = |first| Histogram { counts: [first, 2, 3], under: 4, over: first + 5 };
        TargetVisits {
            visits: 70,
            clipped: 2,
            dwell_sum: Duration::from_ns(1_234_567_890_123),
            longest_gap: Some(Duration::from_ns(77)),
            last: Some(LastVisit {
                entry: Instant::from_tai_ns(-5),
                exit: Instant::from_tai_ns(9),
                entry_clipped: false,
                exit_clipped: true,
            }),
            dwell: histogram(10),
            revisit: histogram(20),
            gap: histogram(30),
        }
    }

    fn saved(visits: &TargetVisits<BINS>) -> Vec<u8> {
        let mut record = vec![0xaa; visits_record_bytes(BINS)];
        visits.to_record(&divisions(9.0), 4, 8, &mut record).unwrap();
        record
    }

    #[test]
    // REQ-VISIT-2.
    fn visits_come_back_and_no_flipped_bit_passes() {
        assert_eq!(visits_record_bytes(BINS), 68 + 3 * 4 * (BINS + 2) + 4);
        let read = |record: &[u8]| TargetVisits::<BINS>::from_record(record, &divisions(9.0), 4, 8);
        let alone = TargetVisits { last: None, longest_gap: None, ..some() };
        for visits in [some(), alone, TargetVisits::EMPTY] {
            let record = saved(&visits);
            assert_eq!(read(&record), Ok(visits));
            for bit in 0..record.len() * 8 {
                let mut bad = record.clone();
                bad[bit / 8] ^= 1 << (bit % 8);
                assert!(read(&bad).is_err(), "bit {bit}");
            }
        }
    }

    #[test]
    // REQ-VISIT-2.
    fn another_log_is_refused() {
        let record = saved(&some());
        let read = |high_s, target, spacecraft| {
            TargetVisits::<BINS>::from_record(&record, &divisions(high_s), target, spacecraft)
                .unwrap_err()
        };
        assert_eq!(read(8.0, 4, 8), RecordError::OtherOrigin);
        assert_eq!(read(9.0, 5, 8), RecordError::OtherOrigin);
        assert_eq!(read(9.0, 4, 7), RecordError::OtherSpacecraft { record: 8, flown: 7 });
        let length = RecordError::Length(record.len());
        let other = TargetVisits::<4>::from_record(&record, &divisions(9.0), 4, 8);
        assert_eq!(other.unwrap_err(), length);
        let mut short = [0; 20];
        let refused = some().to_record(&divisions(9.0), 4, 8, &mut short);
        assert_eq!(refused, Err(RecordError::Length(20)));
    }
}
