//! The checksums of containers and records: CRC-32 (ISO-HDLC) and CRC-64 (XZ), by the crate `crc`.
//!
//! A state is the register as it stands between two pieces: begin with [`CRC_32`] or [`CRC_64`], take
//! pieces in with [`crc_32`] or [`crc_64`], and invert at the end.
//!
//! Method: each stands once behind a call, because the crate's loops are otherwise written out wherever a
//! checksum is taken. CRC-32 goes through a table of 1 KiB, CRC-64, which covers eight bytes per section,
//! bit by bit.

use crc::{CRC_32_ISO_HDLC, CRC_64_XZ, Crc, NoTable};

/// The register of CRC-32 before any byte.
pub(crate) const CRC_32: u32 = !0;
/// The register of CRC-64 before any byte.
pub(crate) const CRC_64: u64 = !0;

static CHECKSUM: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
static SET_CHECKSUM: Crc<u64, NoTable> = Crc::<u64, NoTable>::new(&CRC_64_XZ);

/// The register of CRC-32 after these bytes.
#[must_use]
#[inline(never)]
pub(crate) fn crc_32(register: u32, bytes: &[u8]) -> u32 {
    let mut digest = CHECKSUM.digest_with_initial(register.reverse_bits());
    digest.update(bytes);
    !digest.finalize()
}

/// The register of CRC-64 after these bytes.
#[must_use]
#[inline(never)]
pub(crate) fn crc_64(register: u64, bytes: [u8; 8]) -> u64 {
    let mut digest = SET_CHECKSUM.digest_with_initial(register.reverse_bits());
    digest.update(&bytes);
    !digest.finalize()
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    #[test]
    fn check_values_are_the_catalogues() {
        assert_eq!(!crc_32(CRC_32, b"123456789"), 0xcbf4_3926);
        // Of eight bytes, by the division written out bit by bit.
        let divided = b"12345678".iter().fold(u64::MAX, |register, byte| {
            (0..8).fold(register ^ u64::from(*byte), |register, _| {
                (register >> 1) ^ ((register & 1) * 0xc96c_5795_d787_0f42)
            })
        });
        assert_eq!(crc_64(CRC_64, *b"12345678"), divided);
    }

    proptest! {
        #[test]
        fn pieces_give_what_the_whole_gives(bytes: Vec<u8>, cut in 0..64_usize) {
            let (first, second) = bytes.split_at(cut.min(bytes.len()));
            prop_assert_eq!(crc_32(crc_32(CRC_32, first), second), crc_32(CRC_32, &bytes));
        }
    }
}
