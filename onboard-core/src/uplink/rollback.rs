//! The explicit order to return to the older container.
//!
//! | bytes | field |
//! |---|---|
//! | 0..8 | magic `GYRBACK` and zero |
//! | 8..12 | sequence number of the active container, to be left, u32 |
//! | 12..16 | sequence number of the container to return to, u32 |
//! | 16..24 | set digest of that container, u64 |
//! | 24..32 | last instant at which the order may be carried out, i64 ns of TAI |
//! | 32..36 | zero |
//! | 36..40 | CRC of bytes 0..36 |
//!
//! An order names what it leaves and what it returns to, so that it can neither be carried out
//! twice nor hit another pair of containers than the one it was written for.
//!
//! Limits: who may send it is decided by the telecommand link's authentication.

use super::checksum;
use crate::bytes::{field, i64_at, put, u32_at, u64_at};
use crate::time::Instant;

/// Bytes of an order.
pub const ROLLBACK_BYTES: usize = 40;
const MAGIC: [u8; 8] = *b"GYRBACK\0";

/// Why the bytes are no order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum RollbackError {
    /// The first bytes are not the magic.
    NotAnOrder,
    /// The CRC does not match, or spare bytes are not zero.
    Damaged,
    /// The order returns to the same or a newer container.
    NotBack,
}

/// An order to return from one container to an older one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RollbackOrder {
    /// Sequence number of the active container.
    pub from: u32,
    /// Sequence number of the container to return to.
    pub to: u32,
    /// Set digest of the container to return to.
    pub to_digest: u64,
    /// Last instant at which the order may be carried out.
    pub until: Instant,
}

impl RollbackOrder {
    /// The order's bytes.
    #[must_use]
    pub fn to_le_bytes(&self) -> [u8; ROLLBACK_BYTES] {
        let mut bytes = [0; ROLLBACK_BYTES];
        put(&mut bytes, 0, MAGIC);
        put(&mut bytes, 8, self.from.to_le_bytes());
        put(&mut bytes, 12, self.to.to_le_bytes());
        put(&mut bytes, 16, self.to_digest.to_le_bytes());
        put(&mut bytes, 24, self.until.tai_ns().to_le_bytes());
        let crc = bytes.first_chunk::<36>().map_or(0, |covered| checksum(covered));
        put(&mut bytes, 36, crc.to_le_bytes());
        bytes
    }

    /// Reads and checks an order.
    ///
    /// # Errors
    /// [`RollbackError`], the first thing found wrong.
    pub fn from_le_bytes(bytes: &[u8; ROLLBACK_BYTES]) -> Result<Self, RollbackError> {
        if field(bytes, 0) != Some(MAGIC) {
            return Err(RollbackError::NotAnOrder);
        }
        let damaged = RollbackError::Damaged;
        let covered = bytes.first_chunk::<36>().ok_or(damaged)?;
        if u32_at(bytes, 36) != Some(checksum(covered)) || u32_at(bytes, 32) != Some(0) {
            return Err(damaged);
        }
        let order = Self {
            from: u32_at(bytes, 8).ok_or(damaged)?,
            to: u32_at(bytes, 12).ok_or(damaged)?,
            to_digest: u64_at(bytes, 16).ok_or(damaged)?,
            until: Instant::from_tai_ns(i64_at(bytes, 24).ok_or(damaged)?),
        };
        if order.to < order.from { Ok(order) } else { Err(RollbackError::NotBack) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDER: RollbackOrder =
        RollbackOrder { from: 9, to: 8, to_digest: 0x1234, until: Instant::from_tai_ns(77) };

    #[test]
    fn an_order_comes_back_and_no_flipped_bit_passes() {
        let good = ORDER.to_le_bytes();
        assert_eq!(RollbackOrder::from_le_bytes(&good), Ok(ORDER));
        for bit in 0..ROLLBACK_BYTES * 8 {
            let mut bad = good;
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(RollbackOrder::from_le_bytes(&bad).is_err(), "bit {bit}");
        }
        let forwards = RollbackOrder { to: 9, ..ORDER }.to_le_bytes();
        assert_eq!(RollbackOrder::from_le_bytes(&forwards), Err(RollbackError::NotBack));
    }
}
