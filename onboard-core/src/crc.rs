//! The checksums of containers and records: CRC-32 (ISO-HDLC) and CRC-64 (XZ).
//!
//! Both are reflected, begin with ones and end inverted. A state is the register as it stands between
//! two pieces: begin with [`CRC_32`] or [`CRC_64`], take pieces in with [`crc_32`] or [`crc_64`], and
//! invert at the end.
//!
//! Method: CRC-32 a byte at a time through a table of 1 KiB, CRC-64, which covers eight bytes per
//! section, four bits at a time. Written out here because a general implementation, unrolled, takes 3 KiB
//! of a flight computer's code; tested against the crate `crc`.

use crate::convert::{rolled, uncounted};

/// The register of CRC-32 before any byte.
pub(crate) const CRC_32: u32 = !0;
/// The register of CRC-64 before any byte.
pub(crate) const CRC_64: u64 = !0;

const POLYNOMIAL_32: u32 = 0xedb8_8320;
const POLYNOMIAL_64: u64 = 0xc96c_5795_d787_0f42;

/// What four bits do to a register of zeros.
static NIBBLES_64: [u64; 16] = {
    let mut table = [0; 16];
    let mut rest: &mut [u64] = &mut table;
    let mut nibble = 0_u64;
    while let Some((entry, others)) = rest.split_first_mut() {
        let mut register = nibble;
        let mut bit = 0;
        while bit < 4 {
            let carry = register & 1;
            register >>= 1;
            if carry == 1 {
                register ^= POLYNOMIAL_64;
            }
            bit += 1;
        }
        *entry = register;
        nibble += 1;
        rest = others;
    }
    table
};

/// What a byte does to a register of zeros.
static BYTES_32: [u32; 256] = {
    let mut table = [0; 256];
    let mut rest: &mut [u32] = &mut table;
    let mut byte = 0_u32;
    while let Some((entry, others)) = rest.split_first_mut() {
        let mut register = byte;
        let mut bit = 0;
        while bit < 8 {
            let carry = register & 1;
            register >>= 1;
            if carry == 1 {
                register ^= POLYNOMIAL_32;
            }
            bit += 1;
        }
        *entry = register;
        byte += 1;
        rest = others;
    }
    table
};

/// The register of CRC-32 after these bytes.
#[must_use]
#[inline(never)]
pub(crate) fn crc_32(mut register: u32, bytes: &[u8]) -> u32 {
    for byte in bytes {
        rolled();
        let [low, ..] = register.to_le_bytes();
        let entry = BYTES_32.get(usize::from(low ^ byte)).copied().unwrap_or(0);
        register = entry ^ (register >> 8);
    }
    register
}

/// The register of CRC-64 after these bytes.
#[must_use]
#[inline(never)]
pub(crate) fn crc_64(mut register: u64, bytes: [u8; 8]) -> u64 {
    register ^= u64::from_le_bytes(bytes);
    let mut nibbles = uncounted(1 << 15);
    while nibbles != 0 {
        rolled();
        let [low, ..] = register.to_le_bytes();
        let entry = NIBBLES_64.get(usize::from(low & 15)).copied().unwrap_or(0);
        register = entry ^ (register >> 4);
        nibbles >>= 1;
    }
    register
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crc::{CRC_32_ISO_HDLC, CRC_64_XZ, Crc};
    use proptest::prelude::*;
    use std::vec::Vec;

    proptest! {
        #[test]
        fn both_are_what_their_catalogue_says(bytes: Vec<u8>, words: Vec<[u8; 8]>, cut in 0..64_usize) {
            let (first, second) = bytes.split_at(cut.min(bytes.len()));
            let register = crc_32(crc_32(CRC_32, first), second);
            prop_assert_eq!(!register, Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(&bytes));
            let register = words.iter().fold(CRC_64, |register, word| crc_64(register, *word));
            let whole = words.concat();
            prop_assert_eq!(!register, Crc::<u64>::new(&CRC_64_XZ).checksum(&whole));
        }
    }
}
