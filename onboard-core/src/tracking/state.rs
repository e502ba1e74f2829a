//! What a tracker remembers across a reset, as bytes.
//!
//! | bytes of the record | field |
//! |---|---|
//! | 0..12 | head, kind `TRCK`, version 1 ([`crate::record`]) |
//! | 12..16 | CRC-32 of the nominal strategy, u32 |
//! | 16..88 | strategy as corrected: start, alpha, beta, precession, spin |
//! | 88..96 | instant that the covariance belongs to, i64 ns of TAI |
//! | 96..216 | upper half of the covariance, row by row, 15 f64 |
//! | 216..220 | accepted measurements, u32 |
//! | 220..224 | refused ones since, u32 |
//! | 224..228 | CRC-32 |

use super::filter::ErrorCovariance;
use crate::bytes::{instant_at, put, u32_at};
use crate::convert::{rolled, uncounted};
use crate::record::{FRAME_BYTES, Kind, RecordError};
use crate::scan::{SCAN_BYTES, ScanParameters};
use crate::time::Instant;

/// Bytes of a saved tracker.
pub const TRACKER_BYTES: usize = FRAME_BYTES + 4 + SCAN_BYTES + 8 + 8 * NUMBERS + 8;

const KIND: Kind = Kind { letters: *b"TRCK", version: 1 };
/// Numbers of a symmetric covariance.
const NUMBERS: usize = 15;

/// All that a tracker must remember to go on with the same bits: [`TrackerState::to_le_bytes`] saves
/// it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackerState {
    /// CRC-32 of the nominal strategy that the tracker began with.
    pub(super) nominal: u32,
    pub(super) scan: ScanParameters,
    /// Instant that the covariance belongs to.
    pub(super) epoch: Instant,
    pub(super) covariance: ErrorCovariance,
    pub(super) accepted: u32,
    pub(super) refused_in_a_row: u32,
}

impl TrackerState {
    /// The record to save, for this spacecraft (the identity in the tables' header).
    #[must_use]
    #[inline(never)]
    pub fn to_le_bytes(&self, spacecraft: u32) -> [u8; TRACKER_BYTES] {
        let mut record = [0; TRACKER_BYTES];
        put(&mut record, 12, self.nominal.to_le_bytes());
        put(&mut record, 16, self.scan.to_le_bytes());
        put(&mut record, 88, self.epoch.tai_ns().to_le_bytes());
        let mut offset = 96_usize;
        for number in self.covariance.upper() {
            put(&mut record, offset, number.to_le_bytes());
            offset = offset.wrapping_add(8);
        }
        put(&mut record, 216, self.accepted.to_le_bytes());
        put(&mut record, 220, self.refused_in_a_row.to_le_bytes());
        KIND.seal(&mut record, spacecraft);
        record
    }

    /// Reads a saved state; [`Tracker::resume`](super::Tracker::resume) checks what it says.
    ///
    /// # Errors
    /// [`RecordError`] when it is damaged, of another version, or another spacecraft's.
    #[inline(never)]
    pub fn from_le_bytes(
        record: &[u8; TRACKER_BYTES],
        spacecraft: u32,
    ) -> Result<Self, RecordError> {
        KIND.open(record, spacecraft)?;
        let mut upper = [0.0; NUMBERS];
        let saved = record.get(96..).unwrap_or(&[]).as_chunks().0;
        for (number, bytes) in upper.iter_mut().zip(saved).take(uncounted(NUMBERS)) {
            rolled();
            *number = f64::from_le_bytes(*bytes);
        }
        let fields = || {
            Some(Self {
                nominal: u32_at(record, 12)?,
                scan: ScanParameters::from_le_bytes(record.get(16..)?)?,
                epoch: instant_at(record, 88)?,
                covariance: ErrorCovariance::of_upper(upper),
                accepted: u32_at(record, 216)?,
                refused_in_a_row: u32_at(record, 220)?,
            })
        };
        fields().ok_or(RecordError::Damaged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::{Phase, Rotor, TurnRate};
    use crate::scan::ScanStrategy;
    use crate::time::Duration;
    use crate::tracking::{ResumeError, Tracker, TrackerSettings};

    const SETTINGS: TrackerSettings = TrackerSettings {
        angle_sigmas_rad: [0.01, 0.02, 0.03],
        rate_sigmas: [1e-5; 2],
        angle_walks: [0.0; 3],
        rate_walks: [0.0; 2],
        max_age: Duration::from_ns(1),
        max_lead: Duration::ZERO,
        gate: 21.1,
        limits_rad: [0.1; 3],
    };

    /// Spin once in so many seconds, alpha in degrees; start, beta and precession are the same.
    fn tracker(spin_s: u128, alpha_deg: f64) -> Tracker {
        let rotor = |seconds: u128| Rotor {
            rate: TurnRate::from_bits(u128::MAX / (seconds * 1_000_000_000)),
            start: Phase::ZERO,
        };
        let scan = ScanStrategy::new(ScanParameters {
            start: Instant::from_tai_ns(0),
            alpha_rad: alpha_deg.to_radians(),
            beta_rad: 0.8,
            precession: rotor(11_541),
            spin: rotor(spin_s),
        });
        Tracker::new(&scan.unwrap(), &SETTINGS, Instant::from_tai_ns(5)).unwrap()
    }

    #[test]
    // REQ-TRACK-3.
    fn a_tracker_comes_back_and_no_flipped_bit_passes() {
        let saved = tracker(1200, 45.0).state();
        let record = saved.to_le_bytes(7);
        let mut other = tracker(1200, 45.0);
        let read = TrackerState::from_le_bytes(&record, 7).unwrap();
        assert_eq!(read, saved);
        assert_eq!(other.resume(&read), Ok(()));
        assert_eq!(other.state(), saved);
        for bit in 0..TRACKER_BYTES * 8 {
            let mut bad = record;
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(TrackerState::from_le_bytes(&bad, 7).is_err(), "bit {bit}");
        }
    }

    #[test]
    // REQ-TRACK-3.
    fn another_mission_is_refused() {
        let state = tracker(1014, 30.0).state();
        let record = state.to_le_bytes(7);
        let other = RecordError::OtherSpacecraft { record: 7, flown: 8 };
        assert_eq!(TrackerState::from_le_bytes(&record, 8).unwrap_err(), other);
        let mut flown = tracker(1200, 45.0);
        let before = flown.state();
        assert_eq!(flown.resume(&state), Err(ResumeError::OtherStrategy));
        assert_eq!(flown.resume(&tracker(1200, 44.0).state()), Err(ResumeError::OtherStrategy));
        assert_eq!(flown.state(), before);
        // A restart makes the new strategy the nominal one.
        let own = tracker(1014, 30.0);
        flown.restart(own.strategy(), Instant::from_tai_ns(9));
        assert_eq!(flown.resume(&state), Ok(()));
    }

    #[test]
    fn what_a_record_says_is_checked() {
        let mut flown = tracker(1200, 45.0);
        let good = flown.state();
        let scan = ScanParameters { alpha_rad: 4.0, ..good.scan };
        let refused = flown.resume(&TrackerState { scan, ..good });
        assert!(matches!(refused, Err(ResumeError::Scan(_))));
        let covariance = ErrorCovariance::of_upper([-1.0; NUMBERS]);
        let refused = flown.resume(&TrackerState { covariance, ..good });
        assert_eq!(refused, Err(ResumeError::Covariance));
        let scan = ScanParameters { beta_rad: 0.5, ..good.scan };
        let refused = flown.resume(&TrackerState { scan, ..good });
        assert_eq!(refused, Err(ResumeError::OtherStrategy));
        assert_eq!(flown.state(), good);
    }
}
