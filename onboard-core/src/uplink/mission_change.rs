//! The explicit order to take tables of another spacecraft: a change of mission on purpose.
//!
//! | bytes | field |
//! |---|---|
//! | 0..8 | magic `GYRCHNGE` |
//! | 8..12 | identity of the spacecraft whose tables are flown, u32 |
//! | 12..16 | identity of the spacecraft in the container to be taken, u32 |
//! | 16..24 | set digest of that container, u64 |
//! | 24..32 | last instant at which the order may be carried out, i64 ns of TAI |
//! | 32..36 | sequence number of that container, u32 |
//! | 36..40 | CRC of bytes 0..36 |
//!
//! An order names what is flown and the one container that may take its place, so that it fits no
//! other upload and cannot be carried out twice.
//!
//! Limits: who may send it is decided by the telecommand link's authentication.

use super::checksum;
use crate::bytes::{field, i64_at, put, u32_at, u64_at};
use crate::time::Instant;

/// Bytes of an order.
pub const MISSION_CHANGE_BYTES: usize = 40;
const MAGIC: [u8; 8] = *b"GYRCHNGE";

/// Why the bytes are no order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MissionChangeError {
    /// The first bytes are not the magic.
    NotAnOrder,
    /// The CRC does not match.
    Damaged,
    /// The order changes nothing.
    NoChange,
}

/// An order to take one container of another spacecraft.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MissionChangeOrder {
    /// Identity of the spacecraft whose tables are flown.
    pub from: u32,
    /// Identity of the spacecraft in the container to be taken.
    pub to: u32,
    /// Sequence number of that container.
    pub sequence: u32,
    /// Set digest of that container.
    pub set_digest: u64,
    /// Last instant at which the order may be carried out.
    pub until: Instant,
}

impl MissionChangeOrder {
    /// The order's bytes.
    #[must_use]
    pub fn to_le_bytes(&self) -> [u8; MISSION_CHANGE_BYTES] {
        let mut bytes = [0; MISSION_CHANGE_BYTES];
        put(&mut bytes, 0, MAGIC);
        put(&mut bytes, 8, self.from.to_le_bytes());
        put(&mut bytes, 12, self.to.to_le_bytes());
        put(&mut bytes, 16, self.set_digest.to_le_bytes());
        put(&mut bytes, 24, self.until.tai_ns().to_le_bytes());
        put(&mut bytes, 32, self.sequence.to_le_bytes());
        let crc = bytes.first_chunk::<36>().map_or(0, |covered| checksum(covered));
        put(&mut bytes, 36, crc.to_le_bytes());
        bytes
    }

    /// Reads and checks an order.
    ///
    /// # Errors
    /// [`MissionChangeError`], the first thing found wrong.
    pub fn from_le_bytes(bytes: &[u8; MISSION_CHANGE_BYTES]) -> Result<Self, MissionChangeError> {
        if field(bytes, 0) != Some(MAGIC) {
            return Err(MissionChangeError::NotAnOrder);
        }
        let damaged = MissionChangeError::Damaged;
        let covered = bytes.first_chunk::<36>().ok_or(damaged)?;
        if u32_at(bytes, 36) != Some(checksum(covered)) {
            return Err(damaged);
        }
        let order = Self {
            from: u32_at(bytes, 8).ok_or(damaged)?,
            to: u32_at(bytes, 12).ok_or(damaged)?,
            sequence: u32_at(bytes, 32).ok_or(damaged)?,
            set_digest: u64_at(bytes, 16).ok_or(damaged)?,
            until: Instant::from_tai_ns(i64_at(bytes, 24).ok_or(damaged)?),
        };
        if order.from == order.to { Err(MissionChangeError::NoChange) } else { Ok(order) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_comes_back_and_no_flipped_bit_passes() {
        let order = MissionChangeOrder {
            from: 3,
            to: 7,
            sequence: 12,
            set_digest: 0x0123_4567_89ab_cdef,
            until: Instant::from_tai_ns(77),
        };
        let good = order.to_le_bytes();
        assert_eq!(MissionChangeOrder::from_le_bytes(&good), Ok(order));
        for bit in 0..MISSION_CHANGE_BYTES * 8 {
            let mut bad = good;
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(MissionChangeOrder::from_le_bytes(&bad).is_err(), "bit {bit}");
        }
        let none = MissionChangeOrder { to: 3, ..order }.to_le_bytes();
        assert_eq!(MissionChangeOrder::from_le_bytes(&none), Err(MissionChangeError::NoChange));
    }
}
