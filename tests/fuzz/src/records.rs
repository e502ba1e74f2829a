//! Clock correlations and rollback orders, as they are and repaired.

use crate::input::Input;
use crate::repair;
use onboard_core::clock::{CLOCK_BYTES, ClockCorrelation, ClockError};
use onboard_core::time::Instant;
use onboard_core::uplink::{
    MISSION_CHANGE_BYTES, MissionChangeOrder, ROLLBACK_BYTES, RollbackOrder, SequenceError,
};

/// Reads a correlation and an order from the front of the bytes, and counters from the rest.
pub fn run(data: &[u8]) {
    let mut input = Input(data);
    if let Some(bytes) = input.array::<CLOCK_BYTES>() {
        let counters = input.rest().as_chunks::<8>().0;
        for image in [bytes, repair::record(&bytes, *b"GYRCLOCK")] {
            if let Ok(record) = ClockCorrelation::from_le_bytes(&image) {
                assert_eq!(record.to_le_bytes(), image);
                let newest = record.sequence;
                let older = SequenceError::Older { candidate: newest, newest };
                assert_eq!(
                    record.replacing(Some(&record), record.spacecraft),
                    Err(ClockError::Sequence(older))
                );
                let near = [0, 1, u64::MAX, 1 << 63].map(|it| record.ticks.wrapping_add(it));
                let given = counters.iter().take(32).map(|it| u64::from_le_bytes(*it));
                for ticks in near.into_iter().chain(given) {
                    assert_eq!(record.instant(ticks), by_definition(&record, ticks), "{ticks}");
                }
            }
        }
    }
    if let Some(bytes) = data.first_chunk::<ROLLBACK_BYTES>() {
        for image in [*bytes, repair::record(bytes, *b"GYRBACK\0")] {
            if let Ok(order) = RollbackOrder::from_le_bytes(&image) {
                assert_eq!(order.to_le_bytes(), image);
                assert!(order.to < order.from);
            }
        }
    }
    if let Some(bytes) = data.first_chunk::<MISSION_CHANGE_BYTES>() {
        for image in [*bytes, repair::record(bytes, *b"GYRCHNGE")] {
            if let Ok(order) = MissionChangeOrder::from_le_bytes(&image) {
                assert_eq!(order.to_le_bytes(), image);
                assert_ne!(order.to, order.from);
            }
        }
    }
}

/// The floor of reference plus difference times the tick's length, in signed wide integers.
fn by_definition(record: &ClockCorrelation, ticks: u64) -> Result<Instant, ClockError> {
    let beyond = ClockError::BeyondScale;
    let difference = i128::from(ticks.wrapping_sub(record.ticks).cast_signed());
    let whole = i128::try_from(record.tick_bits >> 64).map_err(|_| beyond)?;
    // The tick's fraction in two halves of 32 bits: every product stays inside an i128, and the
    // right shift of a negative number rounds down.
    let high = i128::try_from((record.tick_bits >> 32) & 0xffff_ffff).map_err(|_| beyond)?;
    let low = i128::try_from(record.tick_bits & 0xffff_ffff).map_err(|_| beyond)?;
    let fraction = (difference * high + ((difference * low) >> 32)) >> 32;
    let exact_floor =
        difference.checked_mul(whole).and_then(|ns| ns.checked_add(fraction)).ok_or(beyond)?;
    let offset = i64::try_from(exact_floor).map_err(|_| beyond)?;
    // The record counts its offset as a magnitude, which holds one value less on the negative side.
    let offset = if offset == i64::MIN { return Err(beyond) } else { offset };
    let at = record.at.tai_ns().checked_add(offset).map(Instant::from_tai_ns).ok_or(beyond)?;
    if at > record.valid_until {
        Err(ClockError::Expired(record.valid_until))
    } else if at < record.valid_from {
        Err(ClockError::NotYetValid(record.valid_from))
    } else {
        Ok(at)
    }
}
